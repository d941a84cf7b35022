//! One ray at a time through the tree.
//!
//! The plain form, and the oracle of `flight.rs`. Both give answers that depend on the ray and the
//! triangles alone, as far as computed distances go: of equally near triangles the one with the
//! smallest index is taken, and boxes are never missed (`slabs.rs`), so neither the tree nor the
//! order of traversal shows.
//!
//! Distances that f32 cannot hold in the unit of an extremely short or long direction are reported
//! as the nearest that it can.
//!
//! Input: as [`crate::rays`] says; a ray with a component that is not finite, or without a
//! direction, meets nothing. Reads 28 to 36 bytes of a ray and writes 16 (closest) or 4 (occluded).

use crate::bvh::{BLOCK, Bvh, LEAF, NOTHING, index};
use crate::order::Stack;
use crate::query::{ClosestHit, Occlusion, Prepared, Query};
use crate::rays::{Hits, Rays, Segments};
use crate::visits;

/// Writes the closest hit of each ray.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest(bvh: Bvh, rays: Rays, hits: Hits) {
    walk(bvh, &mut ClosestHit { rays, hits });
}

/// Writes 1 for each segment that something lies on, else 0.
///
/// # Panics
/// If a column is shorter than `segments.len`.
pub fn occluded(bvh: Bvh, segments: Segments, occluded: &mut [u32]) {
    walk(bvh, &mut Occlusion { segments, occluded });
}

fn walk<Q: Query>(bvh: Bvh, query: &mut Q) {
    let mut stack = Stack::default();
    for i in 0..query.len() {
        if let Some((ray, mut state)) = query.start(i) {
            if !bvh.nodes.is_empty() {
                walk_one::<Q>(bvh, &ray, &mut state, &mut stack);
            }
            query.finish(i, &ray, &state);
        }
    }
}

fn walk_one<Q: Query>(bvh: Bvh, ray: &Prepared, state: &mut Q::State, stack: &mut Stack) {
    stack.clear();
    let mut next = 0;
    while next != NOTHING && !Q::settled(state) {
        if next & LEAF == 0 {
            visits::add(1, 0);
            let node = &bvh.nodes[index(next)];
            let (hits, enter) = ray.slabs.test(node, Q::limit(state));
            stack.push::<Q>(node, hits, enter);
        } else {
            visits::add(0, BLOCK);
            Q::visit(state, ray, &bvh.blocks[index(next)]);
        }
        next = stack.pop::<Q>(Q::limit(state));
    }
}
