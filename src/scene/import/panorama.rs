//! Images of radiance: OpenEXR and Radiance HDR files.

use crate::scene::error::{SceneError, io_message};
use std::path::Path;

/// An image of finite, non-negative numbers.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct Pixels {
    pub(in crate::scene) width: u32,
    pub(in crate::scene) height: u32,
    /// By rows from the top.
    pub(in crate::scene) rgb: Vec<[f32; 3]>,
}

/// The formats that hold radiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Exr,
    Hdr,
}

/// The largest edge of an image.
const LARGEST: usize = 65_535;

impl Format {
    fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        match extension.to_str()?.to_ascii_lowercase().as_str() {
            "exr" => Some(Self::Exr),
            "hdr" | "pic" => Some(Self::Hdr),
            _ => None,
        }
    }
}

/// What is wrong with a file's name, without a look at its pixels: nothing, if it could hold radiance.
pub(in crate::scene) fn check(path: &Path) -> Result<(), String> {
    if Format::of(path).is_none() {
        return Err(format!(
            "{}: expected an .exr or .hdr file: a map holds radiance, not display colours",
            path.display()
        ));
    }
    match std::fs::File::open(path).and_then(|f| f.metadata()) {
        Ok(found) if found.is_dir() => {
            Err(format!("{}: is a folder, expected a file", path.display()))
        }
        Ok(_) => Ok(()),
        Err(e) => Err(format!("{}: {}", path.display(), io_message(&e))),
    }
}

/// Reads the image at `path`.
///
/// # Errors
/// If it is no such image, or holds a number that is negative or not finite.
pub(in crate::scene) fn load(path: &Path) -> Result<Pixels, SceneError> {
    let wrong = |message: String| SceneError::file(path, message);
    let pixels = match Format::of(path) {
        Some(Format::Exr) => exr(path).map_err(wrong)?,
        _ => hdr(path).map_err(wrong)?,
    };
    let fits = |n: u32| (1..=LARGEST).contains(&(n as usize));
    if !fits(pixels.width) || !fits(pixels.height) {
        return Err(wrong(format!(
            "is {} x {} pixels, expected 1 to {LARGEST} each way",
            pixels.width, pixels.height
        )));
    }
    let bad = |p: &[f32; 3]| !p.iter().all(|&c| (0.0..=f32::MAX).contains(&c));
    if let Some(at) = pixels.rgb.iter().position(bad) {
        let [r, g, b] = pixels.rgb[at];
        let (x, y) = (at % pixels.width as usize, at / pixels.width as usize);
        return Err(wrong(format!(
            "pixel ({x}, {y}) from the top left is [{r}, {g}, {b}], expected finite numbers of at \
             least 0"
        )));
    }
    Ok(pixels)
}

fn exr(path: &Path) -> Result<Pixels, String> {
    use exr::prelude::*;
    // Two columns a row: the crate asks for a function that makes room and one that fills it.
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.0, vec![[0.0f32; 3]; size.area()]),
            |(width, pixels): &mut (usize, Vec<[f32; 3]>), at, (r, g, b): (f32, f32, f32)| {
                pixels[at.1 * *width + at.0] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|e| format!("is no EXR image of channels R, G and B: {e}"))?;
    let layer = image.layer_data;
    Ok(Pixels {
        width: layer.size.0 as u32,
        height: layer.size.1 as u32,
        rgb: layer.channel_data.pixels.1,
    })
}

fn hdr(path: &Path) -> Result<Pixels, String> {
    let file = std::fs::File::open(path).map_err(|e| io_message(&e))?;
    let reader = std::io::BufReader::new(file);
    let image = image::load(reader, image::ImageFormat::Hdr)
        .map_err(|e| format!("is no Radiance HDR image: {e}"))?
        .into_rgb32f();
    let (width, height) = image.dimensions();
    let (rgb, _) = image.as_raw().as_chunks::<3>();
    Ok(Pixels {
        width,
        height,
        rgb: rgb.to_vec(),
    })
}
