//! The film: sums of samples and of their squares, a pixel at a time, in sample order.

mod job;

pub use job::{Job, SampleBuffer, Tile};

/// An image under exposure. Shared by all workers.
#[derive(Debug)]
pub struct Film {
    width: u32,
    height: u32,
    tile: u32,
}

impl Film {
    /// An unexposed film of `width` by `height` pixels, kept in tiles of `tile` by `tile`.
    #[must_use]
    pub fn new(width: u32, height: u32, tile: u32) -> Self {
        Self {
            width,
            height,
            tile,
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
        unimplemented!("written by the film room; edge {}", self.tile)
    }

    /// Adds a finished job's samples, each pixel's in sample order after all earlier ones of that
    /// pixel: blocks until the jobs of the same tile with smaller samples are in, so jobs must be
    /// started in order. Returns without adding if `stop` is raised while it waits. Samples that are
    /// not finite are left out (and out of the pixel's count), and returned: (x, y, sample).
    pub fn commit(
        &self,
        job: &Job,
        samples: &SampleBuffer,
        stop: &std::sync::atomic::AtomicBool,
    ) -> Vec<(u32, u32, u32)> {
        let _ = (job, samples, stop);
        unimplemented!("written by the film room")
    }
}
