//! Are two pictures the same but for noise?
//!
//! Two questions are asked, each at a significance that is stated: does any one pixel differ more
//! than the most extreme of so many normal variables should, and does the mean over all pixels
//! differ? The first finds a wrong spot, the second a small error everywhere.
//!
//! A mean of skewed samples is not quite normal when it is divided by its own estimated error: its
//! tail at z is off by a factor of about `1 + skewness z^3 / (3 sqrt n)` (the first term of
//! Edgeworth's expansion). Renders here take enough samples to keep that below a factor of ten, so
//! a significance of 1e-4 stays below 1e-3. All renders have fixed seeds: a test that has passed
//! goes on passing until somebody changes what is computed.

use super::picture::Picture;
use huygens::estimate::{Running, normal_quantile, sidak};

/// Chance that a comparison of two right pictures fails.
pub(crate) const SIGNIFICANCE: f64 = 1e-4;

/// What f32 arithmetic may bend a value: a path multiplies some ten factors of some ten roundings
/// (2^-24) each. Far below any standard error met here, but a pixel without noise has none.
pub(crate) const ROUNDING: f64 = 128.0 / 16_777_216.0;

/// Largest `|z|` of `tests` normal variables, at the given significance.
pub(crate) fn threshold(significance: f64, tests: usize) -> f64 {
    -normal_quantile(0.5 * sidak(significance, tests))
}

/// Distance of two means in standard errors, after what rounding may account for; infinite where
/// any of the numbers is not one.
pub(crate) fn z_score(a: f64, b: f64, variance: f64) -> f64 {
    let beyond = (a - b).abs() - ROUNDING * a.abs().max(b.abs());
    if !(beyond.is_finite() && variance.is_finite()) {
        f64::INFINITY
    } else if beyond <= 0.0 {
        0.0
    } else {
        beyond / variance.sqrt()
    }
}

/// Fails with a description if the pictures' expectations differ.
pub(crate) fn same(a: &Picture, b: &Picture, significance: f64) -> Result<(), String> {
    assert_eq!(
        (a.width, a.height),
        (b.width, b.height),
        "pictures of one size"
    );
    let pixels = a.mean.len();
    let limit = threshold(0.5 * significance, 3 * pixels);
    for i in 0..pixels {
        for c in 0..3 {
            let (ma, mb) = (a.mean[i][c], b.mean[i][c]);
            let z = z_score(ma, mb, a.variance[i][c] + b.variance[i][c]);
            if z > limit {
                let (x, y) = (i % a.width, i / a.width);
                return Err(format!(
                    "pixel ({x}, {y}), channel {c}: {ma} and {mb} are {z:.2} standard errors apart, \
                     the limit is {limit:.2}"
                ));
            }
        }
    }
    let limit = threshold(0.5 * significance, 3);
    for c in 0..3 {
        let ([ma, va], [mb, vb]) = (a.overall(c), b.overall(c));
        let z = z_score(ma, mb, va + vb);
        if z > limit {
            return Err(format!(
                "mean of channel {c}: {ma} and {mb} are {z:.2} standard errors apart, the limit is \
                 {limit:.2}"
            ));
        }
    }
    Ok(())
}

/// Asserts that `running` has the expectation `expected`, to within its confidence interval at
/// the level `1 - SIGNIFICANCE / tests` for `tests` such assertions together.
pub(crate) fn assert_mean(what: &str, running: &Running, expected: f64, tests: usize) {
    let error = running.standard_error().expect("two values at least");
    let z = z_score(running.mean(), expected, error * error);
    let limit = threshold(SIGNIFICANCE, tests);
    assert!(
        z <= limit,
        "{what}: {} +- {error} is {z:.2} standard errors from {expected}, the limit is {limit:.2}",
        running.mean()
    );
}

#[test]
fn z_scores_of_what_is_no_number_are_infinite() {
    assert_eq!(z_score(1.0, 1.0, 0.0), 0.0);
    assert_eq!(z_score(1.0, 2.0, 0.0), f64::INFINITY);
    assert_eq!(z_score(f64::NAN, 1.0, 1.0), f64::INFINITY);
    assert_eq!(z_score(1.0, 1.0, f64::NAN), f64::INFINITY);
    assert_eq!(z_score(1.0, 1.0, f64::INFINITY), f64::INFINITY);
}
