//! Light through dispersive glass: against the f64 reference, whose samples are of one wavelength each,
//! and where the answer is known.

mod common;

use common::picture::{
    Picture, by_reference, by_wave, independent, over_seeds, same_bits_however_it_runs,
};
use common::scenes::{Builder, camera_along_z};
use common::statistics::{SIGNIFICANCE, assert_mean, same, threshold};
use huygens::scene::material::{Cauchy, Dielectric, Principled};
use huygens::scene::{Bsdf, Scene, Sky};
use huygens::settings::{Integrator, Sampler, Settings, Strategy};

const ZENITH: [f32; 3] = [0.2, 0.4, 0.8];
const NADIR: [f32; 3] = [0.6, 0.3, 0.1];
/// Of the wall behind the prism.
const WALL: [f32; 3] = [4.0, 3.0, 2.0];
/// A glass that disperses more than any there is: colours lie wide apart.
const ABBE: f64 = 12.0;

fn glass(abbe: Option<f64>, roughness: f32) -> Bsdf {
    Bsdf::Dielectric(Box::new(Dielectric {
        ior: 1.5,
        dispersion: abbe.map(|v| Cauchy::from_abbe(1.5, v)),
        roughness: roughness.into(),
        ..Dielectric::default()
    }))
}

/// A prism, its edge up, before the camera; light that it bends meets the upper edge of a wall.
fn prism(bsdf: Bsdf) -> Scene {
    let mut b = Builder::new();
    let glass = b.material([1.0; 3], [0.0; 3]);
    let wall = b.material([0.0; 3], WALL);
    let end = |x: f32| [[x, -1.0, -2.0], [x, -1.0, -4.0], [x, 1.0, -3.0]];
    let (left, right) = (end(-3.0), end(3.0));
    b.triangle(glass, left, true);
    b.triangle(glass, right, false);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        b.quad(glass, [left[i], left[j], right[j], right[i]]);
    }
    let top = -3.2;
    b.quad(
        wall,
        [
            [-30.0, -30.0, -8.0],
            [30.0, -30.0, -8.0],
            [30.0, top, -8.0],
            [-30.0, top, -8.0],
        ],
    );
    let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 0.2), 5, 5);
    scene.materials[0].bsdf = bsdf;
    scene.sky = Some(Sky::Gradient {
        zenith: ZENITH,
        nadir: NADIR,
    });
    scene
}

fn settings(spp: u32) -> Settings {
    Settings {
        spp,
        roulette: false,
        ..independent()
    }
}

#[test]
fn a_prism_agrees_with_the_reference() {
    let scene = prism(glass(Some(ABBE), 0.0));
    let reference = Settings {
        integrator: Integrator::Reference,
        seed: 1,
        ..settings(20_000)
    };
    let expected = by_reference(&scene, &reference);
    let rendered = by_wave(&scene, &settings(20_000));
    same(&rendered, &expected, SIGNIFICANCE).unwrap();
    // Paths that end at random have the same mean, though throughput is negative in part.
    let ended = Settings {
        roulette: true,
        ..settings(20_000)
    };
    same(&by_wave(&scene, &ended), &expected, SIGNIFICANCE).unwrap();
    let plain = by_wave(&prism(glass(None, 0.0)), &settings(2000));
    assert!(same(&plain, &expected, SIGNIFICANCE).is_err());
    assert!(same(&rendered.scaled(1.03), &expected, SIGNIFICANCE).is_err());
}

/// Compares with the reference, with light samples and without. Facets make up for nothing: the reference
/// has no tables of albedos, and would have to integrate them for every wavelength.
#[track_caller]
fn assert_agrees(bsdf: Bsdf) {
    let mut scene = prism(bsdf);
    scene.materials[0].compensation = false;
    assert_eq!(scene.beyond_reference(), None);
    let reference = Settings {
        integrator: Integrator::Reference,
        seed: 1,
        max_depth: Some(6),
        ..settings(20_000)
    };
    let expected = by_reference(&scene, &reference);
    for strategy in [Strategy::Cosine, Strategy::Mis] {
        let rendered = by_wave(
            &scene,
            &Settings {
                strategy,
                max_depth: Some(6),
                ..settings(20_000)
            },
        );
        same(&rendered, &expected, 0.5 * SIGNIFICANCE).unwrap();
        assert!(same(&rendered.scaled(1.05), &expected, 0.5 * SIGNIFICANCE).is_err());
    }
}

#[test]
fn a_frosted_prism_agrees_with_the_reference() {
    assert_agrees(glass(Some(ABBE), 0.4));
}

fn principled(dispersion: Option<Cauchy>, roughness: f32) -> Bsdf {
    Bsdf::Principled(Box::new(Principled {
        base_color: [0.9, 0.8, 0.7].into(),
        transmission: 0.9.into(),
        roughness: roughness.into(),
        dispersion,
        ..Principled::default()
    }))
}

#[test]
fn a_principled_prism_agrees_with_the_reference() {
    // With a third term, as Sellmeier's formula brings it.
    let steep = Cauchy::through(|nm| 1.45 + 0.1 * (500.0 / nm).powi(4));
    assert_agrees(principled(Some(steep), 0.3));
}

#[test]
fn a_principled_prism_that_hardly_disperses_is_plain() {
    let limit = Cauchy::from_abbe(1.5, 1e9);
    let seeded = Settings {
        seed: 1,
        ..settings(20_000)
    };
    let plain = by_wave(&prism(principled(None, 0.3)), &seeded);
    let limit = by_wave(&prism(principled(Some(limit), 0.3)), &settings(20_000));
    same(&limit, &plain, SIGNIFICANCE).unwrap();
}

/// What does not depend on wavelengths stays as it is: glass that hardly disperses is plain glass.
#[test]
fn without_dispersion_the_glass_is_plain() {
    for roughness in [0.0, 0.4] {
        let seeded = Settings {
            seed: 1,
            ..settings(20_000)
        };
        let plain = by_wave(&prism(glass(None, roughness)), &seeded);
        let limit = by_wave(&prism(glass(Some(1e9), roughness)), &settings(20_000));
        same(&limit, &plain, SIGNIFICANCE).unwrap();
    }
}

/// With light samples and without, through rough dispersive glass.
#[test]
fn rough_glass_has_one_image_with_and_without_light_samples() {
    let scene = prism(glass(Some(ABBE), 0.5));
    let with = |strategy, seed| {
        let settings = Settings {
            strategy,
            seed,
            ..settings(20_000)
        };
        by_wave(&scene, &settings)
    };
    let (expected, found) = (with(Strategy::Cosine, 1), with(Strategy::Mis, 2));
    same(&found, &expected, SIGNIFICANCE).unwrap();
    assert!(same(&found.scaled(1.05), &expected, SIGNIFICANCE).is_err());
}

/// Under an even sky glass is not to be seen, whatever the wavelength.
#[test]
fn a_furnace_stays_white() {
    let mut scene = prism(glass(Some(ABBE), 0.0));
    scene.materials[1].emission.factor = [0.0; 3];
    // The wall takes its part: without it, all paths end in the sky.
    scene.mesh.indices.truncate(8);
    scene.mesh.material.truncate(8);
    scene.sky = Some(Sky::Gradient {
        zenith: [1.0; 3],
        nadir: [1.0; 3],
    });
    let picture = by_wave(&scene, &settings(4000));
    for c in 0..3 {
        assert_mean(&format!("channel {c}"), picture.overall(c), 1.0, 3);
    }
    assert!(picture.variance[12][0] > 0.0, "seen through the prism");
}

/// A low-discrepancy sequence of wavelengths has the same mean.
#[test]
fn with_sobol_points_the_image_is_the_same() {
    let scene = prism(glass(Some(ABBE), 0.0));
    let sobol = Settings {
        sampler: Sampler::Sobol,
        ..settings(64)
    };
    let z = threshold(0.5 * SIGNIFICANCE, 3 * 25);
    let found = over_seeds(&scene, &sobol, 64, z);
    let expected = by_wave(&scene, &settings(20_000));
    same(&found, &expected, SIGNIFICANCE).unwrap();
}

/// A path whose only light is of negative weight goes on: red light is the same over a red floor as
/// over a white one, path by path.
#[test]
fn no_path_is_lost_where_all_that_is_left_is_negative() {
    let over = |floor: [f32; 3]| -> Picture {
        let mut scene = prism(glass(Some(ABBE), 0.0));
        let wall = &mut scene.materials[1];
        wall.emission.factor = [0.0; 3];
        wall.bsdf = Bsdf::Diffuse {
            reflectance: floor.into(),
            roughness: 0.0,
        };
        scene.sky = Some(Sky::Gradient {
            zenith: [1.0; 3],
            nadir: [0.5; 3],
        });
        by_wave(&scene, &settings(500))
    };
    let (red, white) = (over([0.8, 0.0, 0.0]), over([0.8; 3]));
    let channel = |p: &Picture| p.mean.iter().map(|m| m[0]).collect::<Vec<f64>>();
    assert_eq!(channel(&red), channel(&white));
}

#[test]
fn bits_do_not_depend_on_the_wave_nor_do_branches() {
    let scene = prism(glass(Some(ABBE), 0.3));
    same_bits_however_it_runs(&scene);
}

/// Branches keep the wavelength of their path: their mean is that of single paths.
#[test]
fn branches_keep_their_wavelength() {
    let scene = prism(glass(Some(ABBE), 0.3));
    let branched = Settings {
        split: vec![2, 2],
        ..settings(5000)
    };
    let expected = Settings {
        seed: 1,
        ..settings(20_000)
    };
    let (a, b) = (by_wave(&scene, &branched), by_wave(&scene, &expected));
    same(&a, &b, SIGNIFICANCE).unwrap();
}
