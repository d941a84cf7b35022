//! Which nodes of the binary tree become children of one wide node, by dynamic programming over
//! the surface area heuristic (H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal
//! on GPUs Through Compressed Wide BVHs", HPG 2017, section 3).
//!
//! For each binary node and each `k` in `1 ..= 7`: the least cost of representing its subtree by at
//! most `k` roots, each a leaf or a wide node. Costs are areas times the cost of a step; dividing by
//! the root's area gives the expected cost of a ray. Costs live on the stack of the recursion; what
//! is decided takes 8 bytes a binary node while the tree is built. Each node's decision is a function
//! of its subtree, so it does not matter which thread takes it.

#[cfg(test)]
mod tests_of_shares;

use super::build::Binary;
use huygens_kernels::bvh::{BLOCK, WIDTH};
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use wide::{f32x4, f32x8, u32x8};

/// Cost of testing a ray with a node, in whatever unit [`BLOCK_COST`] has.
pub(super) const NODE_COST: f32 = 1.0;
/// Cost of testing a ray with a block of triangles.
pub(super) const BLOCK_COST: f32 = 0.6;
/// Most triangles in a leaf.
pub(super) const MAX_LEAF: usize = BLOCK;
/// Nodes above this depth are decided in parallel, unless the tree is so small that a task would have
/// fewer nodes than a power of two.
const FORK: u32 = 12;
const TASK: u32 = 6;
/// Entries of a table that one task writes, at least.
const MANY: usize = 1 << 12;
/// References that are looked through for triangles that occur more than once. What has more is no
/// leaf, unless most of them are the same.
const LOOK_THROUGH: u32 = 2 * MAX_LEAF as u32;

/// How a node is represented by at most so many roots: a byte.
#[derive(Clone, Copy)]
struct Share(u8);

impl Share {
    /// A leaf.
    const LEAF: Self = Self(0);
    /// A wide node.
    const WIDE: Self = Self(1);

    /// So many roots from its first child, and so many from its second, where it is split between them:
    /// 1 to 7 each.
    fn split(self) -> Option<(usize, usize)> {
        (self.0 > Self::WIDE.0).then(|| (usize::from(self.0 >> 4), usize::from(self.0 & 15)))
    }
}

/// What a node's parent needs to know of it.
struct Subtree {
    /// Entry `k`: cost with at most `k + 1` roots; infinite if it has no more than `k` leaves, and in the
    /// last entry, because no child is given as many.
    costs: [f32; WIDTH],
    /// Leaves of the binary tree.
    leaves: u32,
    /// References in them.
    references: u32,
}

/// The best way to collapse each node of a binary tree.
pub(super) struct Collapse<'a> {
    nodes: &'a [Bvh2Node],
    triangles: &'a [u32],
    /// Whether a triangle may be in more than one leaf.
    repeats: bool,
    /// Byte `k` of an entry: with at most `k + 1` roots; the last one is how the node's own eight
    /// children are shared out. (Atomic, because threads write entries all over the table; each is
    /// written once.)
    shares: Vec<AtomicU64>,
    /// Cost of the whole tree.
    cost: f32,
    /// Depth above which nodes are decided in parallel.
    fork: u32,
}

impl<'a> Collapse<'a> {
    /// Decides for every node of a tree that is not empty, on the current rayon pool.
    pub(super) fn new(tree: &'a Binary) -> Self {
        let entries = (0..tree.nodes.len()).into_par_iter().with_min_len(MANY);
        let mut collapse = Self {
            nodes: &tree.nodes,
            triangles: &tree.triangles,
            repeats: tree.repeats,
            shares: entries.map(|_| AtomicU64::new(0)).collect(),
            cost: 0.0,
            fork: tree.nodes.len().ilog2().saturating_sub(TASK).min(FORK),
        };
        collapse.cost = collapse.solve(0, 0).costs[0];
        collapse
    }

    /// Expected cost of a ray that meets the root's box.
    pub(super) fn sah_cost(&self) -> f32 {
        let area = self.nodes[0].aabb().half_area();
        if area > 0.0 { self.cost / area } else { 0.0 }
    }

    fn solve(&self, node: u32, depth: u32) -> Subtree {
        let binary = &self.nodes[node as usize];
        let area = binary.aabb().half_area();
        if binary.is_leaf() {
            let mut costs = [f32::INFINITY; WIDTH];
            costs[0] = area * BLOCK_COST;
            return Subtree {
                costs,
                leaves: 1,
                references: binary.prim_count,
            };
        }
        let first = binary.first_index;
        let (left, right) = if depth < self.fork {
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
        let children = [first, first + 1].map(|i| *self.nodes[i as usize].aabb());
        debug_assert_eq!(
            *binary.aabb(),
            children[0].union(&children[1]),
            "boxes are tight"
        );
        let references = left.references.saturating_add(right.references);
        let leaf = self.leaf_cost(node, area, references);
        let (costs, shares) = decide(area, leaf, &left, &right);
        self.shares[node as usize].store(u64::from_le_bytes(shares), Ordering::Relaxed);
        Subtree {
            costs,
            leaves: left.leaves.saturating_add(right.leaves),
            references,
        }
    }

    /// Cost of `node` as a leaf.
    fn leaf_cost(&self, node: u32, area: f32, references: u32) -> f32 {
        let mut triangles = references as usize;
        if self.repeats && triangles > MAX_LEAF && references <= LOOK_THROUGH {
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
        Share(packed.to_le_bytes()[roots - 1])
    }

    /// Whether `node` becomes a leaf when it stands alone.
    pub(super) fn is_leaf(&self, node: u32) -> bool {
        self.share(node, 1).0 == Share::LEAF.0
    }

    /// The box of `node`.
    pub(super) fn aabb(&self, node: u32) -> &'a Aabb {
        self.nodes[node as usize].aabb()
    }

    /// Lower and upper corner of the box of `node`; their last lanes mean nothing.
    pub(super) fn corners(&self, node: u32) -> [f32x4; 2] {
        bytemuck::cast(self.nodes[node as usize])
    }

    /// The nodes that become children of `node` as a wide node, left to right, and how many they are: one
    /// to eight.
    pub(super) fn children(&self, node: u32) -> ([u32; WIDTH], usize) {
        let (mut out, mut n) = ([node; WIDTH], 1);
        if !self.is_leaf(node) {
            n = 0;
            self.collect(node, WIDTH, &mut out, &mut n);
        }
        (out, n)
    }

    fn collect(&self, node: u32, roots: usize, out: &mut [u32; WIDTH], n: &mut usize) {
        if let Some((left, right)) = self.share(node, roots).split() {
            let first = self.nodes[node as usize].first_index;
            self.collect(first, left, out, n);
            self.collect(first + 1, right, out, n);
        } else {
            out[*n % WIDTH] = node;
            *n += 1;
        }
    }

    /// The triangles of a leaf of the binary tree.
    fn run(&self, leaf: &Bvh2Node) -> &'a [u32] {
        let first = leaf.first_index as usize;
        &self.triangles[first..first + leaf.prim_count as usize]
    }

    fn gather(&self, node: u32, out: &mut Vec<u32>) {
        let node = &self.nodes[node as usize];
        if node.is_leaf() {
            out.extend_from_slice(self.run(node));
        } else {
            self.gather(node.first_index, out);
            self.gather(node.first_index + 1, out);
        }
    }

    /// As [`Self::triangles`], which are in `out` only where they do not lie side by side already.
    pub(super) fn run_of<'o>(&self, node: u32, out: &'o mut Vec<u32>) -> &'o [u32]
    where
        'a: 'o,
    {
        let one = &self.nodes[node as usize];
        if one.is_leaf() {
            return self.run(one);
        }
        self.triangles(node, out);
        out
    }

    /// The triangles below `node`, left to right, each once.
    pub(super) fn triangles(&self, node: u32, out: &mut Vec<u32>) {
        out.clear();
        self.gather(node, out);
        if self.nodes[node as usize].is_leaf() {
            return;
        }
        if !self.repeats {
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

/// Costs and shares of a node of area `area`, which would cost `leaf` as a leaf. Byte `k` of the shares
/// is for `k + 1` roots.
///
/// All numbers of roots are considered at once, a lane each: with `k` of them from the left half the rest
/// come from the right half, whose costs are moved up by `k` lanes for that.
fn decide(area: f32, leaf: f32, left: &Subtree, right: &Subtree) -> ([f32; WIDTH], [u8; WIDTH]) {
    // No subtree has more roots than leaves: larger shares bring nothing, and cost infinitely much.
    let most = [left, right].map(|side| (side.leaves as usize).min(WIDTH - 1));
    let mut moved = [f32::INFINITY; 2 * WIDTH];
    moved[WIDTH..].copy_from_slice(&right.costs);
    let mut best = f32x8::splat(f32::INFINITY);
    // Where every cost is infinite the first split stands: still a valid tree.
    let first = std::array::from_fn(|i| (i + 1).saturating_sub(most[1]).max(1) as u32);
    let mut from_left = u32x8::new(first);
    for k in 1..WIDTH {
        let rest: [f32; WIDTH] = std::array::from_fn(|i| moved[WIDTH - k + i]);
        let costs = f32x8::splat(left.costs[k - 1]) + f32x8::new(rest);
        let less = costs.simd_lt(best);
        best = less.select(costs, best);
        let k = u32x8::splat(k as u32);
        from_left = bytemuck::cast::<f32x8, u32x8>(less).select(k, from_left);
    }
    // `left << 4 | right`, where the two make up the number of roots.
    let splits = from_left * u32x8::splat(15) + u32x8::new([1, 2, 3, 4, 5, 6, 7, 8]);
    let (best, splits) = (best.to_array(), splits.to_array());
    let all = most[0] + most[1];
    let own = all.min(WIDTH) - 1;
    let wide = area * NODE_COST + best[own];
    let (mut cost, mut share) = if leaf <= wide && leaf < f32::INFINITY {
        (leaf, Share::LEAF.0)
    } else {
        (wide, Share::WIDE.0)
    };
    let mut costs = [f32::INFINITY; WIDTH];
    let mut shares = [splits[own] as u8; WIDTH];
    for k in 0..WIDTH - 1 {
        if best[k] < cost && k > 0 {
            (cost, share) = (best[k], splits[k] as u8);
        }
        costs[k] = if k < all { cost } else { f32::INFINITY };
        shares[k] = share;
    }
    (costs, shares)
}
