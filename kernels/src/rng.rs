//! Counter-based random numbers: a pure function of (seed, pixel, sample, block of dimensions).
//!
//! `pcg4d` of M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020: a
//! bijection of four words to four words that passes TestU01's BigCrush at their setting. The four
//! words in are the counter, the four words out are four dimensions. So a path carries no state:
//! whoever needs numbers asks for its *block* by number, and any lane, wave, thread or machine
//! that asks the same gets the same.
//!
//! The seam for other samplers is [`Sampler`]: four dimensions at a time, since that is what one
//! evaluation of the hash, or one padded four-dimensional Owen-scrambled Sobol point, gives.
//!
//! Input: any. Output: uniform on `{0, 1, …, 2^24 - 1} * 2^-24`, so in `[0, 1 - 2^-24]`.

use crate::lanes::{Fx, Ux, to_f32};

/// A sequence of points: four dimensions a block, one point a (pixel, sample).
pub trait Sampler: Copy + Send + Sync {
    /// Dimensions `4 * block .. 4 * block + 4` of the point of each lane's `(pixel, sample)`.
    #[must_use]
    fn draw4(&self, pixel: Ux, sample: Ux, block: Ux) -> [Fx; 4];
}

/// Independent uniform numbers.
#[derive(Clone, Copy, Debug)]
pub struct Independent {
    /// Two renders with different seeds are independent of each other.
    pub seed: u32,
}

impl Sampler for Independent {
    #[inline(always)]
    fn draw4(&self, pixel: Ux, sample: Ux, block: Ux) -> [Fx; 4] {
        pcg4d([pixel, sample, block, scatter(Ux::splat(self.seed))]).map(unit)
    }
}

/// What a path vertex draws its numbers for: each gets a block of its own, so that no number is used
/// twice and none depends on what else a scene calls for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// Two for the next direction, one for roulette.
    Direction,
    /// Two to select a light, two for a point on it.
    Light,
}

/// The camera's block: two numbers for the pixel filter, two for the lens.
pub const CAMERA_BLOCK: u32 = 0;

/// The block of a path that has scattered `bounces` times so far (whatever its topmost bit).
#[inline(always)]
#[must_use]
pub fn block(bounces: Ux, what: Block) -> Ux {
    bounces + bounces + Ux::splat(1 + what as u32)
}

/// MurmurHash3's finalizer (A. Appleby), a bijection. Seeds and pixels pass through it because
/// `pcg4d`'s highest input bits reach few output bits: seeds that differ in bit 30 or 31 alone would
/// give renders that resemble each other, and so would rows of pixels far apart. The other words of
/// the counter do not grow that large.
#[inline(always)]
fn scatter(word: Ux) -> Ux {
    let h = (word ^ (word >> 16)) * Ux::splat(0x85eb_ca6b);
    let h = (h ^ (h >> 13)) * Ux::splat(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// The word by which a pixel is known to samplers, for coordinates below 2^16.
#[inline(always)]
#[must_use]
pub fn pixel_name(x: Ux, y: Ux) -> Ux {
    scatter((y << 16) | x)
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

/// The top 24 bits as a number in `[0, 1 - 2^-24]`.
#[inline(always)]
#[must_use]
pub fn unit(bits: Ux) -> Fx {
    to_f32(bits >> 8) * Fx::splat(1.0 / 16_777_216.0)
}
