//! `few.rs` for processors with AVX-512: sixteen rays, a lane each, against every triangle. The same
//! arithmetic, so the same answers, bit for bit.
//!
//! Nobody is dealt into hands here: which coordinate of a vertex is along a ray's main axis is said by
//! masks, twice two moves a coordinate. That costs less than to bring rays together and their answers
//! back. The rays of which some edge function was in doubt are asked about again one at a time.

use super::simd::{load_part, store_lanes};
use super::sixteen::Sixteen;
use crate::few::{self, Few, MAX_VERTICES, Triangle};
use crate::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use crate::triangle::{CONTACT, SURE};
use crate::visits;
use std::arch::x86_64::*;
use std::ops::Range;

/// Writes the closest hit of each ray.
///
/// # Panics
/// If a column is shorter than `rays.len`, there are too many vertices, or
/// [`available`](super::available) is false.
pub fn closest(few: Few, rays: Rays, mut hits: Hits) {
    assert!(super::available(), "a processor with AVX-512");
    hits.primitive[..rays.len].fill(NO_PRIMITIVE);
    // SAFETY: the processor has what the function is compiled for.
    unsafe { closest_of(few, rays, &mut hits) }
}

/// Writes 1 for each segment that something lies on, else 0.
///
/// # Panics
/// As [`closest`].
pub fn occluded(few: Few, segments: Segments, occluded: &mut [u32]) {
    assert!(super::available(), "a processor with AVX-512");
    occluded[..segments.len].fill(0);
    // SAFETY: the processor has what the function is compiled for.
    unsafe { occluded_by(few, segments, occluded) }
}

#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn closest_of(few: Few, rays: Rays, hits: &mut Hits) {
    let mut sheared = [[_mm512_setzero_ps(); 3]; MAX_VERTICES];
    for range in sixteens(rays.len) {
        let sixteen = Sixteen::new(rays.origin, rays.direction, range.clone());
        let inverse = shear(&sixteen, few, &mut sheared);
        let used = sixteen.usual();
        let leaves = integers(rays.leaves, &range);
        visits::add(0, 16 * few.triangles.len());
        let mut doubt = Doubt::new();
        let mut t = _mm512_set1_ps(f32::MAX);
        let [mut u, mut v] = [_mm512_setzero_ps(); 2];
        let mut primitive = _mm512_set1_epi32(NO_PRIMITIVE as i32);
        for triangle in few.triangles {
            let index = _mm512_set1_epi32(triangle.primitive as i32);
            let wanted = _mm512_mask_cmpneq_epi32_mask(used, index, leaves);
            let met = meet(corners(triangle, &sheared), inverse, wanted, &mut doubt);
            // Strictly nearer: of equally near ones the first.
            let nearer = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(met.which, met.t, t);
            t = _mm512_mask_mov_ps(t, nearer, met.t);
            u = _mm512_mask_mov_ps(u, nearer, met.u);
            v = _mm512_mask_mov_ps(v, nearer, met.v);
            primitive = _mm512_mask_mov_epi32(primitive, nearer, index);
        }
        let unsure = doubt.lanes(used);
        // What f32 cannot hold becomes the nearest it can.
        let t = _mm512_mul_ps(t, sixteen.scale);
        let t = _mm512_max_ps(t, _mm512_set1_ps(f32::from_bits(1)));
        let t = _mm512_min_ps(t, _mm512_set1_ps(f32::MAX));
        let zero = _mm512_setzero_ps();
        // Adding 0 turns -0 into 0.
        let (u, v) = (_mm512_add_ps(u, zero), _mm512_add_ps(v, zero));
        let (primitives, i) = (bytemuck::cast_slice_mut(hits.primitive), range.start);
        store_lanes(primitives, i, used, _mm512_castsi512_ps(primitive));
        store_lanes(hits.t, i, used, t);
        store_lanes(hits.u, i, used, u);
        store_lanes(hits.v, i, used, v);
        for i in lanes_of(i, unsure | sixteen.able & !sixteen.ordinary) {
            few::closest_of_one(few, rays, hits.part(0..rays.len), i);
        }
    }
}

#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn occluded_by(few: Few, segments: Segments, occluded: &mut [u32]) {
    let mut sheared = [[_mm512_setzero_ps(); 3]; MAX_VERTICES];
    for range in sixteens(segments.len) {
        let sixteen = Sixteen::new(segments.origin, segments.direction, range.clone());
        let inverse = shear(&sixteen, few, &mut sheared);
        let used = sixteen.usual();
        let leaves = integers(segments.leaves, &range);
        let reaches = integers(segments.reaches, &range);
        let end = load_part(segments.t_max, range.start, range.end);
        let end = _mm512_div_ps(end, sixteen.scale);
        visits::add(0, 16 * few.triangles.len());
        let mut doubt = Doubt::new();
        let mut blocked = 0;
        for triangle in few.triangles {
            let index = _mm512_set1_epi32(triangle.primitive as i32);
            let wanted = _mm512_mask_cmpneq_epi32_mask(used, index, leaves);
            let wanted = _mm512_mask_cmpneq_epi32_mask(wanted, index, reaches);
            let met = meet(corners(triangle, &sheared), inverse, wanted, &mut doubt);
            blocked |= _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(met.which, met.t, end);
        }
        let unsure = doubt.lanes(used);
        let one = _mm512_castsi512_ps(_mm512_maskz_set1_epi32(blocked, 1));
        let (out, i) = (bytemuck::cast_slice_mut(occluded), range.start);
        store_lanes(out, i, used, one);
        for i in lanes_of(i, unsure | sixteen.able & !sixteen.ordinary) {
            few::occluded_of_one(few, segments, occluded, i);
        }
    }
}

/// The places of `len` rays, sixteen by sixteen.
fn sixteens(len: usize) -> impl Iterator<Item = Range<usize>> {
    (0..len).step_by(16).map(move |i| i..len.min(i + 16))
}

/// The places behind `first` that a mask names.
fn lanes_of(first: usize, mask: __mmask16) -> impl Iterator<Item = usize> {
    let mut left = mask;
    std::iter::from_fn(move || {
        let lane = left.trailing_zeros() as usize;
        left &= left.wrapping_sub(1);
        (lane < 16).then_some(first + lane)
    })
}

#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn integers(column: &[u32], range: &Range<usize>) -> __m512i {
    let column = bytemuck::cast_slice(column);
    _mm512_castps_si512(load_part(column, range.start, range.end))
}

/// Vertices as sixteen rays see them.
type Sheared = [[__m512; 3]; MAX_VERTICES];

/// Which rays' lines meet a triangle at `t > 0`, and where.
pub(super) struct Met {
    pub(super) which: __mmask16,
    pub(super) t: __m512,
    pub(super) u: __m512,
    pub(super) v: __m512,
}

/// Shears all vertices, and gives 1 over the main components, which [`meet`] takes.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn shear(sixteen: &Sixteen, few: Few, sheared: &mut Sheared) -> __m512 {
    assert!(few.vertices.len() <= MAX_VERTICES, "too many vertices");
    let origin = sixteen.permute(sixteen.o);
    let slope = sixteen.slope();
    for (&[x, y, z], into) in few.vertices.iter().zip(sheared) {
        let corner = [_mm512_set1_ps(x), _mm512_set1_ps(y), _mm512_set1_ps(z)];
        let [x, y, z] = sixteen.permute(corner);
        let z = _mm512_sub_ps(z, origin[2]);
        let x = _mm512_fnmadd_ps(slope[0], z, _mm512_sub_ps(x, origin[0]));
        let y = _mm512_fnmadd_ps(slope[1], z, _mm512_sub_ps(y, origin[1]));
        *into = [x, y, z];
    }
    sixteen.by_main(sixteen.inverse)
}

/// Tests the `wanted` rays against a triangle, given its corners as the rays see them and 1 over
/// the rays' main components.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn meet(
    [a, b, c]: [&[__m512; 3]; 3],
    inverse: __m512,
    wanted: __mmask16,
    doubt: &mut Doubt,
) -> Met {
    let edge = |p: &[__m512; 3], q: &[__m512; 3]| {
        let product = _mm512_mul_ps(p[1], q[0]);
        _mm512_sub_ps(
            _mm512_fnmadd_ps(p[1], q[0], product),
            _mm512_fnmadd_ps(p[0], q[1], product),
        )
    };
    let (wa, wb, wc) = (edge(c, b), edge(a, c), edge(b, a));
    let det = _mm512_add_ps(_mm512_add_ps(wa, wb), wc);
    doubt.consider(wanted, least_size(wa, least_size(wb, wc)), det);
    let share = _mm512_div_ps(_mm512_set1_ps(1.0), det);
    let ua = _mm512_mul_ps(wa, share);
    let (ub, uc) = (_mm512_mul_ps(wb, share), _mm512_mul_ps(wc, share));
    let depth = _mm512_fmadd_ps(ub, b[2], _mm512_mul_ps(uc, c[2]));
    let depth = _mm512_fmadd_ps(ua, a[2], depth);
    let t = _mm512_mul_ps(depth, inverse);
    // (a ^ b) | (b ^ c): where all are sure, signs differ where sign bits do.
    let [wa, wb, wc] = [
        _mm512_castps_si512(wa),
        _mm512_castps_si512(wb),
        _mm512_castps_si512(wc),
    ];
    let mixed = _mm512_ternarylogic_epi32::<0x7e>(wa, wb, wc);
    let inside = wanted & !_mm512_movepi32_mask(mixed);
    let near = greatest_size(a[2], greatest_size(b[2], c[2]));
    let near = _mm512_mul_ps(near, _mm512_set1_ps(CONTACT));
    let depth = _mm512_abs_ps(depth);
    doubt.contact |= _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(inside, depth, near);
    Met {
        which: _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(inside, _mm512_setzero_ps(), t),
        t,
        u: ub,
        v: uc,
    }
}

/// For `vrangeps`: of the lesser magnitude, the magnitude.
const LEAST: i32 = 0b1010;

/// A triangle's corners.
#[inline]
fn corners<'a>(triangle: &Triangle, sheared: &'a Sheared) -> [&'a [__m512; 3]; 3] {
    let [a, b, c] = triangle.corners;
    [a, b, c].map(|corner| &sheared[usize::from(corner)])
}

/// The magnitude of the lesser one.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn least_size(a: __m512, b: __m512) -> __m512 {
    _mm512_range_ps::<LEAST>(a, b)
}

/// The magnitude of the greater one.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn greatest_size(a: __m512, b: __m512) -> __m512 {
    _mm512_range_ps::<0b1011>(a, b)
}

/// What decides in the end whether all edge functions were sure.
pub(super) struct Doubt {
    /// The least magnitude of an edge function.
    least: __m512,
    /// The bits of the greatest magnitude of a doubled area: those of a NaN are greater still.
    most: __m512i,
    /// Where a triangle is met so near that only its plane can tell on which side.
    contact: __mmask16,
}

impl Doubt {
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn new() -> Self {
        Self {
            least: _mm512_set1_ps(f32::MAX),
            most: _mm512_setzero_si512(),
            contact: 0,
        }
    }

    /// Takes note, for the lanes `of`, of the least edge function and of the doubled area.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn consider(&mut self, of: __mmask16, least: __m512, det: __m512) {
        self.least = _mm512_mask_range_ps::<LEAST>(self.least, of, self.least, least);
        let size = _mm512_castps_si512(_mm512_abs_ps(det));
        self.most = _mm512_mask_max_epu32(self.most, of, self.most, size);
    }

    /// Those of the lanes `used` that are in doubt.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn lanes(&self, used: __mmask16) -> __mmask16 {
        let most = _mm512_set1_epi32((1.0 / SURE).to_bits() as i32);
        let least = _mm512_set1_ps(SURE);
        used & (self.contact
            | _mm512_cmp_ps_mask::<_CMP_NLE_UQ>(least, self.least)
            | _mm512_cmpgt_epu32_mask(self.most, most))
    }
}
