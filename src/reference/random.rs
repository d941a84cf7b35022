//! Random numbers of the reference, and the pixel filter that they are drawn for.

use crate::scene::Filter;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use std::f64::consts::PI;

/// An offset from the pixel's centre with the filter's density, by rejection.
pub(super) fn filter_offset(filter: Filter, rng: &mut impl Rng) -> f64 {
    let radius = match filter {
        Filter::Box => 0.5,
        Filter::Tent => 1.0,
        Filter::Gaussian => 1.5,
        Filter::BlackmanHarris => 1.65,
    };
    loop {
        let x = radius * (2.0 * uniform(rng) - 1.0);
        let height = match filter {
            Filter::Box => 1.0,
            Filter::Tent => 1.0 - x.abs(),
            Filter::Gaussian => (-0.5 * (x / 0.5).powi(2)).exp(),
            Filter::BlackmanHarris => {
                let a = PI * x / radius;
                0.35875 + 0.48829 * a.cos() + 0.14128 * (2.0 * a).cos() + 0.01168 * (3.0 * a).cos()
            }
        };
        if uniform(rng) < height {
            return x;
        }
    }
}

/// A generator for four words: started where SplitMix64's finalizer scatters them.
pub(super) fn generator(words: [u32; 4]) -> Pcg64 {
    let mut state = [0u64; 2];
    for word in words {
        let mixed = mix(state[1] ^ u64::from(word));
        state = [state[1], mixed];
    }
    let join = |a: u64, b: u64| (u128::from(a) << 64) | u128::from(b);
    Pcg64::new(join(state[1], state[0]), join(state[0], state[1]))
}

/// G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Uniform on the multiples of 2^-53 in [0, 1).
pub(super) fn uniform(rng: &mut impl Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 * (-53f64).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Running;

    #[test]
    fn filter_offsets_have_the_moments_of_their_density() {
        // Densities as in the windows' own definitions, over their whole support.
        let gaussian = |x: f64| (-2.0 * x * x).exp();
        let blackman_harris = |x: f64| {
            let n = (x / 1.65 + 1.0) * PI;
            0.35875 - 0.48829 * n.cos() + 0.14128 * (2.0 * n).cos() - 0.01168 * (3.0 * n).cos()
        };
        let variance = |f: &dyn Fn(f64) -> f64, radius: f64| {
            let (mut weight, mut square) = (0.0, 0.0);
            for i in 0..10_000 {
                let x = radius * ((f64::from(i) + 0.5) / 5_000.0 - 1.0);
                weight += f(x);
                square += f(x) * x * x;
            }
            square / weight
        };
        for (filter, expected) in [
            (Filter::Box, 1.0 / 12.0),
            (Filter::Tent, 1.0 / 6.0),
            (Filter::Gaussian, variance(&gaussian, 1.5)),
            (Filter::BlackmanHarris, variance(&blackman_harris, 1.65)),
        ] {
            let mut rng = generator([7, filter as u32, 0, 0]);
            let (mut first, mut second) = (Running::new(), Running::new());
            for _ in 0..100_000 {
                let x = filter_offset(filter, &mut rng);
                first.push(x);
                second.push(x * x);
            }
            // Eight tests at 1e-5 together: 4.8 standard errors each; the quadrature is exact to
            // 1e-8, far below those (1e-3 of the variance).
            let level = 1.0 - 1e-5 / 8.0;
            for (moment, expected) in [(first, 0.0), (second, expected)] {
                let [low, high] = moment.confidence_interval(level).unwrap();
                assert!(
                    low <= expected && expected <= high,
                    "{filter:?}: {moment:?}, {expected}"
                );
            }
        }
    }

    #[test]
    fn generators_of_neighbours_are_unrelated() {
        // First numbers of 64 x 64 neighbouring pixels and samples: mean and correlation.
        let first = |x, s| uniform(&mut generator([0, x, 3, s])) - 0.5;
        let products: Running = (0..64)
            .flat_map(|x| (0..64).map(move |s| first(x, s) * first(x, s + 1)))
            .collect();
        let values: Running = (0..64)
            .flat_map(|x| (0..64).map(move |s| first(x, s)))
            .collect();
        for moment in [products, values] {
            let [low, high] = moment.confidence_interval(1.0 - 1e-5).unwrap();
            assert!(low <= 0.0 && 0.0 <= high, "{moment:?}");
        }
    }
}
