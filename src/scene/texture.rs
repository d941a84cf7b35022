//! Images that materials read.

/// The texels of one image file, with its mip levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The file, for people.
    pub name: String,
    /// How `words` holds texels.
    pub format: TexelFormat,
    /// Whether colours are stored with the curve of sRGB; always false for
    /// [`TexelFormat::Rgb32`]. Opacity is never.
    pub srgb: bool,
    /// Sizes and places of the mip levels: the image first, then ever smaller ones to 1 by 1.
    pub levels: Vec<MipLevel>,
    /// All levels, rows from the bottom up.
    pub words: Vec<u32>,
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
}

/// A mip level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MipLevel {
    /// Texels across and up, each at least 1.
    pub size: [u32; 2],
    /// Index in [`Texture::words`] of its first word.
    pub first: u32,
}

impl Texture {
    /// Texels across and up.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.levels[0].size
    }

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }
}
