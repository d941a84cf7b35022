//! Masks and partial opacity: the wave beside the reference, and where the answer is known.

mod common;
mod scene_folder;

use common::agreement::{assert_images_agree, of_images};
use common::picture::by_wave;
use common::statistics::assert_mean;
use huygens::scene::Scene;
use huygens::settings::{Settings, Strategy};
use image::{ImageBuffer, Rgb, Rgba};
use scene_folder::Folder;

fn folder() -> Folder {
    let folder = Folder::new();
    let leaf = ImageBuffer::from_fn(4, 4, |x, y| {
        let there = (x + 2 * y) % 3 > 0;
        Rgba([
            60 * x as u8,
            200,
            50 * y as u8,
            if there { 250 } else { 20 },
        ])
    });
    leaf.save(folder.path("leaf.png")).unwrap();
    let veil = ImageBuffer::from_fn(3, 3, |x, y| Rgb([(40 + 80 * x) as u8, 90 * y as u8, 0]));
    veil.save(folder.path("veil.png")).unwrap();
    folder
}

/// Two sheets of `m`, one behind the other, over a floor, under a lamp, a bulb and a sky.
fn sheets(material: &str) -> Scene {
    let sheet = |y: f64| {
        format!(
            "[[shapes]]\nmaterial = \"m\"\n\
             rectangle = {{ corner = [-0.6, {y}, 0.6], edges = [[1.2, 0.1, 0], [0, 0, -1.2]] }}\n"
        )
    };
    let text = format!(
        "[camera]\norigin = [0.3, 2.2, 1.5]\ntarget = [0, 0.2, 0]\nfov = 45\n\
         [film]\nwidth = 8\nheight = 8\nfilter = \"box\"\n\
         [sky]\nradiance = 0.3\n[materials.m]\n{material}\n\
         [materials.lamp]\nalbedo = 0\nemission = 6\n\
         [[lights]]\npoint = {{ position = [-0.5, 1.5, 0.2] }}\nintensity = 1\n\
         [[shapes]]\n\
         rectangle = {{ corner = [-2, 0, 2], edges = [[4, 0, 0], [0, 0, -4]] }}\n\
         [[shapes]]\nmaterial = \"lamp\"\n\
         rectangle = {{ corner = [0.3, 1.6, 0.4], edges = [[0, 0, -0.5], [0.5, 0, 0]] }}\n{}{}",
        sheet(0.4),
        sheet(0.7)
    );
    folder().scene_of(&text)
}

#[test]
fn masks() {
    assert_images_agree(&sheets(
        "albedo = { file = \"leaf.png\", scale = 2 }\n\
         alpha = { file = \"leaf.png\", scale = 2 }\nalpha_cutoff = 0.6",
    ));
}

#[test]
fn partial_opacity() {
    assert_images_agree(&sheets(
        "albedo = [0.9, 0.5, 0.2]\nalpha = { file = \"veil.png\", wrap = \"mirror\", factor = 0.8 }",
    ));
}

/// A ball of which one sees the far side through the near one, over a floor.
fn ball(material: &str) -> Scene {
    let text = format!(
        "[camera]\norigin = [0.3, 1.2, 2.5]\ntarget = [0, 0.4, 0]\nfov = 30\n\
         [film]\nwidth = 8\nheight = 8\nfilter = \"box\"\n\
         [sky]\nradiance = [0.6, 0.5, 0.4]\n[materials.m]\n{material}\n\
         [materials.lamp]\nalbedo = 0\nemission = 4\n\
         [[lights]]\npoint = {{ position = [-0.5, 1.5, 0.2] }}\nintensity = 1\n\
         [[shapes]]\n\
         rectangle = {{ corner = [-2, 0, 2], edges = [[4, 0, 0], [0, 0, -4]] }}\n\
         [[shapes]]\nmaterial = \"lamp\"\n\
         rectangle = {{ corner = [0.3, 1.6, 0.4], edges = [[0, 0, -0.8], [0.8, 0, 0]] }}\n\
         [[shapes]]\nmaterial = \"m\"\nsphere = {{ center = [0, 0, 0], radius = 0.5 }}\n\
         transform = [{{ rotate = {{ axis = [1, 0, 1], degrees = 40 }} }}, {{ translate = [0, 0.5, 0] }}]\n"
    );
    folder().scene_of(&text)
}

#[test]
fn masks_on_spheres() {
    assert_images_agree(&ball(
        "albedo = [0.8, 0.6, 0.4]\nalpha = { file = \"leaf.png\", scale = [3, 2] }\nalpha_cutoff = 0.6",
    ));
}

#[test]
fn partial_opacity_of_spheres() {
    assert_images_agree(&ball(
        "albedo = [0.9, 0.5, 0.2]\nalpha = { file = \"veil.png\", wrap = \"mirror\", factor = 0.8 }",
    ));
}

/// A black ball before the sky is passed twice, each time by a chance of its own.
#[test]
fn a_ray_passes_each_side_of_a_sphere_by_itself() {
    let text = "[camera]\norigin = [0, 0, 9]\ntarget = [0, 0, 0]\nfov = 1\n\
         [film]\nwidth = 16\nheight = 16\nfilter = \"box\"\n[sky]\nradiance = 1\n\
         [materials.m]\nalbedo = 0\nalpha = 0.4\n\
         [[shapes]]\nmaterial = \"m\"\nsphere = { center = [0, 0, 0], radius = 1 }\n";
    let seen = by_wave(&folder().scene_of(text), &of_images(Strategy::Mis)).overall(0);
    assert_mean("through the ball", seen, 0.6 * 0.6, 1);
}

/// A stack of black sheets of opacity `a` before the sky, straight on: the chance to see it is the
/// product of theirs, which it would not be if draws of one ray were alike.
#[test]
fn a_ray_passes_each_sheet_by_itself() {
    let opacities = [0.5, 0.25, 0.1, 0.6];
    let materials = |(k, a): (usize, &f64)| {
        format!(
            "[materials.m{k}]\nalbedo = 0\nalpha = {a}\n[[shapes]]\nmaterial = \"m{k}\"\n\
             rectangle = {{ corner = [-9, -9, -{k}], edges = [[18, 0, 0], [0, 18, 0]] }}\n"
        )
    };
    let sheets: String = opacities.iter().enumerate().map(materials).collect();
    let text = format!(
        "[camera]\norigin = [0, 0, 3]\ntarget = [0, 0, 0]\n[film]\nwidth = 16\nheight = 16\n\
         filter = \"box\"\n[sky]\nradiance = 1\n{sheets}"
    );
    let scene = folder().scene_of(&text);
    let seen = by_wave(&scene, &of_images(Strategy::Mis)).overall(0);
    let through = opacities.iter().map(|a| 1.0 - a).product();
    assert_mean("through the sheets", seen, through, 1);
}

/// Paths go through a sheet and look back for a light through the same triangle: two events, each with
/// a chance of its own. A bright floor behind one black sheet, lit by a point before it.
#[test]
fn ways_there_and_back_are_two_events() {
    let text = "[camera]\norigin = [0, 0, 4]\ntarget = [0, 0, 0]\nfov = 0.01\n\
         [film]\nwidth = 8\nheight = 8\nfilter = \"box\"\n\
         [materials.wall]\nalbedo = 0.5\n[materials.sheet]\nalbedo = 0\nalpha = 0.4\n\
         [[lights]]\npoint = { position = [0, 0, 4] }\nintensity = 16\n\
         [[shapes]]\nmaterial = \"wall\"\n\
         rectangle = { corner = [-9, -9, 0], edges = [[18, 0, 0], [0, 18, 0]] }\n\
         [[shapes]]\nmaterial = \"sheet\"\n\
         rectangle = { corner = [-9, -9, 2], edges = [[18, 0, 0], [0, 18, 0]] }\n";
    let scene = folder().scene_of(text);
    let straight = Settings {
        max_depth: Some(1),
        ..of_images(Strategy::Mis)
    };
    let seen = by_wave(&scene, &straight).overall(0);
    // Radiance albedo / pi * intensity / distance^2, through the sheet twice.
    let expected = 0.6 * 0.6 * 0.5 / std::f64::consts::PI;
    assert_mean("there and back", seen, expected, 1);
}
