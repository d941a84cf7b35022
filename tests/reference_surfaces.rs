//! The oracle on surfaces with images, masks and smooth normals, where the answer is known.

mod scene_folder;

use huygens::reference::Reference;
use huygens::scene::Scene;
use huygens::settings::Settings;
use image::{ImageBuffer, Rgb, Rgba};
use rand_pcg::Pcg64;
use scene_folder::Folder;

/// A floor from (0, 0) to (2, 1), looked at from above, under a sky of radiance 1 on both sides.
fn scene(material: &str, more: &str) -> Scene {
    let folder = Folder::new();
    // Left red, right green with a hole; linear values 1 and 0 have no curve.
    let colours = ImageBuffer::from_fn(2, 1, |x, _| Rgb([[255u8, 0, 0], [0, 255, 0]][x as usize]));
    colours.save(folder.path("colours.png")).unwrap();
    let holes = ImageBuffer::from_fn(2, 1, |x, _| Rgba([255u8, 255, 255, 255 * (1 - x as u8)]));
    holes.save(folder.path("holes.png")).unwrap();
    let text = format!(
        "[sky]\nradiance = 1\n[materials.floor]\n{material}\n[[shapes]]\nmaterial = \"floor\"\n\
         rectangle = {{ corner = [0, 0, 0], edges = [[2, 0, 0], [0, 0, -1]] }}\n{more}"
    );
    folder.with("s.toml", text).scene("s.toml")
}

/// What is seen of the floor at (x, z): one sample, with all scattering.
fn seen(scene: &Scene, x: f64, z: f64) -> [f64; 3] {
    let reference = Reference::new(scene, &Settings::default());
    let mut rng = Pcg64::new(1, 2);
    reference.li(&mut rng, [x, 1.0, z], [0.0, -1.0, 0.0], 0)
}

/// Drawn by the cosine, every sample of an unshadowed floor is its albedo, but for rounding.
#[track_caller]
fn assert_seen(scene: &Scene, x: f64, z: f64, expected: [f64; 3]) {
    let found = seen(scene, x, z);
    for c in 0..3 {
        assert!(
            (found[c] - expected[c]).abs() < 1e-12,
            "{found:?} {expected:?}"
        );
    }
}

#[test]
fn images_lie_where_their_coordinates_say() {
    let nearest = scene(
        "albedo = { file = \"colours.png\", filter = \"nearest\" }",
        "",
    );
    assert_seen(&nearest, 0.4, -0.7, [1.0, 0.0, 0.0]);
    assert_seen(&nearest, 1.6, -0.2, [0.0, 1.0, 0.0]);
    let linear = scene(
        "albedo = { file = \"colours.png\", wrap = \"clamp\", factor = 0.5 }",
        "",
    );
    assert_seen(&linear, 0.25, -0.5, [0.5, 0.0, 0.0]);
    // Three quarters of the way between the middles of the texels, at 0.5 and 1.5.
    assert_seen(&linear, 1.25, -0.5, [0.125, 0.375, 0.0]);
    let repeated = scene(
        "albedo = { file = \"colours.png\", filter = \"nearest\", scale = 2 }",
        "",
    );
    assert_seen(&repeated, 0.7, -0.5, [0.0, 1.0, 0.0]);
    let lit = scene(
        "albedo = 0\nemission = { file = \"colours.png\", filter = \"nearest\", factor = 3 }",
        "",
    );
    assert_seen(&lit, 0.4, -0.5, [3.0, 0.0, 0.0]);
}

#[test]
fn masks_let_rays_through() {
    let holes = scene(
        "albedo = 0.25\nalpha = { file = \"holes.png\", filter = \"nearest\" }",
        "",
    );
    assert_seen(&holes, 0.4, -0.5, [0.25; 3]);
    assert_seen(&holes, 1.6, -0.5, [1.0; 3]);
}

/// A normal that leans sees as much of the sky as another, but for what lies below the floor: less
/// comes back, never more, and on the side of the light more than on the other.
#[test]
fn smooth_normals_turn_the_light() {
    let mesh = |lean: f64| {
        let text = format!(
            "[[lights]]\nsun = {{ from = [1, 1, 0] }}\nirradiance = 1\n\
             [materials.m]\nalbedo = 1\n[[shapes]]\nmaterial = \"m\"\n\
             mesh = {{ vertices = [[0, 0, 0], [1, 0, 0], [0, 0, -1]], faces = [[0, 1, 2]], \
             normals = [[{lean}, 1, 0], [{lean}, 1, 0], [{lean}, 1, 0]] }}\n"
        );
        let folder = Folder::new().with("s.toml", text);
        seen(&folder.scene("s.toml"), 0.2, -0.2)[0] * std::f64::consts::PI
    };
    let half = 0.5f64.sqrt();
    // All corners alike: no cone, and the factor is 1 where the light is near the normal.
    assert!((mesh(0.0) - half).abs() < 1e-4);
    let leaning = (0.2 + 1.0) / (1.04f64.sqrt() * 2f64.sqrt());
    assert!((mesh(0.2) - leaning).abs() < 1e-3, "{}", mesh(0.2));
    assert!(mesh(-0.2) < half && mesh(0.2) > half);
}
