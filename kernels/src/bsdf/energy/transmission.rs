//! The albedo of a rough dielectric boundary: what single scattering reflects and passes.
//!
//! `E(o)` is the mean, over visible normals, of `R G2 / G1(o)` where the reflection is above the
//! horizon, and of `(1 - R) G2 / G1(o)` where the refraction is below. Across relative indices the
//! coordinate is the root of `|eta - 1| / (eta + 1)`, the amplitude reflected at normal incidence, in
//! a table for `eta >= 1` and one for `eta < 1`; along the cosine the latter has half its entries
//! evenly, for the edge of total reflection. It starts at `|eta - 1|` of 0.05: closer to 1 the lobe
//! that passes is not evaluated ([`crate::bsdf::RoughDielectric`]).
//!
//! Interpolation and quadrature are off by -0.0039 to 0.0009 together where `eta > 1`, by -0.0042 to
//! 0.0077 where `eta < 1` (against 96 x 96 points, on a grid between the entries); entries are raised
//! by [`MARGIN`], so that a furnace never gains.

use super::{Between, ReflectionEnergy, across, alpha_of, coordinate, cosine_at, over_unit_square};
use crate::bsdf::fresnel::dielectric;
use crate::bsdf::ggx::{Ggx, reflect};
use crate::bsdf::refraction::Refraction;
use crate::lanes::{Fx, Ux, as_bits, gather};
use crate::vec3::Vec3x;
use std::sync::LazyLock;

/// Entries along the cosine.
const COSINES: usize = 32;
/// Entries along the width.
const WIDTHS: usize = 16;
/// Entries along the index, on either side of 1.
const INDICES: usize = 16;
/// Entries for `eta >= 1`, and as many for `eta < 1`.
const HALF: usize = INDICES * WIDTHS * COSINES;
/// First and last amplitude: `eta` from 1.05 to 4, and from 1/4 to 0.953; clamped beyond.
const AMPLITUDE: [f64; 2] = [2.4e-2, 0.6];
/// Points along each side of the unit square for an entry.
const FINE: usize = 24;
/// What entries are raised by: no less than what interpolation and quadrature may lack. They may so
/// come out above 1; what is looked up does not.
const MARGIN: f64 = 4.5e-3;

/// Directional albedos of rough dielectrics.
#[derive(Debug)]
pub struct TransmissionEnergy {
    albedo: [f32; 2 * HALF],
    /// The same for thin walls, which send all of it one way.
    pub reflection: &'static ReflectionEnergy,
}

static TRANSMISSION: LazyLock<TransmissionEnergy> = LazyLock::new(TransmissionEnergy::build);

impl TransmissionEnergy {
    /// The table; built at the first call.
    #[must_use]
    pub fn table() -> &'static Self {
        &TRANSMISSION
    }

    /// The part of the light from `o` that is reflected or passes; `cos` is `o.z`.
    #[inline(always)]
    #[must_use]
    pub fn albedo(&self, cos: Fx, alpha: Fx, eta: Fx) -> Fx {
        Place::new(cos, alpha, eta)
            .take(&self.albedo)
            .fast_min(Fx::ONE)
    }

    fn build() -> Self {
        let mut table = Self {
            albedo: [0.0; 2 * HALF],
            reflection: ReflectionEnergy::table(),
        };
        for entry in 0..2 * HALF {
            let at = entry % COSINES;
            let width = entry / COSINES % WIDTHS;
            let index = entry / (COSINES * WIDTHS) % INDICES;
            let alpha = alpha_of(width, WIDTHS);
            let t = at as f64 / (COSINES - 1) as f64;
            let cos = if entry < HALF {
                cosine_at(t, alpha)
            } else {
                even_at(t, alpha)
            };
            let cos = cos.max(1e-7);
            let [least, most] = AMPLITUDE.map(f64::sqrt);
            let root = least + (most - least) * index as f64 / (INDICES - 1) as f64;
            let amplitude = root * root;
            let above = (1.0 + amplitude) / (1.0 - amplitude);
            let eta = if entry < HALF { above } else { 1.0 / above };
            let kept = scattered(cos, alpha, eta);
            table.albedo[entry] = (kept + MARGIN) as f32;
        }
        table
    }
}

/// Where three numbers lie in the table.
struct Place {
    first: Ux,
    cos: Between,
    width: Between,
    index: Between,
}

impl Place {
    #[inline(always)]
    fn new(cos: Fx, alpha: Fx, eta: Fx) -> Self {
        let amplitude = (eta - Fx::ONE).abs() / (eta + Fx::ONE);
        let [least, most] = AMPLITUDE.map(|a| Fx::splat(a as f32).sqrt());
        let index = Between::new((amplitude.sqrt() - least) / (most - least), INDICES);
        let width = Between::new(across(alpha), WIDTHS);
        let above = eta.simd_ge(Fx::ONE);
        let at = above.select(coordinate(cos, alpha), even(cos, alpha));
        let cos = Between::new(at, COSINES);
        let half = as_bits(eta.simd_lt(Fx::ONE)) & Ux::splat(HALF as u32);
        let row = index.low * Ux::splat(WIDTHS as u32) + width.low;
        Self {
            first: half + row * Ux::splat(COSINES as u32) + cos.low,
            cos,
            width,
            index,
        }
    }

    #[inline(always)]
    fn take(&self, entries: &[f32]) -> Fx {
        let line = |offset: usize| {
            let first = self.first + Ux::splat(offset as u32);
            self.cos
                .mix(gather(entries, first), gather(entries, first + Ux::ONE))
        };
        let sheet = |offset: usize| self.width.mix(line(offset), line(offset + COSINES));
        self.index.mix(sheet(0), sheet(WIDTHS * COSINES))
    }
}

/// Half of the entries where the other table has them, half evenly along the cosine, for the edge of
/// total reflection.
#[inline(always)]
fn even(cos: Fx, alpha: Fx) -> Fx {
    (coordinate(cos, alpha) + cos) * Fx::splat(0.5)
}

/// The cosine at which [`even`] is `t`, by bisection.
fn even_at(t: f64, alpha: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let cos: f64 = 0.5 * (low + high);
        let at = 0.5 * (((1.0 + alpha) * cos / (cos + alpha)).sqrt() + cos);
        if at < t { low = cos } else { high = cos }
    }
    high
}

/// `E` for light from a cosine.
fn scattered(cos: f64, alpha: f64, eta: f64) -> f64 {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    let o = Vec3x::splat([sin as f32, 0.0, cos as f32]);
    let facets = Ggx::isotropic(Fx::splat(alpha as f32));
    let eta = Fx::splat(eta as f32);
    over_unit_square(FINE, |u, v| {
        let m = facets.sample_normal(o, u, v);
        let boundary = dielectric(o.dot(m), eta);
        let up = reflect(o, m);
        let bend = Refraction::by(o, m, boundary.q, eta);
        let reflected = boundary.reflectance * facets.shadowing(o, up);
        let passed = (Fx::ONE - boundary.reflectance) * facets.shadowing(o, bend.direction);
        let below = bend.possible & bend.direction.z.simd_lt(Fx::ZERO);
        (up.z.simd_gt(Fx::ZERO) & reflected) + (below & passed)
    })
}
