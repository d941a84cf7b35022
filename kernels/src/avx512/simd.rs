//! Arrays as vectors and back.

use std::arch::x86_64::*;

/// Sixteen numbers.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn load16(from: &[f32; 16]) -> __m512 {
    // SAFETY: the array is as long as the vector, and the load asks for no alignment.
    unsafe { _mm512_loadu_ps(from.as_ptr()) }
}

/// Sixteen integers.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn load16_u32(from: &[u32; 16]) -> __m512i {
    _mm512_castps_si512(load16(bytemuck::cast_ref(from)))
}

/// Numbers `i ..` of a column that ends at `end`: up to sixteen, zeros in the lanes beyond.
///
/// # Panics
/// If the column is shorter than `end`.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn load_part(column: &[f32], i: usize, end: usize) -> __m512 {
    let column = &column[i..end];
    // SAFETY: of lanes that the mask leaves out nothing is read; the others are in the slice.
    unsafe { _mm512_maskz_loadu_ps(lanes_below(column.len()), column.as_ptr()) }
}

/// Writes the lanes `which` of a vector to numbers `i ..` of a column.
///
/// # Panics
/// If the column ends before the last of them.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn store_lanes(column: &mut [f32], i: usize, which: __mmask16, x: __m512) {
    let lanes = 16 - which.leading_zeros() as usize;
    let column = &mut column[i..i + lanes];
    // SAFETY: of lanes that the mask leaves out nothing is written; the others are in the slice.
    unsafe { _mm512_mask_storeu_ps(column.as_mut_ptr(), which, x) };
}

/// Asks for number `i` of a column, which may lie beyond its end.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn fetch(column: *const f32, i: usize) {
    _mm_prefetch::<_MM_HINT_T0>(column.wrapping_add(i).cast());
}

/// A mask of the first `n` of sixteen lanes.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn lanes_below(n: usize) -> __mmask16 {
    if n < 16 { (1 << n) - 1 } else { !0 }
}

/// Eight numbers.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn load8(from: &[f32; 8]) -> __m256 {
    // SAFETY: as `load16`.
    unsafe { _mm256_loadu_ps(from.as_ptr()) }
}

/// Eight numbers, as bytes.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn load8_bytes(from: &[u8; 32]) -> __m256 {
    // SAFETY: as `load16`.
    unsafe { _mm256_loadu_ps(from.as_ptr().cast()) }
}

/// Four integers.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn load4_u32(from: &[u32; 4]) -> __m128i {
    // SAFETY: as `load16`.
    unsafe { _mm_loadu_si128(from.as_ptr().cast()) }
}

/// Writes sixteen numbers.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn store16(to: &mut [f32; 16], x: __m512) {
    // SAFETY: the array is as long as the vector, and the store asks for no alignment.
    unsafe { _mm512_storeu_ps(to.as_mut_ptr(), x) }
}

/// Writes sixteen integers.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn store16_u32(to: &mut [u32; 16], x: __m512i) {
    store16(bytemuck::cast_mut(to), _mm512_castsi512_ps(x));
}

/// Writes eight addresses.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn store8_u64(to: &mut [u64; 8], x: __m512i) {
    store16(bytemuck::cast_mut(to), _mm512_castsi512_ps(x));
}

/// Writes eight numbers.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn store8(to: &mut [f32; 8], x: __m256) {
    // SAFETY: as `store16`.
    unsafe { _mm256_storeu_ps(to.as_mut_ptr(), x) }
}

/// Writes four numbers.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn store4(to: &mut [f32; 4], x: __m128) {
    // SAFETY: as `store16`.
    unsafe { _mm_storeu_ps(to.as_mut_ptr(), x) }
}

/// Each of four numbers in four lanes: one a ray, for its four triangles.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn four_each(x: [f32; 4]) -> __m512 {
    let all = _mm512_set1_ps(x[0]);
    let all = _mm512_mask_broadcastss_ps(all, 0x00f0, _mm_set_ss(x[1]));
    let all = _mm512_mask_broadcastss_ps(all, 0x0f00, _mm_set_ss(x[2]));
    _mm512_mask_broadcastss_ps(all, 0xf000, _mm_set_ss(x[3]))
}

/// The same for integers.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn four_each_u32(x: [u32; 4]) -> __m512i {
    _mm512_castps_si512(four_each(bytemuck::cast(x)))
}

/// Sixteen vectors of sixteen as a matrix, rows and columns exchanged.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn transpose(row: [__m512; 16]) -> [__m512; 16] {
    // Pairs of rows, then pairs of pairs, within 128 bits; then whole 128 bits.
    let mut pairs = row;
    for i in 0..8 {
        pairs[2 * i] = _mm512_unpacklo_ps(row[2 * i], row[2 * i + 1]);
        pairs[2 * i + 1] = _mm512_unpackhi_ps(row[2 * i], row[2 * i + 1]);
    }
    let low = |a, b| {
        let both = _mm512_unpacklo_pd(_mm512_castps_pd(a), _mm512_castps_pd(b));
        _mm512_castpd_ps(both)
    };
    let high = |a, b| {
        let both = _mm512_unpackhi_pd(_mm512_castps_pd(a), _mm512_castps_pd(b));
        _mm512_castpd_ps(both)
    };
    let mut fours = pairs;
    for i in 0..4 {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| pairs[4 * i + k]);
        fours[4 * i] = low(a, c);
        fours[4 * i + 1] = high(a, c);
        fours[4 * i + 2] = low(b, d);
        fours[4 * i + 3] = high(b, d);
    }
    let mut out = fours;
    for c in 0..4 {
        let [a, b, d, e] = [0, 1, 2, 3].map(|k| fours[4 * k + c]);
        let (ab_low, de_low) = (
            _mm512_shuffle_f32x4::<0x44>(a, b),
            _mm512_shuffle_f32x4::<0x44>(d, e),
        );
        let (ab_high, de_high) = (
            _mm512_shuffle_f32x4::<0xee>(a, b),
            _mm512_shuffle_f32x4::<0xee>(d, e),
        );
        out[c] = _mm512_shuffle_f32x4::<0x88>(ab_low, de_low);
        out[4 + c] = _mm512_shuffle_f32x4::<0xdd>(ab_low, de_low);
        out[8 + c] = _mm512_shuffle_f32x4::<0x88>(ab_high, de_high);
        out[12 + c] = _mm512_shuffle_f32x4::<0xdd>(ab_high, de_high);
    }
    out
}
