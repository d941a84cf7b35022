//! How far an image is from a reference.

use crate::estimate::normal_quantile;
use crate::film::Image;
use crate::film::exr::ExrImage;
use serde::Serialize;

/// Share of the pixels, those with the largest relative error, that [`Difference::rel_mse`] leaves
/// out: one in this many.
pub const TRIM: usize = 1000;

/// Level of the intervals of the bias.
const LEVEL: f64 = super::LEVEL;

/// An image to compare: pixels in scanline order, linear Rec. 709.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Colours.
    pub rgb: &'a [[f32; 3]],
    /// Variance of each colour, if known; infinite or NaN where it is not.
    pub variance: Option<&'a [[f32; 3]]>,
}

impl<'a> From<&'a ExrImage> for Picture<'a> {
    fn from(image: &'a ExrImage) -> Self {
        Self {
            width: image.width,
            height: image.height,
            rgb: &image.rgb,
            variance: image.variance.as_deref(),
        }
    }
}

impl<'a> From<&'a Image> for Picture<'a> {
    fn from(image: &'a Image) -> Self {
        Self {
            width: image.width,
            height: image.height,
            rgb: &image.mean,
            variance: Some(&image.variance),
        }
    }
}

/// Measures of the difference of an image `a` from a reference `b`, over the pixels that are finite
/// in both. Means are over pixels and channels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Pixels compared.
    pub pixels: usize,
    /// Pixels left out, because a channel of either image is not finite.
    pub left_out: usize,
    /// Mean of `(a - b)^2`.
    pub mse: f64,
    /// Its square root.
    pub rmse: f64,
    /// Mean of `(a - b)^2 / (b^2 + m^2 / 100)`, where `m` is the mean of `|b|`: without the one pixel
    /// in [`TRIM`] that has the largest. Unknown if `b` is black.
    pub rel_mse: Option<f64>,
    /// The same over all pixels.
    pub rel_mse_all: Option<f64>,
    /// Mean of `|a - b|`.
    pub mae: f64,
    /// Where `|a - b|` is largest.
    pub max: Largest,
    /// Mean of `a - b` of each channel.
    pub bias: [f64; 3],
    /// What holds the expectation of that mean with probability 0.95, if the images' noise is known:
    /// pixels and images are taken as independent of each other.
    pub bias_interval: Option<[[f64; 2]; 3]>,
    /// The MSE that the noise of both images alone would give, if known: the mean of their variances.
    /// `mse - noise` estimates the mean squared difference of what they converge to.
    pub noise: Option<f64>,
    /// Whose noise is known, and counted in `bias_interval` and `noise`; of the other image it is
    /// taken to be 0.
    pub noise_of: NoiseOf,
}

/// Whose noise is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum NoiseOf {
    /// Neither's.
    None,
    /// The image's.
    Image,
    /// The reference's.
    Reference,
    /// Both.
    Both,
}

/// The largest difference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Largest {
    /// `|a - b|`.
    pub value: f64,
    /// Its pixel, from the left.
    pub x: u32,
    /// And from the top.
    pub y: u32,
}

/// Why two images cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DifferenceError {
    /// They are not of one size.
    #[error("the image has {0} x {1} pixels, the reference {2} x {3}; expected one size")]
    Size(u32, u32, u32, u32),
    /// Nothing is left to compare.
    #[error("no pixel is finite in both images")]
    NoPixel,
}

/// Measures the difference of `image` from `reference`.
///
/// # Errors
/// If they are not of one size, or no pixel is finite in both.
///
/// # Panics
/// If a picture's slices do not have its size.
pub fn difference(image: Picture, reference: Picture) -> Result<Difference, DifferenceError> {
    let errors = pixel_errors(image, reference)?;
    let finite: Vec<usize> = (0..errors.len()).filter(|&i| errors[i].is_some()).collect();
    if finite.is_empty() {
        return Err(DifferenceError::NoPixel);
    }
    let n = finite.len() as f64;
    let error = |i: usize, c: usize| f64::from(image.rgb[i][c]) - f64::from(reference.rgb[i][c]);
    let mean = |of: &dyn Fn(usize, usize) -> f64| -> [f64; 3] {
        [0, 1, 2].map(|c| finite.iter().map(|&i| of(i, c)).sum::<f64>() / n)
    };
    let overall = |channels: [f64; 3]| channels.iter().sum::<f64>() / 3.0;

    let mse = overall(mean(&|i, c| error(i, c).powi(2)));
    let bias = mean(&error);
    let (noise, noise_of) = noise(image, reference, &finite);
    // The variance of a mean over n pixels is the mean of their variances over n.
    let half = -normal_quantile(0.5 * (1.0 - LEVEL));
    let bias_interval = noise.map(|variance| {
        [0, 1, 2].map(|c| {
            let half = half * (variance[c] / n).sqrt();
            [bias[c] - half, bias[c] + half]
        })
    });
    let brightness = overall(mean(&|i, c| f64::from(reference.rgb[i][c]).abs()));
    let relative = (brightness > 0.0).then(|| {
        let floor = floor(brightness);
        let of = |i: usize, c: usize| {
            error(i, c).powi(2) / (f64::from(reference.rgb[i][c]).powi(2) + floor)
        };
        let pixel = |&i: &usize| overall([of(i, 0), of(i, 1), of(i, 2)]);
        finite.iter().map(pixel).collect::<Vec<f64>>()
    });
    Ok(Difference {
        pixels: finite.len(),
        left_out: errors.len() - finite.len(),
        mse,
        rmse: mse.sqrt(),
        rel_mse: relative.clone().map(trimmed_mean),
        rel_mse_all: relative.map(|r| r.iter().sum::<f64>() / n),
        mae: overall(mean(&|i, c| error(i, c).abs())),
        max: largest(&finite, image.width, error),
        bias,
        bias_interval,
        noise: noise.map(overall),
        noise_of,
    })
}

/// What is added to a squared reference before a squared error is divided by it, from the mean
/// `brightness` of the reference: it keeps black pixels from dividing by nothing.
pub(super) fn floor(brightness: f64) -> f64 {
    0.01 * brightness * brightness
}

/// The mean over the channels of `|a - b|` of each pixel, in scanline order; none where either image
/// is not finite.
///
/// # Errors
/// If the images are not of one size.
///
/// # Panics
/// If a picture's slices do not have its size.
pub fn pixel_errors(
    image: Picture,
    reference: Picture,
) -> Result<Vec<Option<f64>>, DifferenceError> {
    let (a, b) = (image, reference);
    if (a.width, a.height) != (b.width, b.height) {
        return Err(DifferenceError::Size(a.width, a.height, b.width, b.height));
    }
    for picture in [a, b] {
        let pixels = picture.width as usize * picture.height as usize;
        assert_eq!(picture.rgb.len(), pixels);
        assert!(picture.variance.is_none_or(|v| v.len() == pixels));
    }
    let finite = |p: &[f32; 3]| p.iter().all(|v| v.is_finite());
    let pixel = |(a, b): (&[f32; 3], &[f32; 3])| {
        let error = |c: usize| (f64::from(a[c]) - f64::from(b[c])).abs();
        (finite(a) && finite(b)).then(|| (error(0) + error(1) + error(2)) / 3.0)
    };
    Ok(a.rgb.iter().zip(b.rgb).map(pixel).collect())
}

/// The mean variance of each channel's difference, as far as known.
fn noise(a: Picture, b: Picture, finite: &[usize]) -> (Option<[f64; 3]>, NoiseOf) {
    let of = |picture: Picture| {
        let variance = picture.variance?;
        let mean = [0, 1, 2].map(|c| {
            let column = finite.iter().map(|&i| f64::from(variance[i][c]));
            column.sum::<f64>() / finite.len() as f64
        });
        mean.iter().all(|v| v.is_finite()).then_some(mean)
    };
    match (of(a), of(b)) {
        (None, None) => (None, NoiseOf::None),
        (a, None) => (a, NoiseOf::Image),
        (None, b) => (b, NoiseOf::Reference),
        (Some(a), Some(b)) => (Some([0, 1, 2].map(|c| a[c] + b[c])), NoiseOf::Both),
    }
}

/// The mean without the largest of every [`TRIM`].
fn trimmed_mean(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let kept = values.len() - values.len() / TRIM;
    values[..kept].iter().sum::<f64>() / kept as f64
}

fn largest(finite: &[usize], width: u32, error: impl Fn(usize, usize) -> f64) -> Largest {
    let pixel = |&i: &usize| {
        let value = (0..3).map(|c| error(i, c).abs()).fold(0.0, f64::max);
        (value, i)
    };
    // The first of several.
    let later = |best: (f64, usize), next: (f64, usize)| if next.0 > best.0 { next } else { best };
    let (value, i) = finite.iter().map(pixel).reduce(later).unwrap_or((0.0, 0));
    Largest {
        value,
        x: (i % width as usize) as u32,
        y: (i / width as usize) as u32,
    }
}

#[cfg(test)]
mod tests;
