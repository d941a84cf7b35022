//! Images that materials read: what they are, and from files to texels with mip levels.

mod decode;
mod mip;
mod store;

pub(super) use store::{Request, Store, beside};

use huygens_kernels::texture::Channel;
pub use huygens_kernels::texture::{MipLevel, TexelFormat};

/// The texels of one image file, with its mip levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The file, for people.
    pub name: String,
    /// How `words` holds texels.
    pub format: TexelFormat,
    /// Whether 8-bit colours are stored with the curve of sRGB. Opacity is never.
    pub srgb: bool,
    /// Sizes and places of the mip levels: the image first, then ever smaller ones to 1 by 1.
    pub levels: Vec<MipLevel>,
    /// All levels, rows from the bottom up.
    pub words: Vec<u32>,
    /// The least and the greatest number in it, opacity apart; after the curve of sRGB.
    pub range: [f32; 2],
}

impl Texture {
    /// Texels across and up.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.levels[0].size
    }

    /// The mean colour of the whole image: its smallest mip level.
    #[must_use]
    pub fn mean(&self) -> [f32; 3] {
        let last = self.levels[self.levels.len() - 1];
        debug_assert_eq!(last.size, [1, 1]);
        self.view().texel(last.first, 0, Channel::Colour)
    }

    /// As kernels read it.
    #[must_use]
    pub fn view(&self) -> huygens_kernels::texture::Texture<'_> {
        huygens_kernels::texture::Texture {
            words: &self.words,
            format: self.format,
            srgb: self.srgb,
            levels: &self.levels,
        }
    }

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }
}
