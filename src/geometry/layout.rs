//! The tables that the kernels read, written from the collapsed tree.
//!
//! Below a small top, nodes are numbered depth first, the children of a node side by side, and so are
//! the blocks of its leaves: what a ray visits next is often in the page, and sometimes in the line, that it has
//! just read.

use super::collapse::{BLOCK_COST, Collapse, MAX_LEAF, NODE_COST};
use super::pages;
use crate::scene::Mesh;
use glam::Vec3A;
use huygens_kernels::bvh::{BLOCK, Block, LEAF, MAX_DEPTH, NOTHING, Node, WIDTH, index, leaf};
use obvhs::aabb::Aabb;
use rayon::prelude::*;
use std::collections::VecDeque;

/// From this depth on a subtree is no longer laid out as the collapse would have it, but cut into
/// eight equal runs again and again. That adds 10 levels at most (4 * 8^10 is the number of
/// references), so [`MAX_DEPTH`] holds whatever the input. Real scenes stay below 15.
const BALANCE_FROM: usize = MAX_DEPTH - 11;

/// Subtrees that are written by tasks of their own.
const SUBTREES: usize = 256;

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

/// Tables under construction: those of the top of the tree, or of a subtree.
#[derive(Default)]
struct Part {
    nodes: Vec<Node>,
    blocks: Vec<Block>,
    depth: usize,
    triangles: usize,
    /// Sum over what the nodes hold of area times cost.
    cost: f64,
}

impl Layout {
    /// Writes the tables of a tree that is not empty, on the current rayon pool: first the top,
    /// breadth first, then the subtrees below it, each by a task.
    ///
    /// # Panics
    /// If there are more triangles than references can tell apart (about 2^31).
    pub(super) fn new(mesh: &Mesh, collapse: &Collapse) -> Self {
        let mut top = Part::default();
        top.nodes.push(Node::EMPTY);
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
            top.write(mesh, collapse, next, |below| pending.push_back(below));
        }
        let subtrees: Vec<(u32, Part)> = pending
            .into_par_iter()
            .map(|root| (root.index, Part::below(mesh, collapse, root)))
            .collect();
        top.join(subtrees, f64::from(collapse.aabb(0).half_area()))
    }
}

impl Part {
    /// The subtree below a node, which is the first of the part.
    fn below(mesh: &Mesh, collapse: &Collapse, root: Pending) -> Self {
        let mut part = Self::default();
        part.nodes.push(Node::EMPTY);
        let mut pending = vec![Pending { index: 0, ..root }];
        while let Some(next) = pending.pop() {
            let from = pending.len();
            part.write(mesh, collapse, next, |below| pending.push(below));
            // The first child is written next.
            pending[from..].reverse();
        }
        part
    }

    /// Fills a node, and names the nodes below it that are to be filled.
    fn write(
        &mut self,
        mesh: &Mesh,
        collapse: &Collapse,
        Pending { index, depth, what }: Pending,
        mut below: impl FnMut(Pending),
    ) {
        self.depth = self.depth.max(depth);
        let mut children = if depth >= BALANCE_FROM {
            evenly(mesh, collapse, what)
        } else {
            as_collapsed(collapse, &what)
        };
        // An occlusion query visits the highest slot first. A ray that enters a small box is more
        // likely to end there, and sooner, than in a large one.
        let area = |child: &Child| child.aabb.half_area();
        children.sort_by(|a, b| area(b).total_cmp(&area(a)));
        let mut triangles = Vec::with_capacity(MAX_LEAF);
        for (slot, child) in children.into_iter().enumerate() {
            let area = f64::from(child.aabb.half_area());
            let reference = if child.is_leaf {
                match child.what {
                    What::Tree(node) => collapse.triangles(node, &mut triangles),
                    What::Run(run) => triangles = run,
                }
                self.cost += area * f64::from(BLOCK_COST);
                self.push_leaf(mesh, &triangles)
            } else {
                self.cost += area * f64::from(NODE_COST);
                let index = self.nodes.len() as u32;
                below(Pending {
                    index,
                    depth: depth + 1,
                    what: child.what,
                });
                self.nodes.push(Node::EMPTY);
                index
            };
            let (min, max) = (child.aabb.min.to_array(), child.aabb.max.to_array());
            self.nodes[index as usize].set(slot, min, max, reference);
        }
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

    /// The whole of the top and its subtrees, each to hang at the node named with it.
    fn join(self, subtrees: Vec<(u32, Self)>, root_area: f64) -> Layout {
        let parts = || subtrees.iter().map(|(_, part)| part);
        let nodes = parts().map(|p| p.nodes.len() - 1).sum::<usize>() + self.nodes.len();
        let blocks = parts().map(|p| p.blocks.len()).sum::<usize>() + self.blocks.len();
        let mut out = Layout {
            nodes: pages::table(nodes),
            blocks: pages::table(blocks),
            depth: parts().map(|p| p.depth).fold(self.depth, usize::max),
            triangles: parts().map(|p| p.triangles).sum::<usize>() + self.triangles,
            sah: f64::from(NODE_COST),
        };
        assert!(out.depth <= MAX_DEPTH, "the depth of a tree is bounded");
        let cost = parts().map(|p| p.cost).sum::<f64>() + self.cost;
        if root_area > 0.0 {
            out.sah += cost / root_area;
        }
        out.nodes.extend(self.nodes);
        out.blocks.extend(self.blocks);
        for (at, part) in subtrees {
            // The part's own first node goes to where it hangs, its second comes next.
            let (first_node, first_block) = (out.nodes.len() as u32 - 1, out.blocks.len());
            let moved = |mut node: Node| {
                for child in node.child.as_mut_array() {
                    *child = match *child {
                        NOTHING => NOTHING,
                        c if c & LEAF != 0 => leaf(first_block + index(c)),
                        c => first_node + c,
                    };
                }
                node
            };
            out.nodes[at as usize] = moved(part.nodes[0]);
            out.nodes.extend(part.nodes[1..].iter().map(|&n| moved(n)));
            out.blocks.extend(part.blocks);
        }
        out
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
