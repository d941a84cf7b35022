//! The albedo of facets that reflect everything: `E(o) = int D G2 / (4 o.z) d omega_i`.
//!
//! Linear interpolation and the quadrature are off by -0.00135 to 0.0008 together (against 256 x 256
//! points, on a grid between the entries); `E` is raised by [`MARGIN`], so that what is made up
//! for is never more than what was lost, and at most 0.0025 less. The mean
//! `E_avg = 2 int E(c) c dc` is that of the interpolated function itself, so that the lobe that
//! compensates carries `1 - E(o)`: exactly at the table's widths, within 1e-4 between them.

use super::{Between, across, alpha_of, coordinate, cosine_at, over_unit_square};
use crate::bsdf::ggx::{Ggx, reflect};
use crate::lanes::{Fx, LANES, Ux, gather, iota, to_f32};
use crate::vec3::Vec3x;
use std::sync::LazyLock;

/// Entries along each side.
const SIDE: usize = 32;
/// Points along each side of the unit square for an entry.
const FINE: usize = 64;

/// What `E` is raised by: no less than what interpolation and quadrature may lack. Entries may so
/// come out above 1; what is looked up does not.
const MARGIN: f64 = 1.5e-3;

/// What reflecting facets lose, from a direction and on average.
#[derive(Debug)]
pub struct ReflectionEnergy {
    lost: [f32; SIDE * SIDE],
    mean_lost: [f32; SIDE],
}

static REFLECTION: LazyLock<ReflectionEnergy> = LazyLock::new(ReflectionEnergy::build);

impl ReflectionEnergy {
    /// The table; built at the first call.
    #[must_use]
    pub fn table() -> &'static Self {
        &REFLECTION
    }

    /// `1 - E(o)` for facets of width `alpha`; `cos` is `o.z`.
    #[inline(always)]
    #[must_use]
    pub fn lost(&self, cos: Fx, alpha: Fx) -> Fx {
        let row = Between::new(across(alpha), SIDE);
        let at = Between::new(coordinate(cos, alpha), SIDE);
        let first = row.low * Ux::splat(SIDE as u32) + at.low;
        let take = |offset: usize| gather(&self.lost, first + Ux::splat(offset as u32));
        let low = at.mix(take(0), take(1));
        let high = at.mix(take(SIDE), take(SIDE + 1));
        row.mix(low, high).fast_max(Fx::ZERO)
    }

    /// `1 - E_avg`.
    #[inline(always)]
    #[must_use]
    pub fn mean_lost(&self, alpha: Fx) -> Fx {
        let row = Between::new(across(alpha), SIDE);
        let low = gather(&self.mean_lost, row.low);
        row.mix(low, gather(&self.mean_lost, row.low + Ux::ONE))
    }

    fn build() -> Self {
        let mut table = Self {
            lost: [0.0; SIDE * SIDE],
            mean_lost: [0.0; SIDE],
        };
        for row in 0..SIDE {
            let alpha = alpha_of(row, SIDE);
            let facets = Ggx::isotropic(Fx::splat(alpha as f32));
            for at in 0..SIDE {
                let t = at as f64 / (SIDE - 1) as f64;
                let albedo = reflected(facets, cosine_at(t, alpha).max(1e-7));
                table.lost[row * SIDE + at] = (1.0 - albedo - MARGIN) as f32;
            }
        }
        for row in 0..SIDE {
            table.mean_lost[row] = table.mean_of(alpha_of(row, SIDE)) as f32;
        }
        table
    }

    /// `2 int (1 - E(c)) c dc` of the interpolated `E`, by the midpoint rule in `sqrt(c)`, which puts more
    /// points where `E` is steep.
    fn mean_of(&self, alpha: f64) -> f64 {
        const STEPS: usize = 4096;
        let mut sum = 0.0;
        for first in (0..STEPS).step_by(LANES) {
            let x = (to_f32(iota(first as u32)) + Fx::splat(0.5)) / Fx::splat(STEPS as f32);
            let lost = self.lost(x * x, Fx::splat(alpha as f32));
            // c = x^2, so 2 c dc = 4 x^3 dx.
            let part = lost * x * x * x * Fx::splat(4.0);
            sum += f64::from(part.reduce_add());
        }
        sum / STEPS as f64
    }
}

/// The mean of `G2 / G1(o)` over visible normals whose reflection is above the horizon.
fn reflected(facets: Ggx, cos: f64) -> f64 {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    let o = Vec3x::splat([sin as f32, 0.0, cos as f32]);
    over_unit_square(FINE, |u, v| {
        let i = reflect(o, facets.sample_normal(o, u, v));
        i.z.simd_gt(Fx::ZERO) & facets.shadowing(o, i)
    })
}
