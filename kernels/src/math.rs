//! Elementary functions on a path to a pixel.
//!
//! The platform's libm differs between machines, so none of it is used: what is here is made of
//! IEEE operations in a fixed order.

use crate::lanes::{Fx, as_mask, to_f32, to_u32};
use wide::u32x8 as Ux;

/// pi, rounded to f32.
pub const PI: f32 = std::f32::consts::PI;
/// 1 / pi, rounded to f32.
pub const INV_PI: f32 = std::f32::consts::FRAC_1_PI;

/// `(sin, cos)` of `2 pi u` for `u` in `[0, 1]`, each within 1.2e-7 of the true value (tested
/// against f64 over every 2^-20th of the domain).
///
/// The turn is cut into quarters exactly (multiplication by four and subtraction of an integer do
/// not round there), which leaves Taylor polynomials of degree 9 and 10 on `[-pi/4, pi/4]`, whose
/// remainder is below 2e-9.
#[inline(always)]
#[must_use]
pub fn sin_cos_turn(u: Fx) -> (Fx, Fx) {
    let quarters = u * Fx::splat(4.0);
    let nearest = to_u32(quarters + Fx::splat(0.5));
    let x = (quarters - to_f32(nearest)) * Fx::splat(std::f32::consts::FRAC_PI_2);
    let x2 = x * x;
    let sin = Fx::splat(2.755_731_9e-6)
        .mul_add(x2, Fx::splat(-1.984_126_98e-4))
        .mul_add(x2, Fx::splat(8.333_333_33e-3))
        .mul_add(x2, Fx::splat(-1.666_666_67e-1))
        .mul_add(x2 * x, x);
    let cos = Fx::splat(-2.755_731_92e-7)
        .mul_add(x2, Fx::splat(2.480_158_73e-5))
        .mul_add(x2, Fx::splat(-1.388_888_89e-3))
        .mul_add(x2, Fx::splat(4.166_666_67e-2))
        .mul_add(x2, Fx::splat(-0.5))
        .mul_add(x2, Fx::ONE);
    // Quarter q turns (sin, cos) to (cos, -sin), (-sin, -cos), (-cos, sin).
    let one = Ux::splat(1);
    let odd = as_mask((nearest & one).simd_eq(one));
    let (s, c) = (odd.select(cos, sin), odd.select(sin, cos));
    let sign = |bits: Ux| -> Fx { bytemuck::cast((bits & Ux::splat(2)) << 30) };
    (s ^ sign(nearest), c ^ sign(nearest + one))
}

/// Arc cosine of `x` in `[0, 1]`, within 3e-7 of the true value (tested against f64 over every
/// 2^-20th of the domain): `sqrt(1 - x)` times a polynomial (M. Abramowitz, I. Stegun, *Handbook of
/// Mathematical Functions*, 4.4.46, whose own error is below 2e-8).
#[inline(always)]
#[must_use]
pub fn acos_unit(x: Fx) -> Fx {
    let p = Fx::splat(-0.001_262_491_1)
        .mul_add(x, Fx::splat(0.006_670_090_1))
        .mul_add(x, Fx::splat(-0.017_088_125_6))
        .mul_add(x, Fx::splat(0.030_891_881_0))
        .mul_add(x, Fx::splat(-0.050_174_304_6))
        .mul_add(x, Fx::splat(0.088_978_987_4))
        .mul_add(x, Fx::splat(-0.214_598_801_6))
        .mul_add(x, Fx::splat(1.570_796_305_0));
    (Fx::ONE - x).sqrt() * p
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;

    #[test]
    fn acos_unit_is_within_its_bound() {
        let steps = 1u32 << 20;
        for i in (0..=steps).step_by(LANES) {
            let x: [f32; LANES] =
                std::array::from_fn(|l| (i + l as u32).min(steps) as f32 / steps as f32);
            let a = acos_unit(Fx::new(x));
            for l in 0..LANES {
                let off = (f64::from(a.as_array()[l]) - f64::from(x[l]).acos()).abs();
                assert!(off < 3e-7, "acos at {} is off by {off}", x[l]);
            }
        }
    }

    #[test]
    fn sin_cos_turn_is_within_its_bound() {
        let steps = 1u32 << 20;
        for i in (0..=steps).step_by(LANES) {
            let u: [f32; LANES] =
                std::array::from_fn(|l| (i + l as u32).min(steps) as f32 / steps as f32);
            let (s, c) = sin_cos_turn(Fx::new(u));
            for l in 0..LANES {
                let (ts, tc) = (f64::from(u[l]) * std::f64::consts::TAU).sin_cos();
                assert!(
                    (f64::from(s.as_array()[l]) - ts).abs() < 1.2e-7,
                    "sin at {}",
                    u[l]
                );
                assert!(
                    (f64::from(c.as_array()[l]) - tc).abs() < 1.2e-7,
                    "cos at {}",
                    u[l]
                );
            }
        }
    }
}
