//! From triangles to a binary tree: splitting (`sbvh/`) or clustering (`ploc.rs`), then obvhs'
//! reinsertion, which takes badly placed subtrees out and puts them where they cost least
//! (D. Meister, J. Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF
//! 37(2), 2018). It moves whole leaves, which splitting has filled: on trees with one triangle a
//! leaf it spoils the blocks, see `docs/performance/trees.md`.

use super::{collapse::Collapse, ploc, sbvh};
use crate::scene::Mesh;
use crate::settings::Preset;
use glam::Vec3A;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
};
use rayon::prelude::*;

/// Share of the nodes that one pass of reinsertion considers, for `balanced`: obvhs' own `medium`.
const MEDIUM: f32 = 0.05;
/// The same for `best`: obvhs' own `slow`.
const SLOW: f32 = 0.2;
/// References that `best` may add by cutting, as a share of the triangles.
const CUTS: f32 = 1.0;
/// Reinsertion walks the tree with a stack of 192 entries that panics when it is full. Trees start
/// at 30 to 60 levels for millions of triangles and hardly grow; one that is this deep already
/// comes from boxes that reinsertion could not improve.
const DEEP: u32 = 96;
/// Vertices that one task looks through.
const CHUNK: usize = 1 << 14;
/// Levels whose nodes are looked through in parallel.
const FORK: u32 = 8;
/// Areas of boxes beyond this size overflow: there is no surface area heuristic, and reinsertion
/// panics on a NaN. Clustering takes whatever comes.
const HUGE: f32 = 1e18;

/// A binary tree. Node 0 is the root, children lie side by side and after their parents until
/// reinsertion. A leaf holds `prim_count` entries of `triangles` from `first_index` on: at most a
/// block. Boxes of inner nodes are tight around their children's.
pub(super) struct Binary {
    pub(super) nodes: Vec<Bvh2Node>,
    /// What leaves refer to.
    pub(super) triangles: Vec<u32>,
    /// Whether a triangle may be in more than one leaf.
    pub(super) repeats: bool,
}

impl Binary {
    /// The tree over all triangles of `mesh` that are finite; none if there are no such triangles.
    pub(super) fn build(mesh: &Mesh, preset: Preset) -> Option<Self> {
        let (largest, all_finite) = extremes(&mesh.vertices);
        // A scene promises finite vertices. Should one slip through, its triangles are left out
        // rather than let spoil every comparison of areas.
        let all = (0..mesh.triangles() as u32).into_par_iter();
        let kept: Vec<u32> = if all_finite {
            all.collect()
        } else {
            all.filter(|&i| is_finite(&bounds(mesh, i as usize)))
                .collect()
        };
        if kept.is_empty() {
            return None;
        }
        if largest >= HUGE {
            return Some(Self::cluster(mesh, &kept));
        }
        Some(match preset {
            Preset::Fast => sbvh::build(mesh, &kept, 0.0),
            Preset::Balanced => sbvh::build(mesh, &kept, 0.0).reinsert(MEDIUM),
            Preset::Best => {
                // One after the other, so that no more than two are in memory.
                let split = sbvh::build(mesh, &kept, 0.0).reinsert(SLOW);
                let split = split.or(Self::cluster(mesh, &kept).reinsert(SLOW));
                split.or(sbvh::build(mesh, &kept, CUTS).reinsert(SLOW))
            }
        })
    }

    /// The tree that costs less; if both cost the same, this one.
    fn or(self, other: Self) -> Self {
        if Collapse::new(&other).sah_cost() < Collapse::new(&self).sah_cost() {
            other
        } else {
            self
        }
    }

    /// The tree over the triangles `kept`, by clustering.
    fn cluster(mesh: &Mesh, kept: &[u32]) -> Self {
        let boxes: Vec<Aabb> = kept.par_iter().map(|&i| bounds(mesh, i as usize)).collect();
        Self {
            nodes: ploc::build(&boxes),
            triangles: kept.to_vec(),
            repeats: false,
        }
    }

    /// Improves the tree where it can.
    fn reinsert(mut self, share: f32) -> Self {
        if depth(&self.nodes, 0, 1) < DEEP {
            // obvhs' own passes, over fewer and fewer nodes, look for these at the front of a list in
            // breadth-first order, into which the whole tree would have to be brought. So it is told.
            let most = (self.nodes.len() as f32 * share) as usize;
            let front = breadth_first(&self.nodes, 2 * most + 1);
            let mut tree = Bvh2 {
                nodes: self.nodes,
                ..Bvh2::default()
            };
            let mut optimizer = ReinsertionOptimizer::default();
            for part in (1..32).step_by(2) {
                let candidates = largest(&tree.nodes, &front, (most / part).max(1));
                optimizer.run_with_candidates(&mut tree, &candidates, 1);
            }
            self.nodes = tree.nodes;
        }
        self
    }
}

/// The largest finite coordinate without its sign, and whether all are finite.
fn extremes(vertices: &[[f32; 3]]) -> (f32, bool) {
    // Without their sign, numbers are in the order of their bits, infinity and what is no number last.
    let bits = |c: &f32| c.abs().to_bits();
    let largest = |part: &[[f32; 3]]| {
        let coordinates = part.as_flattened().iter();
        coordinates.fold(0, |most, c| most.max(bits(c)))
    };
    let most = vertices.par_chunks(CHUNK).map(largest).max().unwrap_or(0);
    if f32::from_bits(most).is_finite() {
        return (f32::from_bits(most), true);
    }
    let finite = vertices.par_iter().flatten_iter().filter(|c| c.is_finite());
    (f32::from_bits(finite.map(bits).max().unwrap_or(0)), false)
}

fn is_finite(aabb: &Aabb) -> bool {
    aabb.min.is_finite() && aabb.max.is_finite()
}

/// The box of triangle `i`; not finite if a corner is not.
fn bounds(mesh: &Mesh, i: usize) -> Aabb {
    let [a, b, c] = mesh.corners(i).map(Vec3A::from_array);
    if !(a.is_finite() && b.is_finite() && c.is_finite()) {
        return Aabb::INFINITY;
    }
    Aabb::new(a.min(b).min(c), a.max(b).max(c))
}

/// The first nodes below the root, level by level, `most` of them if there are so many.
fn breadth_first(nodes: &[Bvh2Node], most: usize) -> Vec<u32> {
    let mut front = Vec::with_capacity(most + 2);
    let children = |node: u32| {
        let node = &nodes[node as usize];
        (!node.is_leaf()).then(|| [node.first_index, node.first_index + 1])
    };
    front.extend(children(0).into_iter().flatten());
    let mut next = 0;
    while next < front.len() && front.len() < most {
        front.extend(children(front[next]).into_iter().flatten());
        next += 1;
    }
    front
}

/// Of twice as many nodes at the front of a list the `most` that have the largest boxes, by falling
/// area.
fn largest(nodes: &[Bvh2Node], front: &[u32], most: usize) -> Vec<u32> {
    // Areas are not negative, so their bits are in their order.
    let key = |(i, &node): (usize, &u32)| {
        let area = nodes[node as usize].aabb().half_area();
        u64::from(!area.to_bits()) << 32 | i as u64
    };
    let front = &front[..front.len().min(2 * most + 1)];
    let mut keys: Vec<u64> = front.par_iter().enumerate().map(key).collect();
    keys.par_sort_unstable();
    keys.truncate(most);
    let node = |key: u64| front[key as u32 as usize];
    keys.into_iter().map(node).collect()
}

/// Nodes on the longest path from the root, if `node` is the one numbered `level` on its own path.
fn depth(nodes: &[Bvh2Node], node: u32, level: u32) -> u32 {
    let first = nodes[node as usize].first_index;
    if nodes[node as usize].is_leaf() {
        return level;
    }
    let below = |node: u32| depth(nodes, node, level + 1);
    let (low, high) = if level <= FORK {
        rayon::join(|| below(first), || below(first + 1))
    } else {
        (below(first), below(first + 1))
    };
    low.max(high)
}
