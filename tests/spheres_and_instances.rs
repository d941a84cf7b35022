//! Spheres and instances shade as the reference says, as lights and as surfaces, near and far, from
//! outside and inside, for every strategy.

mod common;

use common::picture::{Picture, by_reference, by_wave, independent, mean_by_wave, render};
use common::scenes::{Builder, camera_along_z, pinhole};
use common::statistics::{SIGNIFICANCE, assert_mean, same};
use glam::{DAffine3, DMat3, DVec3};
use huygens::scene::{Camera, Scene};
use huygens::settings::{Integrator, Sampler, Settings, Strategy};

const STRATEGIES: [Strategy; 4] = [
    Strategy::Uniform,
    Strategy::Cosine,
    Strategy::Light,
    Strategy::Mis,
];

fn settings(strategy: Strategy, spp: u32) -> Settings {
    Settings {
        strategy,
        spp,
        max_depth: Some(3),
        roulette: false,
        ..independent()
    }
}

/// A room with a lamp that is a sphere, a sphere to be lit, and copies of a block: turned, mirrored,
/// unevenly scaled, one in another colour.
fn room() -> Scene {
    let mut b = Builder::new();
    let white = b.material([0.7, 0.6, 0.5], [0.0; 3]);
    let red = b.material([0.6, 0.1, 0.1], [0.0; 3]);
    let lamp = b.material([0.3; 3], [4.0, 3.0, 2.0]);
    b.room(white, [-0.5, -0.5, 0.5], [0.5, 0.5, -0.5]);
    let block = b.object();
    b.room(white, [-2.0, -1.5, -4.0], [2.0, 1.5, 1.0]);
    b.sphere(lamp, [0.6, 0.7, -2.4], 0.7);
    b.sphere(red, [-0.9, -0.8, -2.2], 0.6);
    let turn = DMat3::from_rotation_y(0.6) * DMat3::from_rotation_x(0.3);
    let uneven = DMat3::from_diagonal(DVec3::new(0.6, 1.4, 0.5));
    let at = DVec3::new(0.9, -0.8, -2.6);
    let map = DAffine3::from_mat3_translation(turn * uneven, at);
    b.instance(block, &map, None);
    let mirror = DMat3::from_diagonal(DVec3::new(-0.5, 0.5, 0.5));
    let at = DVec3::new(0.2, -1.0, -1.6);
    b.instance(
        block,
        &DAffine3::from_mat3_translation(mirror, at),
        Some(red),
    );
    b.scene(camera_along_z([0.0, 0.0, 0.9], -1.0, 0.8), 8, 8)
}

fn assert_agrees(name: &str, scene: &Scene, reference: &Picture, spp: [u32; 4], tests: usize) {
    for (strategy, spp) in STRATEGIES.into_iter().zip(spp) {
        let rendered = by_wave(scene, &settings(strategy, spp));
        if let Err(difference) = same(&rendered, reference, SIGNIFICANCE / tests as f64) {
            let path = rendered.leave_behind(&format!("spheres_and_instances-{name}"));
            panic!("{name}, {strategy:?}: {difference} (the render is in {path})");
        }
    }
}

#[test]
fn a_room_looks_as_the_reference_says() {
    let scene = room();
    let reference = by_reference(&scene, &settings(Strategy::Cosine, 16_384));
    assert_agrees("room", &scene, &reference, [8192, 8192, 2048, 2048], 4);
    // The same comparison must not pass an image that is 2% wrong.
    let rendered = by_wave(&scene, &settings(Strategy::Mis, 2048));
    for factor in [0.98, 1.02] {
        let wrong = same(&rendered.scaled(factor), &reference, SIGNIFICANCE);
        assert!(wrong.is_err(), "{factor} times the image passes too");
    }
}

#[test]
fn inside_a_glowing_sphere_everything_is_one_over_one_minus_albedo() {
    // Far from the origin, too, and of another size.
    for (k, (radius, centre)) in [(1.0, [0.0; 3]), (30.0, [100.0, -50.0, 20.0])]
        .into_iter()
        .enumerate()
    {
        for strategy in STRATEGIES {
            let mut b = Builder::new();
            let wall = b.material([0.5; 3], [1.0; 3]);
            b.two_sided();
            b.sphere(wall, centre, radius);
            let eye = [
                centre[0] + 0.4 * radius,
                centre[1],
                centre[2] + 0.1 * radius,
            ];
            let scene = b.scene(camera_along_z(eye, -1.0, 1.0), 4, 4);
            let settings = Settings {
                max_depth: None,
                ..settings(strategy, 2048)
            };
            let mean = mean_by_wave(
                &scene,
                &Settings {
                    roulette: true,
                    ..settings
                },
            );
            assert_mean(&format!("sphere {k}, {strategy:?}"), mean, 2.0, 8);
        }
    }
}

/// Irradiance on a floor below a sphere of radius `r` and radiance 1 at height `h`, over `pi`: the
/// form factor `(r / h)^2` (J. Howell, "A Catalog of Radiation Heat Transfer Configuration
/// Factors", B-35), as far as the sphere is above the horizon.
#[test]
fn a_lamp_near_and_far_gives_its_form_factor() {
    let cases = [
        (1.01f32, 1.0f32),
        (2.0, 1.0),
        (50.0, 1.0),
        (3.0e4, 1.0),
        (1.0, 1e-4),
    ];
    for (h, r) in cases {
        let mut b = Builder::new();
        let lamp = b.material([0.0; 3], [1.0; 3]);
        b.sphere(lamp, [0.0, h, 0.0], r);
        // One triangle, so that nothing lies in its plane.
        let grey = b.material([0.5; 3], [0.0; 3]);
        b.triangle(
            grey,
            [[-3.0, 0.0, 2.0], [3.0, 0.0, 2.0], [0.0, 0.0, -4.0]],
            false,
        );
        let camera = Camera {
            // Below the lamp.
            origin: [0.0, 0.5 * (h - r), 0.0],
            forward: [0.0, -1.0, 0.0],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 0.0, -1.0],
            projection: pinhole(1e-6, 1e-6),
        };
        let scene = b.scene(camera, 2, 2);
        for strategy in [Strategy::Light, Strategy::Mis] {
            let mean = mean_by_wave(&scene, &settings(strategy, 4096));
            let expected = 0.5 * (f64::from(r) / f64::from(h)).powi(2);
            assert_mean(&format!("h {h}, r {r}, {strategy:?}"), mean, expected, 10);
        }
    }
}

#[test]
fn the_image_does_not_depend_on_how_the_work_is_cut() {
    let scene = room();
    for (sampler, integrator) in [
        (Sampler::Sobol, Integrator::Path),
        (Sampler::Independent, Integrator::Ao),
    ] {
        let base = Settings {
            sampler,
            integrator,
            spp: 33,
            ..settings(Strategy::Mis, 33)
        };
        let bits = |settings: &Settings| -> Vec<[u32; 3]> {
            let image = render(&scene, settings).0;
            image.mean.iter().map(|p| p.map(f32::to_bits)).collect()
        };
        let whole = bits(&base);
        for (threads, wave, tile) in [(2, 4096, 4), (3, 64, 8), (1, 17, 16)] {
            let settings = Settings {
                threads,
                wave,
                tile,
                ..base.clone()
            };
            assert!(
                bits(&settings) == whole,
                "{threads} threads, wave {wave}, tile {tile}"
            );
        }
    }
}

#[test]
fn spheres_elsewhere_change_no_bit_of_what_triangles_show() {
    // One scene by the kernels for triangles, the same with a sphere behind the camera that nobody
    // sees by the kernels for worlds: quick looks, which meet nothing but the camera's rays.
    let mut b = Builder::new();
    let white = b.material([0.7, 0.6, 0.5], [0.0; 3]);
    b.room(white, [-2.0, -1.5, -4.0], [2.0, 1.5, 1.0]);
    let plain = b.scene(camera_along_z([0.0, 0.0, 0.9], -1.0, 0.8), 16, 16);
    let mut with = plain.clone();
    with.spheres.push(huygens::scene::Sphere {
        centre: [0.0, 0.0, 50.0],
        radius: 1.0,
        material: 0,
        turn: huygens::scene::Sphere::UPRIGHT,
    });
    for integrator in [Integrator::Normals, Integrator::Depth, Integrator::Albedo] {
        let settings = Settings {
            integrator,
            spp: 4,
            ..Settings::default()
        };
        let bits = |scene: &Scene| -> Vec<[u32; 3]> {
            let image = render(scene, &settings).0;
            image.mean.iter().map(|p| p.map(f32::to_bits)).collect()
        };
        assert!(bits(&plain) == bits(&with), "{integrator:?}");
    }
}
