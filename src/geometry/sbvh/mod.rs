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
//! **Bounds.** A path has at most [`HALVE_FROM`] chosen splits; below, nodes are cut in the middle
//! of their list. So time is O(n log n) and the depth bounded, whatever comes in.

mod bounds;
mod distribute;
mod reference;
mod split;
mod sweep;

use super::build::Binary;
use crate::scene::Mesh;
use bounds::Bounds;
use huygens_kernels::bvh::BLOCK;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;
use reference::Reference;
use split::Grid;
use std::ops::Range;
use sweep::{FEW, Sweep};

/// A spatial split is tried where the halves of the object split overlap by more than this share
/// of the root's area (the paper's alpha, there 1e-5, which takes longer and gains nothing; nor
/// does it gain anything to cut a few references).
const OVERLAP: f32 = 1e-4;
/// A block's worth of references is split all the same where that leaves less than this share of
/// the area: they lie far apart. (More splits would gain hardly anything, and cost memory.)
const SPREAD: f32 = 0.8;
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
    let mut from: Vec<Reference> = Vec::with_capacity(room);
    kept.par_iter()
        .map(|&i| {
            let [a, b, c] = mesh.corners(i as usize).map(Bounds::point);
            Reference::new(a.union(b).union(c), i)
        })
        .collect_into_vec(&mut from);
    let (bounds, centres) = from
        .par_iter()
        .map(|r| (r.bounds(), r.bounds().twice_centre()))
        .reduce(
            || (Bounds::EMPTY, Bounds::EMPTY),
            |a, b| (a.0.union(b.0), a.1.union(b.1)),
        );
    from.resize(room, Reference::new(Bounds::EMPTY, 0));
    let mut to = from.clone();
    let builder = Builder {
        mesh,
        overlap: bounds.half_area() * OVERLAP,
    };
    let root = Task {
        valid: 0..kept.len(),
        from: &mut from,
        to: &mut to,
        bounds,
        centres,
        depth: 0,
    };
    let grown = builder.grow(root);
    drop((from, to));
    let (nodes, triangles) = grown.len();
    let mut tree = Binary {
        nodes: Vec::with_capacity(nodes),
        triangles: Vec::with_capacity(triangles),
        repeats: triangles > kept.len(),
    };
    tree.nodes.push(Bvh2Node::default());
    grown.write(0, &mut tree);
    tree
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
    /// Around twice their centres.
    centres: Bounds,
    depth: u32,
}

impl Task<'_> {
    /// The best way to part a few references, two at least, above the depth where all is halved.
    fn sweep(&self) -> Option<Sweep> {
        let few = (2..=FEW).contains(&self.valid.len()) && self.depth < HALVE_FROM;
        few.then(|| sweep::sweep(&self.from[self.valid.clone()]))
    }
}

/// A subtree that is built.
enum Grown {
    /// Built by one task: the subtree's root comes first.
    Run(Binary),
    /// Two halves that were built in parallel.
    Fork(Bounds, Box<[Grown; 2]>),
}

impl Grown {
    /// Nodes and references.
    fn len(&self) -> (usize, usize) {
        match self {
            Self::Run(run) => (run.nodes.len(), run.triangles.len()),
            Self::Fork(_, halves) => {
                let [low, high] = halves.each_ref().map(Self::len);
                (1 + low.0 + high.0, low.1 + high.1)
            }
        }
    }

    /// Writes the root to `tree.nodes[at]` and appends the others.
    fn write(self, at: usize, tree: &mut Binary) {
        match self {
            Self::Run(run) => {
                // Indices in the run count from its root; its second node comes next.
                let nodes = tree.nodes.len() as u32 - 1;
                let triangles = tree.triangles.len() as u32;
                let moved = |mut node: Bvh2Node| {
                    node.first_index += if node.is_leaf() { triangles } else { nodes };
                    node
                };
                tree.nodes[at] = moved(run.nodes[0]);
                tree.nodes
                    .extend(run.nodes[1..].iter().map(|&node| moved(node)));
                tree.triangles.extend(run.triangles);
            }
            Self::Fork(bounds, halves) => {
                let first = tree.nodes.len();
                tree.nodes[at] = Bvh2Node::new(bounds.to_aabb(), 0, first as u32);
                tree.nodes.extend([Bvh2Node::default(); 2]);
                let [low, high] = *halves;
                low.write(first, tree);
                high.write(first + 1, tree);
            }
        }
    }
}

impl Builder<'_> {
    fn grow(&self, task: Task) -> Grown {
        if task.valid.len() < FORK {
            let mut run = Binary {
                nodes: Vec::with_capacity(task.valid.len()),
                triangles: Vec::with_capacity(task.from.len()),
                repeats: false,
            };
            run.nodes.push(Bvh2Node::default());
            self.run(task, 0, &mut run);
            return Grown::Run(run);
        }
        let bounds = task.bounds;
        let (low, high) = self.divide(task);
        let (low, high) = rayon::join(|| self.grow(low), || self.grow(high));
        Grown::Fork(bounds, Box::new([low, high]))
    }

    /// Builds a subtree whose root is `run.nodes[at]`.
    fn run(&self, task: Task, at: usize, run: &mut Binary) {
        let aabb = task.bounds.to_aabb();
        let count = task.valid.len();
        let few = task.sweep();
        if count <= BLOCK && few.is_none_or(|few| few.cost >= SPREAD * task.bounds.half_area()) {
            run.nodes[at] = Bvh2Node::new(aabb, count as u32, run.triangles.len() as u32);
            let references = &task.from[task.valid];
            run.triangles
                .extend(references.iter().map(|r| r.triangle()));
            return;
        }
        let first = run.nodes.len();
        run.nodes[at] = Bvh2Node::new(aabb, 0, first as u32);
        run.nodes.extend([Bvh2Node::default(); 2]);
        let (low, high) = match few {
            Some(few) => task.sort(&few),
            None => self.divide(task),
        };
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
        let centres = Grid::new(task.centres);
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
