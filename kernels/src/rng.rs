//! Counter-based random numbers: hashes that make a number of a counter.
//!
//! `pcg4d` of M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020: a
//! bijection of four words to four words that passes TestU01's BigCrush at their setting. The four
//! words in are the counter, the four words out are four dimensions. What is counted, and how numbers
//! become the points of a path, is up to [`crate::sampler`].
//!
//! Input: any. Output: uniform on `{0, 1, …, 2^24 - 1} * 2^-24`, so in `[0, 1 - 2^-24]`.

use crate::lanes::{Fx, Ux, to_f32};

/// MurmurHash3's finalizer (A. Appleby), a bijection. Seeds and pixels pass through it because
/// `pcg4d`'s highest input bits reach few output bits: seeds that differ in bit 30 or 31 alone would
/// give renders that resemble each other, and so would rows of pixels far apart. The other words of
/// the counter do not grow that large.
#[inline(always)]
pub(crate) fn scatter(word: Ux) -> Ux {
    let h = (word ^ (word >> 16)) * Ux::splat(0x85eb_ca6b);
    let h = (h ^ (h >> 13)) * Ux::splat(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// The hash itself, a bijection on 128 bits.
#[inline(always)]
#[must_use]
pub fn pcg4d(v: [Ux; 4]) -> [Ux; 4] {
    let (a, c) = (Ux::splat(1_664_525), Ux::splat(1_013_904_223));
    let [mut x, mut y, mut z, mut w] = v.map(|e| e * a + c);
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    w ^= w >> 16;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    [x, y, z, w]
}

/// Four words of which every bit is random.
///
/// The lowest bits of [`pcg4d`] are not: no bit above reaches them in its last round, and over blocks
/// of dimensions, three values of bit 0 agree nearly twice as often as they should. Numbers leave
/// those bits out; seeds need them, so the upper halves are folded over the lower ones once more.
#[inline(always)]
#[must_use]
pub fn seeds(v: [Ux; 4]) -> [Ux; 4] {
    pcg4d(v).map(|word| word ^ (word >> 16))
}

/// The top 24 bits as a number in `[0, 1 - 2^-24]`.
#[inline(always)]
#[must_use]
pub fn unit(bits: Ux) -> Fx {
    to_f32(bits >> 8) * Fx::splat(1.0 / 16_777_216.0)
}
