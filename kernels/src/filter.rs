//! Filter importance sampling in one dimension: a position drawn from a pixel filter.
//!
//! M. Ernst, M. Stamminger, G. Greiner, "Filter Importance Sampling", RT 2006. Separable filters
//! are drawn from once across and once down.
//!
//! The filter comes as a table of its inverse distribution over the square root of the tail: for a
//! filter `f >= 0`, symmetric about 0 and of integral 1, `table[k]` is the `x >= 0` with
//! `2 * integral of f from x on = (k / last)^2`. So `table[0]` is the filter's radius, `table[last]`
//! is 0. The root is there because filters fall to zero at their edge, where `x` over `u` itself is
//! infinitely steep and cannot be interpolated; over the root a tent is a straight line, and within
//! a cell of the table any filter becomes a linear density.
//!
//! Input: `u` in `[0, 1]`. Output: a position relative to the pixel's centre, in pixels, within the
//! filter's radius, growing with `u`, odd about `u = 1/2`. Pdf: the filter, in pixels^-1. Reads 12
//! bytes and writes 4 an item.

use crate::lanes::{Fx, Ux, gather, to_f32, to_u32};

/// Draws from the filter whose inverse distribution is `table` (see the head of this file), by
/// linear interpolation between its two or more knots.
#[inline(always)]
#[must_use]
pub fn sample(table: &[f32], u: Fx) -> Fx {
    let last = (table.len() - 1) as u32;
    // Exact for every multiple of 2^-24, so both sides of the filter come from the same numbers.
    let rest = Fx::ONE - u;
    let tail = u.fast_min(rest);
    let at = (tail + tail).sqrt() * Fx::splat(last as f32);
    // At u = 1/2 this is the last knot itself: the last interval ends there too.
    let knot = to_u32(at).min(Ux::splat(last - 1));
    let (outer, inner) = (gather(table, knot), gather(table, knot + Ux::splat(1)));
    let x = (at - to_f32(knot)).mul_add(inner - outer, outer);
    u.simd_lt(rest).select(-x, x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;

    /// The tent of radius 1, for which interpolation is exact: `x = 1 - sqrt(2 u)` in the tail.
    const TENT: [f32; 3] = [1.0, 0.5, 0.0];

    #[test]
    fn a_tent_is_inverted_to_rounding() {
        // Three operations of at most one rounding each on numbers up to 2 (the table's index).
        let bound = 3.0 * f64::from(f32::EPSILON);
        for start in (0..=1u32 << 24).step_by(4093 * LANES) {
            let u: [f32; LANES] = std::array::from_fn(|l| {
                (start + 4093 * l as u32).min((1 << 24) - 1) as f32 / 16_777_216.0
            });
            let x = sample(&TENT, Fx::new(u)).to_array();
            for (u, x) in u.map(f64::from).into_iter().zip(x) {
                let expected = if u < 0.5 {
                    (2.0 * u).sqrt() - 1.0
                } else {
                    1.0 - (2.0 - 2.0 * u).sqrt()
                };
                assert!((f64::from(x) - expected).abs() <= bound, "{x} at {u}");
            }
        }
    }

    #[test]
    fn the_ends_are_the_radius_and_the_middle_is_zero() {
        let near_one = 1.0 - f32::EPSILON / 2.0;
        let u = Fx::new([0.0, 0.5, 1.0, near_one, 0.125, 0.875, 0.5, 0.5]);
        let x = sample(&TENT, u).to_array();
        assert_eq!(x[..3], [-1.0, 0.0, 1.0]);
        assert!(x[3] < 1.0 && x[3] > 0.999);
        assert_eq!(x[4..6], [-0.5, 0.5]);
    }
}
