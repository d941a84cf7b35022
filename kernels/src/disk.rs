//! Points on the unit disk.
//!
//! The concentric map of P. Shirley and K. Chiu, "A Low Distortion Map Between Disk and Square",
//! Journal of Graphics Tools 2(3), 1997: squares about the middle become circles, so that points
//! that are spread evenly over the square stay so on the disk. With `a = 2 u - 1`, `b = 2 v - 1` and
//! the larger of the two in magnitude first, `(r, phi) = (a, pi/4 b/a)` or
//! `(b, pi/2 - pi/4 a/b)`.
//!
//! Input: `u`, `v` in `[0, 1]`. Output: `x`, `y` with `x^2 + y^2 <= 1` to rounding. Pdf: `1 / pi`
//! in area.

use crate::lanes::Fx;
use crate::math::sin_cos_turn;

/// Uniform over the disk of radius 1 about the origin.
#[inline(always)]
#[must_use]
pub fn sample_concentric(u: Fx, v: Fx) -> [Fx; 2] {
    let (a, b) = (u + u - Fx::ONE, v + v - Fx::ONE);
    let (size_a, size_b) = (a.abs(), b.abs());
    let across = size_a.simd_gt(size_b);
    let radius = size_a.fast_max(size_b);
    let small = size_a.fast_min(size_b);
    // In the middle both are 0, and so must be their ratio. Elsewhere the radius is at least 2^-23
    // (for u and v on the samplers' grid), which this bound leaves alone.
    let ratio = small / radius.fast_max(Fx::splat(f32::MIN_POSITIVE));
    // The angle from the larger one's axis, 0 to 45 degrees: an eighth of a turn. Signs come last,
    // since `sin_cos_turn` takes no negative angle.
    let (sin, cos) = sin_cos_turn(ratio * Fx::splat(0.125));
    let (near, far) = (radius * cos, radius * sin);
    let signed = |size: Fx, like: Fx| size | (like & Fx::splat(-0.0));
    [
        signed(across.select(near, far), a),
        signed(across.select(far, near), b),
    ]
}
