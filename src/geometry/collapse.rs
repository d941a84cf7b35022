//! Which nodes of the binary tree become children of one wide node, by dynamic programming over
//! the surface area heuristic (H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal
//! on GPUs Through Compressed Wide BVHs", HPG 2017, section 3).
//!
//! For each binary node and each `k` in `1 ..= 7`: the least cost of representing its subtree by at
//! most `k` roots, each a leaf or a wide node. Costs are areas times the cost of a step; dividing by
//! the root's area gives the expected cost of a ray. Costs live on the stack of the recursion; what
//! is decided takes 8 bytes a binary node while the tree is built. Each node's decision is a function
//! of its subtree, so it does not matter which thread takes it.

use super::build::Binary;
use huygens_kernels::bvh::{BLOCK, WIDTH};
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};
use std::sync::atomic::{AtomicU64, Ordering};

/// Cost of testing a ray with a node, in whatever unit [`BLOCK_COST`] has.
pub(super) const NODE_COST: f32 = 1.0;
/// Cost of testing a ray with a block of triangles.
pub(super) const BLOCK_COST: f32 = 0.6;
/// Most triangles in a leaf.
pub(super) const MAX_LEAF: usize = BLOCK;
/// Nodes above this depth are decided in parallel.
const FORK: u32 = 12;
/// References that are looked through for triangles that occur more than once. What has more is no
/// leaf, unless most of them are the same.
const LOOK_THROUGH: u32 = 2 * MAX_LEAF as u32;

/// How a node is represented by at most so many roots.
#[derive(Clone, Copy)]
enum Share {
    /// A leaf.
    Leaf,
    /// A wide node.
    Wide,
    /// This many roots from its first child, and this many from its second: 1 to 7 each.
    Split(u8, u8),
}

impl Share {
    fn to_byte(self) -> u8 {
        match self {
            Self::Leaf => 0,
            Self::Wide => 1,
            Self::Split(left, right) => left << 4 | right,
        }
    }

    fn from_byte(byte: u8) -> Self {
        match byte {
            0 => Self::Leaf,
            1 => Self::Wide,
            split => Self::Split(split >> 4, split & 15),
        }
    }
}

/// What a node's parent needs to know of it.
struct Subtree {
    /// Entry `k`: cost with at most `k + 1` roots.
    costs: [f32; WIDTH - 1],
    /// Leaves of the binary tree.
    leaves: u32,
    /// References in them.
    references: u32,
}

/// The best way to collapse each node of a binary tree.
pub(super) struct Collapse<'a> {
    tree: &'a Binary,
    /// Byte `k` of an entry: with at most `k + 1` roots; the last one is how the node's own eight
    /// children are shared out. (Atomic, because threads write entries all over the table; each is
    /// written once.)
    shares: Vec<AtomicU64>,
    /// Cost of the whole tree.
    cost: f32,
}

impl<'a> Collapse<'a> {
    /// Decides for every node of a tree that is not empty, on the current rayon pool.
    pub(super) fn new(tree: &'a Binary) -> Self {
        let mut collapse = Self {
            tree,
            shares: Vec::new(),
            cost: 0.0,
        };
        collapse
            .shares
            .resize_with(tree.nodes.len(), AtomicU64::default);
        collapse.cost = collapse.solve(0, 0).costs[0];
        collapse
    }

    fn nodes(&self) -> &'a [Bvh2Node] {
        &self.tree.nodes
    }

    /// Expected cost of a ray that meets the root's box.
    pub(super) fn sah_cost(&self) -> f32 {
        let area = self.nodes()[0].aabb().half_area();
        if area > 0.0 { self.cost / area } else { 0.0 }
    }

    fn solve(&self, node: u32, depth: u32) -> Subtree {
        let binary = &self.nodes()[node as usize];
        let area = binary.aabb().half_area();
        if binary.is_leaf() {
            return Subtree {
                costs: [area * BLOCK_COST; WIDTH - 1],
                leaves: 1,
                references: binary.prim_count,
            };
        }
        let first = binary.first_index;
        let (left, right) = if depth < FORK {
            rayon::join(
                || self.solve(first, depth + 1),
                || self.solve(first + 1, depth + 1),
            )
        } else {
            (
                self.solve(first, depth + 1),
                self.solve(first + 1, depth + 1),
            )
        };
        let children = [first, first + 1].map(|i| *self.nodes()[i as usize].aabb());
        debug_assert_eq!(
            *binary.aabb(),
            children[0].union(&children[1]),
            "boxes are tight"
        );
        let references = left.references.saturating_add(right.references);
        let leaf = self.leaf_cost(node, area, references);
        let (costs, shares) = decide(area, leaf, &left, &right);
        let packed = u64::from_le_bytes(shares.map(Share::to_byte));
        self.shares[node as usize].store(packed, Ordering::Relaxed);
        Subtree {
            costs,
            leaves: left.leaves.saturating_add(right.leaves),
            references,
        }
    }

    /// Cost of `node` as a leaf.
    fn leaf_cost(&self, node: u32, area: f32, references: u32) -> f32 {
        let mut triangles = references as usize;
        if self.tree.repeats && triangles > MAX_LEAF && references <= LOOK_THROUGH {
            let mut distinct = Vec::with_capacity(triangles);
            self.triangles(node, &mut distinct);
            triangles = distinct.len();
        }
        if triangles <= MAX_LEAF {
            area * BLOCK_COST
        } else {
            f32::INFINITY
        }
    }

    fn share(&self, node: u32, roots: usize) -> Share {
        let packed = self.shares[node as usize].load(Ordering::Relaxed);
        Share::from_byte(packed.to_le_bytes()[roots - 1])
    }

    /// Whether `node` becomes a leaf when it stands alone.
    pub(super) fn is_leaf(&self, node: u32) -> bool {
        matches!(self.share(node, 1), Share::Leaf)
    }

    /// The box of `node`.
    pub(super) fn aabb(&self, node: u32) -> &'a Aabb {
        self.nodes()[node as usize].aabb()
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
        match self.share(node, roots) {
            Share::Split(left, right) => {
                let first = self.nodes()[node as usize].first_index;
                self.collect(first, left.into(), out);
                self.collect(first + 1, right.into(), out);
            }
            Share::Leaf | Share::Wide => out.push(node),
        }
    }

    /// The triangles of a leaf of the binary tree.
    fn run(&self, leaf: &Bvh2Node) -> &'a [u32] {
        let first = leaf.first_index as usize;
        &self.tree.triangles[first..first + leaf.prim_count as usize]
    }

    /// The triangles below `node`, left to right, each once.
    pub(super) fn triangles(&self, node: u32, out: &mut Vec<u32>) {
        out.clear();
        let one = &self.nodes()[node as usize];
        if one.is_leaf() {
            out.extend_from_slice(self.run(one));
            return;
        }
        let mut pending = vec![node];
        while let Some(i) = pending.pop() {
            let node = &self.nodes()[i as usize];
            if node.is_leaf() {
                out.extend_from_slice(self.run(node));
            } else {
                pending.extend([node.first_index + 1, node.first_index]);
            }
        }
        if !self.tree.repeats {
            return;
        }
        if out.len() <= LOOK_THROUGH as usize {
            let mut kept = 0;
            for i in 0..out.len() {
                if !out[..kept].contains(&out[i]) {
                    out[kept] = out[i];
                    kept += 1;
                }
            }
            out.truncate(kept);
        } else {
            let mut seen = std::collections::HashSet::with_capacity(out.len());
            out.retain(|&i| seen.insert(i));
        }
    }
}

/// Costs and shares of a node of area `area`, which would cost `leaf` as a leaf.
fn decide(
    area: f32,
    leaf: f32,
    left: &Subtree,
    right: &Subtree,
) -> ([f32; WIDTH - 1], [Share; WIDTH]) {
    // No subtree has more roots than leaves: larger shares bring nothing.
    let most = [left, right].map(|side| (side.leaves as usize).min(WIDTH - 1));
    // Where every cost is infinite the first split stands: still a valid tree.
    let split = |roots: usize| {
        let from = roots.saturating_sub(most[1]).max(1);
        let (mut best, mut share) = (f32::INFINITY, from);
        for k in from..=most[0].min(roots - 1) {
            let cost = left.costs[k - 1] + right.costs[roots - k - 1];
            if cost < best {
                (best, share) = (cost, k);
            }
        }
        (best, Share::Split(share as u8, (roots - share) as u8))
    };
    let all = most[0] + most[1];
    let mut costs = [0.0; WIDTH - 1];
    let mut shares = [Share::Leaf; WIDTH];
    let (own, share) = split(all.min(WIDTH));
    let wide = area * NODE_COST + own;
    shares[WIDTH - 1] = share;
    (costs[0], shares[0]) = if leaf <= wide && leaf < f32::INFINITY {
        (leaf, Share::Leaf)
    } else {
        (wide, Share::Wide)
    };
    for roots in 2..WIDTH {
        let unchanged = (costs[roots - 2], shares[roots - 2]);
        (costs[roots - 1], shares[roots - 1]) = if roots > all {
            unchanged
        } else {
            let (cost, share) = split(roots);
            if cost < unchanged.0 {
                (cost, share)
            } else {
                unchanged
            }
        };
    }
    (costs, shares)
}
