//! Writes the images of scenes/textures.toml into a folder:
//!
//! ```text
//! cargo run --release --example make_textures -- scenes/textures
//! ```
//!
//! Tiles with their normals and roughness, leaves to be cut out, a window of coloured glass, and a
//! screen that shines. All of them repeat. The same files every time.

use image::{GrayImage, ImageBuffer, Luma, Rgb, RgbImage, Rgba, RgbaImage};
use std::path::Path;

const SIZE: u32 = 256;
const TILES: f64 = 4.0;

/// A number in [0, 1) for two whole ones (the finalizer of SplitMix64).
fn noise(x: i64, y: i64) -> f64 {
    let mut z = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (y as u64).wrapping_mul(0xd1b5_4a32_d192_ed03);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn byte(x: f64) -> u8 {
    (255.0 * x.clamp(0.0, 1.0)).round() as u8
}

/// Height of the tiles at (u, v): flat, with rounded edges before a joint.
fn height(u: f64, v: f64) -> f64 {
    let edge = |x: f64| {
        let within = (TILES * x).rem_euclid(1.0);
        (within.min(1.0 - within) / 0.06).min(1.0)
    };
    let e = edge(u) * edge(v);
    1.0 - (1.0 - e).powi(2)
}

/// The tile at (u, v).
fn tile(u: f64, v: f64) -> (i64, i64) {
    let wrap = |x: f64| (TILES * x).floor().rem_euclid(TILES) as i64;
    (wrap(u), wrap(v))
}

fn image_of<P: image::Pixel>(f: impl Fn(f64, f64) -> P) -> ImageBuffer<P, Vec<P::Subpixel>> {
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(SIZE);
    ImageBuffer::from_fn(SIZE, SIZE, |x, y| f(at(x), 1.0 - at(y)))
}

fn tiles() -> RgbImage {
    image_of(|u, v| {
        let (i, j) = tile(u, v);
        let warm = noise(i, j);
        let grain = 0.05 * noise((u * 256.0) as i64 + 9000, (v * 256.0) as i64);
        let joint = height(u, v) < 0.3;
        let colour = match ((i + j) % 2, joint) {
            (_, true) => [0.35, 0.33, 0.3],
            (0, _) => [0.72 + 0.12 * warm, 0.5 + 0.1 * warm, 0.36],
            _ => [0.24 + 0.1 * warm, 0.36, 0.42 + 0.1 * warm],
        };
        Rgb(colour.map(|c| byte(c + grain)))
    })
}

fn normals() -> RgbImage {
    let step = 1.0 / f64::from(SIZE);
    image_of(|u, v| {
        let slope = |du, dv| height(u + du, v + dv) - height(u - du, v - dv);
        let n = [-0.5 * slope(step, 0.0), -0.5 * slope(0.0, step), 0.15];
        let length = n.iter().map(|c| c * c).sum::<f64>().sqrt();
        Rgb(n.map(|c| byte(0.5 + 0.5 * c / length)))
    })
}

fn roughness() -> GrayImage {
    image_of(|u, v| {
        let (i, j) = tile(u, v);
        let joint = height(u, v) < 0.3;
        Luma([byte(if joint {
            0.9
        } else {
            0.15 + 0.35 * noise(i + 77, j)
        })])
    })
}

/// A leaf to a cell of 4 by 4, each of its own size and green.
fn leaves() -> RgbaImage {
    image_of(|u, v| {
        let (i, j) = tile(u, v);
        let (x, y) = (
            (TILES * u).rem_euclid(1.0) - 0.5,
            (TILES * v).rem_euclid(1.0) - 0.5,
        );
        let half = (0.25 - y * y).max(0.0) * (0.7 + 0.5 * noise(i, j + 50));
        let there = x.abs() < half && x.abs() + y.abs() < 0.49;
        let vein = x.abs() < 0.012 || ((y - x.abs()) * 9.0).rem_euclid(1.0) < 0.08;
        let green = 0.45 + 0.3 * noise(i + 5, j) - if vein { 0.12 } else { 0.0 };
        Rgba([
            byte(0.6 * green),
            byte(green),
            byte(0.15),
            if there { 255 } else { 0 },
        ])
    })
}

/// Panes of coloured glass in lead: the colour, and how much of it is there.
fn glass() -> RgbaImage {
    image_of(|u, v| {
        let (i, j) = tile(u, v);
        let lead = height(u, v) < 0.7;
        let hue = noise(i + 31, j + 13) * 3.0;
        let colour = [0.0, 1.0, 2.0]
            .map(|k: f64| (1.2 - (hue - k).abs().min(3.0 - (hue - k).abs())).max(0.05));
        match lead {
            true => Rgba([20, 20, 22, 255]),
            false => {
                let [r, g, b] = colour.map(byte);
                Rgba([r, g, b, 90])
            }
        }
    })
}

/// Rows of lit letters, or what looks like them from afar.
fn screen() -> RgbImage {
    image_of(|u, v| {
        let (column, row) = ((u * 24.0) as i64, (v * 12.0) as i64);
        let inside = (v * 12.0).fract() > 0.35 && (u * 24.0).fract() > 0.2;
        let lit = inside && noise(column / 2, row) > 0.3 && noise(column, row + 400) > 0.25;
        Rgb(match (lit, row % 4) {
            (false, _) => [2, 4, 6],
            (true, 0) => [255, 170, 60],
            (true, _) => [80, 220, 255],
        })
    })
}

fn main() -> Result<(), image::ImageError> {
    let Some(folder) = std::env::args().nth(1) else {
        eprintln!("usage: make_textures FOLDER");
        std::process::exit(2);
    };
    let at = |name: &str| Path::new(&folder).join(name);
    tiles().save(at("tiles.png"))?;
    normals().save(at("tiles-normal.png"))?;
    roughness().save(at("tiles-rough.png"))?;
    leaves().save(at("leaves.png"))?;
    glass().save(at("glass.png"))?;
    screen().save(at("screen.png"))
}
