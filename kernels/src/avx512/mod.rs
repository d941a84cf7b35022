//! `flight.rs` for processors with AVX-512: the same steps in the same order, so the same answers,
//! bit for bit, in about two thirds of the time.
//!
//! Measured, that form spends its time neither on arithmetic nor on memory but on waiting: each ray's step
//! is one long chain of dependent instructions, and the processor looks ahead too few rays to fill
//! the gaps. So a turn here is a number of short sweeps over all rays of a queue, each with a short chain,
//! and what one sweep finds lies in small arrays for the next:
//!
//! 1. nodes: test eight boxes (`node.rs`);
//! 2. nodes: put the children hit on the ray's stack, in order, but for the nearest, which is next
//!    (`node.rs`, `slot.rs`);
//! 3. leaves: edge functions, the three corners of four triangles in one vector (`leaf.rs`);
//! 4. leaves: distances and what is nearest, four rays with four triangles each in a vector (`leaf.rs`);
//! 5. leaves, and nodes of which no child is hit: the next reference from the stack (`slot.rs`);
//! 6. both: queues and prefetches, sixteen rays at a time (`queue.rs`).
//!
//! Rays are made ready sixteen at a time (`prepare.rs`). The few whose direction is so long or so
//! short that its power of two is no ordinary f32 are traced one at a time.
//!
//! Camera rays go in packets of sixteen (`packet.rs`), and where triangles are few there is no tree at all (`few.rs`).
//!
//! Chosen at run time, by [`available`]: nothing here runs elsewhere. Every function states what it
//! needs of the processor, so that safe code may call it from a function that states the same;
//! `unsafe` stands where a slice becomes a vector (`simd.rs`) and where this world is entered.
//! (Closures given to the standard library, as to an array's `map`, are not inlined from here: it
//! is not compiled for AVX-512. Hot code writes such things out.)
//!
//! Input and output: as `traverse.rs`.

pub mod few;
mod leaf;
pub(crate) mod levels;
mod node;
pub(crate) mod packet;
pub(crate) mod prepare;
mod queue;
mod simd;
mod sixteen;
mod slot;

use crate::bvh::{Bvh, index};
use crate::query::Prepared;
use crate::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use crate::traverse;
use leaf::{Found, Groups};
use node::Met;
use prepare::{Stage, View};
use queue::{Queues, What};
use slot::{Slot, key};
use std::cell::RefCell;
use std::ptr::null;

/// Rays under way together.
const N: usize = 64;

thread_local! {
    /// 135 KB that need not be written at every call: a ray sets what it will read, but for the
    /// sentinels below its stack, and those nobody writes over.
    static SLOTS: RefCell<[Slot; N]> = const { RefCell::new([const { Slot::NEW }; N]) };
}

/// Whether this processor can run [`closest`] and [`occluded`].
#[must_use]
pub fn available() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
}

/// Writes the closest hit of each ray.
///
/// # Panics
/// If a column is shorter than `rays.len`, or [`available`] is false.
pub fn closest(bvh: Bvh, rays: Rays, mut hits: Hits) {
    assert!(available(), "a processor with AVX-512");
    hits.primitive[..rays.len].fill(NO_PRIMITIVE);
    if !bvh.nodes.is_empty() {
        // SAFETY: the processor has what the function is compiled for.
        SLOTS.with_borrow_mut(|slots| unsafe { fly_closest(slots, bvh, &rays, &mut hits) });
    }
}

/// Writes 1 for each segment that something lies on, else 0.
///
/// # Panics
/// If a column is shorter than `segments.len`, or [`available`] is false.
pub fn occluded(bvh: Bvh, segments: Segments, occluded: &mut [u32]) {
    assert!(available(), "a processor with AVX-512");
    occluded[..segments.len].fill(0);
    if !bvh.nodes.is_empty() {
        // SAFETY: the processor has what the function is compiled for.
        SLOTS.with_borrow_mut(|slots| unsafe { fly_occluded(slots, bvh, &segments, occluded) });
    }
}

#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn fly_closest(slots: &mut [Slot; N], bvh: Bvh, rays: &Rays, hits: &mut Hits) {
    let view = View::of_rays(rays);
    let answers = [hits.t.as_ptr(), hits.u.as_ptr(), hits.v.as_ptr()];
    let (mut stage, mut queues) = (Stage::new(bvh, answers), Queues::new());
    let (mut next, mut groups) = ([0; N], Groups::NEW);
    queues.done.fill_with_all();
    let mut started = false;
    loop {
        queues.for_each_done(|id, nodes| {
            let slot = &mut slots[id as usize % N];
            if started {
                slot.hand_in(hits);
            }
            let odd = |i: usize| traverse::closest(bvh, rays.part(i..i + 1), hits.part(i..i + 1));
            if let Some((i, ray)) = stage.next(&view, odd) {
                slot.start(i, ray);
                slot.best = key(f32::MAX, NO_PRIMITIVE);
                nodes.push(id);
            }
        });
        started = true;
        if queues.nodes.len() > queues.leaves.len() {
            let ids = queues.nodes.ids();
            nodes_in_order(bvh, slots, ids, &mut next);
            queues.sort(bvh, What::Nodes, &next);
        } else if queues.leaves.len() > 0 {
            let ids = queues.leaves.ids();
            groups.edges(bvh, slots, ids);
            for (g, ids) in ids.chunks(4).enumerate() {
                let exactly = |r: usize| {
                    exactly(bvh, &slots[ids[r] as usize % N], |i| {
                        Prepared::load(rays.origin, rays.direction, i)
                    })
                };
                let primitive = leaf::primitives(bvh, slots, ids);
                let wanted = leaf::but_left(primitive, slots, ids);
                let found = groups.finish(g, slots, ids, wanted, exactly);
                let best = leaf::nearest(primitive, &found, slots, ids);
                for (r, &id) in ids.iter().enumerate() {
                    slots[id as usize % N].improve(best.key[r], best.uv[r]);
                }
            }
            choose_in_order(slots, ids, &mut next);
            queues.sort(bvh, What::Leaves, &next);
        } else {
            break;
        }
    }
}

#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn fly_occluded(slots: &mut [Slot; N], bvh: Bvh, segments: &Segments, occluded: &mut [u32]) {
    let view = View::of_segments(segments);
    let (mut stage, mut queues) = (Stage::new(bvh, [null(); 3]), Queues::new());
    let (mut next, mut groups) = ([0; N], Groups::NEW);
    queues.done.fill_with_all();
    let mut started = false;
    loop {
        queues.for_each_done(|id, nodes| {
            let slot = &mut slots[id as usize % N];
            if started {
                occluded[slot.id as usize] = slot.best as u32;
            }
            let odd = |i: usize| {
                traverse::occluded(bvh, segments.part(i..i + 1), &mut occluded[i..=i]);
            };
            if let Some((i, ray)) = stage.next(&view, odd) {
                slot.start(i, ray);
                slot.reaches = segments.reaches[i];
                slot.best = 0;
                nodes.push(id);
            }
        });
        started = true;
        if queues.nodes.len() > queues.leaves.len() {
            let ids = queues.nodes.ids();
            nodes(bvh, slots, ids, &mut next);
            queues.sort(bvh, What::Nodes, &next);
        } else if queues.leaves.len() > 0 {
            let ids = queues.leaves.ids();
            groups.edges(bvh, slots, ids);
            for (g, ids) in ids.chunks(4).enumerate() {
                let exactly = |r: usize| {
                    exactly(bvh, &slots[ids[r] as usize % N], |i| {
                        Prepared::load(segments.origin, segments.direction, i)
                    })
                };
                let primitive = leaf::primitives(bvh, slots, ids);
                let wanted = leaf::but_left(primitive, slots, ids);
                let wanted = leaf::but_reached(wanted, primitive, slots, ids);
                let found = groups.finish(g, slots, ids, wanted, exactly);
                let blocked = leaf::blocked(&found, slots, ids);
                for (r, &id) in ids.iter().enumerate() {
                    slots[id as usize % N].best = u64::from(blocked >> (4 * r) & 15 != 0);
                }
            }
            choose(slots, ids, &mut next);
            queues.sort(bvh, What::Leaves, &next);
        } else {
            break;
        }
    }
}

/// Tests the next node of each ray and says what comes then.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn nodes_in_order(bvh: Bvh, slots: &mut [Slot; N], ids: &[u32], next: &mut [u32; N]) {
    let mut missed = 0;
    let mut put = |i: usize, id: usize, met: Met, slots: &mut [Slot; N]| {
        next[i % N] = slots[id].push_in_order(met);
        missed |= u64::from(met.hits == 0) << i;
    };
    let (mut id, mut met) = closest_of(bvh, slots, ids[0]);
    for (i, &later) in ids[1..].iter().enumerate() {
        let after = closest_of(bvh, slots, later);
        put(i, id, met, slots);
        (id, met) = after;
    }
    put(ids.len() - 1, id, met, slots);
    while missed != 0 {
        let i = missed.trailing_zeros() as usize % N;
        next[i] = slots[ids[i] as usize % N].pop_in_order();
        missed &= missed - 1;
    }
}

/// The same for segments.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn nodes(bvh: Bvh, slots: &mut [Slot; N], ids: &[u32], next: &mut [u32; N]) {
    let (mut id, mut met) = within(bvh, slots, ids[0]);
    for (i, &later) in ids[1..].iter().enumerate() {
        let after = within(bvh, slots, later);
        next[i % N] = slots[id].push(met);
        (id, met) = after;
    }
    next[(ids.len() - 1) % N] = slots[id].push(met);
}

/// A ray, and what it meets of its next node before its nearest hit.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn closest_of(bvh: Bvh, slots: &[Slot; N], id: u32) -> (usize, Met) {
    let id = id as usize % N;
    let slot = &slots[id];
    (id, node::test(slot, &bvh.nodes[index(slot.next)], slot.t()))
}

/// A ray, and what its segment meets of its next node.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn within(bvh: Bvh, slots: &[Slot; N], id: u32) -> (usize, Met) {
    let id = id as usize % N;
    let slot = &slots[id];
    (
        id,
        node::test(slot, &bvh.nodes[index(slot.next)], slot.ray.span),
    )
}

/// Takes each ray's next reference within its limit from its stack.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn choose_in_order(slots: &mut [Slot; N], ids: &[u32], next: &mut [u32; N]) {
    for (next, &id) in next.iter_mut().zip(ids) {
        *next = slots[id as usize % N].pop_in_order();
    }
}

/// Takes each ray's next reference from its stack; none for those that are blocked.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn choose(slots: &mut [Slot; N], ids: &[u32], next: &mut [u32; N]) {
    for (next, &id) in next.iter_mut().zip(ids) {
        *next = slots[id as usize % N].pop();
    }
}

/// A ray's leaf and the ray as the exact test takes them.
#[cold]
fn exactly(bvh: Bvh, slot: &Slot, load: impl Fn(usize) -> Option<Prepared>) -> Found<[f32; 4], u8> {
    // A ray under way could be loaded.
    let ray = load(slot.id as usize).unwrap_or_default();
    leaf::exactly(&ray, &bvh.blocks[index(slot.next)])
}
