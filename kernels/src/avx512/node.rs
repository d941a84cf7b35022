//! A ray against the eight boxes of a node, and the order of what it hits: `order.rs`.
//!
//! As `slabs.rs`, never missing a box that the ray or its rounded triangle test could enter, but by one
//! fused operation a plane: `t = b i + a`, where `i` is the reciprocal of the direction's component,
//! `a = -o i - e` for the plane met first and `-o i + e` for the other. `prepare.rs` makes them.
//!
//! **Bound.** Let `u = 2^-24` and `c` be `o i` as rounded, so `|c - o i| <= u |o i|`. With `e = 4u |c|`
//! the near value is at most `((b - o) i + u |o i| + u (|c| + e) - e) (1 + u)`. The terms in between
//! add up to less than 0, so what remains of the near value's error are the roundings of `1 / d` and of
//! the fused operation: two, where `slabs.rs` has three. The far value likewise. As there, everything
//! rests on `t` above the smallest normal number, which `e` has added.
//!
//! **Small components.** A component below `2^-64` of the largest, zeros of either sign among them, is
//! taken for one of that size, and `e` has `S` more, at least any distance at which the ray can meet
//! something. Over such a distance the ray moves by no more than `S 2^-64` along the axis: if its
//! place along the axis is ever beyond the plane met first, then `(b - o) 2^64 <= S`, and the near value
//! is not above 0; if it is ever before the other plane, then `b - o >= 0`, and the far value is not
//! below `S`. So a box grows by `2^-64` of the distance, no more: rays along an axis are culled as well as
//! others. What overflows comes out as infinities on the wide side or as NaN, which counts as a hit.

use super::simd::{load8, load8_bytes};
use super::slot::Slot;
use crate::bvh::Node;
use crate::slabs::PAD;
use std::arch::x86_64::*;

/// What a ray meets of a node.
#[derive(Clone, Copy)]
pub(super) struct Met {
    /// Which boxes, a bit each.
    pub(super) hits: u8,
    /// Where it enters them.
    pub(super) enter: __m256,
    /// What they hold.
    pub(super) children: __m256,
}

/// Which boxes the ray meets at `0 ..= limit`.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn test(slot: &Slot, node: &Node, limit: f32) -> Met {
    let planes: &[u8; 256] = bytemuck::cast_ref(node);
    let ray = &slot.ray;
    let inverse = |axis: usize| _mm256_set1_ps(ray.inverse[axis]);
    let along = |axis: usize, from: usize, add: f32| {
        let first = 2 * SIDE * axis + from;
        // Always there: `from` is 0 or `SIDE`.
        let planes = planes[first..first + SIDE].first_chunk().expect("a row");
        _mm256_fmadd_ps(load8_bytes(planes), inverse(axis), _mm256_set1_ps(add))
    };
    let near = |axis: usize| usize::from(ray.near[axis]) & SIDE;
    let (x, y, z) = (near(0), near(1), near(2));
    // What may be NaN stands first: the second is then what is left.
    let last = _mm256_max_ps(along(2, z, ray.enter[2]), _mm256_setzero_ps());
    let last = _mm256_max_ps(along(1, y, ray.enter[1]), last);
    let last = _mm256_max_ps(along(0, x, ray.enter[0]), last);
    let first = _mm256_min_ps(along(2, z ^ SIDE, slot.leave[2]), _mm256_set1_ps(limit));
    let first = _mm256_min_ps(along(1, y ^ SIDE, slot.leave[1]), first);
    let first = _mm256_min_ps(along(0, x ^ SIDE, slot.leave[0]), first);
    let left = _mm256_mul_ps(first, _mm256_set1_ps(1.0 + PAD));
    Met {
        hits: _mm256_cmp_ps_mask::<_CMP_NGT_UQ>(last, left),
        enter: last,
        children: load8(bytemuck::cast_ref(node.child.as_array())),
    }
}

/// Bytes of eight planes.
const SIDE: usize = 32;

/// The lanes of `hits` in the order of falling `enter`, of equal ones in that of rising lane: `enter`
/// but for its low three bits, which say which ([`lanes`]).
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn descending(hits: u8, enter: __m256) -> __m256i {
    let last_first = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
    let coarse = _mm256_and_si256(_mm256_castps_si256(enter), _mm256_set1_epi32(!7));
    // Lanes that are not hit are filled with 0: no key is less.
    let keys = _mm256_maskz_compress_epi32(hits, _mm256_or_si256(coarse, last_first));
    if hits.count_ones() > 4 {
        sort8(keys)
    } else {
        _mm256_castsi128_si256(sort4(_mm256_castsi256_si128(keys)))
    }
}

/// Lane numbers, in the low three bits, of what [`descending`] gives.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn lanes(keys: __m256i) -> __m256i {
    _mm256_xor_si256(keys, _mm256_set1_epi32(7))
}

/// Sorts downwards, by a bitonic network (K. Batcher, 1968).
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn sort4(keys: __m128i) -> __m128i {
    let stage = |keys: __m128i, other: __m128i, keep_max: u8| {
        _mm_mask_max_epu32(_mm_min_epu32(keys, other), keep_max, keys, other)
    };
    let keys = stage(keys, _mm_shuffle_epi32::<BY1>(keys), 0b1001);
    let keys = stage(keys, _mm_shuffle_epi32::<BY2>(keys), 0b0011);
    stage(keys, _mm_shuffle_epi32::<BY1>(keys), 0b0101)
}

/// The same for eight. More than four children are seldom hit at once.
#[cold]
#[inline(never)]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn sort8(keys: __m256i) -> __m256i {
    let stage = |keys: __m256i, other: __m256i, keep_max: u8| {
        _mm256_mask_max_epu32(_mm256_min_epu32(keys, other), keep_max, keys, other)
    };
    let keys = stage(keys, _mm256_shuffle_epi32::<BY1>(keys), 0b1001_1001);
    let keys = stage(keys, _mm256_shuffle_epi32::<BY2>(keys), 0b1100_0011);
    let keys = stage(keys, _mm256_shuffle_epi32::<BY1>(keys), 0b1010_0101);
    let by4 = _mm256_permute4x64_epi64::<0b01_00_11_10>(keys);
    let keys = stage(keys, by4, 0b0000_1111);
    let keys = stage(keys, _mm256_shuffle_epi32::<BY2>(keys), 0b0011_0011);
    stage(keys, _mm256_shuffle_epi32::<BY1>(keys), 0b0101_0101)
}

/// Exchanges neighbours.
const BY1: i32 = 0b10_11_00_01;
/// Exchanges neighbouring pairs.
const BY2: i32 = 0b01_00_11_10;
