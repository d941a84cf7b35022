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
mod generate;
mod intersect;
mod plan;
mod queue;
mod render;
mod roulette;
mod sampling;
mod scheduler;
mod setup;
mod shade;
mod sort;
mod stats;
mod surfaces;
mod tables;
mod tally;

pub use control::Control;
pub use plan::{Plan, QueuePlan, plan};
pub use render::render;
pub use stats::{BounceStats, Dropped, RenderStats, StageStats};

use crate::effects::Shader;
use crate::film::{Job, SampleBuffer};
use account::{Account, Stage};
use generate::Source;
use huygens_kernels::compact::Kept;
use huygens_kernels::queues::{OcclusionMut, PathHitsMut, PathsMut, ShadowsMut};
use huygens_kernels::scatter::Out;
use queue::Queue;
use setup::Setup;
use sort::Lists;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use surfaces::Surfaces;
use tally::Tally;

/// One worker's wave: its queues, allocated once.
struct Wave<'a> {
    setup: &'a Setup<'a>,
    paths: Queue<PathsMut<'static>>,
    hits: Queue<PathHitsMut<'static>>,
    lists: Lists,
    /// Where some surfaces are more than plain diffuse ones.
    surfaces: Option<Surfaces>,
    scattered: Queue<PathsMut<'static>>,
    shadows: Queue<ShadowsMut<'static>>,
    occlusion: Queue<OcclusionMut<'static>>,
    kept: Vec<Kept>,
    account: Account,
    rays: u64,
}

impl<'a> Wave<'a> {
    fn new(setup: &'a Setup<'a>) -> Self {
        let capacity = setup.capacity;
        let shadows = if setup.casts_shadows() { capacity } else { 0 };
        Self {
            setup,
            paths: Queue::new(capacity),
            hits: Queue::new(capacity),
            lists: Lists::new(capacity, setup.shaders.len(), setup.wanted),
            surfaces: setup.surfaces(),
            scattered: Queue::new(capacity),
            shadows: Queue::new(shadows),
            occlusion: Queue::new(shadows),
            kept: Vec::with_capacity(capacity),
            account: Account::new(),
            rays: 0,
        }
    }

    /// Its queues, as they are.
    fn queues(&self) -> Vec<QueuePlan> {
        let mut queues = Vec::new();
        queues.extend(QueuePlan::of("paths", &self.paths));
        queues.extend(QueuePlan::of("hits", &self.hits));
        queues.extend(self.lists.queues(self.setup));
        queues.extend(self.surfaces.iter().flat_map(Surfaces::queues));
        queues.extend(QueuePlan::of("scattered", &self.scattered));
        queues.extend(QueuePlan::of("shadows", &self.shadows));
        queues.extend(QueuePlan::of("occlusion", &self.occlusion));
        queues
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
            surfaces,
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
            let start = Instant::now();
            let new = source.refill(&setup.lens, sampler, paths);
            if new > 0 {
                let mut out = Tally::default();
                out.add(0, new);
                account.book(Stage::Generate, start, &Tally::default(), &out);
            }
            if paths.len() == 0 {
                return true;
            }
            if stop.load(Ordering::Relaxed) {
                return false;
            }

            let under_way = Tally::of(&paths.view().bounces[..paths.len()], 0);
            let start = Instant::now();
            intersect::intersect(geometry, paths, hits, |slot| {
                account.lose_ray(Stage::Intersect.name(), job.sample_of(slot));
            });
            account.book(Stage::Intersect, start, &under_way, &under_way);

            let start = Instant::now();
            lists.sort(
                paths.len(),
                paths.view(),
                hits.view(),
                tables.triangles.material,
                &setup.routes,
                setup.wanted,
            );
            account.book(Stage::Sort, start, &under_way, &lists.tally());

            let (at, hit) = (paths.view(), hits.view());
            if lists.sky.len() > 0 {
                let start = Instant::now();
                shade::sky(program, lists.sky.of(at, hit), tables, samples, |slot| {
                    account.drop_sample(Stage::Sky.name(), job.sample_of(slot));
                });
                account.book(Stage::Sky, start, &lists.sky.tally, &Tally::default());
            }
            if lists.emission.len() > 0 {
                let start = Instant::now();
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
                    start,
                    &lists.emission.tally,
                    &Tally::default(),
                );
            }
            let mut out = Out {
                paths: scattered.view_mut(),
                path_len: 0,
                shadows: shadows.view_mut(),
                shadow_len: 0,
            };
            for (&shader, list) in setup.shaders.iter().zip(&lists.scatter) {
                if list.len() == 0 {
                    continue;
                }
                let listed = list.of(at, hit);
                let before = (out.path_len, out.shadow_len);
                let mut start = Instant::now();
                match surfaces {
                    Some(surfaces) if shader != Shader::Plain => {
                        surfaces.interact(listed, tables, sampler);
                        start = account.book(Stage::Interact, start, &list.tally, &list.tally);
                        if program.samples_lights() && !shader.is_delta() {
                            surfaces.light_up(shader, tables);
                            start = account.book(Stage::Light, start, &list.tally, &list.tally);
                        }
                        surfaces.respond(program, shader, listed, tables, &mut out);
                    }
                    _ => shade::plain(
                        program,
                        listed,
                        tables,
                        sampler,
                        &mut out,
                        samples,
                        |slot| {
                            account.drop_sample(Stage::Scatter(shader).name(), job.sample_of(slot));
                        },
                    ),
                }
                let made = Tally::of(&out.paths.bounces[before.0..out.path_len], 0).plus(
                    &Tally::of(&out.shadows.bounces[before.1..out.shadow_len], 0),
                );
                account.book(Stage::Scatter(shader), start, &list.tally, &made);
            }
            let (on, cast) = (out.path_len, out.shadow_len);
            scattered.set_len(on);
            shadows.set_len(cast);
            let cast = Tally::of(&shadows.view().bounces[..cast], 0);
            let on = Tally::of(&scattered.view().bounces[..on], 0);

            self.rays += (paths.len() + shadows.len()) as u64;
            if shadows.len() > 0 {
                let start = Instant::now();
                let mut lost = Vec::new();
                intersect::occlude(
                    geometry,
                    shadows,
                    occlusion,
                    samples,
                    |slot| lost.push(slot),
                    |slot| account.drop_sample(Stage::Occlude.name(), job.sample_of(slot)),
                );
                for slot in lost {
                    account.lose_ray(Stage::Occlude.name(), job.sample_of(slot));
                }
                account.book(Stage::Occlude, start, &cast, &Tally::default());
            }

            let start = Instant::now();
            roulette::run(setup.rules, sampler, scattered, kept, paths, |slot| {
                account.drop_sample(Stage::Roulette.name(), job.sample_of(slot));
            });
            if on.total() > 0 {
                let survivors = Tally::of(&paths.view().bounces[..paths.len()], 0);
                account.book(Stage::Roulette, start, &on, &survivors);
            }
        }
    }

    fn rays(&mut self) -> u64 {
        std::mem::take(&mut self.rays)
    }

    fn left_out(&mut self, samples: &[(u32, u32, u32)]) {
        for &at in samples {
            self.account.drop_sample("film", at);
        }
    }
}
