//! Tables of the pixel filters for `huygens_kernels::filter::sample`.
//!
//! The table reaches pixels, so it must be the same on every machine: it is made in f64 of
//! additions, multiplications, divisions and square roots alone, which IEEE 754 rounds alike
//! everywhere and which Rust neither fuses nor reorders. The transcendental functions in it are
//! Taylor series of our own.

use crate::scene::Filter;
use std::f64::consts::PI;

/// Intervals of a table.
pub const INTERVALS: usize = 1024;

/// The inverse distribution of `filter` over the square root of the tail, `INTERVALS + 1` knots
/// from the radius down to 0; the head of `huygens_kernels::filter` gives the definition.
///
/// Knots are the true values rounded to f32, so the mass between any two of them is the filter's.
/// Within a cell, linear interpolation in the root `w` is off by at most `h^2 / 8 max |x''|` pixels
/// (tested), `h = 1 / INTERVALS` and, for a density `p`, `x'' = -1 / p - w^2 p' / p^3`: 1.2e-7 for
/// the box, nothing for the tent, 1.4e-5 for the Gaussian. For Blackman-Harris it is 2.4e-3 in the
/// outermost cell, which holds a millionth of the mass, and falls quickly from there.
#[must_use]
pub fn table(filter: Filter) -> Vec<f32> {
    (0..=INTERVALS)
        .map(|k| position(filter, k as f64 / INTERVALS as f64) as f32)
        .collect()
}

/// Half the filter's width, in pixels.
#[must_use]
pub fn radius(filter: Filter) -> f64 {
    match filter {
        Filter::Box => 0.5,
        Filter::Tent => 1.0,
        Filter::Gaussian => 1.5,
        Filter::BlackmanHarris => 1.65,
    }
}

/// The `x >= 0` beyond which, on both sides together, lies `root * root` of the filter's mass.
fn position(filter: Filter, root: f64) -> f64 {
    match filter {
        // In closed form, so that the box is an identity but for the table's interpolation.
        Filter::Box => 0.5 * (1.0 - root * root),
        Filter::Tent => 1.0 - root,
        Filter::Gaussian | Filter::BlackmanHarris => bisect(radius(filter), |x| {
            mass_within(filter, x) < 1.0 - root * root
        }),
    }
}

/// The share of the filter's mass in `-x ..= x`, for `0 <= x <= radius`.
fn mass_within(filter: Filter, x: f64) -> f64 {
    let r = radius(filter);
    match filter {
        Filter::Box => x / r,
        Filter::Tent => x * (2.0 - x),
        Filter::Gaussian => {
            // Standard deviation 1/2: exp(-2 x^2).
            let half = |x: f64| integral_of_gaussian(x * 2.0f64.sqrt());
            half(x) / half(r)
        }
        Filter::BlackmanHarris => blackman_harris_integral(x / r) / blackman_harris_integral(1.0),
    }
}

/// Integral of `exp(-t^2)` over `0..z`, as its Taylor series. For `z` up to 2.13 the terms stay
/// below 30, so what is lost to cancellation is below 1e-14.
fn integral_of_gaussian(z: f64) -> f64 {
    let mut power = z;
    let mut sum = z;
    for n in 1..64 {
        power *= -(z * z) / f64::from(n);
        sum += power / f64::from(2 * n + 1);
    }
    sum
}

/// Integral over `0..y` of the four-term Blackman-Harris window on `-1..1`: F. J. Harris, "On the
/// Use of Windows for Harmonic Analysis with the Discrete Fourier Transform", Proc. IEEE 66(1),
/// 1978, with 92 dB coefficients. Centred, so the cosines of odd order change their sign.
fn blackman_harris_integral(y: f64) -> f64 {
    // Sine and cosine of pi y, from the half turn nearer by: both series see at most pi / 2.
    let sin = sine(PI * y.min(1.0 - y));
    let cos = sine(PI * (0.5 - y));
    let sin2 = 2.0 * sin * cos;
    let sin3 = sin * (3.0 - 4.0 * sin * sin);
    0.35875 * y + 0.48829 / PI * sin + 0.14128 / (2.0 * PI) * sin2 + 0.01168 / (3.0 * PI) * sin3
}

/// Taylor series of the sine, for `|x| <= pi / 2`: the first term left out is below 1e-20.
fn sine(x: f64) -> f64 {
    let mut term = x;
    let mut sum = x;
    for n in 1..12 {
        let m = f64::from(2 * n);
        term *= -(x * x) / (m * (m + 1.0));
        sum += term;
    }
    sum
}

/// Where in `0..=end` `below` turns from true to false, to the last bit of f64.
fn bisect(end: f64, below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, end);
    if below(high) {
        return high;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use huygens_kernels::filter::sample;
    use huygens_kernels::lanes::{Fx, LANES};
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    const ALL: [Filter; 4] = [
        Filter::Box,
        Filter::Tent,
        Filter::Gaussian,
        Filter::BlackmanHarris,
    ];

    /// The filters as their definitions say, not normalised, from the platform's functions.
    fn density(filter: Filter, x: f64) -> f64 {
        if x.abs() > radius(filter) {
            return 0.0;
        }
        match filter {
            Filter::Box => 1.0,
            Filter::Tent => 1.0 - x.abs(),
            Filter::Gaussian => (-x * x / (2.0 * 0.25)).exp(),
            Filter::BlackmanHarris => {
                let t = std::f64::consts::TAU * (x + 1.65) / 3.3;
                0.35875 - 0.48829 * t.cos() + 0.14128 * (2.0 * t).cos() - 0.01168 * (3.0 * t).cos()
            }
        }
    }

    /// Simpson's rule with 64 intervals: exact to about 1e-12 on a bin of these smooth filters.
    fn integral(filter: Filter, from: f64, to: f64) -> f64 {
        let h = (to - from) / 64.0;
        let weight = |i: usize| match i {
            0 | 64 => 1.0,
            i if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let f = |i: usize| weight(i) * density(filter, from + i as f64 * h);
        (0..=64).map(f).sum::<f64>() * h / 3.0
    }

    fn positions(filter: Filter, u: impl Iterator<Item = f32>) -> Vec<f32> {
        let (table, u) = (table(filter), u.collect::<Vec<_>>());
        u.as_chunks::<LANES>()
            .0
            .iter()
            .flat_map(|&u| sample(&table, Fx::new(u)).to_array())
            .collect()
    }

    /// Chi-square against the analytic filter: 64 bins, 2^20 random numbers, each filter at the 0.1%
    /// level. The numbers are a fixed sequence, so a sound sampler passes always or never.
    #[test]
    fn samples_follow_the_filter() {
        use rand_pcg::{Pcg32, rand_core::Rng};
        const BINS: usize = 64;
        const N: usize = 1 << 20;
        for filter in ALL {
            let mut rng = Pcg32::new(1, filter as u64);
            let u = (0..N).map(|_| (rng.next_u32() >> 8) as f32 / 16_777_216.0);
            let (r, mut counts) = (radius(filter), [0u32; BINS]);
            for x in positions(filter, u) {
                let bin = (f64::from(x) + r) / (2.0 * r) * BINS as f64;
                counts[(bin as usize).min(BINS - 1)] += 1;
            }
            let edge = |b: usize| -r + 2.0 * r * b as f64 / BINS as f64;
            let all: f64 = (0..BINS)
                .map(|b| integral(filter, edge(b), edge(b + 1)))
                .sum();
            // Bins that expect less than 5 are pooled, as the test's approximation asks.
            let (mut statistic, mut cells, mut pool) = (0.0, 0, (0.0, 0.0));
            for b in 0..BINS {
                let expected = N as f64 * integral(filter, edge(b), edge(b + 1)) / all;
                let observed = f64::from(counts[b]);
                if expected < 5.0 {
                    pool = (pool.0 + expected, pool.1 + observed);
                } else {
                    statistic += (observed - expected).powi(2) / expected;
                    cells += 1;
                }
            }
            if pool.0 >= 5.0 {
                statistic += (pool.1 - pool.0).powi(2) / pool.0;
                cells += 1;
            } else {
                // Too few expected for a cell: more than 30 would have a chance below 1e-12.
                assert!(pool.1 <= 30.0, "{filter:?}: {} in the far tails", pool.1);
            }
            let chi = ChiSquared::new(f64::from(cells - 1)).expect("freedom");
            let p = chi.sf(statistic);
            assert!(p > 1e-3, "{filter:?}: chi-square {statistic}, p = {p}");
        }
    }

    /// Interpolation error in the cell that holds `tail = w^2`, as [`table`] states it, the second
    /// derivative taken at 33 points of the cell. It is smooth and monotone over a cell but for the
    /// outermost of Blackman-Harris, where its maximum is at the end; 5% for what lies between.
    fn stated_error(filter: Filter, tail: f64) -> f64 {
        let n = INTERVALS as f64;
        let cell = (tail.sqrt() * n).floor().min(n - 1.0);
        let r = radius(filter);
        let all = 2.0
            * (0..64)
                .map(|i| {
                    let edge = |i: i32| r * f64::from(i) / 64.0;
                    integral(filter, edge(i), edge(i + 1))
                })
                .sum::<f64>();
        let second = |i: u32| {
            let w = (cell + f64::from(i) / 32.0) / n;
            let x = position(filter, w);
            let p = |x: f64| density(filter, x.clamp(0.0, r)) / all;
            let step = 1e-6;
            let (from, to) = ((x - step).max(0.0), (x + step).min(r));
            let slope = (p(to) - p(from)) / (to - from);
            // Of a filter that ends at 0 (the tent) the limit at its edge: x is linear there.
            if p(x) <= 0.0 {
                0.0
            } else {
                (-1.0 / p(x) - w * w * slope / p(x).powi(3)).abs()
            }
        };
        let worst = (0..=32).map(second).fold(0.0, f64::max);
        1.05 * worst / (8.0 * n * n)
    }

    /// The interpolated inverse against one by bisection, everywhere in u.
    #[test]
    fn interpolation_is_within_its_stated_error() {
        // f32: half an ulp below 2 for the knots and again for the result, and the index's two
        // roundings of 2^-24 of itself, which move x by w x'(w) = w^2 / p <= 1 / p(0) <= 1.25 of it.
        let rounding = (1.0 + 1.0 + 2.0 * 1.25) * f64::powi(2.0, -24);
        for filter in ALL {
            let u: Vec<f32> = (0..1u32 << 11)
                .map(|i| (i * i * 2).max(1) as f32 / 16_777_216.0)
                .collect();
            for (u, x) in u.iter().zip(positions(filter, u.iter().copied())) {
                let tail = 2.0 * f64::from(*u);
                let truth = -bisect(radius(filter), |x| mass_within(filter, x) < 1.0 - tail);
                let error = (f64::from(x) - truth).abs();
                let bound = if filter == Filter::Tent {
                    0.0
                } else {
                    stated_error(filter, tail)
                };
                assert!(
                    error <= bound + rounding,
                    "{filter:?}: off by {error} at {u}, not {bound}"
                );
            }
        }
    }

    #[test]
    fn stated_errors_are_those_in_the_text() {
        for (filter, text) in [
            (Filter::Box, 1.3e-7),
            (Filter::Gaussian, 1.5e-5),
            (Filter::BlackmanHarris, 2.5e-3),
        ] {
            let worst = (0..1024)
                .map(|k| stated_error(filter, (f64::from(k) / 1024.0).powi(2)))
                .fold(0.0, f64::max);
            assert!(worst <= text && worst > 0.9 * text, "{filter:?}: {worst}");
        }
    }

    #[test]
    fn a_box_gives_u_minus_one_half() {
        let u = || (0..1u32 << 14).map(|i| (i << 10) as f32 / 16_777_216.0);
        for (u, x) in u().zip(positions(Filter::Box, u())) {
            // Interpolation (h^2 / 8) and the roundings of the test above, at half the magnitude.
            assert!(
                (x - (u - 0.5)).abs() <= 1.2e-7 + 3.0 * f32::powi(2.0, -24),
                "{x} at {u}"
            );
        }
    }

    #[test]
    fn tables_fall_from_the_radius_to_zero() {
        for filter in ALL {
            let table = table(filter);
            assert_eq!(table[0], radius(filter) as f32);
            assert_eq!(table[INTERVALS], 0.0);
            assert!(table.is_sorted_by(|a, b| a > b), "{filter:?}");
        }
    }

    /// The tables are the same on every machine: their bits, as first computed, hashed.
    #[test]
    fn tables_are_the_same_bits_everywhere() {
        let mut hasher = blake3::Hasher::new();
        for filter in ALL {
            for x in table(filter) {
                hasher.update(&x.to_bits().to_le_bytes());
            }
        }
        assert_eq!(&hasher.finalize().to_hex()[..16], "f667d7a4fceb5f9b");
    }
}
