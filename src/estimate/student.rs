//! Student's t distribution, for intervals from few values.

use super::normal_quantile;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Beyond this many degrees of freedom the expansion about the normal quantile is used: its first
/// term left out is below `1e-12` of `z` for `|z| < 8`.
const MANY: u64 = 1000;

/// The `t` below which a variable of Student's distribution with `freedom` degrees of freedom lies
/// with probability `p`; infinite at 0 and 1, NaN outside and for no degrees of freedom. Relative
/// error about `1e-12`.
///
/// By bisection of the distribution function, which for a whole number of degrees of freedom is a
/// finite sum of powers of cosines (Abramowitz and Stegun, 26.7.3 and 26.7.4); for more than a
/// thousand of them by the expansion about the normal quantile (ibid., 26.7.5).
#[must_use]
pub fn student_quantile(p: f64, freedom: u64) -> f64 {
    if freedom == 0 || !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    let z = normal_quantile(p);
    if freedom > MANY || z == 0.0 || z.is_infinite() {
        return expansion(z, freedom as f64);
    }
    // The probability of a greater |t|, as the two tails: no cancellation for small p.
    let tails = 2.0 * p.min(1.0 - p);
    // In the angle of which t is sqrt(freedom) times the tangent, everything is bounded.
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..128 {
        let middle = 0.5 * (low + high);
        if outside(middle, freedom) > tails {
            low = middle;
        } else {
            high = middle;
        }
    }
    ((freedom as f64).sqrt() * (0.5 * (low + high)).tan()).copysign(z)
}

/// Probability of `|t| > sqrt(freedom) tan(angle)`.
fn outside(angle: f64, freedom: u64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let (mut term, start) = if freedom % 2 == 1 { (cos, 3) } else { (1.0, 2) };
    let mut sum = 0.0;
    for k in (start..=freedom).step_by(2) {
        sum += term;
        term *= cos * cos * (k - 1) as f64 / k as f64;
    }
    if freedom % 2 == 1 {
        1.0 - FRAC_2_PI * (angle + sin * sum)
    } else {
        1.0 - sin * sum
    }
}

fn expansion(z: f64, n: f64) -> f64 {
    if z.is_infinite() {
        return z;
    }
    let z2 = z * z;
    let g1 = z * (z2 + 1.0) / 4.0;
    let g2 = z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
    let g3 = z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
    let g4 = z * ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) / 92_160.0;
    z + (g1 + (g2 + (g3 + g4 / n) / n) / n) / n
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ContinuousCDF, StudentsT};

    #[test]
    fn quantiles_invert_the_distribution() {
        for freedom in [1, 2, 3, 4, 7, 10, 31, 100, 999, 1000, 1001, 5000, 1_000_000] {
            let law = StudentsT::new(0.0, 1.0, freedom as f64).expect("a distribution");
            for p in [1e-6, 1e-3, 0.025, 0.3, 0.5, 0.7, 0.975, 0.999] {
                let t = student_quantile(p, freedom);
                // The other implementation is good for about ten digits.
                let there = law.cdf(t);
                assert!(
                    (there / p - 1.0).abs() < 1e-8,
                    "{freedom}, {p}: {t}, {there}"
                );
            }
        }
    }

    #[test]
    fn one_and_two_degrees_of_freedom_have_closed_forms() {
        for p in [0.01, 0.2, 0.6, 0.99] {
            let cauchy = (std::f64::consts::PI * (p - 0.5)).tan();
            let two = (2.0 * p - 1.0) / (2.0 * p * (1.0 - p)).sqrt();
            for (t, exact) in [
                (student_quantile(p, 1), cauchy),
                (student_quantile(p, 2), two),
            ] {
                // The distribution function loses an absolute 2^-52 or so, twice amplified.
                assert!((t / exact - 1.0).abs() < 1e-12, "{p}: {t} for {exact}");
            }
        }
    }

    #[test]
    fn ends_and_what_is_no_probability() {
        assert_eq!(student_quantile(0.5, 3), 0.0);
        assert_eq!(student_quantile(1.0, 3), f64::INFINITY);
        assert_eq!(student_quantile(0.0, 5000), f64::NEG_INFINITY);
        assert!(student_quantile(-0.1, 3).is_nan() && student_quantile(0.1, 0).is_nan());
    }
}
