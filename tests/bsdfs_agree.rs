//! The wave gives the image of the f64 reference on every kind of surface, whether lights are looked
//! for or not.

mod common;

use common::picture::{by_reference, by_wave, independent};
use common::scenes::{Builder, camera_along_z};
use common::statistics::{ROUNDING, SIGNIFICANCE, same_but_for};
use huygens::scene::material::{Dielectric, Principled};
use huygens::scene::{Bsdf, Light, LightKind, Scene, Sky};
use huygens::settings::{Integrator, Settings, Strategy};

const STRATEGIES: [Strategy; 3] = [Strategy::Cosine, Strategy::Light, Strategy::Mis];
/// Where light that is looked for alone is found with weights that are rare and large: narrow lobes, and
/// refraction that grazes. Means of thousands of those are not normal yet.
const BUT_LIGHT: [Strategy; 2] = [Strategy::Cosine, Strategy::Mis];

/// A ball, and a pane of the same behind it, on a floor between a broad lamp, a sky and a distant
/// light.
fn ball(bsdf: &Bsdf, compensation: bool) -> Scene {
    let mut b = Builder::new();
    let floor = b.material([0.7, 0.5, 0.3], [0.0; 3]);
    let lamp = b.material([0.0; 3], [2.0, 2.5, 3.0]);
    b.two_sided();
    let worn = b.surface(bsdf.clone());
    b.last().compensation = compensation;
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
    b.quad(
        worn,
        [
            [0.2, -0.9, -5.2],
            [2.0, -0.9, -5.2],
            [2.0, 1.5, -5.2],
            [0.2, 1.5, -5.2],
        ],
    );
    b.sphere(worn, [-0.3, 0.0, -4.0], 0.9);
    let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 0.3), 6, 6);
    scene.sky = Some(Sky::Gradient {
        zenith: [0.5, 0.7, 1.0],
        nadir: [0.8, 0.5, 0.4],
    });
    // Half of it comes from behind the pane.
    for z in [1.0, -1.0] {
        scene.lights.push(Light {
            name: "test".into(),
            kind: LightKind::Distant {
                from: [0.48, 0.6, 0.64 * z],
                irradiance: [0.5, 0.4, 0.3],
                half_angle: 0.0,
            },
        });
    }
    scene
}

/// Compares under all of `strategies`. `allowed` is a relative difference that is no fault.
fn assert_agrees(name: &str, scene: &Scene, allowed: f64, strategies: &[Strategy]) {
    let settings = |integrator, strategy, spp| Settings {
        integrator,
        strategy,
        spp,
        max_depth: Some(4),
        ..independent()
    };
    let reference = Settings {
        seed: 1,
        ..settings(Integrator::Reference, Strategy::Cosine, 8192)
    };
    let expected = by_reference(scene, &reference);
    let level = SIGNIFICANCE / strategies.len() as f64;
    for &strategy in strategies {
        let rendered = by_wave(scene, &settings(Integrator::Path, strategy, 4096));
        if let Err(difference) = same_but_for(allowed, &rendered, &expected, level) {
            let path = rendered.leave_behind(&format!("bsdfs_agree-{name}"));
            panic!("{name}, {strategy:?}: {difference} (the render is in {path})");
        }
        // The comparison sees 2% beyond what is allowed.
        for factor in [0.98 - allowed, 1.02 + allowed] {
            let wrong = same_but_for(allowed, &rendered.scaled(factor), &expected, level);
            assert!(
                wrong.is_err(),
                "{name}: {factor} times the image passes too"
            );
        }
    }
}

/// With single scattering alone, which both sides compute exactly; and with what makes up for it, whose
/// tables in the wave lack at most `table` of a surface's light at a time (`docs/bsdf.md`). A path
/// meets at most four surfaces.
fn assert_both_agree(name: &str, bsdf: &Bsdf, table: f64, strategies: &[Strategy]) {
    assert_agrees(name, &ball(bsdf, false), ROUNDING, strategies);
    let name = format!("{name} compensated");
    let allowed = 1.0 - (1.0 - table).powi(4);
    assert_agrees(&name, &ball(bsdf, true), allowed, &[Strategy::Mis]);
}

fn metal(roughness: f32, anisotropy: f32) -> Bsdf {
    Bsdf::Conductor {
        eta: [0.2, 0.9, 1.1],
        k: [3.9, 2.4, 2.3],
        tint: [1.0, 0.9, 0.8].into(),
        roughness: roughness.into(),
        anisotropy,
    }
}

fn glass(ior: f32, roughness: f32, thin: bool) -> Bsdf {
    Bsdf::Dielectric(Box::new(Dielectric {
        ior,
        roughness: roughness.into(),
        thin,
        reflection_tint: [1.0, 1.0, 0.9].into(),
        transmission_tint: [0.9, 0.8, 1.0].into(),
        ..Dielectric::default()
    }))
}

fn principled(change: impl FnOnce(&mut Principled)) -> Bsdf {
    let mut p = Principled {
        base_color: [0.8, 0.5, 0.3].into(),
        ..Principled::default()
    };
    change(&mut p);
    Bsdf::Principled(Box::new(p))
}

#[test]
fn on_rough_diffuse_surfaces() {
    for roughness in [0.3, 1.0] {
        let reflectance = [0.8, 0.5, 0.2].into();
        let bsdf = Bsdf::Diffuse {
            reflectance,
            roughness,
        };
        assert_agrees("diffuse", &ball(&bsdf, true), ROUNDING, &STRATEGIES);
    }
}

#[test]
fn on_metals() {
    assert_agrees(
        "mirror",
        &ball(&metal(0.0, 0.0), true),
        ROUNDING,
        &STRATEGIES,
    );
    assert_both_agree("metal 0.1", &metal(0.1, 0.0), 0.01, &BUT_LIGHT);
    assert_both_agree("metal 0.5", &metal(0.5, 0.0), 0.01, &STRATEGIES);
    assert_both_agree("metal 1", &metal(1.0, 0.0), 0.01, &STRATEGIES);
}

#[test]
fn on_brushed_metals() {
    assert_both_agree("brushed across u", &metal(0.6, 0.8), 0.02, &STRATEGIES);
    assert_both_agree("brushed across v", &metal(0.8, -0.5), 0.02, &STRATEGIES);
}

#[test]
fn on_glass() {
    for (ior, thin) in [(1.5, false), (1.5, true), (0.8, false)] {
        let name = format!("polished glass {ior} {thin}");
        assert_agrees(
            &name,
            &ball(&glass(ior, 0.0, thin), true),
            ROUNDING,
            &STRATEGIES,
        );
    }
}

#[test]
fn on_frosted_glass() {
    assert_both_agree("glass 0.2", &glass(1.5, 0.2, false), 0.02, &BUT_LIGHT);
    assert_both_agree("glass 0.6", &glass(1.5, 0.6, false), 0.02, &BUT_LIGHT);
    assert_both_agree("glass 1", &glass(1.5, 1.0, false), 0.02, &BUT_LIGHT);
    assert_both_agree("thin glass", &glass(1.5, 0.6, true), 0.01, &STRATEGIES);
    assert_both_agree("dense glass", &glass(2.4, 0.5, false), 0.02, &BUT_LIGHT);
    assert_both_agree("light glass", &glass(0.7, 0.6, false), 0.02, &BUT_LIGHT);
}

#[test]
fn on_glass_that_hardly_bends() {
    assert_agrees(
        "index 1",
        &ball(&glass(1.0, 0.5, false), true),
        ROUNDING,
        &STRATEGIES,
    );
    assert_both_agree("index 1.03", &glass(1.03, 0.6, false), 0.01, &STRATEGIES);
    assert_both_agree("narrow", &glass(1.06, 0.12, false), 0.02, &BUT_LIGHT);
}

#[test]
fn on_each_lobe_of_the_principled_surface() {
    let of = |change: fn(&mut Principled)| principled(change);
    let polished = of(|p| p.roughness = 0.1.into());
    assert_both_agree("polished plastic", &polished, 0.02, &BUT_LIGHT);
    let plastic = of(|p| p.roughness = 0.6.into());
    assert_both_agree("plastic", &plastic, 0.02, &STRATEGIES);
    let tinted = of(|p| {
        p.roughness = 0.5.into();
        p.specular = 0.7.into();
        p.specular_color = [3.0, 9.0, 30.0].into();
        p.ior = 1.8;
    });
    assert_both_agree("specular", &tinted, 0.02, &STRATEGIES);
    let metal = of(|p| {
        p.roughness = 0.8.into();
        p.metallic = 1.0.into();
    });
    assert_both_agree("metallic", &metal, 0.02, &STRATEGIES);
    let coat = of(|p| {
        p.clearcoat = 0.8.into();
        p.clearcoat_roughness = 0.4.into();
    });
    assert_both_agree("coat", &coat, 0.02, &STRATEGIES);
    let sheen = of(|p| {
        p.sheen_color = [0.9, 0.5, 0.2].into();
        p.sheen_roughness = 0.4.into();
    });
    assert_both_agree("sheen", &sheen, 0.02, &STRATEGIES);
}

#[test]
fn on_principled_glass_and_all_lobes_at_once() {
    let clear = principled(|p| {
        p.transmission = 1.0.into();
        p.roughness = 0.5.into();
    });
    assert_both_agree("principled glass", &clear, 0.02, &BUT_LIGHT);
    let all = |thin| {
        principled(|p| {
            p.transmission = 0.5.into();
            p.thin = thin;
            p.roughness = 0.5.into();
            p.metallic = 0.3.into();
            p.clearcoat = 0.5.into();
            p.clearcoat_roughness = 0.4.into();
            p.sheen_color = [0.4, 0.3, 0.2].into();
            p.sheen_roughness = 0.5.into();
        })
    };
    for thin in [false, true] {
        let name = format!("all lobes, thin {thin}");
        let strategies: &[Strategy] = if thin { &STRATEGIES } else { &BUT_LIGHT };
        assert_both_agree(&name, &all(thin), 0.02, strategies);
    }
}

/// A mixture of a mixture: rough metal, and glass or paint.
#[test]
fn on_mixtures() {
    let mut scene = ball(&metal(0.5, 0.0), false);
    let paint = Bsdf::Diffuse {
        reflectance: [0.2, 0.6, 0.4].into(),
        roughness: 0.0,
    };
    let mix = |first, second, amount: f32| Bsdf::Mix {
        first,
        second,
        amount: amount.into(),
    };
    let first = scene.materials.len() as u32;
    let worn = first - 1;
    for bsdf in [
        scene.materials[worn as usize].bsdf.clone(),
        glass(1.5, 0.0, false),
        paint,
        mix(first + 1, first + 2, 0.7),
    ] {
        let mut part = scene.materials[worn as usize].clone();
        part.bsdf = bsdf;
        scene.materials.push(part);
    }
    scene.materials[worn as usize].bsdf = mix(first, first + 3, 0.4);
    assert_agrees("mixture", &scene, ROUNDING, &STRATEGIES);
}
