//! The estimator `1/N sum f(X)/p(X)`, and its sum over two densities.

use super::{Density, Running};

/// `f / p`, one term of an estimate; 0 where `p` is not positive and finite.
///
/// A density is never divided by unless it can be: a point that its own density calls impossible is
/// one that rounding has pushed over an edge, an event of probability about `2^-53`.
#[inline]
#[must_use]
pub fn contribution(f: f64, p: f64) -> f64 {
    if p > 0.0 && p.is_finite() { f / p } else { 0.0 }
}

/// Estimates the integral of `f` from the points that `density` makes of `points`, each a point of
/// the unit cube. The mean of what returns is the estimate, unbiased if `density` is positive
/// wherever `f` is not 0.
///
/// Its standard error and confidence interval hold for independent points; for stratified ones they
/// are too large.
pub fn estimate<const D: usize, P: Density<D>>(
    points: impl IntoIterator<Item = [f64; D]>,
    density: &P,
    f: impl Fn(&P::Point) -> f64,
) -> Running {
    points
        .into_iter()
        .map(|u| {
            let x = density.sample(u);
            contribution(f(&x), density.pdf(&x))
        })
        .collect()
}

/// Estimates the integral of `f` from the points of two densities, weighted by the balance
/// heuristic, so that neither needs to fit `f` everywhere. Returns the two parts: their means add up
/// to the estimate, and the variances of their means to its variance.
///
/// The weight of a point of density `a` is `n_a p_a / (n_a p_a + n_b p_b)`, and the other way round
/// (E. Veach and L. Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering",
/// SIGGRAPH 1995).
pub fn estimate_mis<const D: usize, A: Density<D>, B: Density<D, Point = A::Point>>(
    a: (&A, impl ExactSizeIterator<Item = [f64; D]>),
    b: (&B, impl ExactSizeIterator<Item = [f64; D]>),
    f: impl Fn(&A::Point) -> f64,
) -> [Running; 2] {
    let (n_a, n_b) = (a.1.len() as f64, b.1.len() as f64);
    let part_a = a.1.map(|u| {
        let x = a.0.sample(u);
        let (p, q) = (a.0.pdf(&x), b.0.pdf(&x));
        contribution(balance(n_a * p, n_b * q) * f(&x), p)
    });
    let part_a = part_a.collect();
    let part_b = b.1.map(|u| {
        let x = b.0.sample(u);
        let (p, q) = (b.0.pdf(&x), a.0.pdf(&x));
        contribution(balance(n_b * p, n_a * q) * f(&x), p)
    });
    [part_a, part_b.collect()]
}

/// The balance heuristic: the weight of a technique that finds the point `own` times as densely
/// (number of samples times pdf) where another does so `other` times. In `[0, 1]`; 0 if `own` is 0.
#[must_use]
pub fn balance(own: f64, other: f64) -> f64 {
    if own > 0.0 {
        // As a ratio: neither sum nor square overflows.
        1.0 / (1.0 + other / own)
    } else {
        0.0
    }
}

/// The power heuristic with exponent 2, `own^2 / (own^2 + other^2)`; as [`balance`].
#[must_use]
pub fn power(own: f64, other: f64) -> f64 {
    if own > 0.0 {
        let ratio = other / own;
        1.0 / (1.0 + ratio * ratio)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_divided_by_is_not() {
        assert_eq!(contribution(3.0, 2.0), 1.5);
        for p in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(contribution(3.0, p), 0.0);
        }
    }

    #[test]
    fn weights_of_all_techniques_add_up_to_one() {
        for (a, b) in [(1.0, 1.0), (0.25, 8.0), (1e300, 1e-300), (1e-300, 0.0)] {
            for weight in [balance, power] {
                // Two quotients and a sum, each rounded once.
                assert!((weight(a, b) + weight(b, a) - 1.0).abs() < 4.0 * f64::EPSILON);
            }
        }
        assert_eq!((balance(0.0, 0.0), power(0.0, 1.0)), (0.0, 0.0));
        assert_eq!((balance(1.0, 3.0), power(1.0, 3.0)), (0.25, 0.1));
    }
}
