//! OpenEXR: the image as linear floats, with what made it in its attributes.
//!
//! One layer, scan lines in increasing order, ZIP-compressed. Channels `R`, `G`, `B` in linear Rec.
//! 709 (stated in `chromaticities`), float or half; on request `variance.R`, `.G`, `.B` (always
//! float: variances soon fall below what half holds) and `samples` (uint). Attributes:
//! `software`, `huygens.scene`, `huygens.sceneHash` (hex), `huygens.spp` (int), `huygens.seed`
//! (double, which holds every seed), `huygens.settings` (a string as on a command line),
//! `huygens.seconds` (double). No pixel depends on an attribute.

mod read;
#[cfg(test)]
mod tests;

pub use read::{ExrImage, ReadError, read_exr};

use super::Image;
use super::output::{OutputError, write_atomically};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples,
    ImageAttributes, IntegerBounds, Layer, LayerAttributes, LineOrder, SmallVec, Text, Vec2,
    WritableImage, f16,
};
use std::path::Path;

/// What made an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// The scene's name.
    pub scene: String,
    /// The scene's hash.
    pub scene_hash: [u8; 32],
    /// Samples a pixel asked for. Stored as a signed 32-bit number, cut at its end.
    pub spp: u32,
    /// Seed of the random numbers.
    pub seed: u32,
    /// All settings that the image depends on, readable.
    pub settings: String,
    /// Wall-clock seconds of rendering.
    pub seconds: f64,
}

/// What an EXR file holds besides its colours, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExrOptions {
    /// Store colours as half floats.
    pub half: bool,
    /// Add the variance of the mean, and the number of samples.
    pub variance: bool,
}

/// Writes `image` to an EXR file at `path`, atomically. Returns the number of values that half
/// floats cannot hold and that were stored as the largest that they can, 65504.
///
/// # Errors
/// If the file cannot be written.
pub fn write_exr(
    path: &Path,
    image: &Image,
    metadata: &Metadata,
    options: ExrOptions,
) -> Result<usize, OutputError> {
    let mut channels = SmallVec::new();
    let mut cut = 0;
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        let column = image.mean.iter().map(|p| p[c]);
        let samples = if options.half {
            FlatSamples::F16(column.map(|v| to_half(v, &mut cut)).collect())
        } else {
            FlatSamples::F32(column.collect())
        };
        channels.push(AnyChannel::new(name, samples));
    }
    if options.variance {
        for (c, name) in VARIANCE.into_iter().enumerate() {
            let column = image.variance.iter().map(|p| p[c]).collect();
            channels.push(AnyChannel::new(name, FlatSamples::F32(column)));
        }
        let samples = FlatSamples::U32(image.samples.clone());
        channels.push(AnyChannel::new("samples", samples));
    }
    let size = Vec2(image.width as usize, image.height as usize);
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let own = layer_attributes(metadata);
    let layer = Layer::new(size, own, encoding, AnyChannels::sort(channels));
    let mut attributes = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    attributes.chromaticities = Some(rec709());
    let file = exr::prelude::Image {
        attributes,
        layer_data: layer,
    };
    write_atomically(path, |writer| file.write().to_buffered(writer))?;
    Ok(cut)
}

const VARIANCE: [&str; 3] = ["variance.R", "variance.G", "variance.B"];

fn to_half(value: f32, cut: &mut usize) -> f16 {
    let half = f16::from_f32(value);
    if half.is_finite() {
        return half;
    }
    *cut += 1;
    if value < 0.0 { f16::MIN } else { f16::MAX }
}

/// ITU-R BT.709: primaries and white point D65.
fn rec709() -> exr::meta::attribute::Chromaticities {
    exr::meta::attribute::Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.30, 0.60),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.3290),
    }
}

fn layer_attributes(metadata: &Metadata) -> LayerAttributes {
    let hash = blake3::Hash::from_bytes(metadata.scene_hash);
    let spp = i32::try_from(metadata.spp).unwrap_or(i32::MAX);
    let mut attributes = LayerAttributes {
        software_name: Some(text(concat!("huygens ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    for (name, value) in [
        ("huygens.scene", AttributeValue::Text(text(&metadata.scene))),
        (
            "huygens.sceneHash",
            AttributeValue::Text(text(&hash.to_hex())),
        ),
        ("huygens.spp", AttributeValue::I32(spp)),
        ("huygens.seed", AttributeValue::F64(metadata.seed.into())),
        (
            "huygens.settings",
            AttributeValue::Text(text(&metadata.settings)),
        ),
        ("huygens.seconds", AttributeValue::F64(metadata.seconds)),
    ] {
        attributes.other.insert(text(name), value);
    }
    attributes
}

/// OpenEXR's strings are bytes; ours are UTF-8. (The crate's own conversion panics beyond Latin-1.)
fn text(string: &str) -> Text {
    Text::from_bytes_unchecked(SmallVec::from_slice(string.as_bytes()))
}
