//! From the film's sums to an image.

use super::{Film, PixelSums, Tile};

/// A developed film: linear Rec. 709, pixels in scanline order from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Mean of each pixel's samples; black where there are none.
    pub mean: Vec<[f32; 3]>,
    /// Estimated variance of that mean: the unbiased sample variance over the number of samples,
    /// as if samples were independent. Those of every sampler but the independent one complete each
    /// other: the true variance is smaller then, as a rule. Infinite below two samples, where nothing is known of it.
    ///
    /// It is a difference of two sums in f64, so a true variance below about `2^-52 n mean^2` is
    /// lost in their rounding; it is never negative.
    pub variance: Vec<[f32; 3]>,
    /// Samples in each pixel.
    pub samples: Vec<u32>,
}

impl Film {
    /// The means of a tile's pixels, in scanline order, if all samples below the index `samples` are on
    /// the film. Samples that were left out do not count.
    #[must_use]
    pub fn means(&self, tile: usize, samples: u32) -> Option<Vec<[f64; 3]>> {
        let sums = self.exposures[tile]
            .sums
            .lock()
            .expect("no commit panicked");
        let mean = |p: &PixelSums| p.value.map(|v| v / f64::from(p.count.max(1)));
        (sums.next_sample >= samples).then(|| sums.pixels.iter().map(mean).collect())
    }

    /// The image that the samples so far make.
    #[must_use]
    pub fn develop(&self) -> Image {
        let pixels = self.width as usize * self.height as usize;
        let mut image = Image {
            width: self.width,
            height: self.height,
            mean: vec![[0.0; 3]; pixels],
            variance: vec![[f32::INFINITY; 3]; pixels],
            samples: vec![0; pixels],
        };
        for (tile, exposure) in self.tiles.iter().zip(&self.exposures) {
            let sums = exposure.sums.lock().expect("no commit panicked");
            for (at, pixel) in sums.pixels.iter().enumerate() {
                image.put(tile, at, pixel);
            }
        }
        image
    }
}

impl Image {
    /// Memory of an image for each pixel, in bytes.
    pub const BYTES_PER_PIXEL: usize = 2 * size_of::<[f32; 3]>() + size_of::<u32>();

    /// Mean number of samples a pixel.
    #[must_use]
    pub fn mean_samples(&self) -> f64 {
        let all: u64 = self.samples.iter().map(|&n| u64::from(n)).sum();
        all as f64 / self.samples.len().max(1) as f64
    }

    fn put(&mut self, tile: &Tile, at: usize, pixel: &PixelSums) {
        let (x, y) = (at as u32 % tile.width, at as u32 / tile.width);
        let i = (tile.y + y) as usize * self.width as usize + (tile.x + x) as usize;
        self.samples[i] = pixel.count;
        for channel in 0..3 {
            let (mean, variance) =
                mean_and_variance(pixel.value[channel], pixel.square[channel], pixel.count);
            self.mean[i][channel] = mean as f32;
            self.variance[i][channel] = variance as f32;
        }
    }
}

/// The mean, and the variance of that mean, of `count` values with this sum and sum of squares.
fn mean_and_variance(sum: f64, square: f64, count: u32) -> (f64, f64) {
    if count == 0 {
        return (0.0, f64::INFINITY);
    }
    let n = f64::from(count);
    let mean = sum / n;
    if count == 1 {
        return (mean, f64::INFINITY);
    }
    let of_sample = (square - sum * mean).max(0.0) / (n - 1.0);
    (mean, of_sample / n)
}
