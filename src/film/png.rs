//! PNG: what a screen shows of an image, sRGB with 8 bits a channel.

use super::output::{OutputError, write_atomically};
use super::tone::{ToneMap, display};
use image::ImageEncoder;
use std::path::Path;

/// How an image is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Radiance is multiplied by this; [`super::tone::stops`] gives it for an exposure in stops.
    pub scale: f64,
    /// The curve behind it.
    pub tone_map: ToneMap,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            scale: 1.0,
            tone_map: ToneMap::Filmic,
        }
    }
}

/// Writes pixels of linear Rec. 709, in scanline order, to a PNG at `path`, atomically. Negative
/// radiance shows as black.
///
/// # Errors
/// If the file cannot be written.
///
/// # Panics
/// If there are not `width * height` pixels.
pub fn write_png(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[f32; 3]],
    look: Look,
) -> Result<(), OutputError> {
    write_atomically(path, |writer| encode(writer, width, height, pixels, look))
}

/// The same as bytes, for a page that holds its pictures.
///
/// # Errors
/// If the sides are 0 or more than the format can say.
///
/// # Panics
/// If there are not `width * height` pixels.
pub fn png_bytes(
    width: u32,
    height: u32,
    pixels: &[[f32; 3]],
    look: Look,
) -> image::ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    encode(&mut bytes, width, height, pixels, look)?;
    Ok(bytes)
}

fn encode(
    writer: impl std::io::Write,
    width: u32,
    height: u32,
    pixels: &[[f32; 3]],
    look: Look,
) -> image::ImageResult<()> {
    assert_eq!(pixels.len(), width as usize * height as usize);
    let codes: Vec<[u8; 3]> = pixels
        .iter()
        .map(|&radiance| display(radiance, look.scale, look.tone_map))
        .collect();
    image::codecs::png::PngEncoder::new(writer).write_image(
        codes.as_flattened(),
        width,
        height,
        image::ExtendedColorType::Rgb8,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::tone::stops;

    #[test]
    fn a_png_reads_back_with_exposure_applied() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png");
        let look = Look {
            scale: stops(-1.0),
            tone_map: ToneMap::None,
        };
        let pixels = [[2.0, 1.0, 0.0], [0.428_231, 4.0, -1.0]];
        write_png(&path, 2, 1, &pixels, look).expect("written");
        let read = image::open(&path).expect("a PNG").into_rgb8();
        // sRGB encodes 0.5 as 187.5 of 255 (188 rounded) and 0.2140 as 127.5.
        assert_eq!(read.get_pixel(0, 0).0, [255, 188, 0]);
        assert_eq!(read.get_pixel(1, 0).0[1..], [255, 0]);
        assert_eq!(read.dimensions(), (2, 1));
    }
}
