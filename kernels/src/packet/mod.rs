//! Eight rays at once through the tree, or sixteen with AVX-512 (`avx512/packet.rs`), where they go
//! the same way: camera rays.
//!
//! Neighbouring camera rays meet the same nodes. So they walk together, a lane each, and
//! share what a step costs: a node's eight boxes are tested once against an interval that holds all
//! rays, its children are sorted once, its cache lines come from memory once. A leaf's box is
//! then tested by each ray for itself, all at a time, and so are its triangles, as in `few.rs`.
//!
//! **Which rays.** Neighbours of the view make a packet if they agree on the main axis and on
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
pub(crate) use hull::Hull;
use pace::Pace;
pub(crate) use pace::UseOfLanes;
use std::ops::Range;

/// The most that two slopes of a packet may differ by, along either axis. Rays farther apart share
/// too little of their way; an image 1000 pixels wide has some 0.001 to 0.002 a pixel.
pub(crate) const SPREAD: f32 = 0.125;
/// As many rays or more outside packets, in a row, are taken in flight; fewer one at a time.
const FLIGHT: usize = 32;
/// Most nodes of a tree whose children's places a `u32` can number.
const MAX_NODES: usize = NOTHING as usize / WIDTH;

/// Writes the closest hit of each ray; those that make no packet are traced by `many.rs`.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest(bvh: Bvh, rays: Rays, hits: Hits) {
    #[cfg(target_arch = "x86_64")]
    if crate::avx512::available() && can_walk(bvh) {
        use crate::avx512::{packet, prepare};
        let (extent, mut stack) = (prepare::extent(bvh), Stack::default());
        let mut hits = hits;
        return walk::<{ packet::RAYS }>(bvh, &rays, &mut hits, |hits, i| {
            packet::closest(bvh, &rays, hits, i, extent, &mut stack)
        });
    }
    closest_by_eights(bvh, rays, hits);
}

/// [`closest`] as it is where there is no AVX-512.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest_by_eights(bvh: Bvh, rays: Rays, mut hits: Hits) {
    if !can_walk(bvh) {
        return apart(bvh, &rays, &mut hits, 0..rays.len);
    }
    let mut stack = Stack::default();
    walk::<LANES>(bvh, &rays, &mut hits, |hits, i| {
        eight::closest(bvh, &rays, hits, i, &mut stack)
    });
}

fn can_walk(bvh: Bvh) -> bool {
    (1..=MAX_NODES).contains(&bvh.nodes.len())
}

/// `RAYS` at a time, as `packet` does those from a place on if they make a packet, and the others one
/// by one or in flight.
fn walk<const RAYS: usize>(
    bvh: Bvh,
    rays: &Rays,
    hits: &mut Hits,
    mut packet: impl FnMut(&mut Hits, usize) -> Option<UseOfLanes>,
) {
    let mut answered = 0;
    let mut pace = Pace::default();
    for i in (0..rays.len / RAYS * RAYS).step_by(RAYS) {
        if pace.try_packet()
            && let Some(lanes) = packet(hits, i)
        {
            apart(bvh, rays, hits, answered..i);
            pace.learn(lanes);
            answered = i + RAYS;
        }
    }
    apart(bvh, rays, hits, answered..rays.len);
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

#[cfg(test)]
pub(crate) mod tests {
    use crate::rays::{NO_PRIMITIVE, Rays};

    /// `load` says whether `N` rays make a packet.
    pub(crate) fn assert_what_makes_a_packet<const N: usize>(load: impl Fn(&Rays) -> bool) {
        // Rays from one point.
        let together = |directions: [[f32; 3]; N]| {
            let columns = [0, 1, 2].map(|axis| directions.map(|d| d[axis]));
            let (zeros, leaves) = ([0.0; N], [NO_PRIMITIVE; N]);
            load(&Rays {
                len: N,
                origin: [&zeros; 3],
                direction: columns.each_ref().map(<[f32; N]>::as_slice),
                leaves: &leaves,
            })
        };
        let all = |direction: fn(f32) -> [f32; 3]| {
            std::array::from_fn(|lane| direction(0.1 + 0.005 * lane as f32))
        };
        assert!(together(all(|x| [x, -0.5, 1.0])));
        assert!(together(all(|x| [-1e30, 1e29 * x, 3e29])));
        assert!(together(all(|x| [1e-30, 1e-31 * x, -2e-31])));
        for other in [
            [0.1, 0.2, -1.0],
            [-0.1, 0.2, 1.0],
            [1.0, 0.2, 0.9],
            [0.5, 0.2, 1.0],
            [0.0, 0.2, 1.0],
            [1e-39, 0.2, 1.0],
            [f32::NAN, 0.2, 1.0],
            [0.1, f32::INFINITY, 1.0],
            [0.0; 3],
        ] {
            let mut directions = [[0.1, 0.2, 1.0]; N];
            directions[N - 3] = other;
            assert!(!together(directions), "{other:?}");
        }
        assert!(!together([[0.0; 3]; N]));
        assert!(!together([[1e-40, 1e-41, 1e-41]; N]));
    }
}
