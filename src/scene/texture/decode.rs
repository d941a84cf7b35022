//! Image files to texels: PNG, JPEG, Radiance HDR and EXR, told apart by their first bytes.

use super::{MipLevel, TexelFormat};
use image::{ColorType, DynamicImage, ImageDecoder, ImageReader};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Largest number of texels: 1 GiB of 8-bit colours.
const LARGEST: u64 = 1 << 28;

/// First bytes of an EXR file.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// The image of a file, rows from the bottom up, without mip levels.
#[derive(Debug)]
pub(super) struct Base {
    pub(super) size: [u32; 2],
    pub(super) format: TexelFormat,
    pub(super) srgb: bool,
    pub(super) words: Vec<u32>,
}

impl Base {
    /// The one level that there is.
    pub(super) fn level(&self) -> MipLevel {
        MipLevel {
            size: self.size,
            first: 0,
        }
    }
}

/// Texels across and up, by the file's header.
pub(super) fn size(path: &Path) -> Result<[u32; 2], String> {
    let mut file = open(path)?;
    let size = if is_exr(&mut file)? {
        let meta = exr::meta::MetaData::read_from_buffered(file, false).map_err(broken)?;
        let header = meta
            .headers
            .first()
            .ok_or("is an EXR file without layers")?;
        [header.layer_size.x(), header.layer_size.y()].map(|n| u32::try_from(n).unwrap_or(u32::MAX))
    } else {
        reader(file)?.into_dimensions().map_err(broken)?.into()
    };
    let [width, height] = size;
    if width == 0 || height == 0 || u64::from(width) * u64::from(height) > LARGEST {
        return Err(format!(
            "is {width} x {height}, expected at most {LARGEST} texels, such as 16384 x 16384"
        ));
    }
    Ok(size)
}

/// Bytes of the texture of the file at `path` with all mip levels, by the file's header.
pub(super) fn bytes(path: &Path, srgb: bool) -> Result<u64, String> {
    let mut level = size(path)?.map(u64::from);
    let mut file = open(path)?;
    let each = if is_exr(&mut file)? {
        12
    } else {
        let decoder = reader(file)?.into_decoder().map_err(broken)?;
        match decoder.color_type() {
            ColorType::L8 => 1,
            ColorType::Rgb32F | ColorType::Rgba32F => 12,
            ColorType::L16 if !srgb => 4,
            ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 if !srgb => 12,
            _ => 4,
        }
    };
    let whole_words = |level: [u64; 2]| (level[0] * level[1] * each).next_multiple_of(4);
    let mut sum = whole_words(level);
    while level != [1, 1] {
        level = level.map(|n| (n / 2).max(1));
        sum += whole_words(level);
    }
    Ok(sum)
}

/// Decodes the file at `path`. 8-bit colours are taken to be stored with the curve of sRGB if `srgb`
/// says so; images of more bits are kept so if it does not.
pub(super) fn load(path: &Path, srgb: bool) -> Result<Base, String> {
    let [width, height] = size(path)?;
    let mut file = open(path)?;
    let mut base = if is_exr(&mut file)? {
        exr(file, [width, height])?
    } else {
        let mut reader = reader(file)?;
        // The size is one that we allow.
        reader.no_limits();
        texels(reader.decode().map_err(broken)?, srgb)?
    };
    if base.size != [width, height] {
        return Err("has another size than its header says".to_owned());
    }
    base.srgb &= matches!(base.format, TexelFormat::Rgba8 | TexelFormat::Grey8);
    Ok(base)
}

fn open(path: &Path) -> Result<BufReader<File>, String> {
    let file = File::open(path).map_err(|e| crate::scene::error::io_message(&e))?;
    Ok(BufReader::new(file))
}

fn is_exr(file: &mut BufReader<File>) -> Result<bool, String> {
    let start = file.fill_buf();
    let start = start.map_err(|e| crate::scene::error::io_message(&e))?;
    if start.is_empty() {
        return Err("is empty, expected an image".to_owned());
    }
    Ok(start.starts_with(&EXR))
}

fn reader(file: BufReader<File>) -> Result<ImageReader<BufReader<File>>, String> {
    let reader = ImageReader::new(file).with_guessed_format();
    let reader = reader.map_err(|e| crate::scene::error::io_message(&e))?;
    match reader.format() {
        Some(image::ImageFormat::Png | image::ImageFormat::Jpeg | image::ImageFormat::Hdr) => {
            Ok(reader)
        }
        Some(other) => {
            let found = other.extensions_str().first().unwrap_or(&"other");
            Err(format!(
                "is a {found} image, expected PNG, JPEG, HDR or EXR"
            ))
        }
        None => Err("is no image, expected PNG, JPEG, HDR or EXR".to_owned()),
    }
}

fn broken(error: impl std::fmt::Display) -> String {
    format!("cannot be decoded: {error}")
}

/// Rows of `width * parts` numbers, from the bottom up.
fn rows<T>(all: &[T], width: u32, parts: usize) -> impl Iterator<Item = &[T]> {
    all.chunks_exact(width as usize * parts).rev()
}

fn texels(image: DynamicImage, srgb: bool) -> Result<Base, String> {
    let size = [image.width(), image.height()];
    let base = |format, words| Base {
        size,
        format,
        srgb,
        words,
    };
    let deep = matches!(
        image,
        DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_)
    );
    Ok(match image {
        DynamicImage::ImageLuma8(grey) => {
            let mut words = vec![0; (size[0] as usize * size[1] as usize).div_ceil(4)];
            let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
            let flipped = rows(&grey, size[0], 1).flatten();
            for (to, &from) in bytes.iter_mut().zip(flipped) {
                *to = from;
            }
            // The bytes of a word from the lowest on, whatever the machine's order.
            words.iter_mut().for_each(|w| *w = u32::from_le(*w));
            base(TexelFormat::Grey8, words)
        }
        DynamicImage::ImageLuma16(grey) if !srgb => {
            let share = |&x: &u16| (f32::from(x) / 65535.0).to_bits();
            let words = rows(&grey, size[0], 1).flatten().map(share).collect();
            base(TexelFormat::Grey32, words)
        }
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            let rgb = image.into_rgb32f();
            let words = rows(&rgb, size[0], 3).flatten().map(|x| x.to_bits());
            let words: Vec<u32> = words.collect();
            finite(&words, size, 3)?;
            base(TexelFormat::Rgb32, words)
        }
        other if deep && !srgb => {
            let rgb = other.into_rgb16();
            let share = |&x: &u16| (f32::from(x) / 65535.0).to_bits();
            let words = rows(&rgb, size[0], 3).flatten().map(share).collect();
            base(TexelFormat::Rgb32, words)
        }
        other => {
            let rgba = other.into_rgba8();
            let words = rows(&rgba, size[0], 4).flat_map(|row| row.as_chunks::<4>().0);
            let words = words.map(|&bytes| u32::from_le_bytes(bytes)).collect();
            base(TexelFormat::Rgba8, words)
        }
    })
}

/// The first layer of an EXR file that has colours.
fn exr(file: BufReader<File>, size: [u32; 2]) -> Result<Base, String> {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let width = size[0] as usize;
    let texels = width * size[1] as usize;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            // A layer of another size than the first is refused below.
            move |layer, _| vec![[0f32; 3]; layer.area().min(texels)],
            move |pixels: &mut Vec<[f32; 3]>, at, (r, g, b, _): (f32, f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.y() * width + at.x()) {
                    *pixel = [r, g, b];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(file);
    let image = image.map_err(broken)?;
    let layer = image.layer_data;
    let found = [layer.size.x(), layer.size.y()];
    if found != size.map(|n| n as usize) {
        return Err("has layers of several sizes, expected one".to_owned());
    }
    let pixels = layer.channel_data.pixels;
    let rows = pixels.chunks_exact(width).rev();
    let words: Vec<u32> = rows
        .flatten()
        .flat_map(|rgb| rgb.map(f32::to_bits))
        .collect();
    finite(&words, size, 3)?;
    Ok(Base {
        size,
        format: TexelFormat::Rgb32,
        srgb: false,
        words,
    })
}

/// Refuses numbers that no picture can hold. The place is counted from the top left, as viewers do.
fn finite(words: &[u32], size: [u32; 2], parts: usize) -> Result<(), String> {
    let Some(at) = words.iter().position(|&w| !f32::from_bits(w).is_finite()) else {
        return Ok(());
    };
    let (x, y) = (at / parts % size[0] as usize, at / parts / size[0] as usize);
    Err(format!(
        "has {} in the texel in column {x}, row {}, expected finite numbers",
        f32::from_bits(words[at]),
        size[1] as usize - 1 - y
    ))
}
