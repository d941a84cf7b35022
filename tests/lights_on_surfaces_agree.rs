//! Every kind of light, chosen in every way, on surfaces of every sort of lobe: the wave gives the
//! image of the f64 reference.

mod common;

use common::picture::{by_reference, by_wave, independent};
use common::scenes::{Builder, camera_along_z};
use common::statistics::{SIGNIFICANCE, same};
use huygens::scene::material::{Dielectric, Principled};
use huygens::scene::{Bsdf, Environment, Light, LightKind, Scene, Sky, Spot};
use huygens::settings::{Integrator, LightSelection, Settings, Strategy};
use std::sync::Arc;

/// A matt floor, a rough metal ball and a coated plate before it, and a lamp beside other lights. All
/// scatter once, so that the reference is exact.
fn stage() -> Builder {
    let mut b = Builder::new();
    let floor = b.material([0.7, 0.5, 0.3], [0.0; 3]);
    let metal = b.surface(Bsdf::Conductor {
        eta: [0.2, 0.9, 1.1],
        k: [3.9, 2.4, 2.3],
        tint: [1.0; 3].into(),
        roughness: 0.6.into(),
        anisotropy: 0.0,
    });
    b.last().compensation = false;
    let coated = b.surface(Bsdf::Principled(Box::new(Principled {
        base_color: [0.3, 0.5, 0.8].into(),
        roughness: 0.6.into(),
        clearcoat: 0.7.into(),
        clearcoat_roughness: 0.5.into(),
        ..Principled::default()
    })));
    let lamp = b.material([0.0; 3], [2.0, 1.5, 1.0]);
    b.floor(floor);
    b.quad(
        coated,
        [
            [0.3, -0.8, -4.0],
            [1.5, -0.8, -4.0],
            [1.5, 0.2, -4.6],
            [0.3, 0.2, -4.6],
        ],
    );
    b.quad(
        lamp,
        [
            [0.6, 2.0, -1.5],
            [0.6, 2.0, -6.5],
            [3.5, 1.6, -6.5],
            [3.5, 1.6, -1.5],
        ],
    );
    b.sphere(metal, [-0.4, -0.1, -4.0], 0.7);
    b
}

fn finished(b: Builder) -> Scene {
    b.scene(camera_along_z([0.0; 3], -1.0, 0.35), 5, 5)
}

fn light(kind: LightKind) -> Light {
    let name = "test".to_owned();
    Light { name, kind }
}

fn settings(integrator: Integrator, strategy: Strategy, spp: u32) -> Settings {
    Settings {
        integrator,
        strategy,
        spp,
        max_depth: Some(3),
        ..independent()
    }
}

/// All strategies with all ways to choose lights; of those that sample none, one.
fn assert_all_agree(name: &str, scene: &Scene, strategies: &[Strategy], spp: u32) {
    let reference = Settings {
        seed: 1,
        ..settings(Integrator::Reference, Strategy::Mis, 2 * spp)
    };
    let expected = by_reference(scene, &reference);
    let selections = [
        LightSelection::Uniform,
        LightSelection::Power,
        LightSelection::Tree,
    ];
    let level = SIGNIFICANCE / (3 * strategies.len()) as f64;
    for &strategy in strategies {
        let samples_none = matches!(strategy, Strategy::Uniform | Strategy::Cosine);
        for &selection in &selections[..if samples_none { 1 } else { 3 }] {
            // Lights alone find narrow lobes the hard way.
            let times = if strategy == Strategy::Light { 2 } else { 1 };
            let settings = Settings {
                light_selection: selection,
                ..settings(Integrator::Path, strategy, times * spp)
            };
            let rendered = by_wave(scene, &settings);
            if let Err(difference) = same(&rendered, &expected, level) {
                let path = rendered.leave_behind(&format!("lights_on_surfaces_agree-{name}"));
                panic!("{name}, {strategy:?}, {selection:?}: {difference} (see {path})");
            }
            for factor in [0.97, 1.03] {
                let wrong = same(&rendered.scaled(factor), &expected, level);
                assert!(wrong.is_err(), "{name}, {strategy:?}: {factor} passes too");
            }
        }
    }
}

const ALL: [Strategy; 3] = [Strategy::Cosine, Strategy::Light, Strategy::Mis];

#[test]
fn of_triangles_and_spheres() {
    let mut b = stage();
    let glow = b.material([0.3; 3], [1.0, 2.0, 4.0]);
    b.two_sided();
    b.triangle(
        glow,
        [[-2.0, 0.5, -3.0], [-1.5, 2.0, -4.5], [-2.2, 0.8, -5.0]],
        false,
    );
    b.sphere(glow, [-0.2, 1.6, -3.4], 0.4);
    let ember = b.material([0.2; 3], [6.0, 1.0, 0.5]);
    b.sphere(ember, [2.0, 0.4, -5.5], 0.5);
    assert_all_agree("triangles and spheres", &finished(b), &ALL, 8192);
}

#[test]
fn of_a_gradient() {
    let mut scene = finished(stage());
    scene.sky = Some(Sky::Gradient {
        zenith: [0.5, 0.7, 1.0],
        nadir: [0.4, 0.1, 0.0],
    });
    assert_all_agree("gradient", &scene, &ALL, 4096);
}

#[test]
fn of_a_map() {
    let (width, height) = (16, 8);
    let texel = |k: usize| match (k % width, k / width) {
        (3..6, 2) => [6.0, 5.0, 4.0],
        (_, 6..) => [0.0; 3],
        (x, y) => [0.2 + 0.03 * x as f32, 0.5, 1.0 - 0.1 * y as f32],
    };
    let mut scene = finished(stage());
    scene.sky = Some(Sky::Map(Arc::new(Environment {
        width: width as u32,
        height: height as u32,
        texels: (0..width * height).map(texel).collect(),
        // Turned about y, 3-4-5.
        frame: [[0.6, 0.0, -0.8], [0.0, 1.0, 0.0], [0.8, 0.0, 0.6]],
    })));
    assert_all_agree("map", &scene, &ALL, 8192);
}

#[test]
fn of_discs_and_parallel_light() {
    let mut scene = finished(stage());
    let sun = |from, half_angle| LightKind::Distant {
        from,
        irradiance: [1.0, 0.9, 0.7],
        half_angle,
    };
    scene.lights = vec![
        light(sun([0.48, 0.6, 0.64], 35.0)),
        light(sun([-0.6, 0.8, 0.0], 0.0)),
    ];
    assert_all_agree("discs", &scene, &ALL, 16_384);
}

#[test]
fn of_points_and_spots() {
    let mut scene = finished(stage());
    let spot = Spot {
        axis: [-0.6, -0.8, 0.0],
        dark: 0.6,
        full: 0.9,
    };
    scene.lights = vec![
        light(LightKind::Point {
            position: [-1.5, 1.0, -2.5],
            intensity: [2.0, 1.5, 1.0],
            spot: None,
        }),
        light(LightKind::Point {
            position: [1.0, 1.2, -4.0],
            intensity: [0.0, 6.0, 4.0],
            spot: Some(spot),
        }),
    ];
    assert_all_agree("points", &scene, &ALL, 32_768);
}

/// Panes between the lights and the rest: what passes one is found by directions, or at the pane.
#[test]
fn behind_glass() {
    for (roughness, thin) in [(0.0, true), (0.7, true), (0.7, false)] {
        let mut b = stage();
        let pane = b.surface(Bsdf::Dielectric(Box::new(Dielectric {
            roughness: roughness.into(),
            thin,
            ..Dielectric::default()
        })));
        b.last().compensation = false;
        b.quad(
            pane,
            [
                [-3.0, 1.2, -2.0],
                [3.0, 1.2, -2.0],
                [3.0, 1.2, -6.0],
                [-3.0, 1.2, -6.0],
            ],
        );
        let glow = b.material([0.3; 3], [1.0, 2.0, 4.0]);
        b.sphere(glow, [-0.5, 2.4, -3.4], 0.8);
        let mut scene = finished(b);
        scene.sky = Some(Sky::constant([0.4, 0.5, 0.6]));
        let name = format!("behind glass {roughness} {thin}");
        let strategies = [Strategy::Cosine, Strategy::Mis];
        assert_all_agree(&name, &scene, &strategies, 8192);
    }
}
