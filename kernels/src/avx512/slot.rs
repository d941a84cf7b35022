//! A ray under way: 128 bytes and its stack.

use super::node;
use super::simd::{load8, store8};
use crate::bvh::{MAX_DEPTH, NOTHING, WIDTH};
use crate::slabs::PAD;
use bytemuck::{Pod, Zeroable};
use std::arch::x86_64::*;

/// What does not change on the way, in units that make the direction's largest component 1 to 2.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Ray {
    pub(super) origin: [f32; 3],
    /// Reciprocal direction.
    pub(super) inverse: [f32; 3],
    /// The origin along the axes first, second, main.
    pub(super) permuted: [f32; 3],
    /// The direction's first and second component over its main one.
    pub(super) slope: [f32; 2],
    /// 1 over the main component.
    pub(super) inverse_main: f32,
    /// By axis, 1 where the upper plane of a box is met first.
    pub(super) near: [u8; 4],
    /// First, second, main.
    pub(super) axes: [u8; 4],
    /// Closest hit: callers' distances over these. Occlusion: the segment's end.
    pub(super) span: f32,
    /// The triangle it starts on.
    pub(super) leaves: u32,
}

/// Entries below the first, so that the eight topmost ones can always be looked at together. The
/// last of them is a sentinel, which says that nothing is left.
const BELOW: usize = WIDTH;
/// Entries of a stack, as in `order.rs`.
const STACK: usize = BELOW + (WIDTH - 1) * MAX_DEPTH + 2 * WIDTH;

/// A ray under way.
#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Slot {
    pub(super) ray: Ray,
    /// Closest hit: [`key`] of the nearest so far. Occlusion: 1 if blocked, else 0.
    pub(super) best: u64,
    /// Weights of the nearest so far.
    pub(super) uv: [f32; 2],
    /// Its place in the view.
    pub(super) id: u32,
    /// What it visits in its next turn.
    pub(super) next: u32,
    /// Occlusion: the triangle it ends on.
    pub(super) reaches: u32,
    len: u32,
    enter: [f32; STACK],
    child: [u32; STACK],
}

/// Orders hits by distance, then by index. Bits of positive distances order like the distances.
#[inline]
pub(super) fn key(t: f32, primitive: u32) -> u64 {
    u64::from(t.to_bits()) << 32 | u64::from(primitive)
}

impl Slot {
    pub(super) const NEW: Self = Self {
        ray: Ray {
            origin: [0.0; 3],
            inverse: [0.0; 3],
            permuted: [0.0; 3],
            slope: [0.0; 2],
            inverse_main: 0.0,
            near: [0; 4],
            axes: [0; 4],
            span: 0.0,
            leaves: 0,
        },
        best: 0,
        uv: [0.0; 2],
        id: 0,
        next: 0,
        reaches: 0,
        len: BELOW as u32,
        enter: [f32::NEG_INFINITY; STACK],
        child: [NOTHING; STACK],
    };

    /// Ray `i` of the view, at the root.
    #[inline]
    pub(super) fn start(&mut self, i: usize, ray: Ray) {
        self.ray = ray;
        self.id = i as u32;
        self.next = 0;
        self.len = BELOW as u32;
    }

    /// Distance of the nearest so far.
    #[inline]
    pub(super) fn t(&self) -> f32 {
        f32::from_bits((self.best >> 32) as u32)
    }

    /// Takes a hit if it is nearer: no branch.
    #[inline]
    pub(super) fn improve(&mut self, key: u64, uv: [f32; 2]) {
        let better = key < self.best;
        self.best = std::hint::select_unpredictable(better, key, self.best);
        let bits: u64 = bytemuck::cast(uv);
        let old: u64 = bytemuck::cast(self.uv);
        self.uv = bytemuck::cast(std::hint::select_unpredictable(better, bits, old));
    }

    /// Adds the children that are hit, farthest first.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn push_in_order(&mut self, children: &[u32; 8], hits: u8, enter: &[f32; 8]) {
        let order = node::descending(hits, load8(enter));
        let len = self.len as usize;
        let child = node::in_order(order, bytemuck::cast_ref(children));
        let enter = node::in_order(order, enter);
        if let Some(top) = self.child[len..].first_chunk_mut() {
            store8(bytemuck::cast_mut::<[u32; 8], [f32; 8]>(top), child);
        }
        if let Some(top) = self.enter[len..].first_chunk_mut() {
            store8(top, enter);
        }
        self.len += hits.count_ones();
    }

    /// Adds the children that are hit, from the lowest slot up.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn push(&mut self, children: &[u32; 8], hits: u8) {
        let children = load8(bytemuck::cast_ref(children));
        if let Some(top) = self.child[self.len as usize..].first_chunk_mut() {
            let hit = _mm256_maskz_compress_ps(hits, children);
            store8(bytemuck::cast_mut::<[u32; 8], [f32; 8]>(top), hit);
        }
        self.len += hits.count_ones();
    }

    /// Takes the next reference that is entered within the limit.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn pop_in_order(&mut self) -> u32 {
        let limit = _mm256_set1_ps(self.t() * (1.0 + PAD));
        let mut end = self.len as usize;
        // Eight at a time: how many a shrunken limit has made useless no branch can foresee.
        while let Some(top) = self.enter[..end].last_chunk() {
            // Asked this way round, a NaN is visited, and so is the sentinel.
            let within = _mm256_cmp_ps_mask::<_CMP_NGT_UQ>(load8(top), limit);
            end -= WIDTH;
            if within != 0 {
                end += u32::from(within).ilog2() as usize;
                break;
            }
        }
        self.len = end as u32;
        self.next = self.child[end];
        self.next
    }

    /// Takes the next reference; none if the ray is blocked.
    #[inline]
    pub(super) fn pop(&mut self) -> u32 {
        self.len -= 1;
        let next = self.child[self.len as usize];
        self.next = std::hint::select_unpredictable(self.best != 0, NOTHING, next);
        self.next
    }
}
