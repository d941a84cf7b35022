//! The metallic-roughness model of glTF 2.0 (Khronos, *glTF 2.0 Specification*, appendix B, and the
//! pages of KHR_materials_ior, specular, transmission, clearcoat and sheen), layered by albedos as
//! `docs/bsdf.md` says: below a coat, `1 - coat E_c(o)`; below sheen, `1 - max(sheen) E_s(o)`; below
//! the specular layer, `1 - max R(o)`.
//!
//! It is the sum of its lobes. One is drawn, with a probability that depends on their strengths
//! alone, and its weight divided by that.

use super::dielectric::RoughGlass;
use super::facets::{Facets, reflect};
use super::fresnel::schlick;
use super::{Drawn, cosine_direction, uniform_direction};
use crate::reference::random::uniform;
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::{PI, TAU};

/// `f0` of a coat: that of index 1.5.
const COAT: f64 = 0.04;

/// What the material is at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameters {
    pub(super) base: DVec3,
    pub(super) metallic: f64,
    pub(super) alpha: f64,
    pub(super) eta: f64,
    pub(super) specular: f64,
    pub(super) specular_color: DVec3,
    pub(super) transmission: f64,
    /// Strengths; 0 from within.
    pub(super) coat: f64,
    pub(super) coat_alpha: f64,
    pub(super) sheen: DVec3,
    pub(super) sheen_roughness: f64,
    /// Whether the metal makes up for what single scattering loses.
    pub(super) compensated: bool,
}

/// What its layers reflect of the light towards `o`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Albedos {
    /// Of facets that reflect everything, and by Schlick's term alone.
    pub(super) facets: [f64; 2],
    /// Of the coat's.
    pub(super) coat: [f64; 2],
    /// Of sheen of strength 1, and what the published lobe is multiplied with.
    pub(super) sheen: f64,
    pub(super) sheen_scale: f64,
}

/// The lobes for one direction `o`.
#[derive(Clone, Copy, Debug)]
pub(in crate::reference) struct Principled {
    diffuse: DVec3,
    /// The facets' reflectance at normal incidence and at grazing.
    facets: [DVec3; 2],
    alpha: f64,
    coat: f64,
    coat_alpha: f64,
    sheen: DVec3,
    sheen_roughness: f64,
    glass: f64,
    through: Option<RoughGlass>,
}

/// Albedo of facets whose reflectance goes from `f0` to `f90` by Schlick's term.
fn layer(f0: f64, f90: f64, [all, schlick]: [f64; 2]) -> f64 {
    f0 * all + (f90 - f0) * schlick
}

impl Principled {
    /// For light towards where `albedos` are, with the glass, if it is part of it.
    pub(super) fn new(p: &Parameters, albedos: &Albedos, through: Option<RoughGlass>) -> Self {
        let under_coat = 1.0 - p.coat * layer(COAT, 1.0, albedos.coat);
        let under = under_coat * (1.0 - p.sheen.max_element() * albedos.sheen);
        let dielectric = under * (1.0 - p.metallic);
        let opaque = dielectric * (1.0 - p.transmission);
        let normal = ((p.eta - 1.0) / (p.eta + 1.0)).powi(2);
        let f0 = (normal * p.specular_color).min(DVec3::ONE) * p.specular;
        let reflected = layer(f0.max_element(), p.specular, albedos.facets);
        let lost = if p.compensated {
            (1.0 - albedos.facets[0]) / albedos.facets[0]
        } else {
            0.0
        };
        let metal = under * p.metallic * (DVec3::ONE + lost * p.base);
        Self {
            diffuse: opaque * (1.0 - reflected).max(0.0) * p.base,
            facets: [
                metal * p.base + opaque * f0,
                metal + opaque * DVec3::splat(p.specular),
            ],
            alpha: p.alpha,
            coat: p.coat,
            coat_alpha: p.coat_alpha,
            sheen: p.sheen * (under_coat * albedos.sheen_scale),
            sheen_roughness: p.sheen_roughness,
            glass: dielectric * p.transmission,
            through,
        }
    }

    /// Facets' reflectance.
    fn fresnel(&self, cos: f64) -> DVec3 {
        self.facets[0].lerp(self.facets[1], schlick(cos))
    }

    fn coat_fresnel(&self, cos: f64) -> f64 {
        self.coat * (COAT + (1.0 - COAT) * schlick(cos))
    }

    /// `f |cos_i|`.
    pub(super) fn evaluate(&self, o: DVec3, i: DVec3) -> DVec3 {
        let mut sum = DVec3::ZERO;
        if let Some(glass) = &self.through {
            sum += self.glass * glass.evaluate(o, i);
        }
        if i.z <= 0.0 {
            return sum;
        }
        let m = (o + i).normalize();
        let cos = o.dot(m);
        let facets = |alpha| Facets::isotropic(alpha).reflection(o, i, m);
        sum += self.diffuse * i.z / PI;
        sum += self.fresnel(cos) * facets(self.alpha);
        if self.coat > 0.0 {
            sum += DVec3::splat(self.coat_fresnel(cos) * facets(self.coat_alpha));
        }
        sum + self.sheen * charlie(o, i, self.sheen_roughness)
    }

    pub(super) fn draw(&self, o: DVec3, rng: &mut impl Rng) -> Option<Drawn> {
        let strengths = [
            self.diffuse.max_element(),
            self.facets[0]
                .max_element()
                .max(0.2 * self.facets[1].max_element()),
            0.2 * self.coat,
            self.sheen.max_element(),
            self.glass,
        ];
        let total: f64 = strengths.iter().sum();
        let mut u = uniform(rng) * total;
        let drawn = strengths.iter().position(|&strength| {
            u -= strength;
            u < 0.0
        })?;
        let mirrored = |alpha: f64, rng: &mut _| {
            let facets = Facets::isotropic(alpha);
            let m = facets.draw(o, rng);
            let i = reflect(o, m);
            (i.z > 0.0).then(|| (i, o.dot(m), facets.shadowing(o, i)))
        };
        let (direction, weight) = match drawn {
            0 => (cosine_direction(rng), self.diffuse),
            1 => {
                let (i, cos, part) = mirrored(self.alpha, rng)?;
                (i, self.fresnel(cos) * part)
            }
            2 => {
                let (i, cos, part) = mirrored(self.coat_alpha, rng)?;
                (i, DVec3::splat(self.coat_fresnel(cos) * part))
            }
            3 => {
                let i = uniform_direction(rng);
                let value = charlie(o, i, self.sheen_roughness);
                (i, self.sheen * (TAU * value))
            }
            _ => {
                let through = self.through?.draw(o, rng)?;
                (through.direction, self.glass * through.weight)
            }
        };
        Some(Drawn {
            direction,
            weight: weight * (total / strengths[drawn]),
        })
    }
}

/// `f i.z` of sheen as published: A. Estevez, C. Kulla, "Production Friendly Microfacet Sheen BRDF",
/// 2017, with the visibility of M. Ashikhmin, S. Premoze, 2007. 0 where `i` is below.
pub(super) fn charlie(o: DVec3, i: DVec3, roughness: f64) -> f64 {
    if i.z <= 0.0 {
        return 0.0;
    }
    let m = (o + i).normalize();
    let power = 1.0 / (roughness * roughness);
    let sine = m.truncate().length();
    let density = (2.0 + power) * sine.powf(power) / TAU;
    density * i.z / (4.0 * (o.z + i.z - o.z * i.z))
}
