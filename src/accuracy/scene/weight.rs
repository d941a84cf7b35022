//! What makes squared errors relative to a brightness that is itself known with noise.

/// `g(b) = 1 / (b^2 + floor)`: what makes squared errors of a value relative.
pub(super) fn over(b: f64, floor: f64) -> f64 {
    1.0 / (b * b + floor)
}

/// `g` at the expectation of a value that was measured with `variance`: that of `g(b)` is larger by
/// `g'' variance / 2 = g c`, with `c = (3 b^2 - floor) g^2 variance`, to second order. Without that, an
/// image would look worse the noisier its reference is.
pub(super) fn weight(b: f64, variance: f64, floor: f64) -> f64 {
    let g = over(b, floor);
    let c = (3.0 * b * b - floor) * g * g * variance;
    // 1 - c, but never below 0.
    if c > 0.0 {
        g / (1.0 + c)
    } else {
        g * (1.0 - c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of `of` over values about `b`, normal with deviation `sigma`: by the trapezium rule, whose
    /// error falls faster than any power of the step.
    fn expected(b: f64, sigma: f64, of: impl Fn(f64) -> f64) -> f64 {
        let step = 0.01;
        let at = |k: i32| f64::from(k) * step;
        let density = |z: f64| (-0.5 * z * z).exp();
        let all = (-800..=800).map(at);
        let sum: f64 = all.clone().map(|z| density(z) * of(b + sigma * z)).sum();
        sum / all.map(density).sum::<f64>()
    }

    /// What noise adds to the weight falls with its variance, and with the square of that once it is taken
    /// out.
    #[test]
    fn noise_of_a_reference_is_no_weight() {
        let floor = 0.01;
        for (b, sigma) in [(1.0, 0.1), (0.5, 0.05), (0.3, 0.03), (0.0, 0.02)] {
            let off =
                |of: &dyn Fn(f64) -> f64, sigma| expected(b, sigma, of) / over(b, floor) - 1.0;
            let plain = |sigma: f64| off(&|b| over(b, floor), sigma);
            let mended = |sigma: f64| off(&|b| weight(b, sigma * sigma, floor), sigma);
            // By 4 and 16, but for terms of higher orders.
            let falls = [
                plain(sigma) / plain(0.5 * sigma),
                mended(sigma) / mended(0.5 * sigma),
            ];
            assert!(
                (3.5..4.5).contains(&falls[0]) && (12.0..20.0).contains(&falls[1]),
                "{b} +- {sigma}: {falls:?}"
            );
            assert!(
                mended(sigma).abs() < 0.1 * plain(sigma).abs(),
                "{b} +- {sigma}"
            );
        }
    }
}
