//! Many rays at once through the tree: the fast form for the thousands of rays that a wave brings.
//!
//! A ray spends most of its time waiting: for the next node to come from memory, and for
//! branches to be resolved that hang on what was just computed. So `N` rays are under way together,
//! each in one of three queues: those that want a node, those that want a leaf, and those that are
//! done. A turn takes all rays of a queue, first through the test, then through the choice of what
//! comes next. So the processor has many tests to overlap and no branch in between that could be
//! mispredicted: which queue a ray goes to, how many children it hit and whether a triangle was
//! nearer are all data. What comes next is asked for ahead of time, and has arrived by the ray's
//! next turn. A ray that is done hands in its answer, and the next one of the view takes its place.
//!
//! Each ray makes the same steps in the same order as in `traverse.rs`, so the answers are the
//! same, bit for bit.
//!
//! Input and output: as `traverse.rs`.

use crate::bvh::{BLOCK, Block, Bvh, LEAF, NOTHING, Node, index};
use crate::order::Stack;
use crate::query::{ClosestHit, Occlusion, Prepared, Query};
use crate::rays::{Hits, Rays, Segments};
use crate::visits;

/// Writes the closest hit of each ray.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest<const N: usize>(bvh: Bvh, rays: Rays, hits: Hits) {
    fly::<_, N>(bvh, &mut ClosestHit { rays, hits });
}

/// Writes 1 for each segment that something lies on, else 0.
///
/// # Panics
/// If a column is shorter than `segments.len`.
pub fn occluded<const N: usize>(bvh: Bvh, segments: Segments, occluded: &mut [u32]) {
    fly::<_, N>(bvh, &mut Occlusion { segments, occluded });
}

/// A ray under way.
#[derive(Default)]
#[repr(align(64))]
struct Slot<S> {
    ray: Prepared,
    state: S,
    /// Its place in the view.
    id: usize,
    /// What it visits in its next turn.
    next: u32,
    stack: Stack,
}

/// Slots that wait for a turn of one kind.
pub(crate) struct Queue<const N: usize> {
    slots: [u8; N],
    pub(crate) len: usize,
}

impl<const N: usize> Queue<N> {
    pub(crate) const fn new() -> Self {
        Self {
            slots: [0; N],
            len: 0,
        }
    }

    /// Writes `slot` behind the last and keeps it if `keep`: no branch.
    #[inline(always)]
    pub(crate) fn offer(&mut self, slot: usize, keep: bool) {
        self.slots[self.len & (N - 1)] = slot as u8;
        self.len += usize::from(keep);
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> usize {
        usize::from(self.slots[i & (N - 1)]) & (N - 1)
    }
}

fn fly<Q: Query, const N: usize>(bvh: Bvh, query: &mut Q) {
    const { assert!(N.is_power_of_two() && N <= 256) };
    let mut slots: [Slot<Q::State>; N] = std::array::from_fn(|_| Slot::default());
    let mut nodes = Queue::<N>::new();
    let mut leaves = Queue::<N>::new();
    let mut done = Queue::<N>::new();
    let root = if bvh.nodes.is_empty() { NOTHING } else { 0 };
    let mut source = 0;
    for id in 0..N {
        if refill(query, &mut source, root, &mut slots[id]) {
            nodes.offer(id, root != NOTHING);
            done.offer(id, root == NOTHING);
        }
    }
    loop {
        for i in 0..std::mem::take(&mut done.len) {
            let id = done.get(i);
            let slot = &mut slots[id];
            query.finish(slot.id, &slot.ray, &slot.state);
            if refill(query, &mut source, root, slot) {
                nodes.offer(id, root != NOTHING);
                done.offer(id, root == NOTHING);
            }
        }
        let turn_of_nodes = nodes.len > leaves.len;
        let turn = if turn_of_nodes {
            visits::add(nodes.len, 0);
            for i in 0..nodes.len {
                let slot = &mut slots[nodes.get(i)];
                let node = &bvh.nodes[index(slot.next)];
                let (hits, enter) = slot.ray.slabs.test(node, Q::limit(&slot.state));
                slot.stack.push::<Q>(node, hits, enter);
            }
            std::mem::take(&mut nodes.len)
        } else {
            visits::add(0, leaves.len * BLOCK);
            for i in 0..leaves.len {
                let slot = &mut slots[leaves.get(i)];
                Q::visit(&mut slot.state, &slot.ray, &bvh.blocks[index(slot.next)]);
            }
            std::mem::take(&mut leaves.len)
        };
        // A queue is written behind where it is read.
        for i in 0..turn {
            let id = if turn_of_nodes {
                nodes.get(i)
            } else {
                leaves.get(i)
            };
            let slot = &mut slots[id];
            let next = slot.stack.pop::<Q>(Q::limit(&slot.state));
            let next = if Q::settled(&slot.state) {
                NOTHING
            } else {
                next
            };
            slot.next = next;
            fetch(bvh, next);
            let leaf = next & LEAF != 0;
            nodes.offer(id, !leaf);
            leaves.offer(id, leaf & (next != NOTHING));
            done.offer(id, next == NOTHING);
        }
        if nodes.len + leaves.len + done.len == 0 {
            break;
        }
    }
}

/// Puts the next ray that can meet anything into `slot`; false if there is none.
#[inline(always)]
fn refill<Q: Query>(
    query: &mut Q,
    source: &mut usize,
    root: u32,
    slot: &mut Slot<Q::State>,
) -> bool {
    while *source < query.len() {
        let id = *source;
        *source += 1;
        if let Some((ray, state)) = query.start(id) {
            slot.ray = ray;
            slot.state = state;
            slot.id = id;
            slot.next = root;
            slot.stack.clear();
            return true;
        }
    }
    false
}

/// Asks for every cache line that visiting `reference` will read: four of a node, three of a block,
/// wherever it starts. (Fetching most of them, and leaving the rest to the hardware's prefetcher,
/// was 20% slower in a prototype.)
#[inline(always)]
fn fetch(bvh: Bvh, reference: u32) {
    let leaf = reference & LEAF != 0 && reference != NOTHING;
    let (base, stride, last) = if leaf {
        (bvh.blocks.as_ptr().cast::<u8>(), size_of::<Block>(), 128)
    } else {
        (bvh.nodes.as_ptr().cast::<u8>(), size_of::<Node>(), 192)
    };
    let i = if reference == NOTHING {
        0
    } else {
        index(reference)
    };
    let start = base.wrapping_add(i * stride);
    for offset in [0, 64, 128, last] {
        prefetch(start.wrapping_add(offset));
    }
}

/// Asks for the cache line at an address, which may be any.
#[inline(always)]
pub(crate) fn prefetch(address: *const u8) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch reads nothing as far as the program can tell; a bad address is ignored.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(address.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
