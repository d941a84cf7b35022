//! Rays against blocks of four triangles: the arithmetic of `triangle.rs`, operation by operation.
//!
//! First, ray by ray, the edge functions: the corners of four triangles are twelve lanes of one
//! vector. Then the rest, for four rays with four triangles each.

use super::N;
use super::simd::{four_each, lanes_below, load4_u32, load16, store4, store16};
use super::slot::{Slot, key};
use crate::bvh::{Block, Bvh, index};
use crate::query::Prepared;
use crate::triangle::{CONTACT, SURE};
use std::arch::x86_64::*;

/// Numbers of a block along each axis: three corners of four triangles.
pub(super) const ROW: i32 = 12;

/// What four rays and their blocks come to: weights and distances along the main axis by corner,
/// ray and triangle.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Group {
    weight: [[[f32; 4]; 4]; 3],
    depth: [[[f32; 4]; 4]; 3],
}

/// The groups of a turn.
pub(super) struct Groups([Group; N / 4]);

/// What a test answers, before anyone asks which answer is wanted: as
/// [`crate::triangle::Candidates`].
#[derive(Clone, Copy)]
pub(super) struct Found<V, M> {
    pub(super) met: M,
    pub(super) t: V,
    pub(super) u: V,
    pub(super) v: V,
}

/// The nearest of each ray's four, [`u64::MAX`] if there is none to take.
pub(super) struct Best {
    pub(super) key: [u64; 4],
    pub(super) uv: [[f32; 2]; 4],
}

impl Groups {
    pub(super) const NEW: Self = Self(
        [Group {
            weight: [[[1.0; 4]; 4]; 3],
            depth: [[[1.0; 4]; 4]; 3],
        }; N / 4],
    );

    /// The edge functions of the rays' next blocks.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn edges(&mut self, bvh: Bvh, slots: &[Slot; N], ids: &[u32]) {
        // Corners and, behind them, what the block holds next: the upper four lanes are not used, and
        // zero, for what lies there may be slow numbers. A mask that is a constant, the compiler takes for a
        // shuffle, which costs twice as much.
        let used = std::hint::black_box(0x0fff);
        for (ids, group) in ids.chunks(4).zip(&mut self.0) {
            for (r, &id) in ids.iter().enumerate() {
                let slot = &slots[id as usize % N];
                edges(slot, &bvh.blocks[index(slot.next)], used, group, r % 4);
            }
        }
    }

    /// Which of the triangles that are `wanted` the rays of group `g` meet, and where. `exactly`
    /// answers for one ray.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn finish(
        &self,
        g: usize,
        slots: &[Slot; N],
        ids: &[u32],
        wanted: __mmask16,
        exactly: impl Fn(usize) -> Found<[f32; 4], u8>,
    ) -> Found<__m512, __mmask16> {
        let inverse = of_each(slots, ids, |slot| slot.ray.inverse_main);
        let (found, unsure) = finish(&self.0[g % (N / 4)], inverse, wanted);
        if unsure == 0 {
            return found;
        }
        let mut found = settle(found, unsure, &exactly);
        found.met &= wanted;
        found
    }
}

/// A number of each ray, in the lanes of its four triangles; the last ray's where there are fewer.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn of_each(slots: &[Slot; N], ids: &[u32], what: impl Fn(&Slot) -> f32) -> __m512 {
    let last = ids.len() - 1;
    let one = |r: usize| what(&slots[ids[r.min(last)] as usize % N]);
    four_each([one(0), one(1), one(2), one(3)])
}

/// The same for an integer.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn of_each_u32(slots: &[Slot; N], ids: &[u32], what: impl Fn(&Slot) -> u32) -> __m512i {
    _mm512_castps_si512(of_each(slots, ids, |slot| f32::from_bits(what(slot))))
}

/// Indices of the rays' triangles.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn primitives(bvh: Bvh, slots: &[Slot; N], ids: &[u32]) -> __m512i {
    let last = ids.len() - 1;
    let of = |r: usize| {
        let next = slots[ids[r.min(last)] as usize % N].next;
        load4_u32(bvh.blocks[index(next)].primitive.as_array())
    };
    let all = _mm512_inserti32x4::<1>(_mm512_castsi128_si512(of(0)), of(1));
    _mm512_inserti32x4::<3>(_mm512_inserti32x4::<2>(all, of(2)), of(3))
}

#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn edges(slot: &Slot, block: &Block, used: __mmask16, group: &mut Group, r: usize) {
    let numbers: &[f32] = bytemuck::cast_slice(bytemuck::bytes_of(block));
    let ray = &slot.ray;
    // One number, so that the compiler does not make a vector of three bytes.
    let axes = u32::from_le_bytes(ray.axes);
    let corners = |k: usize| {
        let first = (axes as usize >> (8 * k) & 0xff).min(2 * ROW as usize);
        let corners = numbers[first..first + 16].try_into().expect("sixteen");
        _mm512_maskz_sub_ps(used, load16(corners), _mm512_set1_ps(ray.permuted[k]))
    };
    let z = corners(2);
    let x = _mm512_fnmadd_ps(_mm512_set1_ps(ray.slope[0]), z, corners(0));
    let y = _mm512_fnmadd_ps(_mm512_set1_ps(ray.slope[1]), z, corners(1));
    // Lanes a, b, c become b, c, a: then lanes hold the edges (b, a), (c, b), (a, c).
    const NEXT: i32 = 0b11_00_10_01;
    let (x1, y1) = (
        _mm512_shuffle_f32x4::<NEXT>(x, x),
        _mm512_shuffle_f32x4::<NEXT>(y, y),
    );
    let product = _mm512_mul_ps(y1, x);
    let edge = _mm512_sub_ps(
        _mm512_fnmadd_ps(y1, x, product),
        _mm512_fnmadd_ps(x1, y, product),
    );
    store4(&mut group.weight[2][r], _mm512_castps512_ps128(edge));
    store4(&mut group.weight[0][r], _mm512_extractf32x4_ps::<1>(edge));
    store4(&mut group.weight[1][r], _mm512_extractf32x4_ps::<2>(edge));
    store4(&mut group.depth[0][r], _mm512_castps512_ps128(z));
    store4(&mut group.depth[1][r], _mm512_extractf32x4_ps::<1>(z));
    store4(&mut group.depth[2][r], _mm512_extractf32x4_ps::<2>(z));
}

/// The lanes of rays that are there, and of triangles that they do not leave.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn but_left(primitive: __m512i, slots: &[Slot; N], ids: &[u32]) -> __mmask16 {
    let leaves = of_each_u32(slots, ids, |slot| slot.ray.leaves);
    _mm512_mask_cmpneq_epi32_mask(lanes_below(4 * ids.len()), primitive, leaves)
}

/// Of `wanted`, the lanes of triangles that the segments do not reach.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn but_reached(
    wanted: __mmask16,
    primitive: __m512i,
    slots: &[Slot; N],
    ids: &[u32],
) -> __mmask16 {
    let reaches = of_each_u32(slots, ids, |slot| slot.reaches);
    _mm512_mask_cmpneq_epi32_mask(wanted, primitive, reaches)
}

/// The test in f32 of the lanes `used`, and those of them where it is not sure.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn finish(
    group: &Group,
    inverse: __m512,
    used: __mmask16,
) -> (Found<__m512, __mmask16>, __mmask16) {
    let column = |of: &[[f32; 4]; 4]| load16(bytemuck::cast_ref(of));
    let [wa, wb, wc] = &group.weight;
    let (wa, wb, wc) = (column(wa), column(wb), column(wc));
    let [za, zb, zc] = &group.depth;
    let (za, zb, zc) = (column(za), column(zb), column(zc));
    let det = _mm512_add_ps(_mm512_add_ps(wa, wb), wc);
    let least = _mm512_min_ps(_mm512_abs_ps(wb), _mm512_abs_ps(wc));
    let least = _mm512_min_ps(_mm512_abs_ps(wa), least);
    let (low, high) = (_mm512_set1_ps(SURE), _mm512_set1_ps(1.0 / SURE));
    let doubtful = _mm512_mask_cmp_ps_mask::<_CMP_NLE_UQ>(used, low, least)
        | _mm512_mask_cmp_ps_mask::<_CMP_NLE_UQ>(used, _mm512_abs_ps(det), high);
    let zero = _mm512_setzero_ps();
    let least = _mm512_min_ps(wa, _mm512_min_ps(wb, wc));
    let most = _mm512_max_ps(wa, _mm512_max_ps(wb, wc));
    let negative = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(least, zero);
    let outside = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(negative, zero, most);
    let share = _mm512_div_ps(_mm512_set1_ps(1.0), det);
    let ua = _mm512_mul_ps(wa, share);
    let (ub, uc) = (_mm512_mul_ps(wb, share), _mm512_mul_ps(wc, share));
    let depth = _mm512_fmadd_ps(ua, za, _mm512_fmadd_ps(ub, zb, _mm512_mul_ps(uc, zc)));
    let t = _mm512_mul_ps(depth, inverse);
    let farthest = _mm512_max_ps(_mm512_abs_ps(zb), _mm512_abs_ps(zc));
    let farthest = _mm512_max_ps(_mm512_abs_ps(za), farthest);
    let near = _mm512_mul_ps(farthest, _mm512_set1_ps(CONTACT));
    let inside = used & !outside;
    let contact = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(inside, _mm512_abs_ps(depth), near);
    let found = Found {
        met: _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(inside, zero, t),
        t,
        // Adding 0 turns -0 into 0.
        u: _mm512_add_ps(ub, zero),
        v: _mm512_add_ps(uc, zero),
    };
    (found, doubtful | contact)
}

/// Asks the exact test about rays of which some lane is not sure.
#[cold]
#[inline(never)]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn settle(
    found: Found<__m512, __mmask16>,
    unsure: __mmask16,
    exactly: &dyn Fn(usize) -> Found<[f32; 4], u8>,
) -> Found<__m512, __mmask16> {
    let mut met = found.met;
    let mut lanes = [[[0.0f32; 4]; 4]; 3];
    for (lanes, x) in lanes.iter_mut().zip([found.t, found.u, found.v]) {
        store16(bytemuck::cast_mut(lanes), x);
    }
    for r in (0..4).filter(|r| unsure >> (4 * r) & 15 != 0) {
        let exact = exactly(r);
        met = met & !(15 << (4 * r)) | u16::from(exact.met) << (4 * r);
        [lanes[0][r], lanes[1][r], lanes[2][r]] = [exact.t, exact.u, exact.v];
    }
    let [t, u, v] = lanes.map(|lanes| load16(bytemuck::cast_ref(&lanes)));
    Found { met, t, u, v }
}

/// The nearest triangle of each ray, unless it lies no nearer than what was met before; of equally
/// near ones the first.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn nearest(
    primitive: __m512i,
    found: &Found<__m512, __mmask16>,
    slots: &[Slot; N],
    ids: &[u32],
) -> Best {
    let current = of_each(slots, ids, Slot::t);
    let taken = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(found.met, found.t, current);
    // Bits of positive distances order like the distances; what is not taken comes last.
    let none = _mm512_set1_epi32(-1);
    let t = _mm512_mask_mov_epi32(none, taken, _mm512_castps_si512(found.t));
    let least = _mm512_min_epu32(t, _mm512_shuffle_epi32::<0b10_11_00_01>(t));
    let least = _mm512_min_epu32(least, _mm512_shuffle_epi32::<0b01_00_11_10>(least));
    let equal = u32::from(_mm512_cmpeq_epi32_mask(t, least));
    // The lowest bit of each four.
    let later = equal << 1 & 0xeeee | equal << 2 & 0xcccc | equal << 3 & 0x8888;
    let chosen = (equal & !later) as u16;
    let pick = |x: __m512i| _mm512_castsi512_si128(_mm512_maskz_compress_epi32(chosen, x));
    let (primitive, t) = (pick(primitive), pick(t));
    let u = pick(_mm512_castps_si512(found.u));
    let v = pick(_mm512_castps_si512(found.v));
    let mut best = Best {
        key: [key(0.0, 0); 4],
        uv: [[0.0; 2]; 4],
    };
    let halves: &mut [[f32; 4]; 2] = bytemuck::cast_mut(&mut best.key);
    store4(
        &mut halves[0],
        _mm_castsi128_ps(_mm_unpacklo_epi32(primitive, t)),
    );
    store4(
        &mut halves[1],
        _mm_castsi128_ps(_mm_unpackhi_epi32(primitive, t)),
    );
    let halves: &mut [[f32; 4]; 2] = bytemuck::cast_mut(&mut best.uv);
    store4(&mut halves[0], _mm_castsi128_ps(_mm_unpacklo_epi32(u, v)));
    store4(&mut halves[1], _mm_castsi128_ps(_mm_unpackhi_epi32(u, v)));
    best
}

/// Triangles that block each ray's segment, four bits a ray.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn blocked(found: &Found<__m512, __mmask16>, slots: &[Slot; N], ids: &[u32]) -> u32 {
    let end = of_each(slots, ids, |slot| slot.ray.span);
    u32::from(_mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(
        found.met, found.t, end,
    ))
}

/// Triangles that each ray meets no farther away than its nearest so far, four bits a ray.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn no_farther(found: &Found<__m512, __mmask16>, slots: &[Slot; N], ids: &[u32]) -> u32 {
    let current = of_each(slots, ids, Slot::t);
    u32::from(_mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(
        found.met, found.t, current,
    ))
}

/// The exact test of a ray.
#[cold]
pub(super) fn exactly(ray: &Prepared, block: &Block) -> Found<[f32; 4], u8> {
    let found = ray.shear.test(block);
    Found {
        met: found.met.to_bitmask() as u8,
        t: found.t.to_array(),
        u: found.u.to_array(),
        v: found.v.to_array(),
    }
}
