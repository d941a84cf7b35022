//! Chi-square tests for the kernels: counted cells against what a pdf says they hold.
#![allow(dead_code)] // each test binary uses its own part

use huygens_kernels::lanes::{Fx, LANES};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Chance that a right kernel fails a [`Suite`]. All tests are seeded: one that has passed goes on
/// passing until somebody changes what is computed.
pub(crate) const SIGNIFICANCE: f64 = 1e-4;

/// Cells that expect fewer than this are pooled: below it the statistic is not chi-square
/// distributed (W. G. Cochran, Biometrics 10, 1954).
const LEAST_EXPECTED: f64 = 5.0;

/// Chi-square tests that stand or fall together.
#[derive(Default)]
pub(crate) struct Suite {
    results: Vec<(String, f64)>,
}

impl Suite {
    /// Tests counts against expectations, cell by cell; both must have the same sum, which pdfs
    /// that do not integrate to 1 fail.
    pub(crate) fn test(&mut self, name: &str, observed: &[u64], expected: &[f64]) {
        assert_eq!(observed.len(), expected.len());
        let total: f64 = observed.iter().map(|&o| o as f64).sum();
        let sum: f64 = expected.iter().sum();
        assert!(
            (sum / total - 1.0).abs() < 1e-5,
            "{name}: {sum} expected, {total} drawn"
        );
        self.results
            .push((name.to_owned(), p_value(observed, expected)));
    }

    /// Tests counts of cells that are all equally likely.
    pub(crate) fn test_uniform(&mut self, name: &str, observed: &[u64]) {
        let each = observed.iter().sum::<u64>() as f64 / observed.len() as f64;
        self.test(name, observed, &vec![each; observed.len()]);
    }

    /// Fails unless every p-value lies where all of them together should, with probability
    /// `1 - SIGNIFICANCE`. Both ends: counts that are too even are not independent either.
    pub(crate) fn finish(self) {
        let each = -((-SIGNIFICANCE).ln_1p() / self.results.len() as f64).exp_m1();
        for (name, p) in self.results {
            assert!(
                (0.5 * each..=1.0 - 0.5 * each).contains(&p),
                "{name}: p = {p:e} is outside {:e} .. 1 - {:e}",
                0.5 * each,
                0.5 * each
            );
        }
    }
}

/// Probability of a chi-square statistic at least as large as that of `observed`.
pub(crate) fn p_value(observed: &[u64], expected: &[f64]) -> f64 {
    let mut cells: Vec<(f64, f64)> = expected
        .iter()
        .zip(observed)
        .map(|(&e, &o)| (e, o as f64))
        .collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups = vec![(0.0, 0.0)];
    for (e, o) in cells {
        assert!(e > 0.0 || o == 0.0, "counts where none can be");
        let group = groups.last_mut().expect("a group");
        if group.0 < LEAST_EXPECTED {
            *group = (group.0 + e, group.1 + o);
        } else {
            groups.push((e, o));
        }
    }
    let statistic: f64 = groups.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
    let degrees = groups.len() - 1;
    ChiSquared::new(degrees as f64)
        .expect("two groups at least")
        .sf(statistic)
}

/// Jarzynski and Olano (2020), listing of `pcg4d`, one lane.
pub(crate) fn pcg4d_twin([x, y, z, w]: [u32; 4]) -> [u32; 4] {
    let start = |e: u32| e.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let mut v = [x, y, z, w].map(start);
    let multiply = |v: &mut [u32; 4]| {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[3]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
        v[3] = v[3].wrapping_add(v[1].wrapping_mul(v[2]));
    };
    multiply(&mut v);
    v = v.map(|e| e ^ (e >> 16));
    multiply(&mut v);
    v
}

/// A generator of its own for the inputs of tests (SplitMix64; Steele, Lea, Flood, OOPSLA 2014).
pub(crate) struct Source(pub(crate) u64);

impl Source {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// What the sampling kernels take: uniform on the multiples of 2^-24 in [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 16_777_216.0
    }

    pub(crate) fn unit_lanes(&mut self) -> Fx {
        Fx::new(std::array::from_fn(|_| self.unit()))
    }

    /// A uniformly distributed unit vector, rounded.
    pub(crate) fn direction(&mut self) -> [f32; 3] {
        let z = 2.0 * f64::from(self.unit()) - 1.0;
        let phi = std::f64::consts::TAU * f64::from(self.unit());
        let r = (1.0 - z * z).sqrt();
        [r * phi.cos(), r * phi.sin(), z].map(|c| c as f32)
    }
}

/// Integral of `f` over `[a, b]` by Simpson's rule on 32 intervals.
pub(crate) fn integrate(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let h = (b - a) / 32.0;
    let inner: f64 = (1..32)
        .map(|i| [2.0, 4.0][i % 2] * f(a + h * i as f64))
        .sum();
    (f(a) + inner + f(b)) * h / 3.0
}

/// Every value that a component of a sample point can take at its ends, and some between.
pub(crate) const CORNERS: [f32; LANES] = [
    0.0,
    1.0 / 16_777_216.0,
    0.25,
    0.5,
    0.5 + 1.0 / 16_777_216.0,
    0.75,
    1.0 - 2.0 / 16_777_216.0,
    1.0 - 1.0 / 16_777_216.0,
];

#[test]
fn the_test_itself_rejects_what_is_wrong_and_accepts_what_is_right() {
    let mut source = Source(1);
    let mut even = [0u64; 64];
    let mut tilted = [0u64; 64];
    for _ in 0..200_000 {
        even[(source.bits() >> 58) as usize] += 1;
        // 2% fewer in one half, which 200,000 draws show at 4.5 sigma and more.
        let cell = (source.bits() >> 58) as usize;
        tilted[if cell < 32 && source.unit() < 0.02 {
            cell + 32
        } else {
            cell
        }] += 1;
    }
    let each = [200_000.0 / 64.0; 64];
    assert!(p_value(&even, &each) > SIGNIFICANCE);
    assert!(p_value(&tilted, &each) < SIGNIFICANCE);
    // A tail of cells too small to test alone is pooled, not dropped.
    let mut expected = vec![1000.0];
    expected.extend([1.0; 20]);
    let mut observed = vec![1000u64];
    observed.extend([4; 20]);
    assert!(p_value(&observed, &expected) < 1e-12);
}
