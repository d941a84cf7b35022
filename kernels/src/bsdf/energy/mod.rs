//! What single scattering keeps of the light on a rough surface, as tables, for compensating the
//! rest: [`ReflectionEnergy`] for metals and thin walls, [`TransmissionEnergy`] for dielectrics.
//!
//! Each is built once, at first use, from the kernels' own functions: with visible normals, an albedo
//! is the mean over the unit square of weights that never exceed 1, taken by the midpoint rule. No
//! file, no allocation.
//!
//! For grazing light on narrow lobes an albedo is a function of `o.z / alpha`; the tables'
//! coordinate is `t = sqrt((1 + alpha) o.z / (o.z + alpha))`, in which it is smooth down to the floor
//! of alpha, and `sqrt(alpha)` across. All is linear between entries.

mod reflection;
mod transmission;

pub use reflection::ReflectionEnergy;
pub use transmission::TransmissionEnergy;

use super::ggx::ALPHA_FLOOR;
use crate::lanes::{Fx, LANES, Ux, iota, to_f32, to_u32};

/// Where a number lies between two entries.
#[derive(Clone, Copy)]
struct Between {
    low: Ux,
    part: Fx,
}

impl Between {
    /// `x` in `[0, 1]`, clamped, among `entries` of them.
    #[inline(always)]
    fn new(x: Fx, entries: usize) -> Self {
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
    fn mix(self, a: Fx, b: Fx) -> Fx {
        self.part.mul_add(b - a, a)
    }
}

/// `t` of the table.
#[inline(always)]
fn coordinate(cos: Fx, alpha: Fx) -> Fx {
    ((Fx::ONE + alpha) * cos / (cos + alpha)).sqrt()
}

/// The cosine whose coordinate is `t`.
fn cosine_at(t: f64, alpha: f64) -> f64 {
    alpha * t * t / (1.0 + alpha - t * t)
}

/// `sqrt(alpha)` between the floor and 1.
#[inline(always)]
fn across(alpha: Fx) -> Fx {
    let floor = Fx::splat(ALPHA_FLOOR).sqrt();
    (alpha.sqrt() - floor) / (Fx::ONE - floor)
}

/// `alpha` of row `row` out of `rows`.
fn alpha_of(row: usize, rows: usize) -> f64 {
    let floor = f64::from(ALPHA_FLOOR).sqrt();
    let root = floor + (1.0 - floor) * row as f64 / (rows - 1) as f64;
    root * root
}

/// Mean of `f` over the unit square, by the midpoint rule on `fine` by `fine` points; over half of
/// the first coordinate, about which everything here is even, and denser towards 1 in the second,
/// where visible normals are steep.
fn over_unit_square(fine: usize, f: impl Fn(Fx, Fx) -> Fx) -> f64 {
    let mut sum = 0.0;
    for row in 0..fine {
        let root = (row as f32 + 0.5) / fine as f32;
        let v = Fx::splat(1.0 - root * root);
        for first in (0..fine).step_by(LANES) {
            let at = to_f32(iota(first as u32)) + Fx::splat(0.5);
            let values = f(at / Fx::splat(2.0 * fine as f32), v);
            sum += f64::from(2.0 * root * values.reduce_add());
        }
    }
    sum / (fine * fine) as f64
}
