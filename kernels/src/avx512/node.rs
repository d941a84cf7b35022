//! A ray against the eight boxes of a node: `slabs.rs`, both planes of an axis in one vector, and
//! the order of what it hits: `order.rs`.

use super::simd::{load8, store8};
use super::slot::Ray;
use crate::bvh::Node;
use crate::slabs::PAD;
use std::arch::x86_64::*;

/// Which boxes meet the ray at `0 ..= limit`, a bit each; `enter` is where. `limit` is padded.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn test(ray: &Ray, node: &Node, limit: f32, enter: &mut [f32; 8]) -> u8 {
    // Distances to the planes met first in the lower half, to the others in the upper one.
    let distances = |axis: usize| {
        let near = usize::from(ray.near[axis] & 1);
        let planes = |side: usize| load8(node.planes[2 * axis + side].as_array());
        let both = _mm512_insertf32x8::<1>(_mm512_castps256_ps512(planes(near)), planes(near ^ 1));
        let along = _mm512_sub_ps(both, _mm512_set1_ps(ray.origin[axis]));
        _mm512_mul_ps(along, _mm512_set1_ps(ray.inverse[axis]))
    };
    let (x, y, z) = (distances(0), distances(1), distances(2));
    // What may be NaN stands first, as in `slabs.rs`: the second is then what is left.
    let last = _mm512_max_ps(x, _mm512_max_ps(y, _mm512_max_ps(z, _mm512_setzero_ps())));
    let never = _mm512_set1_ps(f32::INFINITY);
    let first = _mm512_min_ps(x, _mm512_min_ps(y, _mm512_min_ps(z, never)));
    let entered = _mm512_castps512_ps256(last);
    let left = _mm512_extractf32x8_ps::<1>(first);
    let left = _mm256_mul_ps(left, _mm256_set1_ps(1.0 + PAD));
    let left = _mm256_min_ps(left, _mm256_set1_ps(limit));
    store8(enter, entered);
    _mm256_cmp_ps_mask::<_CMP_NGT_UQ>(entered, left)
}

/// Lane numbers, in the low three bits, that bring the lanes of `hits` to the front in the order of
/// falling `enter`; of equal ones in that of rising lane.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn descending(hits: u8, enter: __m256) -> __m256i {
    let last_first = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
    let coarse = _mm256_and_si256(_mm256_castps_si256(enter), _mm256_set1_epi32(!7));
    // Lanes that are not hit are filled with 0: no key is less.
    let keys = _mm256_maskz_compress_epi32(hits, _mm256_or_si256(coarse, last_first));
    let keys = if hits.count_ones() > 4 {
        sort8(keys)
    } else {
        _mm256_castsi128_si256(sort4(_mm256_castsi256_si128(keys)))
    };
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

/// `enter` and `children`, eight each, in the order of [`descending`].
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn in_order(order: __m256i, x: &[f32; 8]) -> __m256 {
    _mm256_permutexvar_ps(order, load8(x))
}
