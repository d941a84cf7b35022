//! The scheduler: the only place that knows of threads.
//!
//! Jobs are numbered: all tiles for the first samples, then all tiles for the next. Workers take
//! them from one counter and own everything else that they touch, so nothing is shared in the loop.
//! What it guarantees: a tile's jobs are put on the film in the order of their samples (the film
//! makes a job wait for its predecessor, which was taken earlier and so is done or under way).
//! What it does not: any order between tiles, or which worker takes what.

use super::Control;
use crate::film::{Film, Job, SampleBuffer};
use crate::settings::Settings;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

/// Whoever turns jobs into samples: a worker's own.
pub(crate) trait Worker: Send {
    /// Fills `samples` (black on entry) for `job`. Returns false if `stop` was raised before it was
    /// done, and the samples are then of no use.
    fn trace(&mut self, job: &Job, samples: &mut SampleBuffer, stop: &AtomicBool) -> bool;
    /// Rays traced since the last call.
    fn rays(&mut self) -> u64;
    /// Told that a job of so many samples is on the film, and which of them the film left out.
    fn committed(&mut self, samples: usize, left_out: &[(u32, u32, u32)]);
}

/// Camera samples in a job, unless a tile has more pixels: enough to keep a wave full for most of
/// the job, few enough to stay in cache.
const JOB_SLOTS: u32 = 16_384;

/// The jobs of a film at `spp` samples a pixel.
struct Jobs<'a> {
    film: &'a Film,
    spp: u32,
    samples: u32,
}

impl<'a> Jobs<'a> {
    fn new(film: &'a Film, spp: u32) -> Self {
        let pixels = film.tiles().iter().map(|t| t.pixels()).max().unwrap_or(1);
        Self {
            film,
            spp,
            samples: (JOB_SLOTS / pixels).clamp(1, spp.max(1)),
        }
    }

    fn slots(&self) -> usize {
        let pixels = self
            .film
            .tiles()
            .iter()
            .map(|t| t.pixels())
            .max()
            .unwrap_or(0);
        pixels as usize * self.samples as usize
    }

    fn get(&self, number: usize) -> Option<Job> {
        let tiles = self.film.tiles();
        let pass = (number / tiles.len()) as u32;
        let first_sample = pass.checked_mul(self.samples)?;
        let left = self
            .spp
            .checked_sub(first_sample)
            .filter(|&left| left > 0)?;
        let tile_index = number % tiles.len();
        let samples = self.samples.min(left);
        Some(Job {
            tile_index,
            tile: tiles[tile_index],
            first_sample,
            samples,
        })
    }
}

/// Raises the stop flag if its worker panics: a job that is never put on the film must not keep its
/// successors waiting.
struct StopOnPanic<'a>(&'a AtomicBool);

impl Drop for StopOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

/// Runs all jobs of `settings` on its threads, a worker each, and returns the workers with the
/// seconds that each had from being made to having nothing left to do.
pub(crate) fn run<W: Worker>(
    film: &Film,
    settings: &Settings,
    control: &Control,
    worker: impl Fn() -> W + Sync,
) -> Vec<(W, f64)> {
    let jobs = Jobs::new(film, settings.spp);
    let next = AtomicUsize::new(0);
    let work = || {
        let _guard = StopOnPanic(&control.stop);
        let start = Instant::now();
        let mut worker = worker();
        let mut samples = SampleBuffer::new(jobs.slots());
        while !control.stops() {
            let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) else {
                break;
            };
            if !worker.trace(&job, &mut samples, &control.stop) {
                break;
            }
            let left_out = film.commit(&job, &samples, &control.stop);
            samples.clear(job.slots());
            worker.committed(job.slots(), &left_out);
            control
                .samples
                .fetch_add(job.slots() as u64, Ordering::Relaxed);
            control.rays.fetch_add(worker.rays(), Ordering::Relaxed);
        }
        (worker, start.elapsed().as_secs_f64())
    };
    match rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .build()
    {
        Ok(pool) => pool.broadcast(|_| work()),
        // No thread can be started: this one still can work.
        Err(_) => vec![work()],
    }
}
