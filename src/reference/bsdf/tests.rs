//! What is drawn is what is evaluated, and white surfaces that make up for their losses lose nothing.

use super::*;
use crate::estimate::Running;
use crate::reference::random::generator;
use crate::scene;
use crate::scene::material::{self, Material};
use std::f64::consts::PI;

fn material(bsdf: scene::Bsdf, compensation: bool) -> Material {
    Material {
        bsdf,
        compensation,
        ..Material::diffuse("", [0.0; 3], [0.0; 3])
    }
}

fn metal(roughness: f32, anisotropy: f32) -> scene::Bsdf {
    scene::Bsdf::Conductor {
        // No light enters: a perfect mirror, to what the index is away from infinity.
        eta: [1e6; 3],
        k: [1e6; 3],
        tint: [1.0; 3].into(),
        roughness: roughness.into(),
        anisotropy,
    }
}

fn glass(ior: f32, roughness: f32, thin: bool) -> scene::Bsdf {
    scene::Bsdf::Dielectric(Box::new(material::Dielectric {
        ior,
        roughness: roughness.into(),
        thin,
        ..Default::default()
    }))
}

fn surfaces() -> Vec<(&'static str, scene::Bsdf)> {
    let diffuse = |roughness| scene::Bsdf::Diffuse {
        reflectance: [1.0; 3].into(),
        roughness,
    };
    let plastic = material::Principled {
        roughness: 0.7.into(),
        ..Default::default()
    };
    let layered = material::Principled {
        clearcoat: 0.7.into(),
        clearcoat_roughness: 0.6.into(),
        sheen_color: [0.8; 3].into(),
        sheen_roughness: 0.5.into(),
        metallic: 0.3.into(),
        transmission: 0.4.into(),
        thin: true,
        ..plastic.clone()
    };
    let principled = |p| scene::Bsdf::Principled(Box::new(p));
    vec![
        ("Lambert", diffuse(0.0)),
        ("EON", diffuse(0.8)),
        ("metal", metal(0.7, 0.0)),
        ("rough metal", metal(1.0, 0.0)),
        ("brushed metal", metal(0.8, 0.5)),
        ("glass", glass(1.5, 0.7, false)),
        ("rough glass", glass(1.5, 1.0, false)),
        ("dense glass", glass(2.4, 0.8, false)),
        ("light glass", glass(0.7, 0.8, false)),
        ("pane", glass(1.5, 0.8, true)),
        ("plastic", principled(plastic)),
        ("layers", principled(layered)),
    ]
}

fn directions() -> impl Iterator<Item = DVec3> {
    let at = |cos: f64| DVec3::new(0.6, 0.8, 0.0) * (1.0 - cos * cos).sqrt() + DVec3::Z * cos;
    [0.05, 0.4, 0.95].into_iter().map(at)
}

/// Calls `check` with the mean of what is drawn and, where asked, of what is evaluated all around, for
/// radiance that is 1 times the square of the index, as a furnace's is.
fn each(compensation: bool, mut check: impl FnMut(&str, Running, &dyn Fn() -> f64)) {
    let mut k = 0;
    for (name, bsdf) in surfaces() {
        let ior = match &bsdf {
            scene::Bsdf::Dielectric(glass) if !glass.thin => f64::from(glass.ior),
            _ => 1.0,
        };
        let material = material(bsdf, compensation);
        let worn = Worn::new(&material);
        let read = Reader { point: None };
        for front in [true, false] {
            let squared = if front { ior * ior } else { 1.0 / (ior * ior) };
            let radiance = |i: DVec3| if i.z < 0.0 { squared } else { 1.0 };
            for o in directions() {
                let bsdf = worn.bsdf(&read, o, front);
                k += 1;
                let mut rng = generator([k, 1, 2, 3]);
                let weight = |drawn: Drawn| drawn.weight.x * radiance(drawn.direction);
                let drawn = (0..20_000).map(|_| bsdf.draw(o, false, &mut rng).map_or(0.0, weight));
                let drawn: Running = drawn.collect();
                let evaluated = || {
                    const STEPS: u32 = 400;
                    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
                    let row = |i: u32| {
                        let z = 2.0 * at(i) - 1.0;
                        let r = (1.0 - z * z).sqrt();
                        let column = |j: u32| {
                            let (y, x) = (TAU * at(j)).sin_cos();
                            let i = DVec3::new(r * x, r * y, z);
                            bsdf.evaluate(o, i).x * radiance(i)
                        };
                        (0..STEPS).map(column).sum::<f64>()
                    };
                    let steps = f64::from(STEPS * STEPS);
                    4.0 * PI * (0..STEPS).map(row).sum::<f64>() / steps
                };
                check(&format!("{name} {front} {:.2}", o.z), drawn, &evaluated);
            }
        }
    }
}

/// Twelve surfaces, two sides, three directions, at 1e-4 together.
const LEVEL: f64 = 1.0 - 1e-4 / 72.0;

#[test]
fn what_is_drawn_is_what_is_evaluated() {
    for compensation in [false, true] {
        each(compensation, |name, drawn, evaluated| {
            let value = evaluated();
            // The midpoint rule over lobes of width 0.5 and more with 400 points each way; where they
            // meet the horizon at grazing it is off by half a step of 1/200 of that edge.
            let within = 2e-3 * value;
            let [low, high] = drawn.confidence_interval(LEVEL).expect("many");
            assert!(
                low - within <= value && value <= high + within,
                "{name} {compensation}: {drawn:?} {value}"
            );
        });
    }
}

#[test]
fn white_surfaces_keep_all_light() {
    each(true, |name, drawn, _| {
        let [low, high] = drawn.confidence_interval(LEVEL).expect("many");
        // Twice the quadrature of the albedos, and what a mirror of index 1e6 lets in.
        assert!(low <= 1.001 && high >= 0.999, "{name}: {drawn:?}");
        assert!(high - low < 0.1, "{name}: {drawn:?} says nothing");
    });
}
