//! OpenEXR: the image as linear floats, with what made it in its attributes.
//!
//! One layer, scan lines in increasing order, ZIP-compressed. Channels `R`, `G`, `B` in linear Rec.
//! 709 (stated in `chromaticities`), float or half; on request `variance.R`, `.G`, `.B` (always
//! float: variances soon fall below what half holds) and `samples` (uint). Attributes:
//! `software`, `huygens.scene`, `huygens.sceneHash` (hex), `huygens.spp` (int), `huygens.seed`
//! (double, which holds every seed), `huygens.settings` (a string as on a command line),
//! `huygens.seconds` (double). No pixel depends on an attribute.

use super::Image;
use super::output::{OutputError, write_atomically};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples,
    ImageAttributes, IntegerBounds, Layer, LayerAttributes, LineOrder, SmallVec, Text, Vec2,
    WritableImage, f16,
};
use std::collections::BTreeMap;
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

/// An EXR file as read: linear Rec. 709, pixels in scanline order from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrImage {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Colours.
    pub rgb: Vec<[f32; 3]>,
    /// Variance of each colour, if the file has it.
    pub variance: Option<Vec<[f32; 3]>>,
    /// Samples in each pixel, if the file has them.
    pub samples: Option<Vec<u32>>,
    /// Attributes that are strings or numbers, as text, by name.
    pub attributes: BTreeMap<String, String>,
}

/// Why an EXR file cannot be used.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("cannot read {path}: {problem}")]
pub struct ReadError {
    path: String,
    problem: String,
}

/// Reads the first layer of an EXR file.
///
/// # Errors
/// If there is no such file, it is not an EXR image, or it has no full channels `R`, `G` and `B`.
pub fn read_exr(path: &Path) -> Result<ExrImage, ReadError> {
    let error = |problem: String| ReadError {
        path: path.display().to_string(),
        problem,
    };
    // Opened here: the crate's own message for a missing file does not say that it is missing.
    let file = std::fs::File::open(path).map_err(|e| error(e.to_string()))?;
    let image = {
        use exr::prelude::*;
        read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_unbuffered(file)
    };
    let layer = image.map_err(|e| error(e.to_string()))?.layer_data;
    let Vec2(width, height) = layer.size;
    let channel = |name: &str| {
        let named = |c: &&AnyChannel<FlatSamples>| c.name.as_slice() == name.as_bytes();
        let found = layer.channel_data.list.iter().find(named)?;
        (found.sample_data.len() == width * height).then_some(&found.sample_data)
    };
    let triples = |names: [&str; 3]| -> Option<Vec<[f32; 3]>> {
        let mut pixels = vec![[0.0; 3]; width * height];
        for (c, name) in names.into_iter().enumerate() {
            for (pixel, value) in pixels.iter_mut().zip(channel(name)?.values_as_f32()) {
                pixel[c] = value;
            }
        }
        Some(pixels)
    };
    let samples = match channel("samples") {
        Some(FlatSamples::U32(samples)) => Some(samples.clone()),
        _ => None,
    };
    Ok(ExrImage {
        width: width as u32,
        height: height as u32,
        rgb: triples(["R", "G", "B"])
            .ok_or_else(|| error("it has no channels R, G and B of full size".into()))?,
        variance: triples(VARIANCE),
        samples,
        attributes: readable(&layer.attributes),
    })
}

fn readable(attributes: &LayerAttributes) -> BTreeMap<String, String> {
    let utf8 = |t: &Text| String::from_utf8_lossy(t.as_slice()).into_owned();
    let other = attributes.other.iter().filter_map(|(name, value)| {
        let value = match value {
            AttributeValue::Text(t) => utf8(t),
            AttributeValue::F64(v) => v.to_string(),
            AttributeValue::F32(v) => v.to_string(),
            AttributeValue::I32(v) => v.to_string(),
            _ => return None,
        };
        Some((utf8(name), value))
    });
    let software = attributes.software_name.as_ref();
    let software = software.map(|t| ("software".to_owned(), utf8(t)));
    other.chain(software).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 37 x 21 pixels, so that the last block of 16 lines is not full.
    fn image() -> Image {
        let n = 37 * 21;
        let value = |i: usize, c: usize| (i * 3 + c) as f32 * 0.37e-3;
        Image {
            width: 37,
            height: 21,
            mean: (0..n).map(|i| [0, 1, 2].map(|c| value(i, c))).collect(),
            variance: (0..n)
                .map(|i| [0, 1, 2].map(|c| value(i, c) * 1e-9))
                .collect(),
            samples: (0..n as u32).collect(),
        }
    }

    fn metadata() -> Metadata {
        Metadata {
            scene: "Größe 日本".into(),
            scene_hash: [0xab; 32],
            spp: 64,
            seed: u32::MAX,
            settings: "--integrator path".into(),
            seconds: 1.25,
        }
    }

    fn round_trip(image: &Image, metadata: &Metadata, options: ExrOptions) -> (ExrImage, usize) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.exr");
        let cut = write_exr(&path, image, metadata, options).expect("written");
        (read_exr(&path).expect("read"), cut)
    }

    #[test]
    fn floats_come_back_to_the_bit() {
        let options = ExrOptions {
            variance: true,
            ..ExrOptions::default()
        };
        let (read, cut) = round_trip(&image(), &metadata(), options);
        assert_eq!((read.width, read.height, cut), (37, 21, 0));
        assert!(read.rgb == image().mean);
        assert!(read.variance.expect("asked for") == image().variance);
        assert!(read.samples.expect("asked for") == image().samples);
    }

    #[test]
    fn variance_is_left_out_unless_asked_for() {
        let (read, _) = round_trip(&image(), &metadata(), ExrOptions::default());
        assert_eq!((read.variance, read.samples), (None, None));
    }

    #[test]
    fn halves_are_the_nearest_and_overflow_is_counted() {
        let mut image = image();
        image.mean[5] = [1e6, -1e6, 65_504.0];
        let options = ExrOptions {
            half: true,
            ..ExrOptions::default()
        };
        let (read, cut) = round_trip(&image, &metadata(), options);
        assert_eq!((read.rgb[5], cut), ([65_504.0, -65_504.0, 65_504.0], 2));
        for (half, full) in read.rgb.iter().flatten().zip(image.mean.iter().flatten()) {
            if full.abs() <= 65_504.0 {
                // Eleven significant bits, or 2^-25 below the normal range.
                let bound = (full.abs() * f32::powi(2.0, -11)).max(f32::powi(2.0, -25));
                assert!((half - full).abs() <= bound, "{half} for {full}");
            }
        }
    }

    #[test]
    fn attributes_come_back_and_no_pixel_depends_on_them() {
        let (read, _) = round_trip(&image(), &metadata(), ExrOptions::default());
        let expected = [
            ("huygens.scene", "Größe 日本"),
            ("huygens.sceneHash", &"ab".repeat(32)),
            ("huygens.seconds", "1.25"),
            ("huygens.seed", "4294967295"),
            ("huygens.settings", "--integrator path"),
            ("huygens.spp", "64"),
            ("software", concat!("huygens ", env!("CARGO_PKG_VERSION"))),
        ];
        let found: Vec<(&str, &str)> = read
            .attributes
            .iter()
            .map(|(name, value)| (name.as_str(), value.as_str()))
            .collect();
        assert_eq!(found, expected);
        let (other, _) = round_trip(&image(), &Metadata::default(), ExrOptions::default());
        assert!(other.rgb == read.rgb);
    }

    #[test]
    fn what_is_no_exr_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.exr");
        let missing = read_exr(&path).expect_err("missing").to_string();
        let place = path.display();
        let expected = format!("cannot read {place}: No such file or directory (os error 2)");
        assert_eq!(missing, expected);
        std::fs::write(&path, "P6 1 1 255").expect("written");
        assert!(read_exr(&path).is_err());
    }
}
