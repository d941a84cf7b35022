//! From triangles to a binary tree: splitting (`sbvh/`) or clustering (`ploc.rs`), then reinsertion
//! (`reinsert.rs`).

use super::{collapse::Collapse, ploc, reinsert, sbvh};
use crate::pages::Table;
use crate::scene::Mesh;
use crate::settings::Preset;
use glam::Vec3A;
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};
use rayon::prelude::*;

/// Share of the nodes that the first pass of reinsertion considers, for `balanced`.
const MEDIUM: f32 = 0.05;
/// The same for `best`.
const SLOW: f32 = 0.2;
/// References that `best` may add by cutting, as a share of the triangles.
const CUTS: f32 = 1.0;
/// Vertices that one task looks through.
const CHUNK: usize = 1 << 14;
/// Areas of boxes beyond this size overflow: there is no surface area heuristic, and nothing for
/// reinsertion to go by. Clustering takes whatever comes.
const HUGE: f32 = 1e18;

/// A binary tree. Node 0 is the root, children lie side by side, the first of two on an odd place, and
/// after their parents until reinsertion. A leaf holds `prim_count` entries of `triangles` from `first_index` on: at most a
/// block. Boxes of inner nodes are tight around their children's.
pub(super) struct Binary {
    pub(super) nodes: Table<Bvh2Node>,
    /// What leaves refer to.
    pub(super) triangles: Table<u32>,
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
            nodes: ploc::build(&boxes).into(),
            triangles: kept.to_vec().into(),
            repeats: false,
        }
    }

    /// Improves the tree where it can.
    fn reinsert(mut self, share: f32) -> Self {
        reinsert::improve(&mut self.nodes, share);
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
