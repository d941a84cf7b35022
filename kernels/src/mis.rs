//! Multiple importance sampling: the power heuristic with exponent 2 (E. Veach, L. Guibas,
//! "Optimally Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995).

use crate::lanes::Fx;

/// Weight of a sample drawn with pdf `a` where another technique would have drawn it with pdf `b`:
/// `a^2 / (a^2 + b^2)`, in the form `1 / (1 + (b/a)^2)`, which neither overflows to NaN nor
/// underflows: where `(b/a)^2` overflows the weight is 0, as it should be.
///
/// Domain: `a > 0`, `b >= 0`, same measure. Range: `[0, 1]`.
#[inline(always)]
#[must_use]
pub fn power_heuristic(a: Fx, b: Fx) -> Fx {
    let ratio = b / a;
    Fx::ONE / ratio.mul_add(ratio, Fx::ONE)
}
