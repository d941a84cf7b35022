//! One texel: from words to numbers.

use super::{Channel, TexelFormat, Texture};

impl Texture<'_> {
    /// Texel number `index`, rows from the bottom up, of the level that begins at word `first`.
    #[inline(always)]
    #[must_use]
    pub fn texel(&self, first: u32, index: usize, channel: Channel) -> [f32; 3] {
        let first = first as usize;
        let colour = &DECODE[usize::from(self.srgb)];
        match self.format {
            TexelFormat::Rgba8 => {
                let [r, g, b, alpha] = self.words[first + index].to_le_bytes();
                let one = |byte: u8| [colour[usize::from(byte)]; 3];
                match channel {
                    Channel::Colour => [r, g, b].map(|byte| colour[usize::from(byte)]),
                    Channel::Red => one(r),
                    Channel::Green => one(g),
                    Channel::Blue => one(b),
                    Channel::Alpha => [DECODE[0][usize::from(alpha)]; 3],
                }
            }
            TexelFormat::Grey8 => {
                let byte = self.words[first + index / 4].to_le_bytes()[index % 4];
                match channel {
                    Channel::Alpha => [1.0; 3],
                    _ => [colour[usize::from(byte)]; 3],
                }
            }
            TexelFormat::Rgb32 => {
                let at = first + 3 * index;
                let [r, g, b] = [at, at + 1, at + 2].map(|i| f32::from_bits(self.words[i]));
                match channel {
                    Channel::Colour => [r, g, b],
                    Channel::Red => [r; 3],
                    Channel::Green => [g; 3],
                    Channel::Blue => [b; 3],
                    Channel::Alpha => [1.0; 3],
                }
            }
            TexelFormat::Grey32 => match channel {
                Channel::Alpha => [1.0; 3],
                _ => [f32::from_bits(self.words[first + index]); 3],
            },
        }
    }
}

/// What a byte stands for: shares of 255, and those through the curve of sRGB.
pub static DECODE: [[f32; 256]; 2] = decode();

const fn decode() -> [[f32; 256]; 2] {
    let mut tables = [[0.0; 256]; 2];
    let mut byte = 0;
    while byte < 256 {
        let share = byte as f64 / 255.0;
        tables[0][byte] = share as f32;
        tables[1][byte] = srgb_to_linear(share) as f32;
        byte += 1;
    }
    tables
}

/// The curve of sRGB, for the compiler, which has no powers: `x^2.4 = x^2 (x^2)^(1/5)`, the root by
/// Newton's method, which from 1 falls to it step by step; 64 steps are enough for what is above
/// 0.04.
const fn srgb_to_linear(share: f64) -> f64 {
    if share <= 0.04045 {
        return share / 12.92;
    }
    let x = (share + 0.055) / 1.055;
    let square = x * x;
    let mut root = 1.0;
    let mut step = 0;
    while step < 64 {
        let fourth = root * root * root * root;
        root = (4.0 * root + square / fourth) / 5.0;
        step += 1;
    }
    square * root
}
