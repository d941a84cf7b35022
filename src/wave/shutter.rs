//! Shutter: at which moment each path lives, where something moves.
//!
//! In: new camera rays. Out: their moments, and the rays of a camera that moves from where it is by
//! then. Paths keep their moment to the end; occlusion rays are given that of the path that cast them.

use super::account::Stage;
use super::queue::Queue;
use super::sampling::with_sampler;
use super::tally::Tally;
use super::{QueuePlan, Wave};
use huygens_kernels::bare::called_for;
use huygens_kernels::cost::{Cost, columns};
use huygens_kernels::motion::open_shutter;
use huygens_kernels::queues::{Listed, PathsMut, TimesMut};
use std::ops::Range;

/// A camera ray: its name and, if the camera moves, the ray; a moment written.
const SHUTTER: Cost = Cost::new(
    columns::<PathsMut<'static>>(&["pixel", "sample", "origin", "direction"]),
    columns::<PathsMut<'static>>(&["origin", "direction"])
        + columns::<TimesMut<'static>>(&["time"]),
)
.operations(60);

impl Wave<'_> {
    /// Draws the moments of the last `new` paths.
    pub(super) fn open_shutter(&mut self, new: usize) {
        let at = self.paths.len() - new;
        let Some(times) = called_for(self.extras.times_mut()) else {
            return;
        };
        let (camera, mut paths) = (self.setup.camera_motion.as_ref(), self.paths.view_mut());
        with_sampler!(self.setup.sampler, sampler => {
            open_shutter(at..at + new, sampler, camera, &mut paths, times);
        });
        let mut tally = Tally::default();
        tally.add(0, new);
        self.account
            .book(Stage::Shutter, &tally, &tally, SHUTTER * new);
    }
}

/// The moments of occlusion rays.
pub(crate) struct ShadowTimes(Queue<TimesMut<'static>>);

impl ShadowTimes {
    pub(crate) fn new(capacity: usize) -> Self {
        Self(Queue::new(capacity))
    }

    /// Its queue, as it is.
    pub(crate) fn plan(&self) -> Option<QueuePlan> {
        QueuePlan::of("shadow times", &self.0)
    }

    /// Gives rays `cast` the moments of the listed paths at `rows`.
    pub(crate) fn give(&mut self, cast: Range<usize>, listed: Listed, rows: &[u32]) {
        let Some(times) = listed.times else { return };
        self.0.set_len(cast.end);
        let to = &mut self.0.view_mut().time[cast];
        for (to, &row) in to.iter_mut().zip(rows) {
            *to = times[listed.index[row as usize] as usize];
        }
    }

    /// Those of all rays.
    pub(crate) fn all(&self) -> &[f32] {
        self.0.view().time
    }
}
