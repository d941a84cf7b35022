//! A binary tree from the top down, with object splits and, where asked for, spatial splits
//! (M. Stich, H. Friedrich, A. Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG
//! 2009): where boxes of long triangles overlap whatever one does, a plane cuts the triangles'
//! references instead.
//!
//! **Room.** A node may make more references only as far as its share of a budget goes. What a
//! split leaves is handed on in proportion to the references of the halves, so that every subtree
//! knows its room from the start, its tasks share no counter, and the tree does not depend on the
//! number of threads.
//!
//! **Speed.** Large nodes take several splits at once on a grid (`cells`), smaller ones one by one
//! between bins (`split`, `distribute`), and the last few references are swept (`sweep`).
//!
//! **Bounds.** From a depth of [`HALVE_FROM`] on no grid is made, and nodes are cut in the middle of
//! their list until a sweep can take them. A grid adds fewer levels than it has planes, a sweep fewer
//! than it has references. So time is O(n log n) and the depth bounded, whatever comes in.

mod bounds;
mod cells;
mod distribute;
mod grown;
mod plan;
mod reference;
mod split;
mod sweep;
#[cfg(test)]
mod tests_of_few_and_many;

use super::build::Binary;
use crate::pages::Table;
use crate::scene::Mesh;
use bounds::Bounds;
use grown::{Grown, Run};
use plan::Plan;
use rayon::prelude::*;
use reference::Reference;
use split::{CHUNK, Grid};
use std::ops::Range;
use sweep::FEW;

/// A spatial split is tried where the halves of the object split overlap by more than this share
/// of the root's area (the paper's alpha, there 1e-5, which takes longer and gains nothing; nor
/// does it gain anything to cut a few references).
const OVERLAP: f32 = 1e-4;
/// Depth from which on nodes are halved.
const HALVE_FROM: u32 = 64;
/// References from which on the halves of a node are built in parallel.
const FORK: usize = 1 << 12;

/// The tree over the triangles `kept` of `mesh`, none of which may have a corner that is not
/// finite, nor an area that overflows. Leaves are blocks. At most `budget` times as many references
/// as there are triangles are added by cutting.
///
/// # Panics
/// If nothing is kept.
pub(super) fn build(mesh: &Mesh, kept: &[u32], budget: f32) -> Binary {
    let room = kept.len() + (kept.len() as f32 * budget) as usize;
    let mut from = Table::<Reference>::zeroed(room);
    let mut to = Table::<Reference>::zeroed(room);
    rayon::join(|| from.clear(), || to.clear());
    let bounds = from
        .par_chunks_mut(CHUNK)
        .zip(kept.par_chunks(CHUNK))
        .map(|(from, kept)| {
            let mut bounds = Bounds::EMPTY;
            for (reference, &i) in from.iter_mut().zip(kept) {
                let [a, b, c] = mesh.corners(i as usize).map(Bounds::point);
                *reference = Reference::new(a.union(b).union(c), i);
                bounds = bounds.union(reference.bounds());
            }
            bounds
        })
        .reduce(|| Bounds::EMPTY, Bounds::union);
    let builder = Builder {
        mesh,
        overlap: bounds.half_area() * OVERLAP,
    };
    let root = Task {
        valid: 0..kept.len(),
        from: &mut from,
        to: &mut to,
        bounds,
        depth: 0,
    };
    let grown = builder.grow(root);
    drop(to);
    grown.into_tree(kept.len(), from)
}

/// What all nodes share.
struct Builder<'a> {
    mesh: &'a Mesh,
    /// Least overlap of an object split's halves for which a spatial split is tried.
    overlap: f32,
}

/// A subtree to be built.
struct Task<'a> {
    /// Its references are `from[valid]`; the rest is its room.
    from: &'a mut [Reference],
    valid: Range<usize>,
    /// As long as `from`; its halves will be written here.
    to: &'a mut [Reference],
    /// Around the references.
    bounds: Bounds,
    depth: u32,
}

impl<'a> Task<'a> {
    /// A bucket of a grid, which has no room to spare.
    fn of_bucket(
        plan: &Plan,
        from: &'a mut [Reference],
        to: &'a mut [Reference],
        depth: u32,
    ) -> Self {
        Self {
            valid: 0..from.len(),
            bounds: plan.bounds,
            from,
            to,
            depth,
        }
    }

    /// The splits that a grid gives, if the task has no room to spare and is large enough.
    fn plan(&mut self) -> Option<Plan> {
        let whole = self.valid.len() == self.from.len();
        if !whole || self.from.len() < cells::FROM || self.depth >= HALVE_FROM {
            return None;
        }
        cells::part(self.from, self.to, centres(self.from))
    }
}

/// Around twice the centres.
fn centres(references: &[Reference]) -> Bounds {
    let around = |references: &[Reference]| {
        let twice = |r: &Reference| r.bounds().twice_centre();
        // Four chains of maxima, since each waits for the one before it.
        let (fours, rest) = references.as_chunks::<4>();
        let mut sums = [Bounds::EMPTY; 4];
        for four in fours {
            for (sum, one) in sums.iter_mut().zip(four) {
                *sum = sum.union(twice(one));
            }
        }
        let rest = rest.iter().map(twice).fold(Bounds::EMPTY, Bounds::union);
        sums.into_iter().fold(rest, Bounds::union)
    };
    if references.len() < 2 * CHUNK {
        return around(references);
    }
    let parts = references.par_chunks(CHUNK).map(around);
    parts.reduce(|| Bounds::EMPTY, Bounds::union)
}

impl Builder<'_> {
    fn grow(&self, mut task: Task) -> Grown {
        if task.valid.len() < FORK {
            return Grown::run(task.valid.len(), task.from.len(), |run| {
                self.run(task, 0, run);
            });
        }
        let bounds = task.bounds;
        if let Some(plan) = task.plan() {
            return self.follow(&plan, task.to, task.from, task.depth);
        }
        let (low, high) = self.divide(task);
        let (low, high) = rayon::join(|| self.grow(low), || self.grow(high));
        Grown::Fork(bounds, Box::new([low, high]))
    }

    /// Builds the subtree that begins with the splits of `plan`, which have put the references to `from`.
    fn follow(
        &self,
        plan: &Plan,
        from: &mut [Reference],
        to: &mut [Reference],
        depth: u32,
    ) -> Grown {
        let Some(halves) = &plan.halves else {
            return self.grow(Task::of_bucket(plan, from, to, depth));
        };
        let n = plan.count;
        if n < FORK {
            return Grown::run(n, n, |run| self.run_plan(plan, from, to, depth, 0, run));
        }
        let (from, to) = (
            from.split_at_mut(halves[0].count),
            to.split_at_mut(halves[0].count),
        );
        let (low, high) = rayon::join(
            || self.follow(&halves[0], from.0, to.0, depth + 1),
            || self.follow(&halves[1], from.1, to.1, depth + 1),
        );
        Grown::Fork(plan.bounds, Box::new([low, high]))
    }

    /// As [`Self::follow`], with its root at `run.nodes[at]`.
    fn run_plan(
        &self,
        plan: &Plan,
        from: &mut [Reference],
        to: &mut [Reference],
        depth: u32,
        at: usize,
        run: &mut Run,
    ) {
        let Some(halves) = &plan.halves else {
            return self.run(Task::of_bucket(plan, from, to, depth), at, run);
        };
        let first = run.fork(at, plan.bounds);
        let (from, to) = (
            from.split_at_mut(halves[0].count),
            to.split_at_mut(halves[0].count),
        );
        self.run_plan(&halves[0], from.0, to.0, depth + 1, first, run);
        self.run_plan(&halves[1], from.1, to.1, depth + 1, first + 1, run);
    }

    /// Builds a subtree whose root is `run.nodes[at]`.
    fn run(&self, mut task: Task, at: usize, run: &mut Run) {
        if task.valid.len() <= FEW {
            let spare = &mut task.to[..task.valid.len()];
            return sweep::grow(&mut task.from[task.valid], spare, task.bounds, at, run);
        }
        if let Some(plan) = task.plan() {
            return self.run_plan(&plan, task.to, task.from, task.depth, at, run);
        }
        let first = run.fork(at, task.bounds);
        let (low, high) = self.divide(task);
        self.run(low, first, run);
        self.run(high, first + 1, run);
    }

    /// Splits more than [`FEW`] references, or any number as deep as it may get.
    fn divide<'a>(&self, task: Task<'a>) -> (Task<'a>, Task<'a>) {
        if task.depth >= HALVE_FROM {
            return task.halve();
        }
        let references = &task.from[task.valid.clone()];
        let n = references.len();
        let spare = task.from.len() - n;
        let centres = Grid::new(centres(references));
        let object = split::object(references, &centres);
        let overlap = object.map_or(f32::INFINITY, |split| {
            let [a, b] = split.halves;
            a.intersection(b).half_area()
        });
        if spare > 0 && overlap > self.overlap {
            let space = Grid::new(task.bounds);
            let spatial = split::spatial(self.mesh, references, &space).filter(|spatial| {
                let [low, high] = spatial.counts;
                low < n
                    && high < n
                    && low + high <= n + spare
                    && object.is_none_or(|object| spatial.cost < object.cost)
            });
            if let Some(split) = spatial {
                return task.cut(self.mesh, &space, &split);
            }
        }
        match object {
            Some(split) => task.part(&centres, &split),
            None => task.halve(),
        }
    }
}
