//! The unit of work: a tile of pixels times a range of samples, and the buffer that it fills.

use huygens_kernels::cost::Cost;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Left edge.
    pub x: u32,
    /// Top edge.
    pub y: u32,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl Tile {
    /// Number of pixels.
    #[must_use]
    pub fn pixels(&self) -> u32 {
        self.width * self.height
    }
}

/// A tile of pixels times a range of sample indices.
///
/// Its camera samples are numbered by *slot*: `slot = pixel_in_tile * samples + (sample -
/// first_sample)`, pixels of the tile in scanline order.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// Index of the tile in the film.
    pub tile_index: usize,
    /// The tile.
    pub tile: Tile,
    /// First sample index.
    pub first_sample: u32,
    /// Number of sample indices.
    pub samples: u32,
}

impl Job {
    /// Number of camera samples.
    #[must_use]
    pub fn slots(&self) -> usize {
        self.tile.pixels() as usize * self.samples as usize
    }

    /// The camera sample in `slot`: (x, y, sample index).
    #[must_use]
    pub fn sample_of(&self, slot: u32) -> (u32, u32, u32) {
        let pixel = slot / self.samples;
        (
            self.tile.x + pixel % self.tile.width,
            self.tile.y + pixel / self.tile.width,
            self.first_sample + slot % self.samples,
        )
    }
}

/// Radiance of each camera sample of a job, by slot. Allocated once a worker.
#[derive(Clone, Debug, Default)]
pub struct SampleBuffer {
    /// Red, green and blue columns.
    pub radiance: [Vec<f32>; 3],
}

impl SampleBuffer {
    /// Bytes that putting a sample on the film takes: its radiance, the pixel's sums, and making it
    /// black again.
    pub(crate) const COST: Cost = Cost::new(
        12 + super::Film::BYTES_PER_PIXEL,
        12 + super::Film::BYTES_PER_PIXEL,
    );

    /// Room for `slots` samples, all black.
    #[must_use]
    pub fn new(slots: usize) -> Self {
        Self {
            radiance: std::array::from_fn(|_| vec![0.0; slots]),
        }
    }

    /// The columns, as kernels take them.
    pub fn columns(&mut self) -> [&mut [f32]; 3] {
        self.radiance.each_mut().map(Vec::as_mut_slice)
    }

    /// Makes the first `slots` samples black again.
    pub fn clear(&mut self, slots: usize) {
        for column in &mut self.radiance {
            column[..slots].fill(0.0);
        }
    }
}
