//! What single scattering keeps of the light on a rough surface, as a table, for compensating the
//! rest.
//!
//! `E(o)` is the albedo for light from `o` of GGX facets that reflect everything:
//! `E = int D G2 / (4 o.z) d omega_i`. It is built once, at first use, from the kernels' own
//! functions: with visible normals, `E` is the mean over the unit square of `G2 / G1(o)` where the
//! reflection is above the horizon, taken by the midpoint rule. No file, no allocation.
//!
//! For grazing light on narrow lobes `E` is a function of `o.z / alpha`; the table's coordinate is
//! `t = sqrt((1 + alpha) o.z / (o.z + alpha))`, in which it is smooth down to the floor, and `sqrt(alpha)`
//! across. Linear interpolation and the quadrature are off by -0.00135 to 0.0008 together (against
//! 256 x 256 points, on a grid between the entries); entries are raised by [`MARGIN`], so that what
//! is made up for is never more than what was lost, and at most 0.0025 less. The mean
//! `E_avg = 2 int E(c) c dc` is that of the interpolated function itself, so that the lobe that
//! compensates carries `1 - E(o)` exactly.

use super::ggx::{ALPHA_FLOOR, Ggx, reflect};
use crate::lanes::{Fx, LANES, Ux, gather, iota, to_f32, to_u32};
use crate::vec3::Vec3x;
use std::sync::LazyLock;

/// Entries along each side.
const SIDE: usize = 32;
/// Points along each side of the unit square for an entry.
const FINE: usize = 64;

/// What entries are raised by: no less than what interpolation and quadrature may lack.
const MARGIN: f64 = 1.5e-3;

/// Directional albedo of reflecting facets, and its mean.
#[derive(Debug)]
pub struct ReflectionEnergy {
    albedo: [f32; SIDE * SIDE],
    mean: [f32; SIDE],
}

static REFLECTION: LazyLock<ReflectionEnergy> = LazyLock::new(ReflectionEnergy::build);

/// Where a number lies between two entries.
#[derive(Clone, Copy)]
pub(super) struct Between {
    pub(super) low: Ux,
    pub(super) part: Fx,
}

impl Between {
    /// `x` in `[0, 1]`, clamped, among `entries` of them.
    #[inline(always)]
    pub(super) fn new(x: Fx, entries: usize) -> Self {
        let last = (entries - 1) as f32;
        let at = (x * Fx::splat(last)).fast_clamp(Fx::ZERO, Fx::splat(last));
        let low = to_u32(at).min(Ux::splat(entries as u32 - 2));
        Self {
            low,
            part: at - to_f32(low),
        }
    }

    /// Between `a` and `b`.
    #[inline(always)]
    pub(super) fn mix(self, a: Fx, b: Fx) -> Fx {
        self.part.mul_add(b - a, a)
    }
}

/// `t` of the table.
#[inline(always)]
pub(super) fn coordinate(cos: Fx, alpha: Fx) -> Fx {
    ((Fx::ONE + alpha) * cos / (cos + alpha)).sqrt()
}

/// The cosine whose coordinate is `t`.
pub(super) fn cosine_at(t: f64, alpha: f64) -> f64 {
    alpha * t * t / (1.0 + alpha - t * t)
}

/// `sqrt(alpha)` between the floor and 1.
#[inline(always)]
pub(super) fn across(alpha: Fx) -> Fx {
    let floor = Fx::splat(ALPHA_FLOOR).sqrt();
    (alpha.sqrt() - floor) / (Fx::ONE - floor)
}

/// `alpha` of row `row` out of `rows`.
pub(super) fn alpha_of(row: usize, rows: usize) -> f64 {
    let floor = f64::from(ALPHA_FLOOR).sqrt();
    let root = floor + (1.0 - floor) * row as f64 / (rows - 1) as f64;
    root * root
}

impl ReflectionEnergy {
    /// The table; built at the first call.
    #[must_use]
    pub fn table() -> &'static Self {
        &REFLECTION
    }

    /// `E(o)` for facets of width `alpha`; `cos` is `o.z`.
    #[inline(always)]
    #[must_use]
    pub fn albedo(&self, cos: Fx, alpha: Fx) -> Fx {
        let row = Between::new(across(alpha), SIDE);
        let at = Between::new(coordinate(cos, alpha), SIDE);
        let first = row.low * Ux::splat(SIDE as u32) + at.low;
        let take = |offset: usize| gather(&self.albedo, first + Ux::splat(offset as u32));
        row.mix(at.mix(take(0), take(1)), at.mix(take(SIDE), take(SIDE + 1)))
    }

    /// `E_avg`.
    #[inline(always)]
    #[must_use]
    pub fn mean(&self, alpha: Fx) -> Fx {
        let row = Between::new(across(alpha), SIDE);
        row.mix(
            gather(&self.mean, row.low),
            gather(&self.mean, row.low + Ux::ONE),
        )
    }

    fn build() -> Self {
        let mut table = Self {
            albedo: [0.0; SIDE * SIDE],
            mean: [0.0; SIDE],
        };
        for row in 0..SIDE {
            let alpha = alpha_of(row, SIDE);
            let facets = Ggx::isotropic(Fx::splat(alpha as f32));
            for at in 0..SIDE {
                let t = at as f64 / (SIDE - 1) as f64;
                let albedo = reflected(facets, cosine_at(t, alpha).max(1e-7));
                table.albedo[row * SIDE + at] = (albedo + MARGIN).min(1.0) as f32;
            }
        }
        for row in 0..SIDE {
            table.mean[row] = table.mean_of(alpha_of(row, SIDE)) as f32;
        }
        table
    }

    /// `2 int E(c) c dc` of the interpolated `E`, by the midpoint rule in `sqrt(c)`, which puts more
    /// points where `E` is steep.
    fn mean_of(&self, alpha: f64) -> f64 {
        const STEPS: usize = 4096;
        let mut sum = 0.0;
        for first in (0..STEPS).step_by(LANES) {
            let x = (to_f32(iota(first as u32)) + Fx::splat(0.5)) / Fx::splat(STEPS as f32);
            let e = self.albedo(x * x, Fx::splat(alpha as f32));
            // c = x^2, so 2 c dc = 4 x^3 dx.
            let part = e * x * x * x * Fx::splat(4.0);
            sum += f64::from(part.reduce_add());
        }
        sum / STEPS as f64
    }
}

/// The mean of `G2 / G1(o)` over visible normals whose reflection is above the horizon.
fn reflected(facets: Ggx, cos: f64) -> f64 {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    let o = Vec3x::splat([sin as f32, 0.0, cos as f32]);
    over_unit_square(|u, v| {
        let i = reflect(o, facets.sample_normal(o, u, v));
        let (lo, li) = (facets.stretched(o), facets.stretched(i));
        let weight = i.z * (o.z + lo) / (o.z * li + i.z * lo);
        i.z.simd_gt(Fx::ZERO) & weight
    })
}

/// Mean of `f` over the unit square, by the midpoint rule; over half of the first coordinate, about
/// which everything here is even.
pub(super) fn over_unit_square(f: impl Fn(Fx, Fx) -> Fx) -> f64 {
    let mut sum = 0.0;
    for row in 0..FINE {
        let root = (row as f32 + 0.5) / FINE as f32;
        let v = Fx::splat(1.0 - root * root);
        let mut across = Fx::ZERO;
        for first in (0..FINE).step_by(LANES) {
            let at = to_f32(iota(first as u32)) + Fx::splat(0.5);
            across += f(at / Fx::splat(2.0 * FINE as f32), v);
        }
        sum += f64::from(2.0 * root * across.reduce_add());
    }
    sum / (FINE * FINE) as f64
}
