//! The albedo of facets that reflect by Schlick's term alone: `S(o)`, the mean over visible normals
//! of `(1 - o.m)^5 G2 / G1(o)`. With `E` of [`super::ReflectionEnergy`], facets that reflect
//! `f0 + (f90 - f0) (1 - o.m)^5` have the albedo `f0 E + (f90 - f0) S`.
//!
//! `S` is steep in the cosine itself as well as in `o.z / alpha`; entries along the cosine are as
//! those of dielectrics seen from within. Interpolation and quadrature are off by -1.9% to
//! 0.4% together where `S` is above 0.1 (at the narrowest lobes; against the same quadrature, on a
//! grid between the entries); entries are raised by [`MARGIN`].

use super::{Between, across, alpha_of, even, even_at, over_unit_square};
use crate::bsdf::fresnel::schlick;
use crate::bsdf::ggx::{Ggx, reflect};
use crate::lanes::{Fx, Ux, gather};
use crate::vec3::Vec3x;
use std::sync::LazyLock;

/// Entries along each side.
const SIDE: usize = 32;
/// Points along each side of the unit square for an entry.
const FINE: usize = 48;
/// What entries are raised by, relatively: no less than what interpolation and quadrature may lack.
const MARGIN: f64 = 0.02;

/// Directional albedo of facets that reflect by Schlick's term.
#[derive(Debug)]
pub struct SchlickEnergy {
    albedo: [f32; SIDE * SIDE],
}

static SCHLICK: LazyLock<SchlickEnergy> = LazyLock::new(SchlickEnergy::build);

impl SchlickEnergy {
    /// The table; built at the first call.
    #[must_use]
    pub fn table() -> &'static Self {
        &SCHLICK
    }

    /// `S(o)` for facets of width `alpha`; `cos` is `o.z`.
    #[inline(always)]
    #[must_use]
    pub fn albedo(&self, cos: Fx, alpha: Fx) -> Fx {
        let row = Between::new(across(alpha), SIDE);
        let at = Between::new(even(cos, alpha), SIDE);
        let first = row.low * Ux::splat(SIDE as u32) + at.low;
        let take = |offset: usize| gather(&self.albedo, first + Ux::splat(offset as u32));
        let low = at.mix(take(0), take(1));
        let high = at.mix(take(SIDE), take(SIDE + 1));
        row.mix(low, high).fast_min(Fx::ONE)
    }

    fn build() -> Self {
        let mut table = Self {
            albedo: [0.0; SIDE * SIDE],
        };
        for (entry, albedo) in table.albedo.iter_mut().enumerate() {
            let alpha = alpha_of(entry / SIDE, SIDE);
            let t = (entry % SIDE) as f64 / (SIDE - 1) as f64;
            *albedo = (reflected(alpha, even_at(t, alpha).max(1e-7)) * (1.0 + MARGIN)) as f32;
        }
        table
    }
}

/// `S` for light from a cosine.
fn reflected(alpha: f64, cos: f64) -> f64 {
    let facets = Ggx::isotropic(Fx::splat(alpha as f32));
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    let o = Vec3x::splat([sin as f32, 0.0, cos as f32]);
    over_unit_square(FINE, |u, v| {
        let m = facets.sample_normal(o, u, v);
        let i = reflect(o, m);
        i.z.simd_gt(Fx::ZERO) & (schlick(o.dot(m)) * facets.shadowing(o, i))
    })
}
