//! The tables that the kernels read, planned from the collapsed tree; `tables` writes them.
//!
//! Below a small top, nodes are numbered depth first, the children of a node side by side, and so are
//! the blocks of its leaves: what a ray visits next is often in the page, and sometimes in the line, that it has
//! just read.

mod tables;

use super::collapse::{BLOCK_COST, Collapse, MAX_LEAF, NODE_COST};
use crate::pages::Table;
use crate::scene::Mesh;
use glam::Vec3A;
use huygens_kernels::bvh::{BLOCK, Block, MAX_DEPTH, Node, WIDTH, leaf};
use obvhs::aabb::Aabb;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::Range;

/// From this depth on a subtree is no longer laid out as the collapse would have it, but cut into
/// eight equal runs again and again. That adds 10 levels at most (4 * 8^10 is the number of
/// references), so [`MAX_DEPTH`] holds whatever the input. Real scenes stay below 15.
const BALANCE_FROM: usize = MAX_DEPTH - 11;

/// Subtrees that are written by tasks of their own.
const SUBTREES: usize = 256;

/// The finished tables and what is known about them.
#[derive(Debug, Default)]
pub(super) struct Layout {
    pub(super) nodes: Table<Node>,
    pub(super) blocks: Table<Block>,
    /// Nodes on the longest path.
    pub(super) depth: usize,
    /// Triangles in leaves.
    pub(super) triangles: usize,
    /// Expected cost of a ray through the root's box: see [`NODE_COST`].
    pub(super) sah: f64,
}

/// A wide node still to be planned.
struct Pending {
    index: u32,
    depth: usize,
    what: What,
}

#[derive(Clone, Copy)]
enum What {
    /// A node of the binary tree.
    Tree(u32),
    /// A run of triangles to be cut evenly, by its number in the part.
    Run(u32),
}

/// One child of a wide node.
#[derive(Clone, Copy)]
struct Child {
    /// Of its box.
    area: f32,
    what: What,
    is_leaf: bool,
}

/// The children of a wide node, so many of them.
type Children = ([Child; WIDTH], usize);

/// A run of triangles, and the box around them.
struct Run {
    aabb: Aabb,
    triangles: Vec<u32>,
}

/// What the tables will hold: those of the top of the tree, or of a subtree. References count from
/// the part's own first node and block.
#[derive(Default)]
struct Part {
    /// For each node where its children are in `children`.
    nodes: Vec<Range<usize>>,
    children: Vec<(What, u32)>,
    runs: Vec<Run>,
    blocks: usize,
    depth: usize,
    /// Sum over what the nodes hold of area times cost.
    cost: f64,
}

impl Layout {
    /// Writes the tables of a tree that is not empty, on the current rayon pool: plans the top,
    /// breadth first, and the subtrees below it, each by a task, and then has each write its share.
    ///
    /// # Panics
    /// If there are more triangles than references can tell apart (about 2^31).
    pub(super) fn new(mesh: &Mesh, collapse: &Collapse) -> Self {
        let mut top = Part::default();
        top.nodes.push(0..0);
        let mut pending = VecDeque::from([Pending {
            index: 0,
            depth: 1,
            what: What::Tree(0),
        }]);
        // A fixed number: what the tables look like must not depend on that of the threads.
        while pending.len() < SUBTREES {
            let Some(next) = pending.pop_front() else {
                break;
            };
            top.plan(mesh, collapse, next, |below| pending.push_back(below));
        }
        let subtrees: Vec<(u32, Part)> = pending
            .into_par_iter()
            .map(|root| (root.index, top.below(mesh, collapse, &root)))
            .collect();
        tables::write(mesh, collapse, &top, &subtrees)
    }
}

impl Part {
    /// The subtree below a node of this part, which is the first of the new part.
    fn below(&self, mesh: &Mesh, collapse: &Collapse, root: &Pending) -> Self {
        let mut part = Self::default();
        part.nodes.push(0..0);
        let what = match root.what {
            What::Run(run) => part.push_run(Run {
                aabb: self.runs[run as usize].aabb,
                triangles: self.runs[run as usize].triangles.clone(),
            }),
            tree @ What::Tree(_) => tree,
        };
        let mut pending = vec![Pending {
            index: 0,
            depth: root.depth,
            what,
        }];
        while let Some(next) = pending.pop() {
            let from = pending.len();
            part.plan(mesh, collapse, next, |below| pending.push(below));
            // The first child is planned next.
            pending[from..].reverse();
        }
        part
    }

    fn push_run(&mut self, run: Run) -> What {
        self.runs.push(run);
        What::Run(self.runs.len() as u32 - 1)
    }

    /// Chooses what a node holds, and names the nodes below it that are to be planned.
    fn plan(
        &mut self,
        mesh: &Mesh,
        collapse: &Collapse,
        Pending { index, depth, what }: Pending,
        mut below: impl FnMut(Pending),
    ) {
        self.depth = self.depth.max(depth);
        let (mut children, n) = match what {
            What::Tree(node) if depth < BALANCE_FROM => as_collapsed(collapse, node),
            _ => self.evenly(mesh, collapse, what),
        };
        // An occlusion query visits the highest slot first. A ray that enters a small box is more
        // likely to end there, and sooner, than in a large one.
        let children = &mut children[..n];
        children.sort_by(|a, b| b.area.total_cmp(&a.area));
        let first = self.children.len();
        for child in children {
            let area = f64::from(child.area);
            let reference = if child.is_leaf {
                self.cost += area * f64::from(BLOCK_COST);
                self.blocks += 1;
                leaf(self.blocks - 1)
            } else {
                self.cost += area * f64::from(NODE_COST);
                let index = self.nodes.len() as u32;
                below(Pending {
                    index,
                    depth: depth + 1,
                    what: child.what,
                });
                self.nodes.push(0..0);
                index
            };
            self.children.push((child.what, reference));
        }
        self.nodes[index as usize] = first..self.children.len();
    }

    /// Eight equal runs of the triangles below, in the order of the tree.
    fn evenly(&mut self, mesh: &Mesh, collapse: &Collapse, what: What) -> Children {
        let triangles = match what {
            What::Run(run) => std::mem::take(&mut self.runs[run as usize].triangles),
            What::Tree(node) => {
                let mut triangles = Vec::new();
                collapse.triangles(node, &mut triangles);
                triangles
            }
        };
        let mut children = [Child {
            area: 0.0,
            what,
            is_leaf: true,
        }; WIDTH];
        let runs = triangles.chunks(triangles.len().div_ceil(WIDTH).max(BLOCK));
        let n = runs.len();
        for (child, run) in children.iter_mut().zip(runs) {
            let points = run.iter().flat_map(|&i| mesh.corners(i as usize));
            let aabb = points.fold(Aabb::INVALID, |b, p| {
                let p = Vec3A::from_array(p);
                Aabb::new(b.min.min(p), b.max.max(p))
            });
            let what = self.push_run(Run {
                aabb,
                triangles: run.to_vec(),
            });
            *child = Child {
                area: aabb.half_area(),
                what,
                is_leaf: run.len() <= MAX_LEAF,
            };
        }
        (children, n)
    }
}

/// The children that the collapse has chosen.
fn as_collapsed(collapse: &Collapse, node: u32) -> Children {
    let (nodes, n) = collapse.children(node);
    let child = |node: u32| Child {
        area: collapse.aabb(node).half_area(),
        what: What::Tree(node),
        is_leaf: collapse.is_leaf(node),
    };
    // What is not used is the first one over again.
    let all = std::array::from_fn(|i| child(nodes[if i < n { i } else { 0 }]));
    (all, n)
}
