//! From a material's BSDF to the slots where its kernel looks for its parameters
//! (`huygens_kernels::scatter::kinds`).

use crate::scene::material::{Dielectric, Principled};
use crate::scene::{Bsdf, Material};
use huygens_kernels::bsdf::fresnel::conductor_mean;
use huygens_kernels::scatter::kinds::CAUCHY_B;
use huygens_kernels::tables::SLOTS;

/// The parameters of `material`. A mixture has none.
pub(crate) fn parameters(material: &Material) -> [f32; SLOTS] {
    let mut slots = [0.0; SLOTS];
    let mut at = 0;
    let mut put = |values: &[f32]| {
        slots[at..at + values.len()].copy_from_slice(values);
        at += values.len();
    };
    match &material.bsdf {
        Bsdf::Diffuse {
            reflectance,
            roughness,
        } => {
            put(&reflectance.factor);
            put(&[*roughness]);
        }
        Bsdf::Conductor {
            eta,
            k,
            tint,
            roughness,
            anisotropy,
        } => {
            put(eta);
            put(k);
            put(&tint.factor);
            put(&[roughness.factor, *anisotropy]);
            // Light that has met two facets or more is in proportion to it: at 0 there is none.
            let mean = |c: usize| {
                if material.compensation {
                    conductor_mean(f64::from(eta[c]), f64::from(k[c])) as f32
                } else {
                    0.0
                }
            };
            put(&[mean(0), mean(1), mean(2)]);
        }
        Bsdf::Dielectric(glass) => {
            put_dielectric(glass, &mut put);
            put(&[flag(material.compensation)]);
        }
        Bsdf::Principled(p) => {
            put_principled(p, &mut put);
            put(&[flag(material.compensation)]);
        }
        Bsdf::Mix { .. } => {}
    }
    if let Bsdf::Dielectric(glass) = &material.bsdf
        && let Some(cauchy) = glass.dispersion.filter(|_| !glass.thin)
    {
        (slots[0], slots[CAUCHY_B]) = (cauchy.a, cauchy.b);
    }
    slots
}

fn flag(on: bool) -> f32 {
    f32::from(u8::from(on))
}

fn put_dielectric(glass: &Dielectric, mut put: impl FnMut(&[f32])) {
    put(&[glass.ior, flag(glass.thin)]);
    put(&glass.reflection_tint.factor);
    put(&glass.transmission_tint.factor);
    put(&[glass.roughness.factor]);
}

fn put_principled(p: &Principled, mut put: impl FnMut(&[f32])) {
    put(&p.base_color.factor);
    put(&[
        p.metallic.factor,
        p.roughness.factor,
        p.ior,
        p.specular.factor,
    ]);
    put(&p.specular_color.factor);
    put(&[p.transmission.factor, flag(p.thin)]);
    put(&[p.clearcoat.factor, p.clearcoat_roughness.factor]);
    put(&p.sheen_color.factor);
    put(&[p.sheen_roughness.factor]);
}
