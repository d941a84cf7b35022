//! The tables that the kernels read, written from the collapsed tree.
//!
//! Nodes are numbered depth first, the children of a node side by side, and so are the blocks of
//! its leaves: what a ray visits next is often in the page, and sometimes in the line, that it has
//! just read.

use super::collapse::{BLOCK_COST, Collapse, MAX_LEAF, NODE_COST};
use super::pages::settle;
use crate::scene::Mesh;
use glam::Vec3A;
use huygens_kernels::bvh::{BLOCK, Block, MAX_DEPTH, Node, WIDTH, leaf};
use obvhs::aabb::Aabb;

/// From this depth on a subtree is no longer laid out as the collapse would have it, but cut into
/// eight equal runs again and again. That adds 10 levels at most (4 * 8^10 is the number of
/// references), so [`MAX_DEPTH`] holds whatever the input. Real scenes stay below 15.
const BALANCE_FROM: usize = MAX_DEPTH - 11;

/// The finished tables and what is known about them.
#[derive(Debug, Default)]
pub(super) struct Layout {
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<Block>,
    /// Nodes on the longest path.
    pub(super) depth: usize,
    /// Triangles in leaves.
    pub(super) triangles: usize,
    /// Expected cost of a ray through the root's box: see [`NODE_COST`].
    pub(super) sah: f64,
}

/// A wide node still to be written.
struct Pending {
    index: u32,
    depth: usize,
    what: What,
}

enum What {
    /// A node of the binary tree.
    Tree(u32),
    /// A run of triangles to be cut evenly.
    Run(Vec<u32>),
}

/// One child of a wide node.
struct Child {
    aabb: Aabb,
    what: What,
    is_leaf: bool,
}

impl Layout {
    /// Writes the tables of a tree that is not empty.
    ///
    /// # Panics
    /// If there are more triangles than references can tell apart (about 2^31).
    pub(super) fn new(mesh: &Mesh, collapse: &Collapse) -> Self {
        let mut out = Self::default();
        let mut pending = vec![Pending {
            index: 0,
            depth: 1,
            what: What::Tree(0),
        }];
        out.nodes.push(Node::EMPTY);
        let root_area = f64::from(collapse.aabb(0).half_area());
        let mut cost = 0.0;
        let mut triangles = Vec::new();
        while let Some(Pending { index, depth, what }) = pending.pop() {
            out.depth = out.depth.max(depth);
            let children = if depth >= BALANCE_FROM {
                evenly(mesh, collapse, what)
            } else {
                as_collapsed(collapse, &what)
            };
            let from = pending.len();
            for (slot, child) in children.into_iter().enumerate() {
                let area = f64::from(child.aabb.half_area());
                let reference = if child.is_leaf {
                    match child.what {
                        What::Tree(node) => collapse.triangles(node, &mut triangles),
                        What::Run(run) => triangles = run,
                    }
                    cost += area * f64::from(BLOCK_COST);
                    out.push_leaf(mesh, &triangles)
                } else {
                    cost += area * f64::from(NODE_COST);
                    pending.push(Pending {
                        index: out.nodes.len() as u32,
                        depth: depth + 1,
                        what: child.what,
                    });
                    out.nodes.push(Node::EMPTY);
                    out.nodes.len() as u32 - 1
                };
                let (min, max) = (child.aabb.min.to_array(), child.aabb.max.to_array());
                out.nodes[index as usize].set(slot, min, max, reference);
            }
            // The first child is written next.
            pending[from..].reverse();
        }
        assert!(out.depth <= MAX_DEPTH, "the depth of a tree is bounded");
        out.sah = f64::from(NODE_COST)
            + if root_area > 0.0 {
                cost / root_area
            } else {
                0.0
            };
        out.nodes = settle(out.nodes);
        out.blocks = settle(out.blocks);
        out
    }

    /// Writes the block of a leaf and returns its reference.
    fn push_leaf(&mut self, mesh: &Mesh, triangles: &[u32]) -> u32 {
        let row = |i: u32| (i, mesh.corners(i as usize));
        let mut rows = [row(triangles[0]); BLOCK];
        for (to, &from) in rows.iter_mut().zip(triangles) {
            *to = row(from);
        }
        self.blocks.push(Block::new(&rows[..triangles.len()]));
        self.triangles += triangles.len();
        leaf(self.blocks.len() - 1)
    }
}

/// The children that the collapse has chosen.
fn as_collapsed(collapse: &Collapse, what: &What) -> Vec<Child> {
    let What::Tree(node) = *what else {
        unreachable!("runs begin at BALANCE_FROM");
    };
    let mut nodes = Vec::with_capacity(WIDTH);
    collapse.children(node, &mut nodes);
    let child = |&node: &u32| Child {
        aabb: *collapse.aabb(node),
        what: What::Tree(node),
        is_leaf: collapse.is_leaf(node),
    };
    nodes.iter().map(child).collect()
}

/// Eight equal runs of the triangles below, in the order of the tree.
fn evenly(mesh: &Mesh, collapse: &Collapse, what: What) -> Vec<Child> {
    let run = match what {
        What::Run(run) => run,
        What::Tree(node) => {
            let mut run = Vec::new();
            collapse.triangles(node, &mut run);
            run
        }
    };
    run.chunks(run.len().div_ceil(WIDTH).max(BLOCK))
        .map(|run| Child {
            aabb: run
                .iter()
                .flat_map(|&i| mesh.corners(i as usize))
                .fold(Aabb::INVALID, |b, p| {
                    let p = Vec3A::from_array(p);
                    Aabb::new(b.min.min(p), b.max.max(p))
                }),
            what: What::Run(run.to_vec()),
            is_leaf: run.len() <= MAX_LEAF,
        })
        .collect()
}
