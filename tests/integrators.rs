//! The quick looks and short integrators, where their answers are known without a renderer.

mod common;

use common::picture::{Mean, Picture, by_wave, independent, mean_by_wave, render};
use common::scenes::{Builder, camera_along_z, cornell_box, floor_from_above, furnace};
use common::statistics::assert_mean;
use huygens::scene::Scene;
use huygens::settings::{Integrator, Settings, Strategy};

/// Half a unit in the last place of 1: one rounding.
const ROUNDING: f64 = 1.0 / 16_777_216.0;

fn settings(integrator: Integrator, spp: u32) -> Settings {
    Settings {
        integrator,
        spp,
        ..independent()
    }
}

/// A wall at z = -3 of the given albedo, seen from the origin.
fn wall(albedo: [f32; 3], half_width: f32, facing: bool) -> Scene {
    let mut b = Builder::new();
    let paint = b.material(albedo, [0.0; 3]);
    let (d, z) = (50.0, -3.0);
    let mut corners = [[-d, -d, z], [d, -d, z], [d, d, z], [-d, d, z]];
    if !facing {
        corners.reverse();
    }
    b.quad(paint, corners);
    b.scene(camera_along_z([0.0; 3], -1.0, half_width), 2, 2)
}

/// Asserts that every pixel is `expected`, but for a few roundings of 1.
fn assert_constant(picture: &Picture, expected: [f64; 3], what: &str) {
    for pixel in &picture.mean {
        for c in 0..3 {
            assert!(
                (pixel[c] - expected[c]).abs() <= 4.0 * ROUNDING,
                "{what}: {pixel:?}"
            );
        }
    }
}

#[test]
fn normals_face_the_camera_from_either_side() {
    let normals = settings(Integrator::Normals, 4);
    for facing in [true, false] {
        let picture = by_wave(&wall([0.5; 3], 1.0, facing), &normals);
        assert_constant(&picture, [0.5, 0.5, 1.0], "towards +z");
    }
    let mut from_below = floor_from_above(0.5, Builder::new());
    let above = by_wave(&from_below, &normals);
    assert_constant(&above, [0.5, 1.0, 0.5], "up");
    from_below.camera.origin[1] = -1.0;
    from_below.camera.forward[1] = 1.0;
    from_below.camera.right[0] = -1.0;
    assert_constant(&by_wave(&from_below, &normals), [0.5, 0.0, 0.5], "down");
}

#[test]
fn albedo_is_what_the_material_says() {
    let colour = [0.25, 0.5, 0.75];
    let picture = by_wave(&wall(colour, 1.0, true), &settings(Integrator::Albedo, 4));
    assert_constant(&picture, colour.map(f64::from), "albedo");
}

#[test]
fn depth_is_the_distance_along_the_ray() {
    // Straight on, the distance is that of the wall: 3, times sqrt(1 + 2e-6) at the very corners.
    let picture = by_wave(&wall([0.5; 3], 1e-3, true), &settings(Integrator::Depth, 4));
    for depth in picture.mean.iter().flatten() {
        assert!((depth / 3.0 - 1.0).abs() < 1e-6 + 8.0 * ROUNDING, "{depth}");
    }
    // Wide, each quarter of the film has the mean of 3 sqrt(1 + x^2 + y^2) over the unit square.
    let n = 500;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
    let mean: f64 = (0..n * n)
        .map(|k| 3.0 * (1.0 + at(k % n).powi(2) + at(k / n).powi(2)).sqrt())
        .sum::<f64>()
        / f64::from(n * n);
    let wide = mean_by_wave(
        &wall([0.5; 3], 1.0, true),
        &settings(Integrator::Depth, 4096),
    );
    assert_mean("depth", wide, mean, 1);
}

#[test]
fn an_open_plane_is_not_occluded() {
    let mut ao = settings(Integrator::Ao, 64);
    for distance in [None, Some(1.0), Some(1e6)] {
        ao.ao_distance = distance;
        let picture = by_wave(&floor_from_above(0.5, Builder::new()), &ao);
        assert_constant(&picture, [1.0; 3], "open");
    }
}

#[test]
fn a_closed_box_is_occluded_wherever_its_walls_are_near_enough() {
    let mut ao = settings(Integrator::Ao, 64);
    ao.ao_distance = Some(1e3);
    assert_constant(&by_wave(&furnace(0.5), &ao), [0.0; 3], "closed");
}

/// Below a disk of radius `r` at height `h` the occluded share is `r^2 / (r^2 + h^2)`; a wide ceiling
/// at height `h` and an occlusion distance `d` make just such a disk, with `r^2 + h^2 = d^2`.
#[test]
fn a_ceiling_occludes_up_to_the_distance() {
    let mut b = Builder::new();
    let grey = b.material([0.5; 3], [0.0; 3]);
    let (d, h) = (9.0, 2.0);
    b.quad(grey, [[-d, h, -d], [d, h, -d], [d, h, d], [-d, h, d]]);
    let scene = floor_from_above(0.5, b);
    for (distance, open) in [
        (1.9, 1.0),
        (2.5, 2.0f64.powi(2) / 2.5f64.powi(2)),
        (4.0, 0.25),
    ] {
        let mut ao = settings(Integrator::Ao, 16_384);
        ao.ao_distance = Some(distance);
        assert_mean("ao", mean_by_wave(&scene, &ao), open, 3);
    }
}

#[test]
fn direct_is_path_with_one_scattering_event() {
    let scene = cornell_box(20);
    for strategy in [
        Strategy::Uniform,
        Strategy::Cosine,
        Strategy::Light,
        Strategy::Mis,
    ] {
        for (asked, depth) in [(None, 1), (Some(5), 1), (Some(1), 1), (Some(0), 0)] {
            let mut direct = settings(Integrator::Direct, 8);
            (direct.strategy, direct.max_depth) = (strategy, asked);
            let mut path = settings(Integrator::Path, 8);
            (path.strategy, path.max_depth) = (strategy, Some(depth));
            let [direct, path] = [direct, path].map(|s| render(&scene, &s).0.mean);
            assert!(direct == path, "{strategy:?}, {asked:?}");
        }
    }
}

/// Emission alone, at depth 0: the wall's own, from its front only.
#[test]
fn depth_zero_is_emission() {
    for (facing, expected) in [(true, 3.0), (false, 0.0)] {
        let mut scene = wall([0.5; 3], 1.0, facing);
        scene.materials[0].emission = [3.0; 3].into();
        let mut path = settings(Integrator::Path, 4);
        path.max_depth = Some(0);
        let Mean { value, variance } = mean_by_wave(&scene, &path);
        assert_eq!((value, variance), (expected, 0.0));
    }
}
