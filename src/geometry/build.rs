//! From triangles to binary trees: boxes, clustering (`ploc.rs`) or splitting (`sbvh/`), then obvhs'
//! reinsertion, which takes badly placed subtrees out and puts them where they cost least
//! (D. Meister, J. Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF
//! 37(2), 2018).

use super::{ploc, sbvh};
use crate::scene::Mesh;
use crate::settings::Preset;
use glam::Vec3A;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
};
use rayon::prelude::*;

/// Share of the nodes that one pass of reinsertion considers.
fn reinserted(preset: Preset) -> f32 {
    match preset {
        Preset::Fast => 0.0,
        // obvhs' preset `medium`.
        Preset::Balanced => 0.05,
        // Its preset `slow`.
        Preset::Best => 0.2,
    }
}

/// Reinsertion walks the tree with a stack of 192 entries that panics when it is full. Trees start
/// at 30 to 60 levels for millions of triangles and hardly grow; one that is this deep already
/// comes from boxes that reinsertion could not improve.
const DEEP: usize = 96;
/// Areas of boxes beyond this size overflow, and neither reinsertion nor splitting can do with a
/// NaN.
const HUGE: f32 = 1e18;

/// A binary tree with one triangle a leaf. Node 0 is the root; children lie side by side; a leaf's
/// `first_index` is its triangle. Boxes of inner nodes are tight around their children's.
pub(super) struct Binary {
    pub(super) nodes: Vec<Bvh2Node>,
    /// Whether a triangle may be in more than one leaf.
    pub(super) repeats: bool,
}

impl Binary {
    /// The trees that `preset` chooses from, over all triangles of `mesh` that are finite; none if
    /// there are no such triangles.
    pub(super) fn candidates(mesh: &Mesh, preset: Preset) -> Vec<Self> {
        let boxes: Vec<Aabb> = (0..mesh.triangles())
            .into_par_iter()
            .map(|i| bounds(mesh, i))
            .collect();
        // A scene promises finite vertices. Should one slip through, its triangles are left out
        // rather than let spoil every comparison of areas.
        let is_bad = |i: &u32| !is_finite(&boxes[*i as usize]);
        let all = 0..boxes.len() as u32;
        let kept: Option<Vec<u32>> = all
            .clone()
            .into_par_iter()
            .any(|i| is_bad(&i))
            .then(|| all.clone().filter(|i| !is_bad(i)).collect());
        let mut nodes = match &kept {
            None => ploc::build(&boxes),
            Some(kept) => build_some(&boxes, kept),
        };
        let Some(root) = nodes.first().map(|root| root.aabb) else {
            return Vec::new();
        };
        let largest = root.min.abs().max(root.max.abs()).max_element();
        let share = reinserted(preset);
        if largest < HUGE && depth(&nodes) < DEEP {
            nodes = reinsert(nodes, share);
        }
        let mut candidates = vec![Self {
            nodes,
            repeats: false,
        }];
        if preset == Preset::Best && largest < HUGE {
            drop(boxes);
            let kept = kept.unwrap_or_else(|| all.collect());
            candidates.push(Self {
                nodes: reinsert(sbvh::build(mesh, &kept), share),
                repeats: true,
            });
        }
        candidates
    }
}

/// The tree over the boxes `kept` only.
fn build_some(boxes: &[Aabb], kept: &[u32]) -> Vec<Bvh2Node> {
    let some: Vec<Aabb> = kept.iter().map(|&i| boxes[i as usize]).collect();
    let mut nodes = ploc::build(&some);
    for node in nodes.iter_mut().filter(|node| node.is_leaf()) {
        node.first_index = kept[node.first_index as usize];
    }
    nodes
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

fn reinsert(nodes: Vec<Bvh2Node>, share: f32) -> Vec<Bvh2Node> {
    if share == 0.0 {
        return nodes;
    }
    let mut tree = Bvh2 {
        nodes,
        ..Bvh2::default()
    };
    ReinsertionOptimizer::default().run(&mut tree, share, None);
    tree.nodes
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
