//! Sixteen rays in lanes: the arithmetic of `query.rs`, operation by operation.
//!
//! There the direction is brought to its unit over f64, whose numbers have room for any power of
//! two; where that power is an ordinary f32 the detour rounds nothing that f32 would not. Other
//! directions are for somebody else.

use super::leaf::ROW;
use super::simd::{lanes_below, load_part, transpose};
use crate::vec3::Columns;
use std::arch::x86_64::*;
use std::ops::Range;

/// Sixteen rays, with directions that have their largest component in [1, 2), or any directions.
pub(super) struct Sixteen {
    /// Those that can meet something: all numbers are finite, and they go somewhere.
    pub(super) able: __mmask16,
    /// Those whose direction came to its unit by a power of two that is a normal number, as is its
    /// reciprocal.
    pub(super) ordinary: __mmask16,
    /// That power; of any directions, the power that would do it.
    pub(super) scale: __m512,
    /// Origins.
    pub(super) o: [__m512; 3],
    /// Directions.
    pub(super) d: [__m512; 3],
    /// Their reciprocals.
    pub(super) inverse: [__m512; 3],
    /// Those whose main axis is x, and those whose is y.
    pub(super) x_main: __mmask16,
    pub(super) y_main: __mmask16,
}

impl Sixteen {
    /// The rays of the columns' `range`, up to sixteen.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn new(origin: Columns, direction: Columns, range: Range<usize>) -> Self {
        let o = origin.map(|column| load_part(column, range.start, range.end));
        let d = direction.map(|column| load_part(column, range.start, range.end));
        Self::of::<true>(o, d, range.len())
    }

    /// So many rays, with directions brought to their unit or as they are. In the latter case those are
    /// ordinary whose largest component lies between 2^-63 and 2^64.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn of<const AT_UNIT: bool>(o: [__m512; 3], d: [__m512; 3], used: usize) -> Self {
        let [x, y, z] = d.map(|d| _mm512_abs_ps(d));
        let largest = _mm512_max_ps(x, _mm512_max_ps(y, z));
        let mut able =
            _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(lanes_below(used), largest, _mm512_setzero_ps());
        for number in [o, d].as_flattened() {
            let most = _mm512_set1_ps(f32::MAX);
            let size = _mm512_abs_ps(*number);
            able = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(able, size, most);
        }
        // Exponents 1 to 253: the power of two that undoes them is a normal number.
        let (least, count) = if AT_UNIT { (1, 253) } else { (64, 127) };
        let exponent = _mm512_srli_epi32::<23>(_mm512_castps_si512(largest));
        let above = _mm512_sub_epi32(exponent, _mm512_set1_epi32(least));
        let ordinary = _mm512_cmplt_epu32_mask(above, _mm512_set1_epi32(count));
        let scale = _mm512_sub_epi32(_mm512_set1_epi32(254), exponent);
        let scale = _mm512_castsi512_ps(_mm512_slli_epi32::<23>(scale));
        let d = if AT_UNIT {
            d.map(|d| _mm512_mul_ps(d, scale))
        } else {
            d
        };
        // The largest component's axis; of equally large ones the last.
        let x_main =
            _mm512_cmp_ps_mask::<_CMP_GT_OQ>(x, y) & _mm512_cmp_ps_mask::<_CMP_GT_OQ>(x, z);
        Self {
            able,
            ordinary,
            scale,
            o,
            d,
            inverse: d.map(|d| _mm512_div_ps(_mm512_set1_ps(1.0), d)),
            x_main,
            y_main: !x_main & _mm512_cmp_ps_mask::<_CMP_GT_OQ>(y, z),
        }
    }

    /// Those that the kernels here trace.
    #[inline]
    pub(super) fn usual(&self) -> __mmask16 {
        self.able & self.ordinary
    }

    /// One of three, by main axis.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn by_main(&self, [x, y, z]: [__m512; 3]) -> __m512 {
        _mm512_mask_mov_ps(_mm512_mask_mov_ps(z, self.y_main, y), self.x_main, x)
    }

    /// Along the axes first, second, main.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn permute(&self, [x, y, z]: [__m512; 3]) -> [__m512; 3] {
        [
            self.by_main([y, z, x]),
            self.by_main([z, x, y]),
            self.by_main([x, y, z]),
        ]
    }

    /// A row a [`Ray`], and what is added for planes met last, by axis, of rays with a [`slack`].
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn rows(
        &self,
        [enter, leave, bounded]: [[__m512; 3]; 3],
        span: __m512,
        leaves: __m512,
    ) -> ([__m512; 16], [__m512; 3]) {
        let rows = [0, 1, 2].map(|axis| _mm512_castsi512_ps(_mm512_set1_epi32(ROW * axis)));
        let axes = self.permute(rows);
        let permuted = self.permute(self.o);
        let slope = self.slope();
        let pack = |[a, b, c]: [__m512i; 3]| {
            let bc = _mm512_or_si512(_mm512_slli_epi32::<8>(b), _mm512_slli_epi32::<16>(c));
            _mm512_castsi512_ps(_mm512_or_si512(a, bc))
        };
        // The sign of the bit, not of the number: -0 belongs with the negatives.
        let side = _mm512_set1_epi32(size_of::<[f32; 8]>() as i32);
        let near = self
            .d
            .map(|d| _mm512_srai_epi32::<31>(_mm512_castps_si512(d)));
        let near = pack(near.map(|negative| _mm512_and_si512(negative, side)));
        // Columns as the fields of `Ray`.
        let rows = transpose([
            enter[0],
            enter[1],
            enter[2],
            bounded[0],
            bounded[1],
            bounded[2],
            permuted[0],
            permuted[1],
            permuted[2],
            slope[0],
            slope[1],
            self.by_main(self.inverse),
            near,
            pack(axes.map(|axis| _mm512_castps_si512(axis))),
            span,
            leaves,
        ]);
        (rows, leave)
    }

    /// The direction's first and second component over its main one.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn slope(&self) -> [__m512; 2] {
        let [d0, d1, main] = self.permute(self.d);
        [_mm512_div_ps(d0, main), _mm512_div_ps(d1, main)]
    }
}

/// What `node.rs` adds for planes met first and last, and the reciprocals that it takes, by axis: see
/// there. `extent` bounds the coordinates of what the rays may meet.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn slack(
    o: [__m512; 3],
    d: [__m512; 3],
    inverse: [__m512; 3],
    extent: f32,
) -> [[__m512; 3]; 3] {
    slack_in(o, d, inverse, _mm512_set1_ps(extent), _mm512_set1_ps(1.0))
}

/// The same for directions that `unit`, a power of two, would bring to a largest component in `[1, 2)`.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
pub(super) fn slack_in(
    o: [__m512; 3],
    d: [__m512; 3],
    inverse: [__m512; 3],
    extent: __m512,
    unit: __m512,
) -> [[__m512; 3]; 3] {
    let mut farthest = extent;
    for o in o {
        farthest = _mm512_max_ps(_mm512_abs_ps(o), farthest);
    }
    // The largest component is at least 1, so twice this is a distance; and again, for roundings.
    let distance = _mm512_mul_ps(_mm512_mul_ps(farthest, _mm512_set1_ps(4.0)), unit);
    let most = _mm512_mul_ps(_mm512_set1_ps(MOST), unit);
    let [mut enter, mut leave, mut bounded] = [[_mm512_setzero_ps(); 3]; 3];
    for axis in 0..3 {
        let small = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(_mm512_abs_ps(inverse[axis]), most);
        // The sign is the direction's, whose bit says which planes are met first.
        let sign = _mm512_and_ps(d[axis], _mm512_set1_ps(-0.0));
        let i = _mm512_mask_or_ps(inverse[axis], small, most, sign);
        let c = _mm512_mul_ps(o[axis], i);
        let least = _mm512_set1_ps(f32::MIN_POSITIVE);
        let e = _mm512_fmadd_ps(_mm512_abs_ps(c), _mm512_set1_ps(4.0 / 16_777_216.0), least);
        let e = _mm512_mask_add_ps(e, small, e, distance);
        let minus = _mm512_sub_ps(_mm512_setzero_ps(), c);
        enter[axis] = _mm512_sub_ps(minus, e);
        leave[axis] = _mm512_add_ps(minus, e);
        bounded[axis] = i;
    }
    [enter, leave, bounded]
}

/// The largest reciprocal that `node.rs` takes.
const MOST: f32 = 18_446_744_073_709_551_616.0;
