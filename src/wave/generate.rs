//! Generate: camera rays for a job's samples, as many as the wave has room for.
//!
//! In: the job. Out: paths, appended behind those already under way.

use super::queue::Queue;
use super::sampling::{AnySampler, with_sampler};
use crate::film::Job;
use huygens_kernels::camera::{Lens, Window, camera_rays};
use huygens_kernels::queues::PathsMut;

/// A job's camera samples that have not been started yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    window: Window,
    next: usize,
    slots: usize,
}

impl Source {
    pub(crate) fn new(job: &Job) -> Self {
        Self {
            window: Window {
                x: job.tile.x,
                y: job.tile.y,
                width: job.tile.width,
                first_sample: job.first_sample,
                samples: job.samples,
            },
            next: 0,
            slots: job.slots(),
        }
    }

    /// Fills the queue up, or as far as there are samples. Returns how many were added.
    pub(crate) fn refill(
        &mut self,
        lens: &Lens,
        sampler: AnySampler,
        paths: &mut Queue<PathsMut<'static>>,
    ) -> usize {
        let n = paths.room().min(self.slots - self.next);
        if n > 0 {
            let at = paths.len();
            let slots = self.next..self.next + n;
            with_sampler!(sampler, sampler => camera_rays(
                lens, self.window, slots, sampler, &mut paths.view_mut(), at
            ));
            paths.set_len(at + n);
            self.next += n;
        }
        n
    }
}
