//! Skies from files: what a scene sees of them, and what is wrong with those that are wrong.

mod common;
mod scene_folder;

use common::picture::{by_wave, independent};
use common::statistics::{SIGNIFICANCE, threshold, z_score};
use huygens::scene::{LightKind, Scene, Sky};
use huygens::settings::Settings;
use scene_folder::Folder;
use std::path::Path;

const WIDTH: usize = 8;
const HEIGHT: usize = 4;

/// No two texels alike, and each a number that both formats hold exactly.
fn texel(x: usize, y: usize) -> [f32; 3] {
    [1.0 + x as f32, 0.5 * y as f32, 2.0]
}

fn write_exr(path: &Path, texel: impl Fn(usize, usize) -> [f32; 3] + Sync) {
    let pixel = |x: usize, y: usize| {
        let [r, g, b] = texel(x, y);
        (r, g, b)
    };
    exr::prelude::write_rgb_file(path, WIDTH, HEIGHT, pixel).unwrap();
}

fn write_hdr(path: &Path) {
    let pixels: Vec<_> = (0..WIDTH * HEIGHT)
        .map(|k| image::Rgb(texel(k % WIDTH, k / WIDTH)))
        .collect();
    let file = std::fs::File::create(path).unwrap();
    image::codecs::hdr::HdrEncoder::new(file)
        .encode(&pixels, WIDTH, HEIGHT)
        .unwrap();
}

/// A scene in a folder with `map.exr` and `map.hdr`.
fn folder(scene: &str) -> Folder {
    let folder = Folder::new().with("s.toml", scene);
    write_exr(&folder.path("map.exr"), texel);
    write_hdr(&folder.path("map.hdr"));
    folder
}

fn texels(scene: &Scene) -> &[[f32; 3]] {
    match &scene.sky {
        Some(Sky::Map(map)) => {
            assert_eq!((map.width, map.height), (WIDTH as u32, HEIGHT as u32));
            &map.texels
        }
        other => panic!("expected a map, found {other:?}"),
    }
}

#[test]
fn both_formats_hold_the_same_map() {
    for name in ["map.exr", "map.hdr"] {
        let scene = folder(&format!("[sky]\nmap = \"{name}\"\n")).scene("s.toml");
        for (k, found) in texels(&scene).iter().enumerate() {
            assert_eq!(*found, texel(k % WIDTH, k / WIDTH), "{name}");
        }
    }
}

/// A panorama taken by this program and used as a sky is seen again as it was taken: pixel by pixel,
/// but for the interpolation between texels.
#[test]
fn a_panorama_of_a_map_is_that_map() {
    let seen = |sky: &str, camera: &str| {
        let text = format!(
            "[sky]\nmap = \"map.exr\"\n{sky}\n[camera]\norigin = [0, 0, 0]\nkind = \"panorama\"\n\
             {camera}\n[film]\nwidth = {WIDTH}\nheight = {HEIGHT}\nfilter = \"box\"\n"
        );
        let scene = folder(&text).scene("s.toml");
        let settings = Settings {
            spp: 4096,
            ..independent()
        };
        by_wave(&scene, &settings)
    };
    // The mean over a texel's area of what is bilinear between centres.
    let expected = |x: usize, y: usize, c: usize| -> f64 {
        let part = [0.125, 0.75, 0.125];
        let mut sum = 0.0;
        for (j, v) in part.into_iter().enumerate() {
            for (i, u) in part.into_iter().enumerate() {
                let row = (y + j).clamp(1, HEIGHT) - 1;
                sum += u * v * f64::from(texel((x + i + WIDTH - 1) % WIDTH, row)[c]);
            }
        }
        sum
    };
    // (Sky, camera, columns that the picture is turned to the right.)
    let cases = [
        ("", "target = [0, 0, -1]", 0),
        // A quarter turn to the left, counter-clockwise from above: -z goes to -x.
        ("rotate = 90", "target = [-1, 0, 0]", 0),
        ("rotate = 90", "target = [0, 0, -1]", 6),
        // The short way from +y to +z: -z goes to +y.
        ("up = [0, 0, 2]", "target = [0, 1, 0]\nup = [0, 0, 1]", 0),
        (
            "up = [0, 0, 2]\nrotate = 90",
            "target = [-1, 0, 0]\nup = [0, 0, 1]",
            0,
        ),
    ];
    let tests = cases.len() * WIDTH * HEIGHT * 3;
    let limit = threshold(SIGNIFICANCE, tests);
    for (sky, camera, turned) in cases {
        let picture = seen(sky, camera);
        for k in 0..WIDTH * HEIGHT {
            let (x, y) = ((k % WIDTH + WIDTH - turned) % WIDTH, k / WIDTH);
            for c in 0..3 {
                let (mean, variance) = (picture.mean[k][c], picture.variance[k][c]);
                let z = z_score(mean, expected(x, y, c), variance);
                let of = expected(x, y, c);
                assert!(
                    z <= limit,
                    "{sky} {camera}: ({x}, {y}) {c}: {mean} for {of}, z = {z}"
                );
            }
        }
    }
}

#[test]
fn a_scale_multiplies() {
    let scene = folder("[sky]\nmap = \"map.exr\"\nscale = [2, 3, 0.5]\n").scene("s.toml");
    let [r, g, b] = texel(3, 2);
    assert_eq!(texels(&scene)[2 * WIDTH + 3], [2.0 * r, 3.0 * g, 0.5 * b]);
    assert_eq!(
        folder("[sky]\nmap = \"map.exr\"\nscale = 3e38\n").error("s.toml"),
        "s.toml:1:1: sky: `scale` takes the sky beyond 32-bit floats"
    );
}

#[test]
fn maps_that_are_wrong() {
    let bad = |value: f32| {
        let folder = folder("[sky]\nmap = \"bad.exr\"\n");
        write_exr(&folder.path("bad.exr"), |x, y| {
            if (x, y) == (5, 2) {
                [1.0, value, 0.0]
            } else {
                [1.0; 3]
            }
        });
        folder.error("s.toml")
    };
    for (value, text) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (-0.5, "-0.5")] {
        assert_eq!(
            bad(value),
            format!(
                "bad.exr: pixel (5, 2) from the top left is [1, {text}, 0], expected finite numbers \
                 of at least 0"
            )
        );
    }
    let of = |name: &str| {
        let scene = format!("[sky]\nmap = \"{name}\"\n");
        let folder = folder(&scene)
            .with("text.exr", "no image")
            .with("text.hdr", "no image");
        folder.error("s.toml")
    };
    assert_eq!(
        of("none.exr"),
        "s.toml:2:7: sky.map: none.exr: no such file"
    );
    assert_eq!(
        of("s.toml"),
        "s.toml:2:7: sky.map: s.toml: expected an .exr or .hdr file: a map holds radiance, not \
         display colours"
    );
    assert!(of("text.exr").starts_with("text.exr: is no EXR image of channels R, G and B: "));
    assert!(of("text.hdr").starts_with("text.hdr: is no Radiance HDR image: "));
}

/// The hash of a scene is that of its map too.
#[test]
fn another_map_is_another_scene() {
    let hash = |sky: &str| folder(sky).scene("s.toml").hash;
    let plain = hash("[sky]\nmap = \"map.exr\"\n");
    assert_eq!(plain, hash("[sky]\nmap = \"map.hdr\"\n"));
    assert_ne!(plain, hash("[sky]\nmap = \"map.exr\"\nscale = 2\n"));
    assert_ne!(plain, hash("[sky]\nmap = \"map.exr\"\nrotate = 1\n"));
}

#[test]
fn a_day_brings_its_sun() {
    let scene = |more: &str| {
        let text = format!("[sky]\nsun = [3, 4, 0]\n{more}");
        Folder::new().with("s.toml", text).scene("s.toml")
    };
    let LightKind::Distant {
        from, half_angle, ..
    } = scene("").lights[0].kind
    else {
        panic!("the sun is far away");
    };
    // Normalised, turned into the map's frame and back.
    for (found, expected) in from.into_iter().zip([0.6, 0.8, 0.0]) {
        assert!((found - expected).abs() <= 2.0 * f32::EPSILON);
    }
    assert_eq!(half_angle, 0.2665);
    assert!(scene("disc = false\n").lights.is_empty());
    assert_eq!(
        scene("").warnings,
        ["no shapes: the camera sees nothing but the sky"]
    );
}
