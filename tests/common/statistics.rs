//! Are two pictures the same but for noise?
//!
//! Two questions are asked, each at a significance that is stated: does any one pixel differ more
//! than the most extreme of so many normal variables should, and does the mean over all pixels
//! differ? The first finds a wrong spot, the second a small error everywhere.
//!
//! A mean of samples that are mostly dark and rarely bright is not normal, even of thousands. Where
//! the skewness is known (the reference measures it) it is taken out; elsewhere the renders take
//! samples that are not much skewed, of which there are thousands.
//!
//! All renders have fixed seeds: a test that has passed goes on passing until somebody changes what
//! is computed.

use super::picture::{Mean, Picture};
use huygens::estimate::{normal_quantile, sidak};

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
    z_score_beyond(ROUNDING, a, b, variance)
}

/// The same after a relative difference that is allowed.
fn z_score_beyond(allowed: f64, a: f64, b: f64, variance: f64) -> f64 {
    let beyond = (a - b).abs() - allowed * a.abs().max(b.abs());
    if !(beyond.is_finite() && variance.is_finite()) {
        f64::INFINITY
    } else if beyond <= 0.0 {
        0.0
    } else {
        beyond / variance.sqrt()
    }
}

/// A variable of mean 0, variance 1 and the given skewness, brought to a normal one: the cube root
/// of E. Wilson and M. Hilferty ("The Distribution of Chi-Square", PNAS 17, 1931), which makes gamma
/// variables normal, whose skewness `s` their shape `4 / s^2` sets.
fn without_skewness(z: f64, skewness: f64) -> f64 {
    // Below this the correction is under 0.01 at any z met here.
    if skewness.abs() < 1e-3 {
        return z;
    }
    let root = (1.0 + 0.5 * skewness * z).max(0.0).cbrt();
    6.0 / skewness * (root - 1.0) + skewness / 6.0
}

/// Signed distance of pixel `i`'s channel `c` in the two pictures, as a normal variable.
fn pixel_score(allowed: f64, a: &Picture, b: &Picture, i: usize, c: usize) -> f64 {
    let [va, vb] = [a.variance[i][c], b.variance[i][c]];
    let z = z_score_beyond(allowed, a.mean[i][c], b.mean[i][c], va + vb)
        .copysign(a.mean[i][c] - b.mean[i][c]);
    // Third cumulants add up, the second picture's with its sign changed.
    let third = a.skewness[i][c] * va.powf(1.5) - b.skewness[i][c] * vb.powf(1.5);
    if third == 0.0 {
        z
    } else {
        without_skewness(z, third / (va + vb).powf(1.5))
    }
}

/// Fails with a description if the pictures' expectations differ.
pub(crate) fn same(a: &Picture, b: &Picture, significance: f64) -> Result<(), String> {
    same_but_for(ROUNDING, a, b, significance)
}

/// Fails with a description if the pictures' expectations differ by more than a part `allowed` of them.
pub(crate) fn same_but_for(
    allowed: f64,
    a: &Picture,
    b: &Picture,
    significance: f64,
) -> Result<(), String> {
    assert_eq!(
        (a.width, a.height),
        (b.width, b.height),
        "pictures of one size"
    );
    let pixels = a.mean.len();
    let limit = threshold(0.5 * significance, 3 * pixels);
    for i in 0..pixels {
        for c in 0..3 {
            let z = pixel_score(allowed, a, b, i, c);
            if z.is_nan() || z.abs() > limit {
                let (x, y) = (i % a.width, i / a.width);
                return Err(format!(
                    "pixel ({x}, {y}), channel {c}: {} and {} are {z:.2} standard errors apart, \
                     the limit is {limit:.2}",
                    a.mean[i][c], b.mean[i][c]
                ));
            }
        }
    }
    let limit = threshold(0.5 * significance, 3);
    for c in 0..3 {
        let (a, b) = (a.overall(c), b.overall(c));
        let z = z_score_beyond(allowed, a.value, b.value, a.variance + b.variance);
        if z > limit {
            return Err(format!(
                "mean of channel {c}: {} and {} are {z:.2} standard errors apart, the limit is \
                 {limit:.2}",
                a.value, b.value
            ));
        }
    }
    Ok(())
}

/// Asserts that the expectation of `mean` is `expected`, at [`SIGNIFICANCE`] for `tests` such
/// assertions together.
pub(crate) fn assert_mean(what: &str, mean: Mean, expected: f64, tests: usize) {
    let Mean { value, variance } = mean;
    let z = z_score(value, expected, variance);
    let limit = threshold(SIGNIFICANCE, tests);
    assert!(
        z <= limit,
        "{what}: {value} +- {} is {z:.2} standard errors from {expected}, the limit is {limit:.2}",
        variance.sqrt()
    );
}

#[test]
fn z_scores_of_what_is_no_number_are_infinite() {
    assert_eq!(z_score(1.0, 1.0, 0.0), 0.0);
    assert_eq!(z_score(1.0, 2.0, 0.0), f64::INFINITY);
    assert_eq!(z_score(1.0, 2.0, 0.25), 2.0 * (1.0 - 2.0 * ROUNDING));
    assert_eq!(z_score(f64::NAN, 1.0, 1.0), f64::INFINITY);
    assert_eq!(z_score(1.0, 1.0, f64::NAN), f64::INFINITY);
    assert_eq!(z_score(1.0, 1.0, f64::INFINITY), f64::INFINITY);
}

/// Counts of rare events, the mean of which is as skewed as a dim pixel's.
#[test]
fn skewness_is_taken_out_of_poisson_counts() {
    use statrs::distribution::{DiscreteCDF, Poisson};
    for mean in [16.0, 100.0, 1000.0] {
        let counts = Poisson::new(mean).expect("positive");
        for p in [1e-8, 1e-4, 0.5, 1.0 - 1e-4, 1.0 - 1e-8] {
            // The count between which and the next the distribution passes p.
            let count = (0..4000).find(|&k| counts.cdf(k) >= p).expect("below 4000");
            let standard = |k: f64| without_skewness((k - mean) / mean.sqrt(), 1.0 / mean.sqrt());
            // A Poisson variable is no gamma variable: its tails agree to a few tenths of z, where
            // the plain z is off by more than 1.
            let z = normal_quantile(p);
            let [low, high] = [-1.0, 1.0].map(|half| standard(count as f64 + half));
            assert!(
                low - 0.3 < z && z < high + 0.3,
                "{mean}, {p}: {low}..{high} for {z}"
            );
        }
    }
}
