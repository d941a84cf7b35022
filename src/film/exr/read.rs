//! Reading EXR files, ours and others'.

use super::VARIANCE;
use exr::prelude::{AnyChannel, AttributeValue, FlatSamples, LayerAttributes, Text, Vec2};
use std::collections::BTreeMap;
use std::path::Path;

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
