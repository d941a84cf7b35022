//! Media: closed forms, furnaces, and the f64 reference.

mod common;

use common::agreement::Agreement;
use common::picture::{
    by_reference, by_wave, independent, mean_by_wave, same_bits_however_it_runs,
};
use common::scenes::{Builder, camera_along_z, pinhole, tilted_plate};
use common::statistics::{ROUNDING, SIGNIFICANCE, assert_mean, same};
use huygens::scene::material::{Dielectric, Principled};
use huygens::scene::{Bsdf, Fog, Light, LightKind, Medium, Scene, Sky};
use huygens::settings::{Settings, Strategy};
use std::f64::consts::PI;

const STRATEGIES: [Strategy; 4] = [
    Strategy::Uniform,
    Strategy::Cosine,
    Strategy::Light,
    Strategy::Mis,
];

/// Those of finite variance where a lamp is in the fog: at a distance `d` from one, light samples weigh
/// `1 / d^2`, the square of which has no mean over a volume that reaches the lamp. `mis` weighs them
/// down.
const IN_FOG: [Strategy; 3] = [Strategy::Uniform, Strategy::Cosine, Strategy::Mis];

fn medium(absorption: [f32; 3], scattering: [f32; 3], g: f32) -> Medium {
    Medium {
        name: "medium".into(),
        absorption,
        scattering,
        g,
    }
}

fn fill(scene: &mut Scene, medium: Medium, bounds: Option<[[f32; 3]; 2]>) {
    scene.media = vec![medium];
    scene.fog = Some(Fog { medium: 0, bounds });
}

fn glass(ior: f32, roughness: f32, interior: Option<u32>) -> Bsdf {
    Bsdf::Dielectric(Box::new(Dielectric {
        ior,
        roughness: roughness.into(),
        interior,
        ..Dielectric::default()
    }))
}

fn light(kind: LightKind) -> Light {
    let name = "test".to_owned();
    Light { name, kind }
}

/// A floor, a tilted plate and a small lamp.
fn stage() -> Scene {
    tilted_plate([8.0, 6.0, 4.0], 5)
}

/// Strategies against the reference, with `times` as many samples as most scenes need.
fn assert_agree(scene: &Scene, strategies: &[Strategy], times: u32) {
    let agreement = Agreement {
        strategies,
        reference: times * 16_384,
        wave: times * 8192,
        off: 1.1,
    };
    agreement.assert_of(scene);
}

const COLOURED: [[f32; 3]; 2] = [[0.02, 0.05, 0.1], [0.15, 0.1, 0.05]];

/// Fog everywhere: the sky is out of sight.
#[test]
fn endless_fog_agrees_with_the_reference() {
    let mut scene = stage();
    let [absorption, scattering] = COLOURED;
    fill(&mut scene, medium(absorption, scattering, 0.4), None);
    scene.sky = Some(Sky::Gradient {
        zenith: [5.0; 3],
        nadir: [5.0; 3],
    });
    assert_agree(&scene, &IN_FOG, 2);
}

/// Fog in a box, under all kinds of light, most of which come from beyond it.
#[test]
fn fog_in_a_box_agrees_with_the_reference() {
    let mut scene = stage();
    let [absorption, scattering] = COLOURED;
    let bounds = [[-2.0, -2.0, -5.0], [1.0, 0.75, -1.5]];
    fill(
        &mut scene,
        medium(absorption, scattering, -0.3),
        Some(bounds),
    );
    scene.sky = Some(Sky::Gradient {
        zenith: [0.2, 0.3, 0.5],
        nadir: [0.1, 0.1, 0.0],
    });
    scene.lights = vec![
        light(LightKind::Point {
            position: [-1.5, 1.0, -2.0],
            intensity: [3.0, 2.0, 1.0],
            spot: None,
        }),
        light(LightKind::Distant {
            from: [0.0, 0.8, 0.6],
            irradiance: [0.3, 0.2, 0.7],
            half_angle: 0.0,
        }),
        light(LightKind::Distant {
            from: [0.6, 0.8, 0.0],
            irradiance: [1.0, 0.9, 0.7],
            half_angle: 20.0,
        }),
    ];
    assert_agree(&scene, &STRATEGIES, 2);
}

/// A wall of radiance 1 across the view, one unit wide at distance 4.
fn wall() -> Scene {
    let mut b = Builder::new();
    let wall = b.material([0.0; 3], [1.0; 3]);
    b.quad(
        wall,
        [
            [-9.0, -9.0, -4.0],
            [9.0, -9.0, -4.0],
            [9.0, 9.0, -4.0],
            [-9.0, 9.0, -4.0],
        ],
    );
    let mut camera = camera_along_z([0.0; 3], -1.0, 1.0);
    // So narrow that every ray is as long as any other, to a part in 10^8.
    camera.projection = pinhole(1e-4, 1e-4);
    b.scene(camera, 2, 2)
}

/// Adds a box of glass, fronts outside.
fn boxed(scene: &mut Scene, bsdf: Bsdf, low: [f32; 3], high: [f32; 3]) {
    let mut b = Builder::new();
    b.room(0, high, low);
    let room = b.scene(scene.camera, 1, 1).mesh;
    let first = scene.mesh.vertices.len() as u32;
    scene.mesh.vertices.extend(room.vertices);
    let moved = room.indices.iter().map(|t| t.map(|v| v + first));
    scene.mesh.indices.extend(moved);
    let material = scene.materials.len() as u32;
    scene
        .mesh
        .material
        .extend(vec![material; room.material.len()]);
    let mut glass = scene.materials[0].clone();
    glass.name = "glass".into();
    glass.emission.factor = [0.0; 3];
    glass.bsdf = bsdf;
    scene.materials.push(glass);
}

/// Bouguer, Lambert and Beer: `exp(-sigma d)`, without noise, in fog, in a box of fog, and in glass that
/// is nothing but its inside.
#[test]
fn light_falls_off_exponentially() {
    let sigma = [0.1, 0.5, 3.0];
    let (low, high) = ([-1.0, -1.0, -2.75], [1.0, 1.0, -1.5]);
    let absorbing = || medium(sigma, [0.0; 3], 0.0);
    let mut everywhere = wall();
    fill(&mut everywhere, absorbing(), None);
    let mut in_box = wall();
    fill(&mut in_box, absorbing(), Some([low, high]));
    let mut inside = wall();
    inside.media = vec![absorbing()];
    boxed(&mut inside, glass(1.0, 0.0, Some(0)), low, high);
    let settings = Settings {
        spp: 16,
        roulette: false,
        ..independent()
    };
    for (scene, length) in [(everywhere, 4.0), (in_box, 1.25), (inside, 1.25)] {
        let picture = by_wave(&scene, &settings);
        for mean in &picture.mean {
            for c in 0..3 {
                let depth = f64::from(sigma[c]) * length;
                let expected = (-depth).exp();
                // The depth is off by some roundings of its own size, its exponential by that.
                let off = (mean[c] - expected).abs() / expected;
                assert!(off <= ROUNDING * (1.0 + depth), "{length}: {mean:?}, {c}");
            }
        }
    }
}

/// Parallel light along the view, scattered back once: `p(-1) sigma_s E (1 - exp(-2 sigma_t d)) / (2 sigma_t)`.
#[test]
fn light_scattered_once_has_its_closed_form() {
    let irradiance = [2.0, 3.0, 5.0];
    let (absorption, scattering) = ([0.1, 0.0, 1.0], [0.4, 1.5, 0.2]);
    for g in [-0.7f32, 0.0, 0.5] {
        let mut scene = wall();
        scene.materials[0].emission.factor = [0.0; 3];
        let bounds = [[-9.0, -9.0, -2.5], [9.0, 9.0, -1.0]];
        fill(&mut scene, medium(absorption, scattering, g), Some(bounds));
        scene.lights = vec![light(LightKind::Distant {
            from: [0.0, 0.0, 1.0],
            irradiance,
            half_angle: 0.0,
        })];
        let settings = Settings {
            spp: 40_000,
            max_depth: Some(1),
            ..independent()
        };
        let picture = by_wave(&scene, &settings);
        for c in 0..3 {
            let [a, s, e] = [absorption[c], scattering[c], irradiance[c]].map(f64::from);
            let (t, g) = (a + s, f64::from(g));
            let phase = (1.0 - g * g) / (4.0 * PI * (1.0 + g).powi(3));
            let expected = phase * s * e * (1.0 - (-2.0 * t * 1.5).exp()) / (2.0 * t);
            let mean = picture.overall(c);
            assert_mean(&format!("g {g}, channel {c}"), mean, expected, 9);
            let error = mean.variance.sqrt() / expected;
            assert!(error < 0.01, "{error} tells nothing");
        }
    }
}

/// Whatever is scattered and not absorbed is still there: black walls that emit 1 all around give 1
/// everywhere in a medium that only scatters.
#[test]
fn a_furnace_of_fog_loses_nothing() {
    for (scattering, g) in [
        ([0.3; 3], 0.0),
        ([0.1, 1.0, 4.0], 0.8),
        ([2.0, 0.0, 0.5], -0.6),
    ] {
        for strategy in IN_FOG {
            let mut b = Builder::new();
            let wall = b.material([0.0; 3], [1.0; 3]);
            b.room(wall, [-1.0, -0.5, -2.0], [1.5, 1.0, 1.0]);
            let mut scene = b.scene(camera_along_z([0.1, 0.2, 0.3], -1.0, 1.0), 4, 4);
            fill(&mut scene, medium([0.0; 3], scattering, g), None);
            let settings = Settings {
                strategy,
                spp: 2000,
                ..independent()
            };
            let picture = by_wave(&scene, &settings);
            for c in 0..3 {
                let what = format!("{strategy:?}, {scattering:?}, {g}, channel {c}");
                assert_mean(&what, picture.overall(c), 1.0, 27);
            }
        }
    }
}

/// The same for milk in a glass ball under an even sky.
#[test]
fn a_ball_of_milk_in_a_white_sky_is_white() {
    for roughness in [0.0, 0.5] {
        let mut b = Builder::new();
        let ball = b.material([0.0; 3], [0.0; 3]);
        b.sphere(ball, [0.0, 0.0, -3.0], 1.0);
        let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 0.3), 3, 3);
        scene.materials[0].bsdf = glass(1.4, roughness, Some(0));
        scene.media = vec![medium([0.0; 3], [1.0, 2.0, 4.0], 0.5)];
        scene.sky = Some(Sky::Gradient {
            zenith: [1.0; 3],
            nadir: [1.0; 3],
        });
        let settings = Settings {
            spp: 4000,
            ..independent()
        };
        // Rough glass is made up for by a table that is below 1 by up to 0.02 (docs/bsdf.md), at each
        // of a few passages: only smooth glass is exact.
        let mean = mean_by_wave(&scene, &settings);
        if roughness == 0.0 {
            assert_mean("milk", mean, 1.0, 1);
        } else {
            let slack = 5.0 * mean.variance.sqrt();
            assert!(
                (0.9 - slack..=1.0 + slack).contains(&mean.value),
                "{}",
                mean.value
            );
        }
    }
}

/// Fog in a box, and the same box of glass of index 1 with the fog inside: two ways to say the same,
/// with other stages at work.
#[test]
fn a_box_of_fog_is_a_box_of_glass_of_index_1() {
    let [absorption, scattering] = COLOURED.map(|c| c.map(|x| 4.0 * x));
    let (low, high) = ([-0.9, -0.8, -4.2], [0.7, 0.6, -2.4]);
    let lit = || {
        let mut scene = stage();
        // Without the plate, which would cut the box.
        scene.mesh.indices.drain(2..4);
        scene.mesh.material.drain(2..4);
        scene.sky = Some(Sky::Gradient {
            zenith: [0.2, 0.3, 0.5],
            nadir: [0.1, 0.1, 0.0],
        });
        scene
    };
    let mut fog = lit();
    let milk = medium(absorption, scattering, 0.3);
    fill(&mut fog, milk.clone(), Some([low, high]));
    let mut boxes = lit();
    boxes.media = vec![milk];
    boxed(&mut boxes, glass(1.0, 0.0, Some(0)), low, high);
    let settings = Settings {
        spp: 20_000,
        // Passages count as scattering events, so no path is cut.
        max_depth: None,
        ..independent()
    };
    let expected = by_wave(&fog, &settings);
    let found = by_wave(
        &boxes,
        &Settings {
            seed: 1,
            ..settings
        },
    );
    same(&found, &expected, SIGNIFICANCE).unwrap();
    assert!(same(&found.scaled(1.05), &expected, SIGNIFICANCE).is_err());
}

/// Fog outside, milk inside of frosted glass: lights sampled on either side of a boundary lose what the
/// medium of that side takes.
#[test]
fn frosted_glass_between_two_media_has_one_image_with_every_strategy() {
    let mut b = Builder::new();
    let lamp = b.material([0.5; 3], [3.0, 2.0, 1.0]);
    b.room(lamp, [-2.0, -2.0, -6.0], [2.0, 2.0, 1.0]);
    let ball = b.material([0.0; 3], [0.0; 3]);
    b.sphere(ball, [0.2, 0.1, -3.0], 1.2);
    let core = b.material([0.6, 0.3, 0.2], [4.0; 3]);
    b.sphere(core, [0.2, 0.1, -3.0], 0.5);
    let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 0.5), 4, 4);
    scene.materials[1].bsdf = glass(1.3, 0.6, Some(1));
    fill(
        &mut scene,
        medium([0.02, 0.05, 0.1], [0.1, 0.05, 0.02], 0.2),
        None,
    );
    scene
        .media
        .push(medium([0.1, 0.3, 0.6], [0.3, 0.5, 0.2], -0.2));
    let with = |strategy, seed| {
        let settings = Settings {
            strategy,
            seed,
            max_depth: Some(5),
            spp: 10_000,
            ..independent()
        };
        by_wave(&scene, &settings)
    };
    let expected = with(Strategy::Cosine, 1);
    let found = with(Strategy::Mis, 2);
    same(&found, &expected, SIGNIFICANCE).unwrap();
    assert!(same(&found.scaled(1.03), &expected, SIGNIFICANCE).is_err());
}

/// A ball that is filled, over a floor between a lamp, a distant light and a sky, in thin fog.
fn jar(bsdf: Bsdf, filling: Medium) -> Scene {
    let mut b = Builder::new();
    let floor = b.material([0.7, 0.5, 0.3], [0.0; 3]);
    // Hardly brighter than the sky: found by chance, it makes little noise.
    let lamp = b.material([0.0; 3], [1.2, 1.0, 0.8]);
    let jar = b.surface(bsdf);
    // Tables of albedos are not in question here.
    b.last().compensation = false;
    b.floor(floor);
    b.quad(
        lamp,
        [
            [-2.0, 3.0, -7.0],
            [-2.0, 3.0, -2.0],
            [-3.5, -0.5, -2.0],
            [-3.5, -0.5, -7.0],
        ],
    );
    b.sphere(jar, [0.1, 0.0, -3.6], 0.9);
    let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 0.3), 5, 5);
    scene.sky = Some(Sky::Gradient {
        zenith: [0.5, 0.7, 1.0],
        nadir: [0.8, 0.5, 0.4],
    });
    scene.lights = vec![light(LightKind::Distant {
        from: [0.48, 0.6, 0.64],
        irradiance: [1.0, 0.9, 0.8],
        half_angle: 0.0,
    })];
    let fog = medium([0.01, 0.02, 0.03], [0.05, 0.04, 0.03], 0.3);
    // Out of endless fog no sky would be seen.
    let bounds = [[-3.0, -1.5, -8.0], [3.0, 3.5, 0.5]];
    fill(&mut scene, fog, Some(bounds));
    scene.media.push(filling);
    scene
}

/// Against the reference, up to six scattering events: in, twice within, out, and the floor.
#[track_caller]
fn assert_jar_agrees(bsdf: Bsdf, filling: Medium) {
    let scene = jar(bsdf, filling);
    assert_eq!(scene.beyond_reference(), None);
    let settings = |strategy, seed| Settings {
        strategy,
        seed,
        spp: 16_384,
        max_depth: Some(6),
        ..independent()
    };
    let expected = by_reference(&scene, &settings(Strategy::Cosine, 1));
    let level = SIGNIFICANCE / 2.0;
    for strategy in [Strategy::Cosine, Strategy::Mis] {
        let rendered = by_wave(&scene, &settings(strategy, 2));
        if let Err(what) = same(&rendered, &expected, level) {
            panic!("{strategy:?}: {what}");
        }
        assert!(same(&rendered.scaled(1.05), &expected, level).is_err());
    }
    // The filling is seen.
    let mut empty = scene.clone();
    match &mut empty.materials[2].bsdf {
        Bsdf::Dielectric(glass) => glass.interior = None,
        Bsdf::Principled(p) => p.interior = None,
        _ => panic!("no glass"),
    }
    let empty = by_wave(&empty, &settings(Strategy::Mis, 2));
    assert!(same(&empty, &expected, level).is_err());
}

#[test]
fn tea_in_clear_glass_agrees_with_the_reference() {
    let tea = medium([0.3, 0.8, 1.6], [0.0; 3], 0.0);
    assert_jar_agrees(glass(1.4, 0.0, Some(1)), tea);
}

#[test]
fn milk_in_frosted_glass_agrees_with_the_reference() {
    let milk = medium([0.05, 0.1, 0.2], [0.8, 1.0, 1.2], 0.4);
    assert_jar_agrees(glass(1.3, 0.5, Some(1)), milk);
}

#[test]
fn milk_in_a_principled_surface_agrees_with_the_reference() {
    let milk = medium([0.05, 0.1, 0.2], [0.8, 1.0, 1.2], -0.2);
    let bsdf = Bsdf::Principled(Box::new(Principled {
        base_color: [0.9, 0.95, 0.85].into(),
        transmission: 0.8.into(),
        roughness: 0.5.into(),
        interior: Some(1),
        ..Principled::default()
    }));
    assert_jar_agrees(bsdf, milk);
}

/// Glass in glass: a drop of milk in tea, whose surface says what lies before it.
#[test]
fn a_drop_in_tea_agrees_with_the_reference() {
    let tea = medium([0.2, 0.5, 0.9], [0.1; 3], 0.2);
    let mut scene = jar(glass(1.4, 0.0, Some(1)), tea);
    let milk = medium([0.05, 0.1, 0.2], [2.0, 2.5, 3.0], 0.3);
    scene.media.push(milk);
    let mut drop = scene.materials[2].clone();
    drop.bsdf = Bsdf::Dielectric(Box::new(Dielectric {
        ior: 0.95,
        interior: Some(2),
        exterior: Some(1),
        ..Dielectric::default()
    }));
    scene.materials.push(drop);
    let within = scene.spheres[0];
    scene.spheres.push(huygens::scene::Sphere {
        radius: 0.5,
        material: 3,
        ..within
    });
    let settings = |strategy, seed| Settings {
        strategy,
        seed,
        spp: 16_384,
        max_depth: Some(8),
        ..independent()
    };
    let expected = by_reference(&scene, &settings(Strategy::Cosine, 1));
    let found = by_wave(&scene, &settings(Strategy::Mis, 2));
    same(&found, &expected, SIGNIFICANCE).unwrap();
    // Without a word of what lies before it, light that leaves the drop is out in the fog.
    let Bsdf::Dielectric(glass) = &mut scene.materials[3].bsdf else {
        panic!("no glass");
    };
    glass.exterior = None;
    let out = by_wave(&scene, &settings(Strategy::Mis, 2));
    assert!(same(&out, &expected, SIGNIFICANCE).is_err());
}

#[test]
fn bits_do_not_depend_on_the_wave() {
    let mut scene = stage();
    let [absorption, scattering] = COLOURED;
    fill(&mut scene, medium(absorption, scattering, 0.4), None);
    scene.media.push(medium([0.1; 3], [2.0; 3], 0.1));
    boxed(
        &mut scene,
        glass(1.5, 0.3, Some(1)),
        [-0.5, -0.9, -2.8],
        [0.1, -0.3, -2.2],
    );
    same_bits_however_it_runs(&scene);
}

/// Branches have the mean of single paths, wherever in a medium they set out.
#[test]
fn branches_in_fog_have_the_mean_of_single_paths() {
    let mut scene = stage();
    let [absorption, scattering] = COLOURED;
    fill(&mut scene, medium(absorption, scattering, 0.4), None);
    let settings = |split, spp, seed| Settings {
        split,
        spp,
        seed,
        max_depth: Some(4),
        ..independent()
    };
    let single = by_wave(&scene, &settings(vec![], 16_000, 1));
    let branched = by_wave(&scene, &settings(vec![2, 2], 6000, 2));
    same(&branched, &single, SIGNIFICANCE).unwrap();
}
