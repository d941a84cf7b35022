//! A ray under way: 128 bytes and its stack.

use super::node::{self, Met};
use super::simd::{load8, store8};
use crate::bvh::{MAX_DEPTH, NOTHING, WIDTH};
use crate::rays::Hits;
use crate::slabs::PAD;
use bytemuck::{Pod, Zeroable};
use std::arch::x86_64::*;

/// What does not change on the way, in units that make the direction's largest component 1 to 2.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Ray {
    /// By axis, what `node.rs` adds for planes met first.
    pub(super) enter: [f32; 3],
    /// Reciprocal direction, as `node.rs` takes it.
    pub(super) inverse: [f32; 3],
    /// The origin along the axes first, second, main.
    pub(super) permuted: [f32; 3],
    /// The direction's first and second component over its main one.
    pub(super) slope: [f32; 2],
    /// 1 over the main component.
    pub(super) inverse_main: f32,
    /// By axis, where the planes met first lie behind the axis' first ones, in bytes.
    pub(super) near: [u8; 4],
    /// For the first, second and main axis, where its row begins in a block, in numbers.
    pub(super) axes: [u8; 4],
    /// Closest hit: callers' distances over these. Occlusion: the segment's end.
    pub(super) span: f32,
    /// The triangle it starts on.
    pub(super) leaves: u32,
}

/// Entries below the first, so that the eight topmost ones can always be looked at together. The
/// last of them is a sentinel, which says that nothing is left.
const BELOW: usize = WIDTH;
/// Entries of a stack: as in `order.rs`, and as many as make every `u8` a place where eight entries
/// lie, so that nobody has to ask.
const STACK: usize = (1 << u8::BITS) + WIDTH;
/// Most nodes on a ray's way for which a stack with one mark on it has room.
pub(super) const DEEPEST: usize = (u8::MAX as usize - BELOW - 1) / (WIDTH - 1);
const _: () = assert!(BELOW + (WIDTH - 1) * MAX_DEPTH + 2 * WIDTH <= STACK);

/// A ray under way.
#[derive(Clone)]
#[repr(C, align(64))]
pub(crate) struct Slot {
    pub(super) ray: Ray,
    /// By axis, what `node.rs` adds for planes met last.
    pub(super) leave: [f32; 3],
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
    /// Entries of the stack, those below the first among them.
    len: u8,
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
            enter: [0.0; 3],
            inverse: [0.0; 3],
            permuted: [0.0; 3],
            slope: [0.0; 2],
            inverse_main: 0.0,
            near: [0; 4],
            axes: [0; 4],
            span: 0.0,
            leaves: 0,
        },
        leave: [0.0; 3],
        best: 0,
        uv: [0.0; 2],
        id: 0,
        next: 0,
        reaches: 0,
        len: BELOW as u8,
        enter: [f32::NEG_INFINITY; STACK],
        child: [NOTHING; STACK],
    };

    /// Ray `i` of the view, at the root.
    #[inline]
    pub(super) fn start(&mut self, i: usize, (ray, leave): (Ray, [f32; 3])) {
        self.ray = ray;
        self.leave = leave;
        self.id = i as u32;
        self.next = 0;
        self.len = BELOW as u8;
    }

    /// Writes a closest hit's answer.
    #[inline]
    pub(super) fn hand_in(&self, hits: &mut Hits) {
        let i = self.id as usize;
        // What f32 cannot hold becomes the nearest it can.
        let t = self.t() * self.ray.span;
        hits.primitive[i] = self.best as u32;
        hits.t[i] = t.clamp(f32::from_bits(1), f32::MAX);
        [hits.u[i], hits.v[i]] = self.uv;
    }

    /// Puts on the stack what comes before all that lies below.
    #[inline]
    pub(super) fn push_mark(&mut self, mark: u32) {
        let end = usize::from(self.len);
        self.child[end] = mark;
        self.enter[end] = f32::NEG_INFINITY;
        self.len = self.len.wrapping_add(1);
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

    /// Adds the children that are hit, farthest first, but for the nearest: that one is what is visited
    /// next. If there is none, what is next must be asked for.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn push_in_order(&mut self, met: Met) -> u32 {
        let keys = node::descending(met.hits, met.enter);
        let child = _mm256_permutevar8x32_ps(met.children, node::lanes(keys));
        store8(
            bytemuck::cast_mut(eight_mut(&mut self.child, self.len)),
            child,
        );
        store8(
            eight_mut(&mut self.enter, self.len),
            _mm256_castsi256_ps(keys),
        );
        // All but the nearest, if there is one.
        let others = (met.hits & met.hits.wrapping_sub(1)).count_ones() as u8;
        self.go_on(self.len.wrapping_add(others))
    }

    /// Adds the children that are hit, from the lowest lane up, and takes what is then on top.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn push(&mut self, met: Met) -> u32 {
        let hit = _mm256_maskz_compress_ps(met.hits, met.children);
        store8(
            bytemuck::cast_mut(eight_mut(&mut self.child, self.len)),
            hit,
        );
        let hits = met.hits.count_ones() as u8;
        self.go_on(self.len.wrapping_add(hits).wrapping_sub(1))
    }

    /// Makes entry `end` what is visited next, and the stack end before it.
    #[inline]
    fn go_on(&mut self, end: u8) -> u32 {
        self.len = end;
        self.next = self.child[usize::from(end)];
        self.next
    }

    /// Takes the next reference that is entered within the limit.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn pop_in_order(&mut self) -> u32 {
        // Twice the pad: entries are keys of `node::descending`, off by up to seven roundings.
        let limit = _mm256_set1_ps(self.t() * (1.0 + 2.0 * PAD));
        let mut end = self.len;
        // Eight at a time: how many a shrunken limit has made useless no branch can foresee.
        loop {
            end = end.wrapping_sub(WIDTH as u8);
            // Asked this way round, a NaN is visited, and so is the sentinel: it ends at the latest there.
            let top = load8(eight(&self.enter, end));
            let within = _mm256_cmp_ps_mask::<_CMP_NGT_UQ>(top, limit);
            if within != 0 {
                return self.go_on(end.wrapping_add(within.ilog2() as u8));
            }
        }
    }

    /// Takes the next reference; none if the ray is blocked.
    #[inline]
    pub(super) fn pop(&mut self) -> u32 {
        self.len = self.len.wrapping_sub(1);
        let next = self.child[usize::from(self.len)];
        self.next = std::hint::select_unpredictable(self.best != 0, NOTHING, next);
        self.next
    }
}

/// Eight entries of a stack, from one on.
#[inline]
fn eight<T>(stack: &[T; STACK], from: u8) -> &[T; WIDTH] {
    let from = usize::from(from);
    stack[from..from + WIDTH].first_chunk().expect("eight")
}

/// The same, to be written.
#[inline]
fn eight_mut<T>(stack: &mut [T; STACK], from: u8) -> &mut [T; WIDTH] {
    let from = usize::from(from);
    stack[from..from + WIDTH].first_chunk_mut().expect("eight")
}
