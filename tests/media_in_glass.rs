//! Media inside of glass: against the f64 reference, and strategy against strategy.

mod common;

use common::media::{fill, glass, light, medium};
use common::picture::{by_reference, by_wave, independent};
use common::scenes::{Builder, camera_along_z};
use common::statistics::{SIGNIFICANCE, same};
use huygens::scene::material::{Dielectric, Principled};
use huygens::scene::{Bsdf, LightKind, Medium, Scene, Sky};
use huygens::settings::{Settings, Strategy};

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
