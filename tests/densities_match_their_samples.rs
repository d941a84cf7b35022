//! Chi-square tests of everything that draws from a density in f64: what is drawn falls into each
//! bin as often as the density's integral over the bin says, and the density integrates to 1.

use huygens::estimate::{
    CosineHemisphere, Density, Lorentz, Power, Rejection, Table, Table2, UniformBox,
    UniformHemisphere, UniformSphere, generator, points, sidak,
};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::{PI, TAU};

/// Chance that one of these tests fails although all is right.
const SIGNIFICANCE: f64 = 1e-4;
/// Tests in this file that draw.
const TESTS: usize = 10;
const SAMPLES: usize = 100_000;

/// Asserts that counts of `SAMPLES` are distributed as `probabilities`, which must add up to 1. Bins
/// that expect fewer than 5 are taken together, as is usual.
fn assert_distributed(what: &str, counts: &[u64], probabilities: &[f64]) {
    let total: f64 = probabilities.iter().sum();
    // The integrals over bins are good to 1e-9 or better (Simpson's rule, see `simpson`).
    assert!(
        (total - 1.0).abs() < 1e-6,
        "{what}: the density integrates to {total}"
    );
    let drawn: u64 = counts.iter().sum();
    assert_eq!(
        drawn, SAMPLES as u64,
        "{what}: samples fell outside all bins"
    );
    let (mut statistic, mut bins) = (0.0, 0);
    let (mut rare, mut rarely) = (0.0, 0.0);
    for (&count, p) in counts.iter().zip(probabilities) {
        let expected = p * SAMPLES as f64;
        if expected == 0.0 {
            assert_eq!(count, 0, "{what}: a sample where the density is 0");
        } else if expected < 5.0 {
            rare += expected;
            rarely += count as f64;
        } else {
            statistic += (count as f64 - expected).powi(2) / expected;
            bins += 1;
        }
    }
    if rare > 0.0 {
        statistic += (rarely - rare).powi(2) / rare;
        bins += 1;
    }
    let law = ChiSquared::new(f64::from(bins - 1)).expect("two bins at least");
    let p = 1.0 - law.cdf(statistic);
    assert!(
        p > sidak(SIGNIFICANCE, TESTS),
        "{what}: chi-square {statistic} of {bins} bins, p = {p}"
    );
}

/// Integral of `f` over `[low, high]` by Simpson's rule in `n` steps.
fn simpson(low: f64, high: f64, n: usize, f: impl Fn(f64) -> f64) -> f64 {
    let h = (high - low) / n as f64;
    let step = |i: usize| {
        let x = low + i as f64 * h;
        h / 6.0 * (f(x) + 4.0 * f(x + 0.5 * h) + f(x + h))
    };
    (0..n).map(step).sum()
}

/// The bin of `x` among `bins` equal ones of `[low, high]`.
fn bin(x: f64, low: f64, high: f64, bins: usize) -> usize {
    assert!((low..=high).contains(&x), "{x} outside {low}..{high}");
    (((x - low) / (high - low) * bins as f64) as usize).min(bins - 1)
}

/// A density on an interval, in 64 bins.
fn on_a_line(what: &str, [low, high]: [f64; 2], density: &impl Density<1, Point = f64>) {
    const BINS: usize = 64;
    let mut counts = [0; BINS];
    let mut rng = generator(&[1]);
    for u in points::independent(&mut rng, SAMPLES) {
        counts[bin(density.sample(u), low, high, BINS)] += 1;
    }
    assert_distributed(
        what,
        &counts,
        &probabilities(low, high, BINS, |x| density.pdf(&x)),
    );
}

fn probabilities(low: f64, high: f64, bins: usize, pdf: impl Fn(f64) -> f64) -> Vec<f64> {
    let edge = |i: usize| low + (high - low) * i as f64 / bins as f64;
    // From just inside to just inside, for densities that jump there.
    let integral = |i: usize| simpson(edge(i).next_up(), edge(i + 1).next_down(), 64, &pdf);
    (0..bins).map(integral).collect()
}

/// Directions, in 16 bands of equal height by 32 sectors. The densities here are at most linear in
/// z, for which Simpson's rule is exact.
fn on_the_sphere(what: &str, density: &impl Density<2, Point = [f64; 3]>) {
    const BINS: [usize; 2] = [16, 32];
    let mut counts = vec![0; BINS[0] * BINS[1]];
    let mut rng = generator(&[2]);
    for u in points::independent(&mut rng, SAMPLES) {
        let [x, y, z] = density.sample(u);
        let band = bin(z.clamp(-1.0, 1.0), -1.0, 1.0, BINS[0]);
        let sector = bin(y.atan2(x), -PI, PI, BINS[1]);
        counts[band * BINS[1] + sector] += 1;
    }
    let bands = probabilities(-1.0, 1.0, BINS[0], |z| {
        let r = (1.0 - z * z).sqrt();
        TAU * density.pdf(&[r, 0.0, z])
    });
    let sector = |p: f64| std::iter::repeat_n(p / BINS[1] as f64, BINS[1]);
    let all: Vec<f64> = bands.into_iter().flat_map(sector).collect();
    assert_distributed(what, &counts, &all);
}

#[test]
fn directions_of_the_sphere() {
    on_the_sphere("uniform sphere", &UniformSphere);
}

#[test]
fn directions_of_the_hemisphere() {
    on_the_sphere("uniform hemisphere", &UniformHemisphere);
}

#[test]
fn directions_by_their_cosine() {
    on_the_sphere("cosine hemisphere", &CosineHemisphere);
}

#[test]
fn powers() {
    on_a_line("x^3", [0.0, 2.0], &Power::new(3.0, 2.0));
    on_a_line("x", [0.0, 1.0], &Power::new(1.0, 1.0));
}

#[test]
fn peaks() {
    on_a_line("peak", [-1.0, 3.0], &Lorentz::new(0.5, 0.2, -1.0, 3.0));
}

#[test]
fn tables() {
    let values: Vec<f64> = (0..64).map(|i| f64::from(i * i % 7)).collect();
    let table = Table::new(-2.0, 6.0, &values).expect("a density");
    on_a_line("table", [-2.0, 6.0], &table);
}

#[test]
fn tables_in_two_dimensions() {
    let (columns, rows) = (12, 8);
    let value = |i: usize| {
        if i / columns == 3 {
            0.0
        } else {
            (i * i % 11) as f64
        }
    };
    let values: Vec<f64> = (0..columns * rows).map(value).collect();
    let total: f64 = values.iter().sum();
    let table = Table2::new([1.0, -1.0], [4.0, 1.0], columns, &values).expect("a density");
    let mut counts = vec![0; values.len()];
    let mut rng = generator(&[3]);
    let area = 3.0 / columns as f64 * 2.0 / rows as f64;
    for u in points::independent(&mut rng, SAMPLES) {
        let [x, y] = table.sample(u);
        let cell = bin(y, -1.0, 1.0, rows) * columns + bin(x, 1.0, 4.0, columns);
        counts[cell] += 1;
        // Some ten roundings; its cell's value over the whole.
        let expected = values[cell] / total / area;
        assert!((table.pdf(&[x, y]) / expected - 1.0).abs() < 16.0 * f64::EPSILON);
    }
    let probabilities: Vec<f64> = values.iter().map(|v| v / total).collect();
    assert_distributed("table of two dimensions", &counts, &probabilities);
}

#[test]
fn rejection_draws_from_the_target_at_its_rate() {
    // A triangle of area 1/2 under a bound of 1: one try in two succeeds.
    let target = |x: &[f64; 1]| 1.0 - (2.0 * x[0] - 1.0).abs();
    let mut source = Rejection::new(UniformBox::new([0.0], [1.0]), target, 1.0);
    assert_eq!(source.acceptance_rate(), None);
    const BINS: usize = 32;
    let mut counts = [0; BINS];
    let mut rng = generator(&[4]);
    for _ in 0..SAMPLES {
        let [x] = source.draw(&mut rng).expect("the target is not 0");
        counts[bin(x, 0.0, 1.0, BINS)] += 1;
    }
    let expected = probabilities(0.0, 1.0, BINS, |x| 2.0 * target(&[x]));
    assert_distributed("rejection", &counts, &expected);
    // Tries to the n-th success: mean n/q, variance n (1 - q)/q^2; q = 1/2. Four standard errors
    // are passed with probability 6e-5.
    let n = SAMPLES as f64;
    let z = (source.tries() as f64 - 2.0 * n) / (2.0 * n).sqrt();
    assert!(z.abs() < 4.0, "{z}");
    assert_eq!(source.acceptance_rate(), Some(n / source.tries() as f64));
    assert_eq!(source.beyond(), 0);
}

#[test]
fn rejection_tells_a_bound_that_is_none_and_a_target_that_is_zero() {
    let mut rng = generator(&[5]);
    let mut low = Rejection::new(
        UniformBox::new([0.0], [1.0]),
        |x: &[f64; 1]| 2.0 * x[0],
        1.0,
    );
    for _ in 0..100 {
        let _ = low.draw(&mut rng);
    }
    assert!(low.beyond() > 0);
    let mut zero = Rejection::new(UniformBox::new([0.0], [1.0]), |_: &[f64; 1]| 0.0, 1.0);
    assert_eq!(zero.draw(&mut rng), None);
}
