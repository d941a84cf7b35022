//! The film: sums of samples and of their squares, a pixel at a time, in sample order.
//!
//! Every sum is in f64 and every pixel adds its samples one by one in the order of their index, so
//! the film is a function of the samples alone: bit-identical for any tiling, any split of the
//! samples into jobs and any number of workers.
//!
//! A tile of the film is one lock. Jobs of the same tile take turns by sample index; jobs of
//! different tiles never meet.

mod develop;
pub mod exr;
pub mod filter;
mod job;
pub mod output;
pub mod png;
pub mod tone;

pub use develop::Image;
pub use job::{Job, SampleBuffer, Tile};

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex};
use std::time::Duration;

/// How long a waiting commit sleeps before it looks at the stop flag again. Whoever raises the flag
/// does not know who waits, so this is also the longest that a wait outlives it.
const STOP_POLL: Duration = Duration::from_millis(10);

/// An image under exposure. Shared by all workers.
#[derive(Debug)]
pub struct Film {
    width: u32,
    height: u32,
    tiles: Vec<Tile>,
    exposures: Vec<Exposure>,
}

/// One tile's sums, and the queue of those who want to add to them.
#[derive(Debug)]
struct Exposure {
    sums: Mutex<TileSums>,
    /// Signalled whenever `TileSums::next_sample` grows.
    turn: Condvar,
}

#[derive(Debug)]
struct TileSums {
    /// All samples below this index are in.
    next_sample: u32,
    /// Pixels of the tile in scanline order.
    pixels: Vec<PixelSums>,
}

/// What a pixel remembers of its samples.
#[derive(Clone, Copy, Debug, Default)]
struct PixelSums {
    value: [f64; 3],
    /// Sum of squares. The square of an f32 is exact in f64.
    square: [f64; 3],
    count: u32,
}

impl Film {
    /// Memory of the film for each pixel, in bytes.
    pub const BYTES_PER_PIXEL: usize = size_of::<PixelSums>();

    /// An unexposed film of `width` by `height` pixels, kept in tiles of `tile` by `tile`; those at
    /// the right and lower edges are cut to the image.
    ///
    /// # Panics
    /// If `tile` is 0.
    #[must_use]
    pub fn new(width: u32, height: u32, tile: u32) -> Self {
        assert!(tile > 0, "a tile has pixels");
        let step = tile as usize;
        let tiles: Vec<Tile> = (0..height)
            .step_by(step)
            .flat_map(|y| (0..width).step_by(step).map(move |x| (x, y)))
            .map(|(x, y)| Tile {
                x,
                y,
                width: tile.min(width - x),
                height: tile.min(height - y),
            })
            .collect();
        Self::of_tiles(width, height, tiles)
    }

    /// An unexposed film of `width` by `height` pixels, of which only these tiles are there: the rest
    /// stays black. They lie on the film, and apart.
    #[must_use]
    pub fn of_tiles(width: u32, height: u32, tiles: Vec<Tile>) -> Self {
        let exposures = tiles.iter().map(Exposure::new).collect();
        Self {
            width,
            height,
            tiles,
            exposures,
        }
    }

    /// Pixels across and down.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The film's tiles, in scanline order; a [`Job`] names one by its index.
    #[must_use]
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// Samples on the film, those left out not counted.
    #[must_use]
    pub fn samples(&self) -> u64 {
        let tile = |e: &Exposure| -> u64 {
            let sums = e.sums.lock().expect("no commit panicked");
            sums.pixels.iter().map(|p| u64::from(p.count)).sum()
        };
        self.exposures.iter().map(tile).sum()
    }

    /// Adds a finished job's samples, each pixel's in sample order after all earlier ones of that
    /// pixel: blocks until the jobs of the same tile with smaller samples are in, so jobs must be
    /// started in order. Returns without adding if `stop` is raised while it waits; a job whose turn
    /// has come is added even then. Samples that are not finite in all channels are left out (and out
    /// of the pixel's count), and returned: (x, y, sample).
    ///
    /// # Panics
    /// If the job does not belong to this film, its buffer is too short, or one of its samples is on
    /// the film already.
    pub fn commit(
        &self,
        job: &Job,
        samples: &SampleBuffer,
        stop: &AtomicBool,
    ) -> Vec<(u32, u32, u32)> {
        assert_eq!(
            self.tiles[job.tile_index], job.tile,
            "the job's tile is not this film's"
        );
        let radiance = samples.radiance.each_ref().map(|c| &c[..job.slots()]);
        let exposure = &self.exposures[job.tile_index];
        let mut sums = exposure.sums.lock().expect("no commit panicked");
        while sums.next_sample != job.first_sample {
            assert!(
                sums.next_sample < job.first_sample,
                "sample {} is on the film already",
                job.first_sample
            );
            if stop.load(Ordering::Relaxed) {
                return Vec::new();
            }
            let woken = exposure.turn.wait_timeout(sums, STOP_POLL);
            sums = woken.expect("no commit panicked").0;
        }
        let dropped = sums.add(job, radiance);
        sums.next_sample += job.samples;
        drop(sums);
        exposure.turn.notify_all();
        dropped
    }
}

impl Exposure {
    fn new(tile: &Tile) -> Self {
        Self {
            sums: Mutex::new(TileSums {
                next_sample: 0,
                pixels: vec![PixelSums::default(); tile.pixels() as usize],
            }),
            turn: Condvar::new(),
        }
    }
}

impl TileSums {
    fn add(&mut self, job: &Job, radiance: [&[f32]; 3]) -> Vec<(u32, u32, u32)> {
        let mut dropped = Vec::new();
        let samples = job.samples as usize;
        for (pixel, sums) in self.pixels.iter_mut().enumerate() {
            let slots = pixel * samples..(pixel + 1) * samples;
            for (sample, slot) in (job.first_sample..).zip(slots) {
                let value = radiance.map(|column| column[slot]);
                if value.iter().all(|v| v.is_finite()) {
                    sums.add(value);
                } else {
                    let (x, y) = (pixel as u32 % job.tile.width, pixel as u32 / job.tile.width);
                    dropped.push((job.tile.x + x, job.tile.y + y, sample));
                }
            }
        }
        dropped
    }
}

impl PixelSums {
    fn add(&mut self, value: [f32; 3]) {
        for (channel, v) in value.map(f64::from).into_iter().enumerate() {
            self.value[channel] += v;
            self.square[channel] += v * v;
        }
        self.count += 1;
    }
}

#[cfg(test)]
mod tests;
