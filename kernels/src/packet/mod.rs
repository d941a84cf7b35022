//! Eight rays at once through the tree, where they go the same way: camera rays.
//!
//! Neighbouring camera rays meet the same nodes. So eight of them walk together, a lane each, and
//! share what a step costs: a node's eight boxes are tested once against an interval that holds all
//! eight rays, its children are sorted once, its cache lines come from memory once. A leaf's box is
//! then tested by each ray for itself, eight at a time, and so are its triangles, as in `few.rs`.
//!
//! **Which rays.** Eight neighbours of the view make a packet if they agree on the main axis and on
//! the signs of all components, no component's reciprocal overflows, and their slopes lie within
//! `SPREAD`. Rays scattered by a surface hardly ever do, and asking costs little; so nobody needs
//! to say which rays are camera rays. What makes no packet is left to `many.rs`.
//!
//! **The same answers.** The interval test computes, for each plane, the extreme over the corners of
//! (origins) x (reciprocal directions). Rounding is monotone, so each bound holds for the *computed*
//! value of every ray within: no box that a ray enters is missed. A ray's test of a leaf's box is
//! that of `slabs.rs`, bit for bit; the box lies within those of all its ancestors, and by the same
//! monotony a ray that enters it enters them. So a ray tests the triangles that it tests alone, in
//! another order perhaps, which does not show: see `traverse.rs`. The one exception is a triangle seen
//! edge-on whose computed distance lies before its own box: whether a nearer hit has put that box
//! beyond the ray's limit by then may hang on the order.
//!
//! Input and output: as `traverse.rs`. Reads 28 bytes of a ray, writes 16.

mod eight;
mod hull;
mod pace;

use crate::bvh::{Bvh, NOTHING, WIDTH};
use crate::lanes::LANES;
use crate::order::Stack;
use crate::rays::{Hits, Rays};
use crate::{many, traverse};
use eight::Packet;
use pace::Pace;
use std::ops::Range;

/// As many rays or more outside packets, in a row, are taken in flight; fewer one at a time.
const FLIGHT: usize = 32;
/// Most nodes of a tree whose children's places a `u32` can number.
const MAX_NODES: usize = NOTHING as usize / WIDTH;

/// Writes the closest hit of each ray; those that make no packet are traced by `many.rs`.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest(bvh: Bvh, rays: Rays, mut hits: Hits) {
    let mut stack = Stack::default();
    let mut answered = 0;
    let walkable = !bvh.nodes.is_empty() && bvh.nodes.len() <= MAX_NODES;
    let whole = if walkable {
        rays.len / LANES * LANES
    } else {
        0
    };
    let mut pace = Pace::default();
    for i in (0..whole).step_by(LANES) {
        if !pace.try_packet() {
            continue;
        }
        if let Some(packet) = Packet::load(&rays, i) {
            apart(bvh, &rays, &mut hits, answered..i);
            let (found, lanes) = packet.walk(bvh, &mut stack);
            found.store(&packet, &mut hits, i);
            pace.learn(lanes);
            answered = i + LANES;
        }
    }
    apart(bvh, &rays, &mut hits, answered..rays.len);
}

/// Rays that make no packet.
fn apart(bvh: Bvh, rays: &Rays, hits: &mut Hits, range: Range<usize>) {
    if range.is_empty() {
        return;
    }
    let rays = rays.part(range.clone());
    let hits = hits.part(range);
    if rays.len < FLIGHT {
        traverse::closest(bvh, rays, hits);
    } else {
        many::closest(bvh, rays, hits);
    }
}
