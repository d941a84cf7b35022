//! From triangles to a binary tree: boxes, clustering (`ploc.rs`), then obvhs' reinsertion, which
//! takes badly placed subtrees out and puts them where they cost least (D. Meister, J. Bittner,
//! "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF 37(2), 2018).

use super::{ploc, sbvh};
use crate::scene::Mesh;
use crate::settings::Preset;
use glam::Vec3A;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
};
use rayon::prelude::*;

/// Share of the nodes that one pass of reinsertion considers: obvhs' preset `medium`.
const REINSERTED: f32 = 0.05;
/// Reinsertion walks the tree with a stack of 192 entries that panics when it is full. Trees start
/// at 30 to 60 levels for millions of triangles and hardly grow; one that is this deep already
/// comes from boxes that reinsertion could not improve.
const DEEP: usize = 96;
/// Areas of boxes beyond this size overflow, and reinsertion cannot sort a NaN.
const HUGE: f32 = 1e18;

/// A binary tree with one triangle a leaf. Node 0 is the root; children lie side by side; a leaf's
/// `first_index` is its triangle.
pub(super) struct Binary {
    pub(super) nodes: Vec<Bvh2Node>,
}

impl Binary {
    /// The tree over all triangles of `mesh` that are finite.
    pub(super) fn build(mesh: &Mesh, preset: Preset) -> Self {
        if preset == Preset::Best {
            let kept: Vec<u32> = (0..mesh.triangles() as u32)
                .filter(|&i| is_finite(&bounds(mesh, i as usize)))
                .collect();
            let nodes = sbvh::build(mesh, &kept);
            let nodes = if std::env::var("NOREINS").is_ok() {
                nodes
            } else {
                reinsert(nodes)
            };
            return Self { nodes };
        }
        let boxes: Vec<Aabb> = (0..mesh.triangles())
            .into_par_iter()
            .map(|i| bounds(mesh, i))
            .collect();
        // A scene promises finite vertices. Should one slip through, its triangles are left out
        // rather than let spoil every comparison of areas.
        let bad: Vec<u32> = (0..boxes.len() as u32)
            .filter(|&i| !is_finite(&boxes[i as usize]))
            .collect();
        let mut nodes = if bad.is_empty() {
            ploc::build(&boxes)
        } else {
            build_some(&boxes)
        };
        let largest = nodes.first().map_or(0.0, |root| {
            root.aabb.min.abs().max(root.aabb.max.abs()).max_element()
        });
        if preset != Preset::Fast && largest < HUGE && depth(&nodes) < DEEP {
            nodes = reinsert(nodes);
        }
        Self { nodes }
    }
}

/// The tree over the finite boxes only.
fn build_some(boxes: &[Aabb]) -> Vec<Bvh2Node> {
    let good: Vec<u32> = (0..boxes.len() as u32)
        .filter(|&i| is_finite(&boxes[i as usize]))
        .collect();
    let kept: Vec<Aabb> = good.iter().map(|&i| boxes[i as usize]).collect();
    let mut nodes = ploc::build(&kept);
    for node in nodes.iter_mut().filter(|node| node.is_leaf()) {
        node.first_index = good[node.first_index as usize];
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

fn reinsert(nodes: Vec<Bvh2Node>) -> Vec<Bvh2Node> {
    let mut tree = Bvh2 {
        nodes,
        ..Bvh2::default()
    };
    ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
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
