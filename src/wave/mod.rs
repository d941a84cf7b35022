//! The wave: queues, stages, the loop and the scheduler.
//!
//! ```text
//! generate -> intersect -> sort -> shade (sky, emission, surface) -> roulette, compact -+
//!    ^                                         +-> shadows -> occlude -> add            |
//!    +----------------------------------------------------------------------------------+
//! ```

mod account;
mod camera;
mod control;
mod counters;
mod generate;
mod instruments;
mod intersect;
mod queue;
mod render;
mod roulette;
mod sampling;
mod scheduler;
mod setup;
mod shade;
mod sort;
mod stats;
mod tables;
mod tally;

pub use control::Control;
pub use counters::{COUNTERS, available as available_counters};
pub use instruments::{Instruments, Slice, Timeline};
pub use render::{render, render_with};
pub use stats::{BounceStats, Dropped, RenderStats, StageStats};

use crate::film::{Job, SampleBuffer};
use account::{Account, Stage};
use generate::Source;
use huygens_kernels::compact::Kept;
use huygens_kernels::cost::{Cost, item};
use huygens_kernels::emission::{SKY, SURFACE, UNOCCLUDED};
use huygens_kernels::queues::{OcclusionMut, PathHitsMut, PathsMut, ShadowsMut};
use huygens_kernels::rays::{CLOSEST, OCCLUSION};
use huygens_kernels::scatter::{SCATTER, SHADOW};
use huygens_kernels::{camera as camera_kernel, roulette as roulette_kernel};
use queue::Queue;
use setup::Setup;
use sort::Lists;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use tally::Tally;

/// One worker's wave: its queues, allocated once.
struct Wave<'a> {
    setup: &'a Setup<'a>,
    paths: Queue<PathsMut<'static>>,
    hits: Queue<PathHitsMut<'static>>,
    lists: Lists,
    scattered: Queue<PathsMut<'static>>,
    shadows: Queue<ShadowsMut<'static>>,
    occlusion: Queue<OcclusionMut<'static>>,
    kept: Vec<Kept>,
    account: Account,
    rays: u64,
}

impl<'a> Wave<'a> {
    /// For the calling thread, in a render that began at `epoch`.
    fn new(setup: &'a Setup<'a>, instruments: &Instruments, epoch: Instant) -> Self {
        let capacity = setup.capacity;
        Self {
            setup,
            paths: Queue::new(capacity),
            hits: Queue::new(capacity),
            lists: Lists::new(capacity),
            scattered: Queue::new(capacity),
            shadows: Queue::new(capacity),
            occlusion: Queue::new(capacity),
            kept: Vec::with_capacity(capacity),
            account: Account::new(instruments, epoch),
            rays: 0,
        }
    }
}

impl scheduler::Worker for Wave<'_> {
    /// The loop. It runs while any path is under way; no stage knows which bounce it is at.
    fn trace(&mut self, job: &Job, samples: &mut SampleBuffer, stop: &AtomicBool) -> bool {
        let Self {
            setup,
            paths,
            hits,
            lists,
            scattered,
            shadows,
            occlusion,
            kept,
            account,
            ..
        } = self;
        let Setup {
            geometry,
            tables,
            sampler,
            program,
            ..
        } = *setup;
        let (sampler, program) = (*sampler, *program);
        let mut source = Source::new(job);
        paths.set_len(0);
        loop {
            let new = source.refill(&setup.lens, sampler, paths);
            if new > 0 {
                let mut out = Tally::default();
                out.add(0, new);
                account.book(
                    Stage::Generate,
                    &Tally::default(),
                    &out,
                    camera_kernel::COST * new,
                );
            }
            if paths.len() == 0 {
                return true;
            }
            if stop.load(Ordering::Relaxed) {
                return false;
            }

            let under_way = Tally::of(&paths.view().bounces[..paths.len()], 0);
            intersect::intersect(geometry, paths, hits);
            account.book(
                Stage::Intersect,
                &under_way,
                &under_way,
                CLOSEST * paths.len(),
            );

            lists.sort(
                paths.len(),
                paths.view(),
                hits.view(),
                tables.triangles.material,
                &setup.emits,
                setup.wanted,
            );
            let listed = lists.tally();
            let cost = sort::READ * paths.len() + sort::WRITTEN * listed.total();
            account.book(Stage::Sort, &under_way, &listed, cost);

            let (at, hit) = (paths.view(), hits.view());
            if lists.sky.len() > 0 {
                shade::sky(program, lists.sky.of(at, hit), tables, samples, |slot| {
                    account.drop_sample(Stage::Sky.name(), job.sample_of(slot));
                });
                account.book(
                    Stage::Sky,
                    &lists.sky.tally,
                    &Tally::default(),
                    SKY * lists.sky.len(),
                );
            }
            if lists.emission.len() > 0 {
                shade::emission(
                    program,
                    lists.emission.of(at, hit),
                    tables,
                    samples,
                    |slot| {
                        account.drop_sample(Stage::Emission.name(), job.sample_of(slot));
                    },
                );
                account.book(
                    Stage::Emission,
                    &lists.emission.tally,
                    &Tally::default(),
                    SURFACE * lists.emission.len(),
                );
            }
            let scatter = lists.scatter.of(at, hit);
            let sinks = shade::Sinks {
                scattered,
                shadows,
                samples,
            };
            shade::surface(program, scatter, tables, sampler, sinks, |slot| {
                account.drop_sample(Stage::Scatter.name(), job.sample_of(slot));
            });
            let cast = Tally::of(&shadows.view().bounces[..shadows.len()], 0);
            let on = Tally::of(&scattered.view().bounces[..scattered.len()], 0);
            account.book(
                Stage::Scatter,
                &lists.scatter.tally,
                &cast.clone().plus(&on),
                SCATTER * scattered.len() + SHADOW * shadows.len(),
            );

            self.rays += (paths.len() + shadows.len()) as u64;
            if shadows.len() > 0 {
                intersect::occlude(geometry, shadows, occlusion, samples, |slot| {
                    account.drop_sample(Stage::Occlude.name(), job.sample_of(slot));
                });
                account.book(
                    Stage::Occlude,
                    &cast,
                    &Tally::default(),
                    (OCCLUSION + UNOCCLUDED) * shadows.len(),
                );
            }

            roulette::run(setup.rules, sampler, scattered, kept, paths, |slot| {
                account.drop_sample(Stage::Roulette.name(), job.sample_of(slot));
            });
            if on.total() > 0 {
                let survivors = Tally::of(&paths.view().bounces[..paths.len()], 0);
                let moved = item::<PathsMut<'static>>();
                let cost = (roulette_kernel::COST + Cost::new(moved, 0)) * scattered.len()
                    + Cost::new(0, moved) * paths.len();
                account.book(Stage::Roulette, &on, &survivors, cost);
            }
        }
    }

    fn rays(&mut self) -> u64 {
        std::mem::take(&mut self.rays)
    }

    fn committed(&mut self, samples: usize, left_out: &[(u32, u32, u32)]) {
        for &at in left_out {
            self.account.drop_sample("film", at);
        }
        let mut tally = Tally::default();
        tally.add(0, samples);
        let cost = SampleBuffer::COST * samples;
        self.account
            .book(Stage::Film, &tally, &Tally::default(), cost);
    }
}
