//! Branch: several ways on from one surface.
//!
//! In: paths at surfaces that scatter. Out: the same, each as often as the factor of its depth says, as
//! many at a time as the queues hold; the rest waits. A path's branches share its throughput, so that
//! their sum is worth what the path was.
//!
//! *Order.* Deepest first. A level is given new paths only by branches of the level above, which are
//! taken only when it is empty; so each level holds one wave at most, and the queues need room for one
//! a level, whatever the factors.
//!
//! *Random numbers.* Branch `k` of `n` of sample `s` goes on as sample `n s + k`: the numbers that all
//! branches draw at one depth are those of `n` times the samples, as evenly spread.
//!
//! *Light.* Every branch has a slot of its own, its parent's that of its first branch. So each slot is
//! added to by one chain of events, in their order, whatever is processed first; and a sample is the
//! sum of its slots, in theirs.

use super::extras::{Along, Carried, Extras};
use super::plan::QueuePlan;
use super::queue::Queue;
use super::sort::Lists;
use crate::film::{Job, SampleBuffer};
use huygens_kernels::queues::{MARKS, PathHitsMut, PathsMut};
use std::ops::Range;

/// Slots that are added to at a time, unless one sample has more: some hundred waves, so that their
/// last paths matter little.
const SLOTS: usize = 1 << 18;

/// Paths and their hits.
pub(crate) struct Met<'a> {
    pub(crate) paths: &'a mut Queue<PathsMut<'static>>,
    pub(crate) hits: &'a mut Queue<PathHitsMut<'static>>,
    pub(crate) extras: &'a mut Extras,
}

impl Met<'_> {
    fn clear(&mut self) {
        self.paths.set_len(0);
        self.hits.set_len(0);
        self.extras.clear();
    }
}

/// One depth's paths at surfaces.
struct Level {
    paths: Queue<PathsMut<'static>>,
    hits: Queue<PathHitsMut<'static>>,
    extras: Extras,
    /// Branches of each of them.
    factor: u32,
    /// Slots of each branch.
    slots: u32,
    /// The row that is next.
    next: usize,
    /// How many of its branches are taken.
    taken: u32,
}

/// The paths of a worker that wait to branch.
pub(crate) struct Branches {
    /// One for each depth with a factor, and one for all deeper.
    levels: Vec<Level>,
    /// Scratch space: rows to move.
    rows: Vec<u32>,
    /// Light, by slot.
    light: SampleBuffer,
}

impl Branches {
    /// For waves of `capacity` paths that branch by these factors.
    pub(crate) fn new(factors: &[u32], capacity: usize, carried: Carried) -> Self {
        let all = leaves(factors);
        let mut slots = all;
        let level = |factor: u32| {
            slots /= factor;
            Level {
                paths: Queue::new(capacity),
                hits: Queue::new(capacity),
                extras: Extras::new(carried, capacity, Along::Waiting),
                factor,
                slots,
                next: 0,
                taken: 0,
            }
        };
        Self {
            levels: factors.iter().copied().chain([1]).map(level).collect(),
            rows: Vec::with_capacity(capacity),
            light: SampleBuffer::new(SLOTS.max(all as usize)),
        }
    }

    /// Its queues, as they are.
    pub(crate) fn queues(&self) -> impl Iterator<Item = QueuePlan> {
        self.levels.iter().flat_map(|level| {
            let paths = QueuePlan::of("waiting paths", &level.paths);
            let hits = QueuePlan::of("waiting hits", &level.hits);
            let extras = level.extras.queues();
            paths.into_iter().chain(hits).chain(extras)
        })
    }

    /// Whether any path waits.
    pub(crate) fn wait(&self) -> bool {
        self.levels.iter().any(|l| !l.is_empty())
    }

    /// Takes in the paths that `lists` send to surfaces, and puts the next branches in their place: as
    /// many as there is room for.
    pub(crate) fn exchange(&mut self, lists: &Lists, mut met: Met) {
        self.push(lists, &met);
        met.clear();
        for level in self.levels.iter_mut().rev() {
            level.take(&mut met, &mut self.rows);
        }
    }

    fn push(&mut self, lists: &Lists, met: &Met) {
        let deepest = self.levels.len() - 1;
        let bounces = met.paths.view().bounces;
        for (depth, level) in self.levels.iter_mut().enumerate() {
            self.rows.clear();
            let listed = lists.scatter.iter().flat_map(|list| list.indices());
            self.rows.extend(listed.filter(|&&i| {
                let bounce = (bounces[i as usize] & !MARKS) as usize;
                bounce.min(deepest) == depth
            }));
            if self.rows.is_empty() {
                continue;
            }
            assert!(level.is_empty(), "a level is given paths when it has none");
            level.paths.set_len(0);
            level.hits.set_len(0);
            level.extras.clear();
            (level.next, level.taken) = (0, 0);
            level.paths.append_rows(met.paths, &self.rows);
            level.hits.append_rows(met.hits, &self.rows);
            level.extras.append_rows(met.extras, &self.rows);
        }
    }

    /// Slots of a camera sample.
    pub(crate) fn leaves(&self) -> usize {
        let first = &self.levels[0];
        first.factor as usize * first.slots as usize
    }

    /// Camera samples that are processed at a time.
    pub(crate) fn samples_at_a_time(&self) -> usize {
        (SLOTS / self.leaves()).max(1)
    }

    /// The slots of so many samples, black, until [`Branches::add_up`].
    pub(crate) fn lend(&mut self, samples: usize) -> SampleBuffer {
        let mut light = std::mem::take(&mut self.light);
        light.clear(samples * self.leaves());
        light
    }

    /// Adds up what was lent, each sample's slots in order, into `samples` of `into`.
    pub(crate) fn add_up(
        &mut self,
        light: SampleBuffer,
        samples: Range<usize>,
        into: &mut SampleBuffer,
    ) {
        let leaves = self.leaves();
        for (from, to) in light.radiance.iter().zip(&mut into.radiance) {
            for (slots, sample) in from.chunks_exact(leaves).zip(samples.clone()) {
                to[sample] = slots.iter().map(|&v| f64::from(v)).sum::<f64>() as f32;
            }
        }
        self.light = light;
    }
}

impl Level {
    fn is_empty(&self) -> bool {
        self.next == self.paths.len()
    }

    /// Appends as many branches as there is room for.
    fn take(&mut self, met: &mut Met, rows: &mut Vec<u32>) {
        rows.clear();
        let (start, first) = (met.paths.len(), self.taken);
        let mut room = met.paths.room();
        while room > 0 && !self.is_empty() {
            let n = (self.factor - self.taken).min(room as u32);
            rows.extend(std::iter::repeat_n(self.next as u32, n as usize));
            room -= n as usize;
            self.taken += n;
            if self.taken == self.factor {
                (self.next, self.taken) = (self.next + 1, 0);
            }
        }
        met.paths.append_rows(&self.paths, rows);
        met.hits.append_rows(&self.hits, rows);
        met.extras.append_rows(&self.extras, rows);
        if self.factor == 1 {
            return;
        }
        let share = 1.0 / self.factor as f32;
        let all = start..start + rows.len();
        let paths = met.paths.view_mut();
        for column in paths.throughput {
            column[all.clone()].iter_mut().for_each(|t| *t *= share);
        }
        for (i, at) in all.enumerate() {
            let k = (first + i as u32) % self.factor;
            paths.sample[at] = paths.sample[at] * self.factor + k;
            paths.slot[at] += k * self.slots;
        }
    }
}

/// Branches of a camera sample in all.
pub(crate) fn leaves(factors: &[u32]) -> u32 {
    factors.iter().product()
}

/// Which camera sample a slot belongs to.
#[derive(Clone, Copy)]
pub(crate) struct Slots<'a> {
    job: &'a Job,
    /// Camera samples under way, as slots of the job.
    samples: (usize, usize),
    /// Slots of a camera sample.
    each: usize,
}

impl<'a> Slots<'a> {
    /// For these samples of `job`, whose slots are `each` to a sample and start at 0; of one slot to a
    /// sample, those of the job.
    pub(crate) fn new(job: &'a Job, samples: Range<usize>, each: usize) -> Self {
        Self {
            job,
            samples: (samples.start, samples.end),
            each,
        }
    }

    pub(crate) fn job(&self) -> &'a Job {
        self.job
    }

    pub(crate) fn samples(&self) -> Range<usize> {
        self.samples.0..self.samples.1
    }

    /// From a camera sample's slot of the job to its first here.
    pub(crate) fn rename(&self, slots: &mut [u32]) {
        if self.each > 1 {
            let rename = |s: &mut u32| *s = (*s - self.samples.0 as u32) * self.each as u32;
            slots.iter_mut().for_each(rename);
        }
    }

    /// The camera sample of a slot: (x, y, sample index).
    pub(crate) fn sample_of(&self, slot: u32) -> (u32, u32, u32) {
        if self.each == 1 {
            return self.job.sample_of(slot);
        }
        let sample = self.samples.0 + slot as usize / self.each;
        self.job.sample_of(sample as u32)
    }
}
