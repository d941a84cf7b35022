//! Points in the unit cube `[0, 1)^D`: independent, or spread more evenly than that.
//!
//! Every point of every set is uniform on its own, so each set gives unbiased estimates. What differs
//! is how the points avoid each other, and so the error (root mean square, `N` points):
//!
//! | set | smooth integrand | integrand that jumps | |
//! |---|---|---|---|
//! | [`independent`] | `N^(-1/2)` | `N^(-1/2)` | |
//! | [`jittered`] | `N^(-1/2 - 1/D)` | `N^(-1/2 - 1/(2D))` | one point in each of `N` cells |
//! | [`latin`] | `N^(-1/2)`; `N^(-3/2)` for a sum of functions of one coordinate | `N^(-1/2)` | one point in each of `N` slabs of each coordinate |
//!
//! Why jittering does so: the variance of the mean is `1/N^2 sum V_j`, with `V_j` the variance of `f`
//! over cell `j`. A cell has edges of `h = N^(-1/D)`. Where `f` is smooth, `V_j` is
//! `h^2 |grad f|^2 / 12` to first order, so the sum is `N h^2` and the variance `N^(-1 - 2/D)`. Where
//! `f` jumps, `V_j` does not shrink, but only the `h^(1-D)` cells that hold the edge have any:
//! `N^-2 h^(1-D) = N^(-1 - 1/D)`. (S. Haber, "A Modified Monte-Carlo Quadrature", Math. Comp. 20,
//! 1966; D. Mitchell, "Consequences of Stratified Sampling in Graphics", SIGGRAPH 1996. Latin
//! hypercubes: M. McKay, R. Beckman and W. Conover, Technometrics 21(2), 1979; M. Stein,
//! Technometrics 29(2), 1987.)

use super::Rng;
use rand_pcg::Pcg64;

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// The random numbers of estimates: M. O'Neill's PCG XSL RR 128/64.
pub type Generator = Pcg64;

/// A generator of random numbers named by `words`: equal names give equal numbers, different ones
/// numbers that are independent for any practical purpose. (State and stream come from the words by
/// SplitMix64's finalizer.)
#[must_use]
pub fn generator(words: &[u64]) -> Generator {
    let mut hash = words.len() as u64;
    let mut next = |word: u64| {
        hash = mix(hash.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ word);
        hash
    };
    for &word in words {
        next(word);
    }
    let mut wide = || u128::from(next(0)) << 64 | u128::from(next(0));
    let state = wide();
    Pcg64::new(state, wide())
}

/// SplitMix64's finalizer (G. Steele, D. Lea and C. Flood, OOPSLA 2014), a bijection.
fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A uniform number: a multiple of `2^-53` in `[0, 1 - 2^-53]`.
#[inline]
pub fn uniform(rng: &mut impl Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON)
}

/// `n` independent points.
pub fn independent<const D: usize>(
    rng: &mut impl Rng,
    n: usize,
) -> impl ExactSizeIterator<Item = [f64; D]> {
    (0..n).map(move |_| std::array::from_fn(|_| uniform(rng)))
}

/// One point in each of `strata^D` equal cubes, uniform within it, cell by cell with the first
/// coordinate fastest.
///
/// The points are not independent, so [`super::Running`]'s standard error does not hold for their
/// mean: it is too large (it knows nothing of the strata). One point a cell tells nothing of the
/// variance within the cell; repeat the whole estimate to learn its error.
///
/// # Panics
/// If `strata^D` is more than a `usize` holds.
pub fn jittered<const D: usize>(
    rng: &mut impl Rng,
    strata: usize,
) -> impl ExactSizeIterator<Item = [f64; D]> {
    let cells = strata.checked_pow(D as u32).expect("too many strata");
    let mut cell = [0; D];
    (0..cells).map(move |_| {
        let point = std::array::from_fn(|d| within(cell[d], strata, rng));
        for index in &mut cell {
            *index += 1;
            if *index < strata {
                break;
            }
            *index = 0;
        }
        point
    })
}

/// `n` points of which each of `n` equal slabs of each coordinate holds exactly one: the cells of an
/// `n^D` grid that are taken form one random permutation a coordinate. (In two dimensions also known
/// as N rooks.) Takes memory for `n D` numbers.
///
/// As for [`jittered`], the points are not independent.
pub fn latin<const D: usize>(
    rng: &mut impl Rng,
    n: usize,
) -> impl ExactSizeIterator<Item = [f64; D]> {
    // The first coordinate may as well be in order: a set of points has none.
    let slabs: [Vec<usize>; D] = std::array::from_fn(|d| {
        let mut slabs: Vec<usize> = (0..n).collect();
        if d > 0 {
            shuffle(&mut slabs, rng);
        }
        slabs
    });
    (0..n).map(move |i| std::array::from_fn(|d| within(slabs[d][i], n, rng)))
}

/// A uniform number in stratum `index` of `strata`.
#[inline]
fn within(index: usize, strata: usize, rng: &mut impl Rng) -> f64 {
    // The sum may round up to `strata`.
    ((index as f64 + uniform(rng)) / strata as f64).min(BELOW_ONE)
}

/// Fisher and Yates's shuffle. The index is the high word of a product, whose bias of at most
/// `n 2^-64` nobody can measure.
fn shuffle(items: &mut [usize], rng: &mut impl Rng) {
    for last in (1..items.len()).rev() {
        let other = (u128::from(rng.next_u64()) * (last as u128 + 1)) >> 64;
        items.swap(last, other as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Gives the largest or the smallest number for ever.
    struct Constant(u64);

    impl rand_pcg::rand_core::TryRng for Constant {
        type Error = std::convert::Infallible;
        fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
            Ok(self.0 as u32)
        }
        fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
            Ok(self.0)
        }
        fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Self::Error> {
            bytes.fill(self.0 as u8);
            Ok(())
        }
    }

    #[test]
    fn all_points_lie_in_the_half_open_cube() {
        for word in [0, u64::MAX] {
            for n in [1, 2, 3, 7, 64] {
                let rng = &mut Constant(word);
                let inside = |p: &[f64; 3]| p.iter().all(|u| (0.0..1.0).contains(u));
                assert!(independent(rng, n).all(|p| inside(&p)));
                assert!(jittered(rng, n).all(|p| inside(&p)));
                assert!(latin(rng, n).all(|p| inside(&p)));
            }
        }
    }

    #[test]
    fn every_cell_has_one_point() {
        let rng = &mut generator(&[1]);
        for m in [1, 2, 5, 8] {
            let cells: BTreeSet<_> = jittered(rng, m)
                .map(|p: [f64; 3]| p.map(|u| (u * m as f64) as usize))
                .collect();
            assert_eq!(cells.len(), m * m * m);
        }
    }

    #[test]
    fn every_slab_of_every_coordinate_has_one_point() {
        let rng = &mut generator(&[2]);
        for n in [1, 2, 10, 64] {
            let points: Vec<[f64; 3]> = latin(rng, n).collect();
            for d in 0..3 {
                let slabs: BTreeSet<_> =
                    points.iter().map(|p| (p[d] * n as f64) as usize).collect();
                assert_eq!((points.len(), slabs.len()), (n, n));
            }
        }
    }

    #[test]
    fn shuffles_are_uniform() {
        // 6 orders of 3 items, 6000 times: chi-square with 5 degrees of freedom is below 25.7 with
        // probability 1 - 1e-4 (Abramowitz and Stegun, table 26.8: 25.745).
        let rng = &mut generator(&[3]);
        let mut counts = std::collections::BTreeMap::new();
        for _ in 0..6000 {
            let mut items = [0, 1, 2];
            shuffle(&mut items, rng);
            *counts.entry(items).or_insert(0.0) += 1.0;
        }
        let chi_square: f64 = counts
            .values()
            .map(|n: &f64| (n - 1000.0).powi(2) / 1000.0)
            .sum();
        assert_eq!(counts.len(), 6);
        assert!(chi_square < 25.745, "{chi_square}");
    }

    #[test]
    fn generators_differ_where_their_names_do() {
        let names: [&[u64]; 7] = [&[], &[0], &[1], &[0, 0], &[0, 1], &[1, 0], &[u64::MAX]];
        let first: BTreeSet<u64> = names.iter().map(|n| generator(n).next_u64()).collect();
        assert_eq!(first.len(), names.len());
        assert_eq!(generator(&[1, 2]).next_u64(), generator(&[1, 2]).next_u64());
    }
}
