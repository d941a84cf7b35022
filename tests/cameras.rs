//! Cameras through the whole renderer: against answers that need none, and against the reference.

mod common;

use common::picture::{Picture, by_reference, by_wave};
use common::scenes::{Builder, camera_along_z, thin_lens};
use common::statistics::{ROUNDING, SIGNIFICANCE, same};
use huygens::scene::{Camera, Extent, Projection, Scene};
use huygens::settings::{Integrator, Settings, Strategy};

fn square(b: &mut Builder, material: u32, [x, y, z]: [f32; 3], half: f32) {
    let (left, right, low, high) = (x - half, x + half, y - half, y + half);
    let corners = [
        [left, low, z],
        [right, low, z],
        [right, high, z],
        [left, high, z],
    ];
    b.quad(material, corners);
}

/// Coloured lamps before, in and behind a plane 4 before the camera, over a floor, under a dim sky.
fn lamps(projection: Projection) -> Scene {
    let mut b = Builder::new();
    let colours = [[2.0, 0.5, 0.1], [0.2, 1.5, 0.3], [0.1, 0.4, 2.5]];
    for (i, colour) in colours.into_iter().enumerate() {
        let material = b.material([0.3; 3], colour);
        let depth = [2.0, 4.0, 9.0][i];
        let x = 0.25 * depth * (i as f32 - 1.0);
        square(&mut b, material, [x, 0.03 * depth, -depth], 0.12 * depth);
    }
    let floor = b.material([0.6, 0.5, 0.7], [0.0; 3]);
    let y = -0.6;
    b.quad(
        floor,
        [
            [-9.0, y, 3.0],
            [9.0, y, 3.0],
            [9.0, y, -12.0],
            [-9.0, y, -12.0],
        ],
    );
    let camera = Camera {
        projection,
        ..camera_along_z([0.0; 3], -1.0, 1.0)
    };
    let mut scene = b.scene(camera, 8, 8);
    scene.sky = Some([0.2, 0.3, 0.4]);
    scene
}

fn parallel(half: f32) -> Projection {
    let extent = Extent {
        half_width: half,
        half_height: half,
    };
    Projection::Orthographic { extent }
}

/// Samples a pixel where pictures are compared.
const SPP: u32 = 16_384;

fn settings(spp: u32) -> Settings {
    Settings {
        strategy: Strategy::Mis,
        max_depth: Some(1),
        spp,
        ..Settings::default()
    }
}

fn looks(spp: u32, integrator: Integrator) -> Settings {
    Settings {
        integrator,
        max_depth: Some(0),
        spp,
        ..Settings::default()
    }
}

/// Compares wave and reference for one camera; gives the wave's, for further comparisons.
fn agree(name: &str, projection: Projection) -> Picture {
    let scene = lamps(projection);
    let wave = by_wave(&scene, &settings(SPP));
    let reference = by_reference(&scene, &settings(SPP));
    if let Err(difference) = same(&wave, &reference, SIGNIFICANCE / 3.0) {
        let path = wave.leave_behind(&format!("cameras-{name}"));
        panic!("{name}: {difference} (the render is in {path})");
    }
    wave
}

#[test]
fn depth_of_field_agrees_with_the_reference() {
    let wave = agree("thin lens", thin_lens(0.4, 0.6, 4.0));
    // A tenth more of the radius or of the distance, or no lens at all, would have been seen.
    for other in [
        thin_lens(0.4, 0.66, 4.0),
        thin_lens(0.4, 0.6, 4.4),
        common::scenes::pinhole(0.4, 0.4),
    ] {
        let picture = by_reference(&lamps(other), &settings(SPP));
        assert!(same(&wave, &picture, SIGNIFICANCE).is_err(), "{other:?}");
    }
}

#[test]
fn parallel_rays_agree_with_the_reference() {
    agree("orthographic", parallel(4.0));
}

#[test]
fn panoramas_agree_with_the_reference() {
    agree("panorama", Projection::Panorama);
}

/// What lies in the plane of focus is drawn as a pinhole draws it, sample by sample, for the rays of
/// both go through the same points there; a sample so near to an edge that rounding takes it across
/// is one in a million.
#[test]
fn what_is_in_focus_is_sharp() {
    let image = |projection, depth: f32| {
        let mut b = Builder::new();
        let lamp = b.material([0.0; 3], [1.0; 3]);
        square(&mut b, lamp, [0.13, -0.21, -depth], 1.7);
        let camera = Camera {
            projection,
            ..camera_along_z([0.0; 3], -1.0, 1.0)
        };
        by_wave(&b.scene(camera, 16, 16), &looks(64, Integrator::Path)).mean
    };
    let (lens, pinhole) = (thin_lens(1.0, 0.5, 4.0), common::scenes::pinhole(1.0, 1.0));
    assert_eq!(image(lens, 4.0), image(pinhole, 4.0));
    let blurred = |image: &[[f64; 3]]| image.iter().filter(|p| p[0] > 0.0 && p[0] < 1.0).count();
    let [at, before] = [4.0, 3.0].map(|depth| blurred(&image(lens, depth)));
    assert!(
        before > at,
        "{before} pixels of an edge out of focus, {at} in it"
    );
}

#[test]
fn parallel_rays_find_a_plane_at_one_depth() {
    let mut b = Builder::new();
    let grey = b.material([0.5; 3], [0.0; 3]);
    square(&mut b, grey, [0.0, 0.0, -3.0], 50.0);
    let camera = Camera {
        projection: parallel(10.0),
        ..camera_along_z([1.0, -2.0, 0.5], -1.0, 1.0)
    };
    let picture = by_wave(&b.scene(camera, 16, 8), &looks(16, Integrator::Depth));
    for pixel in picture.mean {
        assert!((pixel[0] / 3.5 - 1.0).abs() <= ROUNDING, "{pixel:?}");
    }
}

#[test]
fn a_panorama_sees_a_direction_in_its_pixel() {
    // 8 by 4 pixels of 45 degrees: this one is the middle of column 6, row 1.
    let (longitude, latitude) = (112.5f32.to_radians(), 22.5f32.to_radians());
    let at = [
        10.0 * latitude.cos() * longitude.sin(),
        10.0 * latitude.sin(),
        -10.0 * latitude.cos() * longitude.cos(),
    ];
    let mut b = Builder::new();
    let lamp = b.material([0.0; 3], [1.0; 3]);
    b.two_sided();
    square(&mut b, lamp, at, 1.0);
    let camera = Camera {
        projection: Projection::Panorama,
        ..camera_along_z([0.0; 3], -1.0, 1.0)
    };
    let scene = b.scene(camera, 8, 4);
    for picture in [
        by_wave(&scene, &looks(256, Integrator::Path)),
        by_reference(&scene, &looks(256, Integrator::Path)),
    ] {
        for (i, pixel) in picture.mean.iter().enumerate() {
            assert_eq!(pixel[0] > 0.0, i == 8 + 6, "pixel {i}: {pixel:?}");
        }
    }
}
