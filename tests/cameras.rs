//! Cameras through the whole renderer: against answers that need none, and against the reference.

mod common;

use common::picture::{Mean, Picture, by_reference, by_wave, independent};
use common::scenes::{Builder, camera_along_z, thin_lens};
use common::statistics::{ROUNDING, SIGNIFICANCE, assert_mean, same};
use huygens::scene::{Camera, Extent, Projection, Scene, Sky};
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
    scene.sky = Some(Sky::constant([0.2, 0.3, 0.4]));
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
        ..independent()
    }
}

fn looks(spp: u32, integrator: Integrator) -> Settings {
    Settings {
        integrator,
        max_depth: Some(0),
        spp,
        ..independent()
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

/// A square out of focus is itself spread over the disk that the lens makes of a point: the second
/// moments of its image about its middle add up, `w^2 / 12` of a width and `r^2 / 4` of a disk.
#[test]
fn what_is_out_of_focus_is_spread_over_the_lens_disk() {
    // Lens, plane of focus, and how far away the square is: behind it and before it.
    for (radius, focus, depth) in [(0.5f32, 4.0f32, 8.0f32), (0.25, 5.0, 3.0)] {
        let mut b = Builder::new();
        let lamp = b.material([0.0; 3], [1.0; 3]);
        // 0.2 of the view wide, which is 2 at distance 1.
        square(&mut b, lamp, [0.0, 0.0, -depth], 0.1 * depth);
        let camera = Camera {
            projection: thin_lens(1.0, radius, focus),
            ..camera_along_z([0.0; 3], -1.0, 1.0)
        };
        let size = 128u16;
        let scene = b.scene(camera, u32::from(size), u32::from(size));
        let picture = by_wave(&scene, &looks(64, Integrator::Path));
        let pixel = 2.0 / f64::from(size);
        let at = |i: usize| (f64::from(i as u16 % size) + 0.5) * pixel - 1.0;
        let sum = |of: &dyn Fn(f64) -> f64, values: &[[f64; 3]]| -> f64 {
            let terms = values.iter().enumerate().map(|(i, v)| of(at(i)) * v[0]);
            terms.sum()
        };
        let total = sum(&|_| 1.0, &picture.mean);
        let moment = sum(&|x| x * x, &picture.mean) / total;
        // Pixels are independent, so the ratio's variance follows from theirs.
        let variance = sum(&|x| (x * x - moment).powi(2), &picture.variance) / total.powi(2);
        // At distance 1, the disk's radius.
        let [r, f, d] = [radius, focus, depth].map(f64::from);
        let disk = r * (1.0 / f - 1.0 / d).abs();
        let expected = (0.2f64.powi(2) + pixel.powi(2)) / 12.0 + disk.powi(2) / 4.0;
        // A pixel spreads too: it is the image under a box filter, taken at its middle. What the
        // moment of a sum differs from an integral's by is, after Poisson, the second derivative of
        // the transform of square, disk and box at 2 pi / pixel = 402: the box is 0 there, with a
        // slope of 1/402, and what the others fall at is at most 0.1 (1/40) (0.04), so that all of
        // it is about 1e-6, a twentieth of the standard error.
        let mean = Mean {
            value: moment,
            variance,
        };
        assert_mean(&format!("{radius}, {focus}, {depth}"), mean, expected, 2);
        assert!(variance.sqrt() < 0.01 * expected);
    }
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
