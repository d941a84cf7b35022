//! Which nodes of the binary tree become children of one wide node, by dynamic programming over
//! the surface area heuristic (H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal
//! on GPUs Through Compressed Wide BVHs", HPG 2017, section 3).
//!
//! For each binary node and each `k` in `1 ..= 7`: the least cost of representing its subtree by at
//! most `k` roots, each a leaf or a wide node. Costs are areas times the cost of a step; dividing by
//! the root's area gives the expected cost of a ray. The tables take 44 bytes a binary node while
//! the tree is built.

use super::build::Binary;
use huygens_kernels::bvh::{BLOCK, WIDTH};
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};

/// Cost of testing a ray with a node, in whatever unit [`BLOCK_COST`] has.
pub(super) const NODE_COST: f32 = 1.0;
/// Cost of testing a ray with a block of triangles.
pub(super) const BLOCK_COST: f32 = 0.6;
/// Most triangles in a leaf.
pub(super) const MAX_LEAF: usize = BLOCK;

/// How a node is represented by at most so many roots.
#[derive(Clone, Copy, Default)]
enum Share {
    /// A leaf.
    #[default]
    Leaf,
    /// A wide node.
    Wide,
    /// This many roots from its first child, and this many from its second.
    Split(u8, u8),
}

/// The best way to collapse each node of a binary tree.
pub(super) struct Collapse<'a> {
    nodes: &'a [Bvh2Node],
    /// `shares[node][k]`: with at most `k + 1` roots; the last entry is how the node's own eight
    /// children are shared out.
    shares: Vec<[Share; WIDTH]>,
}

impl<'a> Collapse<'a> {
    /// Decides for every node. Also tightens every box of the tree around its children, so that
    /// nothing that follows rests on how the tree was made.
    pub(super) fn new(tree: &'a mut Binary) -> Self {
        let order = top_down(&tree.nodes);
        let nodes = &mut tree.nodes;
        let mut costs = vec![[0.0f32; WIDTH - 1]; nodes.len()];
        let mut counts = vec![1u32; nodes.len()];
        let mut shares = vec![[Share::Leaf; WIDTH]; nodes.len()];
        for &i in order.iter().rev() {
            let i = i as usize;
            if nodes[i].is_leaf() {
                costs[i] = [nodes[i].aabb.half_area() * BLOCK_COST; WIDTH - 1];
                continue;
            }
            let (left, right) = children(&nodes[i]);
            nodes[i].aabb = nodes[left].aabb.union(&nodes[right].aabb);
            counts[i] = counts[left].saturating_add(counts[right]);
            let area = nodes[i].aabb.half_area();
            let leaf = leaf_cost(area, counts[i] as usize);
            (costs[i], shares[i]) = decide(area, leaf, &costs[left], &costs[right]);
        }
        Self {
            nodes: &tree.nodes,
            shares,
        }
    }

    /// Whether `node` becomes a leaf when it stands alone.
    pub(super) fn is_leaf(&self, node: u32) -> bool {
        matches!(self.shares[node as usize][0], Share::Leaf)
    }

    /// The box of `node`.
    pub(super) fn aabb(&self, node: u32) -> &'a Aabb {
        &self.nodes[node as usize].aabb
    }

    /// The nodes that become children of `node` as a wide node, left to right: one to eight.
    pub(super) fn children(&self, node: u32, out: &mut Vec<u32>) {
        out.clear();
        if self.is_leaf(node) {
            out.push(node);
        } else {
            self.collect(node, WIDTH, out);
        }
    }

    fn collect(&self, node: u32, roots: usize, out: &mut Vec<u32>) {
        match self.shares[node as usize][roots - 1] {
            Share::Split(left, right) => {
                let first = self.nodes[node as usize].first_index;
                self.collect(first, left.into(), out);
                self.collect(first + 1, right.into(), out);
            }
            Share::Leaf | Share::Wide => out.push(node),
        }
    }

    /// The triangles below `node`, left to right.
    pub(super) fn triangles(&self, node: u32, out: &mut Vec<u32>) {
        let mut pending = vec![node];
        out.clear();
        while let Some(i) = pending.pop() {
            let node = &self.nodes[i as usize];
            if node.is_leaf() {
                out.push(node.first_index);
            } else {
                pending.extend([node.first_index + 1, node.first_index]);
            }
        }
    }
}

fn children(node: &Bvh2Node) -> (usize, usize) {
    (node.first_index as usize, node.first_index as usize + 1)
}

fn leaf_cost(area: f32, count: usize) -> f32 {
    if count <= MAX_LEAF {
        area * BLOCK_COST
    } else {
        f32::INFINITY
    }
}

/// Costs and shares of a node of area `area`, which would cost `leaf` as a leaf.
fn decide(
    area: f32,
    leaf: f32,
    left: &[f32; WIDTH - 1],
    right: &[f32; WIDTH - 1],
) -> ([f32; WIDTH - 1], [Share; WIDTH]) {
    // Where every cost is infinite the first split stands: still a valid tree.
    let split = |roots: usize| {
        let (mut best, mut share) = (f32::INFINITY, 1);
        for k in 1..roots {
            if k < WIDTH && roots - k < WIDTH {
                let cost = left[k - 1] + right[roots - k - 1];
                if cost < best {
                    (best, share) = (cost, k);
                }
            }
        }
        (best, Share::Split(share as u8, (roots - share) as u8))
    };
    let mut costs = [0.0; WIDTH - 1];
    let mut shares = [Share::Leaf; WIDTH];
    let (own, share) = split(WIDTH);
    let wide = area * NODE_COST + own;
    shares[WIDTH - 1] = share;
    (costs[0], shares[0]) = if leaf <= wide && leaf < f32::INFINITY {
        (leaf, Share::Leaf)
    } else {
        (wide, Share::Wide)
    };
    for roots in 2..WIDTH {
        let (cost, share) = split(roots);
        (costs[roots - 1], shares[roots - 1]) = if cost < costs[roots - 2] {
            (cost, share)
        } else {
            (costs[roots - 2], shares[roots - 2])
        };
    }
    (costs, shares)
}

/// All nodes, parents before children.
fn top_down(nodes: &[Bvh2Node]) -> Vec<u32> {
    let mut order = Vec::with_capacity(nodes.len());
    let mut pending = Vec::new();
    if !nodes.is_empty() {
        pending.push(0);
    }
    while let Some(i) = pending.pop() {
        order.push(i);
        let node = &nodes[i as usize];
        if !node.is_leaf() {
            pending.extend([node.first_index + 1, node.first_index]);
        }
    }
    order
}
