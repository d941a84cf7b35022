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
