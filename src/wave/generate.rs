//! Generate: camera rays for a job's samples, as many as the wave has room for.
//!
//! In: the job. Out: paths, appended behind those already under way.

use super::branch::Slots;
use super::queue::Queue;
use super::sampling::{AnySampler, with_sampler};
use huygens_kernels::camera::{Lens, Window, camera_rays};
use huygens_kernels::queues::PathsMut;
use std::ops::Range;

/// A job's camera samples that have not been started yet.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    window: Window,
    slots: Range<usize>,
}

impl Source {
    pub(crate) fn new(slots: Slots) -> Self {
        let job = slots.job();
        Self {
            window: Window {
                x: job.tile.x,
                y: job.tile.y,
                width: job.tile.width,
                first_sample: job.first_sample,
                samples: job.samples,
            },
            slots: slots.samples(),
        }
    }

    /// Fills the queue up, or as far as there are samples. Returns how many were added.
    pub(crate) fn refill(
        &mut self,
        lens: &Lens,
        sampler: AnySampler,
        paths: &mut Queue<PathsMut<'static>>,
        names: Slots,
    ) -> usize {
        let n = paths.room().min(self.slots.len());
        if n > 0 {
            let at = paths.len();
            let slots = self.slots.start..self.slots.start + n;
            with_sampler!(sampler, sampler => camera_rays(
                lens, self.window, slots, sampler, &mut paths.view_mut(), at
            ));
            paths.set_len(at + n);
            names.rename(&mut paths.view_mut().slot[at..at + n]);
            self.slots.start += n;
        }
        n
    }
}
