//! Sobol points whose error is spread over the image as blue noise.
//!
//! A. Ahmed and P. Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via
//! Hierarchical Ordering of Pixels", ACM TOG 39(6), 2020: one scrambled sequence runs through the
//! whole image along a Z-order (Morton) curve, so many points to a pixel, the four quarters of every
//! square in a random order. The samples of each square of 2^k x 2^k pixels then are a net too, and
//! the errors of neighbours cancel: the noise that remains is of high frequency, which the eye, or a
//! filter, averages out. A pixel's own error is about that of [`super::Sobol`].
//!
//! The random order is a nested shuffle of the bits of (Morton code, sample), behind a swap of the
//! two axes by another coin at each square. So of the 24 orders of four quarters 16 occur: those in
//! which halves, upright or lying, follow each other. That is two scramblings, where a table of all
//! 24 permutations wants a hash at each of up to 16 levels.
//!
//! An index has 32 bits: ceil(log2 spp) for the samples, and all that is left, an even number, for
//! the Morton code. At 256 samples those are squares of 4096 x 4096 pixels, at 65536 samples
//! 256 x 256. Squares beside each other are independent.

use super::Sampler;
use super::owen::{nested, reverse};
use super::sobol::Seeds;
use crate::lanes::{Fx, Ux};

/// Scrambled Sobol points along a Z-order curve of pixels.
///
/// `sample` may go beyond the samples a pixel that were announced: each further range of
/// [`BlueNoise::period`] is independent of those before it.
#[derive(Clone, Copy, Debug)]
pub struct BlueNoise {
    seed: u32,
    /// Bits of the index that count the samples of a pixel, 0 to 31.
    sample_bits: u32,
}

impl BlueNoise {
    /// For `spp` samples a pixel, 1 to 2^31. Powers of two are best; others leave gaps in the
    /// sequence, and blue noise suffers from them.
    #[must_use]
    pub fn new(seed: u32, spp: u32) -> Self {
        Self {
            seed,
            sample_bits: spp
                .saturating_sub(1)
                .checked_ilog2()
                .map_or(0, |b| b + 1)
                .min(31),
        }
    }

    /// Samples a pixel in one sequence: the next power of two.
    #[must_use]
    pub fn period(&self) -> u32 {
        1 << self.sample_bits
    }

    /// The bits of a pixel's word that are part of the index.
    #[inline(always)]
    fn pixel_mask(&self) -> u32 {
        // 32 - sample_bits of the highest, or one fewer to have both coordinates alike.
        u32::MAX.unbounded_shl(self.sample_bits + (self.sample_bits & 1))
    }
}

impl Sampler for BlueNoise {
    /// The Morton code, `x` in the even bits and `y` in the odd ones, reversed.
    #[inline(always)]
    fn pixel(&self, x: Ux, y: Ux) -> Ux {
        reverse(spread(x) | (spread(y) << 1))
    }

    #[inline(always)]
    fn draw4(&self, pixel: Ux, sample: Ux, block: Ux) -> [Fx; 4] {
        let mask = self.pixel_mask();
        let square = pixel & Ux::splat(!mask);
        let seeds = Seeds::new(square, sample >> self.sample_bits, block, self.seed);
        // Reversed, each quarter's y is right below its x: the coin that would flip y depends on the
        // squares around alone, so it may choose whether to swap the two.
        let pixel = pixel & Ux::splat(mask);
        let coins = pixel ^ nested(pixel, !seeds.order, seeds.order >> 7);
        let differ = (pixel ^ (pixel >> 1)) & coins & Ux::splat(0x5555_5555);
        let pixel = pixel ^ differ ^ (differ << 1);
        let sample = sample & Ux::splat(self.period() - 1);
        seeds.point((pixel >> self.sample_bits) | reverse(sample))
    }
}

/// The lower 16 bits, a zero above each.
#[inline(always)]
fn spread(x: Ux) -> Ux {
    let x = (x | (x << 8)) & Ux::splat(0x00ff_00ff);
    let x = (x | (x << 4)) & Ux::splat(0x0f0f_0f0f);
    let x = (x | (x << 2)) & Ux::splat(0x3333_3333);
    (x | (x << 1)) & Ux::splat(0x5555_5555)
}
