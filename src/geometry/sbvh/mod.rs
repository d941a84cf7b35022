//! A binary tree from the top down, with object splits and spatial splits (M. Stich, H. Friedrich,
//! A. Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009): where boxes of long
//! triangles overlap whatever one does, a plane cuts the triangles' references instead.
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

use crate::scene::Mesh;
use bounds::Bounds;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;
use reference::Reference;
use split::Grid;
use std::ops::Range;

/// References that may be added, as a share of the triangles.
const BUDGET: f32 = 0.5;
/// A spatial split is tried where the halves of the object split overlap by more than this share
/// of the root's area (the paper's alpha).
const OVERLAP: f32 = 1e-5;
/// Fewest references of a node that is split in space; below, all fit into a block as they are.
const FEWEST: usize = huygens_kernels::bvh::BLOCK + 1;
/// Depth from which on nodes are halved.
const HALVE_FROM: u32 = 64;
/// References from which on the halves of a node are built in parallel.
const FORK: usize = 1 << 12;

/// The tree over the triangles `kept` of `mesh`, none of which may have a corner that is not
/// finite, nor an area that overflows: node 0 is the root, children lie side by side, a leaf's
/// `first_index` is its triangle. A triangle may be in several leaves, whose boxes cover it.
pub(super) fn build(mesh: &Mesh, kept: &[u32]) -> Vec<Bvh2Node> {
    if kept.is_empty() {
        return Vec::new();
    }
    let room = kept.len() + (kept.len() as f32 * BUDGET) as usize;
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
    let mut nodes = Vec::with_capacity(grown.len());
    nodes.push(Bvh2Node::default());
    grown.write(0, &mut nodes);
    nodes
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

/// A subtree that is built.
enum Grown {
    /// One run of nodes, the subtree's root first.
    Run(Vec<Bvh2Node>),
    /// Two halves that were built in parallel.
    Fork(Bounds, Box<[Grown; 2]>),
}

impl Grown {
    fn len(&self) -> usize {
        match self {
            Self::Run(run) => run.len(),
            Self::Fork(_, halves) => 1 + halves[0].len() + halves[1].len(),
        }
    }

    /// Writes the root to `nodes[at]` and appends the others.
    fn write(self, at: usize, nodes: &mut Vec<Bvh2Node>) {
        match self {
            Self::Run(run) => {
                // Indices in the run count from its root; its second node comes next.
                let offset = nodes.len() as u32 - 1;
                let moved = |mut node: Bvh2Node| {
                    if !node.is_leaf() {
                        node.first_index += offset;
                    }
                    node
                };
                nodes[at] = moved(run[0]);
                nodes.extend(run[1..].iter().map(|&node| moved(node)));
            }
            Self::Fork(bounds, halves) => {
                let first = nodes.len();
                nodes[at] = Bvh2Node::new(bounds.to_aabb(), 0, first as u32);
                nodes.extend([Bvh2Node::default(); 2]);
                let [low, high] = *halves;
                low.write(first, nodes);
                high.write(first + 1, nodes);
            }
        }
    }
}

impl Builder<'_> {
    fn grow(&self, task: Task) -> Grown {
        if task.valid.len() < FORK {
            let mut nodes = Vec::with_capacity(2 * task.valid.len());
            nodes.push(Bvh2Node::default());
            self.run(task, 0, &mut nodes);
            return Grown::Run(nodes);
        }
        let bounds = task.bounds;
        let (low, high) = self.divide(task);
        let (low, high) = rayon::join(|| self.grow(low), || self.grow(high));
        Grown::Fork(bounds, Box::new([low, high]))
    }

    /// Builds a subtree whose root is `nodes[at]`.
    fn run(&self, task: Task, at: usize, nodes: &mut Vec<Bvh2Node>) {
        let aabb = task.bounds.to_aabb();
        if task.valid.len() == 1 {
            let reference = task.from[task.valid.start];
            nodes[at] = Bvh2Node::new(aabb, 1, reference.triangle());
            return;
        }
        let first = nodes.len();
        nodes[at] = Bvh2Node::new(aabb, 0, first as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        let (low, high) = self.divide(task);
        self.run(low, first, nodes);
        self.run(high, first + 1, nodes);
    }

    /// Splits two or more references.
    fn divide<'a>(&self, task: Task<'a>) -> (Task<'a>, Task<'a>) {
        let references = &task.from[task.valid.clone()];
        let n = references.len();
        if n == 2 || task.depth >= HALVE_FROM {
            return task.halve();
        }
        let centres = Grid::new(task.centres);
        let object = split::object(references, &centres);
        let spare = task.from.len() - n;
        let overlap = object.map_or(f32::INFINITY, |split| {
            let [a, b] = split.halves;
            a.intersection(b).half_area()
        });
        if n >= FEWEST && spare > 0 && overlap > self.overlap {
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
