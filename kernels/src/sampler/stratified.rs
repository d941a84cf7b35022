//! Stratified sampling: a jittered grid a pair of dimensions, in a random order.
//!
//! A. Kensler, "Correlated Multi-Jittered Sampling", Pixar Technical Memo 13-01, 2013, with his
//! permutation by hashing. For `n` samples a pixel, `across = floor(sqrt n)` and
//! `down = ceil(n / across)`. Sample number `s` of the shuffled samples lies in column
//! `cx = P(s mod across)` and, within it, in the slice `cy = Q(s / across)` of `down`:
//!
//! ```text
//! u = (cx + (cy + jitter) / down) / across
//! v = (s + jitter) / n
//! ```
//!
//! So `v` has one sample in each of `n` equal slices, whatever `n` is. Where `n = across * down`, each
//! cell of an `across` by `down` grid holds one sample, and so does each of `n` equal slices of `u`.
//! Where it is not such a product (7, 11, 13, ...), the last row of the grid is not full: `u` leaves
//! `across * down - n` of its slices out, others at every draw, and is a little less even. Each
//! single sample is uniform over the square for every `n`, so no `n` is biased.
//!
//! Both pairs of a block, and blocks, are shuffled on their own. `n` must be known in advance: the
//! first half of the samples alone is a random half of the cells.

use super::{Sampler, pixel_name};
use crate::lanes::{Fx, Ux, to_f32};
use crate::rng::{pcg4d, scatter, seeds, unit};

/// The largest number that [`Sampler::draw4`] may return.
const BELOW_ONE: f32 = 1.0 - 1.0 / 16_777_216.0;

/// Correlated multi-jittered points.
///
/// Domain: `sample` below the `spp` announced. Beyond, points repeat the last sample's.
#[derive(Clone, Copy, Debug)]
pub struct Stratified {
    seed: u32,
    count: u32,
    across: u32,
    down: u32,
}

impl Stratified {
    /// For `spp` samples a pixel, 1 to 2^31.
    #[must_use]
    pub fn new(seed: u32, spp: u32) -> Self {
        let count = spp.clamp(1, 1 << 31);
        let across = count.isqrt();
        Self {
            seed,
            count,
            across,
            down: count.div_ceil(across),
        }
    }

    /// Columns and rows of the grid.
    #[must_use]
    pub fn grid(&self) -> (u32, u32) {
        (self.across, self.down)
    }

    #[inline(always)]
    fn pair(&self, sample: Ux, seed: Ux, jitter: [Fx; 2]) -> [Fx; 2] {
        // Kensler's three: odd multiples, so that the seeds of the permutations differ.
        let seed_of = |factor| seed * Ux::splat(factor);
        let sample = permute(sample, self.count, seed_of(0x5163_3e2d));
        let (row, column) = divide(sample, self.across);
        let column = permute(column, self.across, seed_of(0x68bc_21eb));
        let row = permute(row, self.down, seed_of(0x02e5_be93));
        let slice = column * Ux::splat(self.down) + row;
        let number = |slice: Ux, jitter: Fx, slices: u32| {
            // Above 2^24 slices, the sum rounds and the jitter has no room left: still uniform to
            // the precision of the number, which may be 1, and then is made the last below.
            let at = (large_to_f32(slice) + jitter) * Fx::splat(1.0 / slices as f32);
            at.fast_min(Fx::splat(BELOW_ONE))
        };
        [
            number(slice, jitter[0], self.across * self.down),
            number(sample, jitter[1], self.count),
        ]
    }
}

impl Sampler for Stratified {
    #[inline(always)]
    fn pixel(&self, x: Ux, y: Ux) -> Ux {
        pixel_name(x, y)
    }

    #[inline(always)]
    fn draw4(&self, pixel: Ux, sample: Ux, block: Ux) -> [Fx; 4] {
        // A permutation that starts outside of its range may never come back to it, and lanes
        // without a path hold anything.
        let sample = sample.min(Ux::splat(self.count - 1));
        let seed = scatter(Ux::splat(self.seed));
        let [a, b, c, d] = pcg4d([pixel, sample, block, seed]).map(unit);
        // No sample has this number, so these words are no sample's jitter.
        let [p, q, ..] = seeds([pixel, Ux::splat(u32::MAX), block, seed]);
        let [u, v] = self.pair(sample, p, [a, b]);
        let [s, t] = self.pair(sample, q, [c, d]);
        [u, v, s, t]
    }
}

/// A permutation of `0 .. count` chosen by `seed`, at `i < count`; `count` at most 2^31.
///
/// Kensler's, but for the last step: there `(i + seed) mod count`, here the offset is scaled into the
/// range first, which needs no division.
#[inline(always)]
fn permute(i: Ux, count: u32, seed: Ux) -> Ux {
    let splat = Ux::splat;
    let mask = splat(u32::MAX.unbounded_shr((count - 1).leading_zeros()));
    let (limit, mut i) = (splat(count), i);
    // A bijection of 0 ..= mask, walked on until it comes back to the range: below two steps on
    // average, as mask < 2 count.
    let mut outside = splat(u32::MAX);
    loop {
        let mut n = i ^ seed;
        n *= splat(0xe170_893d);
        n ^= seed >> 16;
        n ^= (n & mask) >> 4;
        n ^= seed >> 8;
        n *= splat(0x0929_eb3f);
        n ^= seed >> 23;
        n ^= (n & mask) >> 1;
        n *= (seed >> 27) | splat(1);
        n *= splat(0x6935_fa69);
        n ^= (n & mask) >> 11;
        n *= splat(0x74dc_b303);
        n ^= (n & mask) >> 2;
        n *= splat(0x9e50_1cc3);
        n ^= (n & mask) >> 2;
        n *= splat(0xc860_a3df);
        n &= mask;
        n ^= n >> 5;
        i = outside.select(n, i);
        outside = i.simd_ge(limit);
        if !outside.any() {
            break;
        }
    }
    let moved = i + seed.mul_keep_high(limit);
    moved - (moved.simd_ge(limit) & limit)
}

/// Quotient and remainder of numbers below 2^31.
#[inline(always)]
fn divide(i: Ux, by: u32) -> (Ux, Ux) {
    if by == 1 {
        return (i, Ux::ZERO);
    }
    // With the reciprocal rounded up, i * reciprocal is too large by at most i / 2^32 < 1/2 of a
    // quotient: at most one too many.
    let reciprocal = ((1u64 << 32) / u64::from(by) + 1) as u32;
    let by = Ux::splat(by);
    let quotient = i.mul_keep_high(Ux::splat(reciprocal));
    let remainder = i - quotient * by;
    let over = remainder.simd_ge(by); // it went below 0 and around
    (quotient + over, remainder + (over & by))
}

/// Numbers below 2^32, rounded to nearest.
#[inline(always)]
fn large_to_f32(value: Ux) -> Fx {
    let high = to_f32(value >> 16) * Fx::splat(65_536.0);
    high + to_f32(value & Ux::splat(0xffff))
}
