//! The albedo of sheen, and what keeps it from reflecting more than it receives.
//!
//! `E(o) = int f |cos_i| d omega_i` of the lobe in [`crate::bsdf::charlie`] as it is published grows
//! towards grazing, to above 1 for roughness below 0.46. The lobe is divided by its largest albedo
//! where that is above 1, a number of the roughness alone, so that it stays reciprocal.
//!
//! The coordinates are `sqrt(o.z)` and the roughness from 0.1 to 1. Interpolation falls short by at
//! most 0.6% (of the same quadrature, on a grid between the entries); entries are raised by
//! [`MARGIN`].

use super::Between;
use crate::bsdf::charlie::{ROUGHNESS_FLOOR, charlie};
use crate::lanes::{Fx, LANES, Ux, gather, iota, to_f32};
use crate::math::sin_cos_turn;
use crate::vec3::Vec3x;
use std::sync::LazyLock;

/// Entries along each side.
const SIDE: usize = 32;
/// Points along each side of the hemisphere's square for an entry.
const FINE: usize = 64;
/// What entries are raised by, relatively: no less than what interpolation and quadrature may lack.
const MARGIN: f64 = 7e-3;

/// Directional albedo of sheen.
#[derive(Debug)]
pub struct SheenEnergy {
    albedo: [f32; SIDE * SIDE],
    scale: [f32; SIDE],
}

static SHEEN: LazyLock<SheenEnergy> = LazyLock::new(SheenEnergy::build);

impl SheenEnergy {
    /// The table; built at the first call.
    #[must_use]
    pub fn table() -> &'static Self {
        &SHEEN
    }

    /// `E(o)` of the scaled lobe.
    #[inline(always)]
    #[must_use]
    pub fn albedo(&self, cos: Fx, roughness: Fx) -> Fx {
        let row = Self::row(roughness);
        let at = Between::new(cos.sqrt(), SIDE);
        let first = row.low * Ux::splat(SIDE as u32) + at.low;
        let take = |offset: usize| gather(&self.albedo, first + Ux::splat(offset as u32));
        let low = at.mix(take(0), take(1));
        let high = at.mix(take(SIDE), take(SIDE + 1));
        row.mix(low, high).fast_min(Fx::ONE)
    }

    /// What the lobe is multiplied with, in `(0, 1]`.
    #[inline(always)]
    #[must_use]
    pub fn scale(&self, roughness: Fx) -> Fx {
        let row = Self::row(roughness);
        let low = gather(&self.scale, row.low);
        row.mix(low, gather(&self.scale, row.low + Ux::ONE))
    }

    #[inline(always)]
    fn row(roughness: Fx) -> Between {
        let floor = Fx::splat(ROUGHNESS_FLOOR);
        Between::new((roughness - floor) / (Fx::ONE - floor), SIDE)
    }

    fn build() -> Self {
        let mut table = Self {
            albedo: [0.0; SIDE * SIDE],
            scale: [0.0; SIDE],
        };
        let floor = f64::from(ROUGHNESS_FLOOR);
        for row in 0..SIDE {
            let roughness = floor + (1.0 - floor) * row as f64 / (SIDE - 1) as f64;
            let most = (1.0 + MARGIN) * reflected(1e-5, roughness);
            let scale = 1.0 / most.max(1.0);
            table.scale[row] = scale as f32;
            for at in 0..SIDE {
                let t = at as f64 / (SIDE - 1) as f64;
                let albedo = reflected((t * t).max(1e-5), roughness) * scale;
                table.albedo[row * SIDE + at] = (albedo * (1.0 + MARGIN)) as f32;
            }
        }
        table
    }
}

/// `E` of the lobe as published, by the midpoint rule over the azimuth and the root of the cosine.
fn reflected(cos: f64, roughness: f64) -> f64 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let o = Vec3x::splat([sin as f32, 0.0, cos as f32]);
    let roughness = Fx::splat(roughness as f32);
    let mut sum = 0.0;
    for row in 0..FINE {
        let root = (row as f32 + 0.5) / FINE as f32;
        let z = root * root;
        let r = Fx::splat((1.0 - z * z).sqrt());
        for first in (0..FINE).step_by(LANES) {
            let at = to_f32(iota(first as u32)) + Fx::splat(0.5);
            let (y, x) = sin_cos_turn(at / Fx::splat(2.0 * FINE as f32));
            let i = Vec3x::new(x * r, y * r, Fx::splat(z));
            sum += f64::from((charlie(o, i, roughness) * Fx::splat(root)).reduce_add());
        }
    }
    // d omega = 2 root d root dphi.
    sum * 2.0 * std::f64::consts::TAU / (FINE * FINE) as f64
}
