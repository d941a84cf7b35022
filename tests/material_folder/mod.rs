//! Scenes of one material, beside images that it may name.

#![allow(dead_code, reason = "each test binary uses its part")]

use crate::scene_folder::Folder;
use huygens::scene::Scene;
use huygens::scene::material::Material;
use image::{ImageBuffer, Luma, Rgb, Rgba};

/// A folder with images: `red.png` (2 x 2, all red), `cut.png` (2 x 1, the right half clear),
/// `grey.png` (3 x 1), `deep.png` (16 bits), `photo.jpg` and `bright.hdr` (2 x 1: 0.5 and 4).
pub(crate) fn folder() -> Folder {
    let folder = Folder::new();
    let red = ImageBuffer::from_pixel(2, 2, Rgb([255u8, 0, 0]));
    red.save(folder.path("red.png")).unwrap();
    let cut = ImageBuffer::from_fn(2, 1, |x, _| Rgba([9u8, 9, 9, if x == 0 { 255 } else { 0 }]));
    cut.save(folder.path("cut.png")).unwrap();
    let grey = ImageBuffer::from_fn(3, 1, |x, _| Luma([x as u8 * 100]));
    grey.save(folder.path("grey.png")).unwrap();
    let deep = ImageBuffer::from_pixel(2, 2, Luma([257u16]));
    deep.save(folder.path("deep.png")).unwrap();
    let photo = ImageBuffer::from_pixel(16, 8, Rgb([100u8, 100, 100]));
    photo.save(folder.path("photo.jpg")).unwrap();
    let bright = ImageBuffer::from_fn(2, 1, |x, _| Rgb([if x == 0 { 0.5f32 } else { 4.0 }; 3]));
    bright.save(folder.path("bright.hdr")).unwrap();
    folder
}

/// The scene with these materials, on one rectangle of material `m`.
pub(crate) fn text(materials: &str) -> String {
    format!(
        "{materials}\n[sky]\nradiance = 1\n[[shapes]]\nmaterial = \"m\"\n\
         rectangle = {{ corner = [0, 0, 0], edges = [[1, 0, 0], [0, 1, 0]] }}\n"
    )
}

#[track_caller]
pub(crate) fn scene(materials: &str) -> Scene {
    folder().with("s.toml", text(materials)).scene("s.toml")
}

#[track_caller]
pub(crate) fn error(materials: &str) -> String {
    folder().with("s.toml", text(materials)).error("s.toml")
}

#[track_caller]
pub(crate) fn material(materials: &str) -> Material {
    let scene = scene(materials);
    assert_eq!(scene.warnings, Vec::<String>::new());
    let m = scene.materials.iter().find(|m| m.name == "m");
    m.expect("material m").clone()
}
