//! The wave: queues, stages, the loop and the scheduler.
//!
//! ```text
//! generate -> intersect -> sort -> shade (sky, emission, surface) -> roulette, compact -+
//!    ^                                         +-> shadows -> occlude -> add            |
//!    +----------------------------------------------------------------------------------+
//! ```

mod account;
mod branch;
mod camera;
mod cast;
mod control;
mod counters;
mod emitted;
mod environment;
mod extras;
mod generate;
mod images;
mod instruments;
mod intersect;
mod light_tree;
mod lights;
mod media;
mod mixtures;
mod parameters;
mod plan;
mod queue;
mod recorded;
mod render;
mod roulette;
mod sampling;
mod scheduler;
mod setup;
mod shade;
mod shutter;
mod slowed;
mod sort;
mod stages;
mod stats;
mod surfaces;
mod tables;
mod tally;

pub use control::Control;
pub use counters::{COUNTERS, available as available_counters};
pub use instruments::{Instruments, Slice, Timeline};
pub use plan::{Plan, QueuePlan, plan};
pub use recorded::{RECORDED_STAGES, Recorded, recorded};
pub use render::{render, render_with};
pub use stats::{BounceStats, Dropped, RenderStats, StageStats};

use crate::film::{Job, SampleBuffer};
use account::Account;
use branch::{Branches, Slots};
use extras::{Along, Extras};
use generate::Source;
use huygens_kernels::compact::Kept;
use huygens_kernels::queues::{OcclusionMut, PathHitsMut, PathsMut, ShadowsMut};
use queue::Queue;
use setup::Setup;
use shutter::ShadowTimes;
use sort::Lists;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use surfaces::Surfaces;
use tally::Tally;

/// One worker's wave: its queues, allocated once.
struct Wave<'a> {
    setup: &'a Setup<'a>,
    paths: Queue<PathsMut<'static>>,
    /// What paths carry besides, where a scene calls for it.
    extras: Extras,
    hits: Queue<PathHitsMut<'static>>,
    lists: Lists,
    /// Where some surfaces are more than plain diffuse ones.
    surfaces: Option<Surfaces>,
    /// Where paths branch.
    branches: Option<Branches>,
    scattered: Queue<PathsMut<'static>>,
    /// The same for `scattered`.
    scattered_extras: Extras,
    shadows: Queue<ShadowsMut<'static>>,
    occlusion: Queue<OcclusionMut<'static>>,
    kept: Vec<Kept>,
    /// The moments of occlusion rays, where something moves.
    shadow_times: Option<ShadowTimes>,
    /// Scratch space: which row cast an occlusion ray, where there are media or something
    /// moves.
    rows: Vec<u32>,
    account: Account,
    /// Paths at the last intersection by bounce: counted once, booked by several stages.
    traced: Tally,
    /// The same of paths that were scattered and go on.
    went_on: Tally,
    /// The same of occlusion rays.
    cast: Tally,
    rays: u64,
}

impl<'a> Wave<'a> {
    /// For the calling thread, in a render that began at `epoch`.
    fn new(setup: &'a Setup<'a>, instruments: &Instruments, epoch: Instant) -> Self {
        let capacity = setup.capacity;
        let shadows = if setup.casts_shadows() { capacity } else { 0 };
        Self {
            setup,
            paths: Queue::new(capacity),
            extras: Extras::new(setup.carried, capacity, Along::Paths),
            hits: Queue::new(capacity),
            lists: Lists::new(setup, !instruments.unaccounted),
            surfaces: setup.surfaces(),
            branches: setup.branches(),
            scattered: Queue::new(capacity),
            scattered_extras: Extras::new(setup.carried, capacity, Along::Scattered),
            shadows: Queue::new(shadows),
            occlusion: Queue::new(shadows),
            kept: Vec::with_capacity(capacity),
            shadow_times: setup.carried.times.then(|| ShadowTimes::new(shadows)),
            rows: Vec::new(),
            account: Account::new(instruments, epoch),
            traced: Tally::default(),
            went_on: Tally::default(),
            cast: Tally::default(),
            rays: 0,
        }
    }

    /// Its queues, as they are.
    fn queues(&self) -> Vec<QueuePlan> {
        let mut queues = Vec::new();
        queues.extend(QueuePlan::of("paths", &self.paths));
        queues.extend(self.extras.queues());
        queues.extend(QueuePlan::of("hits", &self.hits));
        queues.extend(self.lists.queues(self.setup));
        queues.extend(self.branches.iter().flat_map(Branches::queues));
        queues.extend(self.surfaces.iter().flat_map(Surfaces::queues));
        queues.extend(QueuePlan::of("scattered", &self.scattered));
        queues.extend(self.scattered_extras.queues());
        queues.extend(QueuePlan::of("shadows", &self.shadows));
        queues.extend(self.shadow_times.iter().filter_map(ShadowTimes::plan));
        queues.extend(QueuePlan::of("occlusion", &self.occlusion));
        queues
    }
}

impl Wave<'_> {
    /// The loop. It runs while any path is under way; no stage knows which bounce it is at.
    fn follow(&mut self, slots: Slots, samples: &mut SampleBuffer, stop: &AtomicBool) -> bool {
        let mut source = Source::new(slots);
        self.paths.set_len(0);
        loop {
            self.generate(&mut source, slots);
            if self.paths.len() == 0 && !self.waits() {
                return true;
            }
            if stop.load(Ordering::Relaxed) {
                return false;
            }
            self.rays += self.paths.len() as u64;
            self.intersect(slots);
            self.travel();
            self.sort();
            self.emit(slots, samples);
            self.branch();
            self.disperse();
            self.scatter(slots, samples);
            self.rays += self.shadows.len() as u64;
            self.occlude(slots, samples);
            self.roulette(slots);
        }
    }

    /// Whether paths wait to branch.
    fn waits(&self) -> bool {
        self.branches.as_ref().is_some_and(Branches::wait)
    }
}

impl scheduler::Worker for Wave<'_> {
    fn trace(&mut self, job: &Job, samples: &mut SampleBuffer, stop: &AtomicBool) -> bool {
        let Some((step, each)) = self
            .branches
            .as_ref()
            .map(|b| (b.samples_at_a_time(), b.leaves()))
        else {
            return self.follow(Slots::new(job, 0..job.slots(), 1), samples, stop);
        };
        // Slots of branches are many: some camera samples at a time.
        for first in (0..job.slots()).step_by(step) {
            let some = first..(first + step).min(job.slots());
            let branches = self.branches.as_mut();
            let mut light = branches.map_or_else(SampleBuffer::default, |b| b.lend(some.len()));
            let whole = self.follow(Slots::new(job, some.clone(), each), &mut light, stop);
            if let Some(branches) = &mut self.branches {
                branches.add_up(light, some, samples);
            }
            if !whole {
                // What waits is of no use, and nothing may wait when the next job starts.
                self.branches = self.setup.branches();
                return false;
            }
        }
        true
    }

    fn rays(&mut self) -> u64 {
        std::mem::take(&mut self.rays)
    }

    fn committed(&mut self, samples: usize, left_out: &[(u32, u32, u32)]) {
        self.commit(samples, left_out);
    }
}
