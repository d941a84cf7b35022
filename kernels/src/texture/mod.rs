//! Texture look-up: `LANES` points, each of a texture and transformation of its own.
//!
//! *Coordinates*: a texture use maps the surface's (u, v) by its affine rows; (0, 0) is the lower
//! left corner of the image, texel (i, j) of a level of w by h texels has its middle at
//! `((i + 0.5) / w, (j + 0.5) / h)`. Beyond [0, 1] the image repeats, is mirrored, or its outermost
//! texels go on. Coordinates that are not finite count as 0.
//!
//! *Filter*: a linear mixture of the four texels around, in two neighbouring mip levels
//! (L. Williams, "Pyramidal Parametrics", SIGGRAPH 1983), mixed by the fraction of
//! `lambda = log2(footprint in texels)`. The footprint is the width of a ray cone
//! (T. Akenine-Moeller et al., "Improved Shader and Texture Level of Detail Using Ray Cones", JCGT
//! 10(1), 2021) where it meets the surface, in units of the surface's (u, v); a texture use scales
//! it by the root of its determinant and of the image's size. `Nearest` reads one texel of the
//! whole image.
//!
//! *Decoding*: colours stored with the curve of sRGB (IEC 61966-2-1) are made linear before they
//! are mixed, by a table of all 256 values, each the curve's value rounded once.
//!
//! Output: finite for finite texels; between the least and the greatest texel read, up to rounding.
//! Reads, a lane: 48 bytes of texture use and texture, and 4 or 8 texels.

mod single;
mod texel;

use crate::lanes::{Fx, LANES, Ux, as_mask};
use crate::vec3::Vec3x;

pub use texel::DECODE;

/// In place of the index of a texture use: no texture, which reads as 1.
pub const NO_TEXTURE: u32 = u32::MAX;

/// How a material reads a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureUse {
    /// Index of the texture.
    pub texture: u32,
    /// Which of the texel's channels: a colour takes [`Channel::Colour`], a number one of the
    /// others.
    pub channel: Channel,
    /// From the surface's (u, v) to the texture's: rows of an affine transformation,
    /// `u' = uv[0][0] u + uv[0][1] v + uv[0][2]`.
    pub uv: [[f32; 3]; 2],
    /// What lies beyond the image, across and up.
    pub wrap: [Wrap; 2],
    /// What lies between texels.
    pub filter: TexelFilter,
}

impl TextureUse {
    /// The (u, v) of the surface as they are.
    pub const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
}

/// Which channels of a texel are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Red, green and blue.
    Colour,
    /// Red; of a grey image, its grey.
    Red,
    /// Green; of a grey image, its grey.
    Green,
    /// Blue; of a grey image, its grey.
    Blue,
    /// Opacity; 1 where the image has none.
    Alpha,
}

/// What lies beyond the edges of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image again, every other one mirrored.
    Mirror,
    /// Its outermost texels.
    Clamp,
}

/// What lies between texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TexelFilter {
    /// A linear mixture of the four around, and of two mip levels.
    #[default]
    Linear,
    /// The nearest texel of the whole image, without mip levels.
    Nearest,
}

/// How texels lie in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelFormat {
    /// Four bytes a word: red, green, blue, alpha from the lowest byte on.
    Rgba8,
    /// One byte a texel, four to a word from the lowest byte on; rows are not padded.
    Grey8,
    /// Three words a texel: red, green, blue as `f32`.
    Rgb32,
    /// One word a texel, an `f32`.
    Grey32,
}

/// A mip level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MipLevel {
    /// Texels across and up, each at least 1.
    pub size: [u32; 2],
    /// Index of its first word.
    pub first: u32,
}

/// An image.
#[derive(Clone, Copy, Debug)]
pub struct Texture<'a> {
    /// Texels of all levels, rows from the bottom up.
    pub words: &'a [u32],
    /// How they lie there.
    pub format: TexelFormat,
    /// Whether 8-bit colours are stored with the curve of sRGB. Opacity is never.
    pub srgb: bool,
    /// The image first, then ever smaller ones; at least one.
    pub levels: &'a [MipLevel],
}

/// All textures of a scene, and the ways in which materials read them.
#[derive(Clone, Copy, Debug)]
pub struct Textures<'a> {
    /// Images.
    pub textures: &'a [Texture<'a>],
    /// Indexed by what [`Textures::sample`] is given.
    pub uses: &'a [TextureUse],
}

/// What the lanes of a look-up need of their texture uses and images.
struct Rows {
    uv: [[[f32; LANES]; 3]; 2],
    /// Texels of the whole image, both ways together: its area.
    area: [f32; LANES],
    last_level: [f32; LANES],
    /// 0.5 where texels are mixed, 0 where the nearest is taken.
    middle: [f32; LANES],
}

impl Textures<'_> {
    /// The values at `uv` of texture uses `which`, filtered over a footprint of `width` in units of
    /// the surface's `uv`: a colour, or a number three times over. [`NO_TEXTURE`] reads as 1.
    #[inline]
    #[must_use]
    pub fn sample(&self, which: Ux, uv: [Fx; 2], width: Fx) -> Vec3x {
        let which = which.to_array();
        let rows = self.rows(which);
        let [s, t]: [Fx; 2] = std::array::from_fn(|axis| {
            let [a, b, c] = rows.uv[axis].map(Fx::new);
            let x = a.mul_add(uv[0], b.mul_add(uv[1], c));
            x.is_finite() & x
        });
        let [[a, b, _], [c, d, _]] = rows.uv.map(|row| row.map(Fx::new));
        let determinant = a.mul_sub(d, b * c).abs();
        let middle = Fx::new(rows.middle);
        let lambda = level(
            width * (determinant * Fx::new(rows.area)).sqrt(),
            middle.simd_gt(Fx::ZERO) & Fx::new(rows.last_level),
        );
        let below = lambda.floor();
        let fraction = lambda - below;
        let fine = self.mixed(which, below, s, t, middle);
        if fraction.simd_gt(Fx::ZERO).none() {
            return fine;
        }
        let up = below + Fx::ONE;
        let last = Fx::new(rows.last_level);
        let coarse = self.mixed(which, up.simd_lt(last).select(up, last), s, t, middle);
        (coarse - fine).scale_add(fraction, fine)
    }

    fn rows(&self, which: [u32; LANES]) -> Rows {
        let mut rows = Rows {
            uv: [[[0.0; LANES]; 3]; 2],
            area: [0.0; LANES],
            last_level: [0.0; LANES],
            middle: [0.0; LANES],
        };
        for lane in 0..LANES {
            let Some(read) = self.uses.get(which[lane] as usize) else {
                continue;
            };
            for (row, from) in rows.uv.iter_mut().zip(read.uv) {
                for (column, from) in row.iter_mut().zip(from) {
                    column[lane] = from;
                }
            }
            let levels = self.textures[read.texture as usize].levels;
            let [w, h] = levels[0].size;
            rows.area[lane] = w as f32 * h as f32;
            rows.last_level[lane] = (levels.len() - 1) as f32;
            rows.middle[lane] = match read.filter {
                TexelFilter::Linear => 0.5,
                TexelFilter::Nearest => 0.0,
            };
        }
        rows
    }

    /// The four texels around (`s`, `t`) of mip levels `level`, mixed.
    #[inline]
    fn mixed(&self, which: [u32; LANES], level: Fx, s: Fx, t: Fx, middle: Fx) -> Vec3x {
        let level = level.to_array();
        let mut sizes = [[1.0f32; LANES]; 2];
        let mut wraps = [[Wrap::Clamp; LANES]; 2];
        for lane in 0..LANES {
            if let Some(read) = self.uses.get(which[lane] as usize) {
                let at = self.textures[read.texture as usize].levels[level[lane] as usize];
                for axis in 0..2 {
                    sizes[axis][lane] = at.size[axis] as f32;
                    wraps[axis][lane] = read.wrap[axis];
                }
            }
        }
        let [across, up] =
            [(s, 0), (t, 1)].map(|(x, axis)| Span::new(x, sizes[axis], &wraps[axis], middle));
        let mut texels = [[[[1.0f32; LANES]; 3]; 2]; 2];
        for lane in 0..LANES {
            let Some(read) = self.uses.get(which[lane] as usize) else {
                continue;
            };
            let texture = &self.textures[read.texture as usize];
            let at = &texture.levels[level[lane] as usize];
            for (row, texels) in texels.iter_mut().enumerate() {
                let row = up.texel[row][lane] * at.size[0];
                for (column, texel) in texels.iter_mut().enumerate() {
                    let index = row + across.texel[column][lane];
                    let value = texture.texel(at.first, index as usize, read.channel);
                    for c in 0..3 {
                        texel[c][lane] = value[c];
                    }
                }
            }
        }
        let [[a, b], [c, d]] =
            texels.map(|row| row.map(|[x, y, z]| Vec3x::new(Fx::new(x), Fx::new(y), Fx::new(z))));
        let low = (b - a).scale_add(across.fraction, a);
        let high = (d - c).scale_add(across.fraction, c);
        (high - low).scale_add(up.fraction, low)
    }
}

/// Between which two texels of a row lanes lie, and how far from the first to the second.
struct Span {
    texel: [[u32; LANES]; 2],
    fraction: Fx,
}

impl Span {
    #[inline(always)]
    fn new(x: Fx, sizes: [f32; LANES], wraps: &[Wrap; LANES], middle: Fx) -> Self {
        let is = |wrap: Wrap| {
            let lanes = wraps.map(|w| if w == wrap { u32::MAX } else { 0 });
            as_mask(Ux::new(lanes))
        };
        let (repeat, mirror) = (is(Wrap::Repeat), is(Wrap::Mirror));
        let half = x * Fx::splat(0.5);
        let turn = half - half.floor();
        let mirrored = Fx::ONE - (turn + turn - Fx::ONE).abs();
        let clamped = x.fast_max(Fx::ZERO).fast_min(Fx::ONE);
        let inside = repeat.select(x - x.floor(), mirror.select(mirrored, clamped));
        let size = Fx::new(sizes);
        let place = inside * size - middle;
        let first = place.floor();
        // From -1 to the size: one step beyond the image at most, on either side.
        let last = size - Fx::ONE;
        let fold = |i: Fx| {
            let under = repeat.select(last, Fx::ZERO);
            let over = repeat.select(Fx::ZERO, last);
            let i = i.simd_lt(Fx::ZERO).select(under, i);
            i.simd_gt(last).select(over, i)
        };
        let whole = |i: Fx| fold(i).to_array().map(|i| i as u32);
        Self {
            texel: [whole(first), whole(first + Fx::ONE)],
            fraction: middle.simd_gt(Fx::ZERO) & (place - first),
        }
    }
}

/// `log2(texels)` in `0 ..= last`.
#[inline(always)]
fn level(texels: Fx, last: Fx) -> Fx {
    // Also where it is NaN. Beyond 2^32 texels there is no image.
    let texels = texels.simd_gt(Fx::ONE).select(texels, Fx::ONE);
    let texels = texels.fast_min(Fx::splat(4_294_967_296.0));
    let lambda = texels.ln() * Fx::splat(std::f32::consts::LOG2_E);
    lambda.fast_max(Fx::ZERO).fast_min(last)
}
