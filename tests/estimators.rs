//! Expectation and variance of estimators, against identities and closed forms.
//!
//! Every assertion is a test at a stated significance with a fixed seed: it goes on passing until
//! somebody changes what is computed.

mod common;

use common::statistics::threshold;
use huygens::accuracy::{Ladder, Target, study};
use huygens::estimate::{
    Density, Inversion, Lorentz, Power, Running, UniformBox, estimate, estimate_mis, generator,
    points,
};
use statrs::distribution::{Binomial, Discrete};
use std::f64::consts::PI;

/// Chance that a test here fails although all is right, shared out over its comparisons.
const SIGNIFICANCE: f64 = 1e-4;

/// Asserts that the expectation of the values is `expected`.
fn expect(what: &str, values: &Running, expected: f64, comparisons: usize) {
    let error = values.standard_error().expect("two values at least");
    let z = (values.mean() - expected) / error;
    let limit = threshold(SIGNIFICANCE, comparisons);
    assert!(
        z.abs() <= limit,
        "{what}: {} +- {error} is {z:.2} standard errors from {expected}, the limit is {limit:.2}",
        values.mean()
    );
}

fn uniform_points<const D: usize>(seed: u64, n: usize) -> impl Iterator<Item = [f64; D]> {
    let mut rng = generator(&[seed]);
    let points: Vec<_> = points::independent(&mut rng, n).collect();
    points.into_iter()
}

#[test]
fn expectation_is_linear_and_variance_is_what_it_is_of_sums() {
    // Sample means and variances obey these exactly, but for rounding: some ten roundings of each
    // of the values, which are of order 10.
    let n = 1000;
    let bound = 1e2 * 10.0 * n as f64 * f64::EPSILON;
    let pairs: Vec<[f64; 2]> = uniform_points(1, n)
        .map(|[u, v]| [u * u, 3.0 - v])
        .collect();
    let of = |f: &dyn Fn(&[f64; 2]) -> f64| pairs.iter().map(f).collect::<Running>();
    let variance = |r: &Running| r.variance().expect("values");
    let (x, y) = (of(&|p| p[0]), of(&|p| p[1]));
    let (a, b) = (2.0, -5.0);

    // E[aX + bY] = a E[X] + b E[Y]
    let sum = of(&|p| a * p[0] + b * p[1]);
    assert!((sum.mean() - (a * x.mean() + b * y.mean())).abs() < bound);
    // V[aX + b] = a^2 V[X]
    let affine = of(&|p| a * p[0] + b);
    assert!((variance(&affine) - a * a * variance(&x)).abs() < bound);
    // V[X] = E[X^2] - E[X]^2, times n/(n - 1) for the unbiased one
    let square = of(&|p| p[0] * p[0]);
    let biased = square.mean() - x.mean().powi(2);
    assert!((variance(&x) - biased * n as f64 / (n as f64 - 1.0)).abs() < bound);
    // V[X + Y] = V[X] + V[Y] + 2 cov[X, Y]
    let covariance = of(&|p| (p[0] - x.mean()) * (p[1] - y.mean()));
    let covariance = covariance.mean() * n as f64 / (n as f64 - 1.0);
    let total = of(&|p| p[0] + p[1]);
    assert!((variance(&total) - variance(&x) - variance(&y) - 2.0 * covariance).abs() < bound);
    // Independent: the covariance is 0 but for chance, with standard deviation sqrt(V V / n).
    let z = covariance / (variance(&x) * variance(&y) / n as f64).sqrt();
    assert!(z.abs() < threshold(SIGNIFICANCE, 1), "{z}");
}

/// `E[f(X)] = integral of f p`, and `E[(X - mu)^2]` is what the density says.
#[test]
fn moments_of_the_densities() {
    let n = 100_000;
    let power = Power::new(2.0, 3.0);
    let exponential = Inversion {
        inverse_cdf: |u: f64| -(-u).ln_1p(),
        pdf: |x: f64| (-x).exp(),
    };
    let lorentz = Lorentz::new(0.25, 0.1, -1.0, 1.0);
    // E[x] of the peak: centre plus half a logarithm over the angle.
    let [a, b] = [-12.5f64, 7.5];
    let lorentz_mean =
        0.25 + 0.1 * 0.5 * ((1.0 + b * b) / (1.0 + a * a)).ln() / (b.atan() - a.atan());
    let mean = |density: &dyn Density<1, Point = f64>, power: i32| -> Running {
        uniform_points(2, n)
            .map(|u| density.sample(u).powi(power))
            .collect()
    };
    // x^2 on 0..3: E[x^k] = 3 3^k / (3 + k).
    expect("power, x", &mean(&power, 1), 9.0 / 4.0, 5);
    expect("power, x^2", &mean(&power, 2), 27.0 / 5.0, 5);
    // k! for the exponential.
    expect("exponential, x", &mean(&exponential, 1), 1.0, 5);
    expect("exponential, x^2", &mean(&exponential, 2), 2.0, 5);
    expect("lorentz, x", &mean(&lorentz, 1), lorentz_mean, 5);
}

/// A density proportional to the integrand leaves no variance: every term is the answer.
#[test]
fn the_perfect_density_has_no_variance() {
    let quadratic = Power::new(2.0, 2.0);
    let exact = 8.0 / 3.0;
    for value in uniform_points(3, 1000).map(|u| {
        let x = quadratic.sample(u);
        x * x / quadratic.pdf(&x)
    }) {
        // A power, some products and a quotient: some ten roundings.
        assert!((value / exact - 1.0).abs() < 16.0 * f64::EPSILON, "{value}");
    }
}

/// The interval of a mean of darts covers pi as often as its level says, up to what counts do to it:
/// the hits are binomial, so how often the interval covers can be summed up exactly.
#[test]
fn confidence_intervals_cover() {
    let square = UniformBox::<2>::unit();
    let hit = |p: &[f64; 2]| 4.0 * f64::from(u8::from(p[0] * p[0] + p[1] * p[1] < 1.0));
    let (level, trials, n) = (0.95, 2000, 1024);
    let covers = |values: &Running| {
        let [low, high] = values.confidence_interval(level).expect("many");
        low <= PI && PI <= high
    };
    let hits = Binomial::new(PI / 4.0, n).expect("a distribution");
    let counted = (0..=n).filter(|&k| {
        let hits = std::iter::repeat_n(4.0, k as usize);
        covers(
            &hits
                .chain(std::iter::repeat_n(0.0, (n - k) as usize))
                .collect(),
        )
    });
    let expected: f64 = counted.map(|k| hits.pmf(k)).sum();
    // One count more or less at either end: a density of 0.058 / 13.1 each.
    assert!((expected - level).abs() < 2.0 * 0.058 / 13.1, "{expected}");

    let covered = (0..trials).filter(|&t| {
        covers(&estimate(
            uniform_points(1000 + t, n as usize),
            &square,
            hit,
        ))
    });
    let trials = trials as f64;
    let deviation = (trials * expected * (1.0 - expected)).sqrt();
    let z = (covered.count() as f64 - trials * expected) / deviation;
    assert!(z.abs() < threshold(SIGNIFICANCE, 1), "{z}");
}

/// Two densities, neither of which finds the whole integrand well, are unbiased together; and where
/// one of them alone misses a part, the other one finds it.
#[test]
fn two_densities_are_unbiased_together() {
    let half = UniformBox::new([0.0], [0.5]);
    let whole = UniformBox::new([0.0], [1.0]);
    let f = |x: &[f64; 1]| (5.0 * x[0]).exp();
    let exact = (5f64.exp() - 1.0) / 5.0;
    for (seed, [n, m]) in [[1000, 9000], [5000, 5000], [9999, 1]]
        .into_iter()
        .enumerate()
    {
        let repeated: Running = (0..200)
            .map(|repetition| {
                let mut rng = generator(&[4, seed as u64, repetition]);
                let a: Vec<_> = points::independent(&mut rng, n / 10).collect();
                let b: Vec<_> = points::independent(&mut rng, m.max(10) / 10).collect();
                let parts = estimate_mis((&half, a.into_iter()), (&whole, b.into_iter()), f);
                parts[0].mean() + parts[1].mean()
            })
            .collect();
        expect("two densities", &repeated, exact, 3);
    }
}

/// All estimators of all targets are unbiased, at every rung.
#[test]
fn no_estimator_is_biased() {
    let ladder = Ladder {
        last: 1024,
        repetitions: 400,
        ..Ladder::default()
    };
    for target in Target::ALL {
        for curve in study(&target.problem(), &ladder, || true).curves {
            for point in curve.points {
                let z = point.bias / point.bias_error;
                // At most five curves and rungs for each of six targets.
                let limit = threshold(SIGNIFICANCE, 150);
                assert!(
                    z.abs() <= limit,
                    "{target:?}, {}, {} samples: {z:.2} standard errors",
                    curve.name,
                    point.samples
                );
            }
        }
    }
}

/// Squared errors over the repetitions of one estimator.
fn squared_errors(exact: f64, estimate: impl Fn(u64) -> f64) -> Running {
    (0..2000)
        .map(|repetition| (estimate(repetition) - exact).powi(2))
        .collect()
}

/// `V[F_N] = V[f/p] / N`.
#[test]
fn independent_samples_have_the_variance_of_the_formula() {
    let uniform = UniformBox::new([0.0], [2.0]);
    let linear = Power::new(1.0, 2.0);
    let exact = 8.0 / 3.0;
    for n in [16, 64] {
        let seed = |repetition| [5, n as u64, repetition];
        let with_uniform = squared_errors(exact, |repetition| {
            let mut rng = generator(&seed(repetition));
            estimate(points::independent(&mut rng, n), &uniform, |x| x[0] * x[0]).mean()
        });
        // E[(2 x^2)^2] = 2 * 2^5 / 5 = 64/5.
        let variance = 64.0 / 5.0 - exact * exact;
        expect("uniform", &with_uniform, variance / n as f64, 4);
        let with_linear = squared_errors(exact, |repetition| {
            let mut rng = generator(&seed(repetition));
            estimate(points::independent(&mut rng, n), &linear, |x| x * x).mean()
        });
        // x^2 / (x/2) = 2x, E[(2x)^2] = integral of 4 x^2 x/2 = 8.
        let variance = 8.0 - exact * exact;
        expect("linear", &with_linear, variance / n as f64, 4);
    }
}

/// The variance of a stratified mean is the sum of the variances in its strata, over `N^2`.
#[test]
fn jittered_samples_have_the_variance_of_their_strata() {
    let uniform = UniformBox::new([0.0], [2.0]);
    let square = UniformBox::<2>::unit();
    for m in [4, 16] {
        // On a stratum of half width r about c, x^2 varies as (2 c t + t^2): 4 c^2 r^2/3 + 4 r^4/45.
        // Each term of the estimate is 2 x^2.
        let r = 1.0 / f64::from(m);
        let strata = (0..m).map(|j| {
            let c = 2.0 * r * (f64::from(j) + 0.5);
            4.0 * (4.0 * c * c * r * r / 3.0 + 4.0 * r.powi(4) / 45.0)
        });
        let variance = strata.sum::<f64>() / f64::from(m * m);
        let errors = squared_errors(8.0 / 3.0, |repetition| {
            let mut rng = generator(&[6, m as u64, repetition]);
            estimate(points::jittered(&mut rng, m as usize), &uniform, |x| {
                x[0] * x[0]
            })
            .mean()
        });
        expect("x^2", &errors, variance, 4);

        // A cell of which the quarter disk covers a share q has variance 16 q (1 - q).
        let cells = (0..m * m).map(|i| {
            let q = covered(f64::from(i % m) * r, f64::from(i / m) * r, r);
            16.0 * q * (1.0 - q)
        });
        let variance = cells.sum::<f64>() / f64::from(m * m).powi(2);
        let errors = squared_errors(PI, |repetition| {
            let mut rng = generator(&[7, m as u64, repetition]);
            let points = points::jittered(&mut rng, m as usize);
            estimate(points, &square, |p: &[f64; 2]| {
                4.0 * f64::from(u8::from(p[0] * p[0] + p[1] * p[1] < 1.0))
            })
            .mean()
        });
        expect("darts", &errors, variance, 4);
    }
}

/// Share of the square of edge `h` with its lower left corner at (x, y) that the unit disk covers:
/// the integral of the height under the circle, cut to the square.
fn covered(x: f64, y: f64, h: f64) -> f64 {
    // Antiderivative of sqrt(1 - t^2).
    let under = |t: f64| 0.5 * (t * (1.0 - t * t).max(0.0).sqrt() + t.asin());
    // Where the circle crosses the square's upper and lower edge.
    let cross = |y: f64| (1.0 - y * y).max(0.0).sqrt();
    let full = cross(y + h).clamp(x, x + h);
    let none = cross(y).clamp(x, x + h);
    let area = h * (full - x) + (under(none) - under(full)) - y * (none - full);
    area / (h * h)
}

#[test]
fn the_quarter_disk_is_covered_by_its_cells() {
    let m = 16;
    let r = 1.0 / f64::from(m);
    let cells = (0..m * m).map(|i| covered(f64::from(i % m) * r, f64::from(i / m) * r, r));
    let area = cells.sum::<f64>() * r * r;
    // A few roundings a cell.
    assert!((area - PI / 4.0).abs() < 8.0 * f64::from(m * m) * f64::EPSILON);
}
