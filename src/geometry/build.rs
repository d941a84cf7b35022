//! From triangles to a binary tree: splitting (`sbvh/`) or clustering (`ploc.rs`), then obvhs'
//! reinsertion, which takes badly placed subtrees out and puts them where they cost least
//! (D. Meister, J. Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF
//! 37(2), 2018). It moves whole leaves, which splitting has filled: on trees with one triangle a
//! leaf it spoils the blocks, see `docs/performance.md`.

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
const DEEP: usize = 96;
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
        // A scene promises finite vertices. Should one slip through, its triangles are left out
        // rather than let spoil every comparison of areas.
        let kept: Vec<u32> = (0..mesh.triangles() as u32)
            .into_par_iter()
            .filter(|&i| is_finite(&bounds(mesh, i as usize)))
            .collect();
        if kept.is_empty() {
            return None;
        }
        let largest = mesh
            .vertices
            .par_iter()
            .flatten_iter()
            .map(|c| c.abs())
            .filter(|c| c.is_finite())
            .reduce(|| 0.0, f32::max);
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
        if depth(&self.nodes) < DEEP {
            let mut tree = Bvh2 {
                nodes: breadth_first(&self.nodes),
                ..Bvh2::default()
            };
            ReinsertionOptimizer::default().run(&mut tree, share, None);
            self.nodes = tree.nodes;
        }
        self
    }
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

/// The same tree with the nodes of a level before those of the next: reinsertion looks for
/// candidates at the front of the list, and means large nodes.
fn breadth_first(nodes: &[Bvh2Node]) -> Vec<Bvh2Node> {
    let mut sorted = Vec::with_capacity(nodes.len());
    sorted.push(nodes[0]);
    let mut next = 0;
    while next < sorted.len() {
        let first = sorted[next].first_index as usize;
        if !sorted[next].is_leaf() {
            sorted[next].first_index = sorted.len() as u32;
            sorted.extend([nodes[first], nodes[first + 1]]);
        }
        next += 1;
    }
    sorted
}

/// Nodes on the longest path from the root; children must come after their parents.
fn depth(nodes: &[Bvh2Node]) -> usize {
    let mut depth = vec![1u32; nodes.len()];
    for i in 0..nodes.len() {
        if !nodes[i].is_leaf() {
            let first = nodes[i].first_index as usize;
            depth[first] = depth[i] + 1;
            depth[first + 1] = depth[i] + 1;
        }
    }
    depth.into_iter().max().unwrap_or(0) as usize
}
