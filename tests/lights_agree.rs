//! Every strategy of the wave gives the image of the f64 reference under each kind of light that is
//! no triangle: maps, discs in the sky, and lights that no direction finds.

mod common;

use common::agreement::Agreement;
use common::scenes::tilted_plate;
use huygens::scene::{Environment, Light, LightKind, Scene, Sky, Spot};
use huygens::settings::Strategy;
use std::sync::Arc;

const STRATEGIES: [Strategy; 4] = [
    Strategy::Uniform,
    Strategy::Cosine,
    Strategy::Light,
    Strategy::Mis,
];

/// A floor, a tilted plate and a small lamp.
fn stage() -> Scene {
    tilted_plate([2.0, 1.0, 0.5], 6)
}

fn light(kind: LightKind) -> Light {
    let name = "test".to_owned();
    Light { name, kind }
}

/// `times` as many samples as most scenes need.
fn assert_all_agree(scene: &Scene, times: u32) {
    let agreement = Agreement {
        strategies: &STRATEGIES,
        reference: times * 16_384,
        wave: times * 8192,
        off: 1.03,
    };
    agreement.assert_of(scene);
}

/// A map of soft colours with one bright texel in it, dark below.
fn map() -> Environment {
    let (width, height) = (16, 8);
    let texel = |k: usize| {
        let (x, y) = (k % width, k / width);
        match (x, y) {
            (4, 2) => [20.0, 18.0, 12.0],
            (_, 5..) => [0.0; 3],
            _ => [0.2 + 0.05 * x as f32, 0.5, 1.0 - 0.1 * y as f32],
        }
    };
    Environment {
        width: width as u32,
        height: height as u32,
        texels: (0..width * height).map(texel).collect(),
        // Turned about y, 3-4-5.
        frame: [[0.6, 0.0, -0.8], [0.0, 1.0, 0.0], [0.8, 0.0, 0.6]],
    }
}

#[test]
fn under_a_map() {
    let mut scene = stage();
    scene.sky = Some(Sky::Map(Arc::new(map())));
    assert_all_agree(&scene, 1);
}

#[test]
fn under_discs_and_a_gradient() {
    let mut scene = stage();
    scene.sky = Some(Sky::Gradient {
        zenith: [0.2, 0.3, 0.5],
        nadir: [0.1, 0.1, 0.0],
    });
    scene.lights.push(light(LightKind::Distant {
        from: [0.6, 0.8, 0.0],
        irradiance: [1.0, 0.9, 0.7],
        half_angle: 20.0,
    }));
    // Half of it below the horizon.
    scene.lights.push(light(LightKind::Distant {
        from: [0.0, 0.0, 1.0],
        irradiance: [0.0, 0.5, 1.0],
        half_angle: 50.0,
    }));
    assert_all_agree(&scene, 1);
}

#[test]
fn under_a_disc_alone() {
    let mut scene = stage();
    scene.lights.push(light(LightKind::Distant {
        from: [0.48, 0.6, 0.64],
        irradiance: [1.0, 0.9, 0.7],
        half_angle: 25.0,
    }));
    // Blind directions find it rarely.
    assert_all_agree(&scene, 6);
}

#[test]
fn under_points_spots_and_parallel_light() {
    let mut scene = stage();
    scene.lights = [
        LightKind::Point {
            position: [-1.5, 1.0, -2.0],
            intensity: [3.0, 2.0, 1.0],
            spot: None,
        },
        LightKind::Point {
            position: [1.0, 2.0, -4.0],
            intensity: [0.0, 9.0, 6.0],
            spot: Some(Spot {
                axis: [-0.6, -0.8, 0.0],
                dark: 0.8,
                full: 0.9,
            }),
        },
        LightKind::Distant {
            from: [0.0, 0.8, 0.6],
            irradiance: [0.3, 0.2, 0.7],
            half_angle: 0.0,
        },
    ]
    .map(light)
    .to_vec();
    assert_all_agree(&scene, 1);
}

/// What no direction finds, alone: there is nothing to weigh it against.
#[test]
fn under_one_point() {
    let mut scene = stage();
    scene.materials[1].emission.factor = [0.0; 3];
    scene.lights.push(light(LightKind::Point {
        position: [-0.5, 1.5, -2.5],
        intensity: [3.0, 2.0, 1.0],
        spot: None,
    }));
    assert_all_agree(&scene, 1);
}
