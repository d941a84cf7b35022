//! Rays made ready sixteen at a time: the arithmetic of `query.rs`, operation by operation.
//!
//! There the direction is brought to its unit over f64, whose numbers have room for any power of
//! two; where that power is an ordinary f32 the detour rounds nothing that f32 would not. Other
//! directions, [`Stage`] hands to the caller.

use super::leaf::ROW;
use super::simd::{fetch, lanes_below, load_part, store16, transpose};
use super::slot::Ray;
use crate::bvh::Bvh;
use crate::rays::{Rays, Segments};
use crate::vec3::Columns;
use std::arch::x86_64::*;
use std::ops::Range;

/// How far ahead of the rays that are made ready their columns are asked for. So many columns, a few
/// rays at a time and long pauses in between: the processor does not foresee it by itself.
const AHEAD: usize = 32;

/// Rays that are ready and wait for a slot.
#[repr(align(64))]
pub(super) struct Stage {
    rays: [[f32; 16]; 16],
    /// By axis, what is added for planes met last.
    leave: [[f32; 16]; 3],
    /// No coordinate of what rays may meet is larger.
    extent: f32,
    /// The place of the first in the view.
    first: usize,
    /// Which are still there, a bit each, and which are for the caller.
    ready: u32,
    odd: u32,
    /// The first ray that has not been looked at.
    next: usize,
    /// Where answers will be written that nobody has touched yet.
    answers: [*const f32; 3],
}

impl Stage {
    /// For rays through a tree that is not empty. `answers` are columns whose numbers are asked for as
    /// their rays' turn comes (never read: null will do).
    pub(super) fn new(bvh: Bvh, answers: [*const f32; 3]) -> Self {
        Self {
            rays: [[0.0; 16]; 16],
            leave: [[0.0; 16]; 3],
            extent: extent(bvh),
            first: 0,
            ready: 0,
            odd: 0,
            next: 0,
            answers,
        }
    }

    /// The next ray of the view that can meet anything, and its place. `odd` is told the places of
    /// those that it must answer itself.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn next_ray(
        &mut self,
        view: &Rays,
        mut odd: impl FnMut(usize),
    ) -> Option<(usize, (Ray, [f32; 3]))> {
        while self.ready == 0 && self.next < view.len {
            let (origin, direction) = (view.origin, view.direction);
            self.prepare(view.len, origin, direction, None, view.leaves);
            self.for_each_odd(&mut odd);
        }
        self.take()
    }

    /// The same for segments.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn next_segment(
        &mut self,
        view: &Segments,
        mut odd: impl FnMut(usize),
    ) -> Option<(usize, (Ray, [f32; 3]))> {
        while self.ready == 0 && self.next < view.len {
            let (origin, direction) = (view.origin, view.direction);
            self.prepare(view.len, origin, direction, Some(view.t_max), view.leaves);
            self.for_each_odd(&mut odd);
        }
        self.take()
    }

    #[inline]
    fn for_each_odd(&mut self, odd: &mut impl FnMut(usize)) {
        while self.odd != 0 {
            odd(self.first + self.odd.trailing_zeros() as usize);
            self.odd &= self.odd - 1;
        }
    }

    #[inline]
    fn take(&mut self) -> Option<(usize, (Ray, [f32; 3]))> {
        if self.ready == 0 {
            return None;
        }
        let lane = self.ready.trailing_zeros() as usize % 16;
        self.ready &= self.ready - 1;
        let leave = [0, 1, 2].map(|axis| self.leave[axis][lane]);
        Some((self.first + lane, (bytemuck::cast(self.rays[lane]), leave)))
    }

    /// Looks at the next sixteen.
    #[inline(never)]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn prepare(
        &mut self,
        len: usize,
        origin: Columns,
        direction: Columns,
        t_max: Option<&[f32]>,
        leaves: &[u32],
    ) {
        let first = self.next;
        let end = len.min(first + 16);
        for column in origin.iter().chain(&direction) {
            fetch(column.as_ptr(), first + AHEAD);
        }
        fetch(leaves.as_ptr().cast(), first + AHEAD);
        if let Some(t_max) = t_max {
            fetch(t_max.as_ptr(), first + AHEAD);
        }
        for column in self.answers {
            fetch(column, first + 16);
        }
        let leaves = load_part(bytemuck::cast_slice(leaves), first, end);
        let sixteen = Sixteen::new(origin, direction, first..end);
        let Sixteen {
            o,
            d,
            scale,
            inverse,
            ..
        } = sixteen;
        let [mut able, mut ordinary] = [sixteen.able, sixteen.ordinary];
        let rows = [0, 1, 2].map(|axis| _mm512_castsi512_ps(_mm512_set1_epi32(ROW * axis)));
        let axes = sixteen.permute(rows);
        let permuted = sixteen.permute(o);
        let slope = sixteen.slope();
        let pack = |[a, b, c]: [__m512i; 3]| {
            let bc = _mm512_or_si512(_mm512_slli_epi32::<8>(b), _mm512_slli_epi32::<16>(c));
            _mm512_castsi512_ps(_mm512_or_si512(a, bc))
        };
        // The sign of the bit, not of the number: -0 belongs with the negatives.
        let side = _mm512_set1_epi32(size_of::<[f32; 8]>() as i32);
        let near = d.map(|d| _mm512_srai_epi32::<31>(_mm512_castps_si512(d)));
        let near = pack(near.map(|negative| _mm512_and_si512(negative, side)));
        let [enter, leave, bounded] = slack(o, d, inverse, self.extent);
        let span = match t_max {
            None => scale,
            Some(t_max) => {
                let t_max = load_part(t_max, first, end);
                let zero = _mm512_setzero_ps();
                let inward = _mm512_div_ps(t_max, scale);
                // A segment without a length meets nothing; one whose length vanishes here is odd.
                able = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(able, t_max, zero);
                ordinary = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(ordinary, inward, zero);
                inward
            }
        };
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
            sixteen.by_main(inverse),
            near,
            pack(axes.map(|axis| _mm512_castps_si512(axis))),
            span,
            leaves,
        ]);
        for (to, row) in self.rays.iter_mut().zip(rows) {
            store16(to, row);
        }
        for (to, leave) in self.leave.iter_mut().zip(leave) {
            store16(to, leave);
        }
        self.first = first;
        self.next = end;
        self.ready = u32::from(able & ordinary);
        self.odd = u32::from(able & !ordinary);
    }
}

/// Sixteen rays, with directions that have their largest component in [1, 2).
pub(super) struct Sixteen {
    /// Those that can meet something: all numbers are finite, and they go somewhere.
    pub(super) able: __mmask16,
    /// Those whose direction came to its unit by a power of two that is a normal number, as is its
    /// reciprocal.
    pub(super) ordinary: __mmask16,
    /// That power.
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
        let [x, y, z] = d.map(|d| _mm512_abs_ps(d));
        let largest = _mm512_max_ps(x, _mm512_max_ps(y, z));
        let mut able = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(
            lanes_below(range.len()),
            largest,
            _mm512_setzero_ps(),
        );
        for number in [o, d].as_flattened() {
            let most = _mm512_set1_ps(f32::MAX);
            let size = _mm512_abs_ps(*number);
            able = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(able, size, most);
        }
        // Exponents 1 to 253: the power of two that undoes them is a normal number.
        let exponent = _mm512_srli_epi32::<23>(_mm512_castps_si512(largest));
        let one_less = _mm512_sub_epi32(exponent, _mm512_set1_epi32(1));
        let ordinary = _mm512_cmplt_epu32_mask(one_less, _mm512_set1_epi32(253));
        let scale = _mm512_sub_epi32(_mm512_set1_epi32(254), exponent);
        let scale = _mm512_castsi512_ps(_mm512_slli_epi32::<23>(scale));
        let d = d.map(|d| _mm512_mul_ps(d, scale));
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

    /// The direction's first and second component over its main one.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn slope(&self) -> [__m512; 2] {
        let [d0, d1, main] = self.permute(self.d);
        [_mm512_div_ps(d0, main), _mm512_div_ps(d1, main)]
    }
}

/// The largest coordinate of a tree's boxes that is finite, without its sign. The tree is not empty.
pub(crate) fn extent(bvh: Bvh) -> f32 {
    // Unused slots have infinite planes.
    let planes = bvh.nodes[0].planes.iter();
    let sizes = planes.flat_map(|row| row.to_array()).map(f32::abs);
    sizes.filter(|size| size.is_finite()).fold(0.0, f32::max)
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
    let mut farthest = _mm512_set1_ps(extent);
    for o in o {
        farthest = _mm512_max_ps(_mm512_abs_ps(o), farthest);
    }
    // The largest component is at least 1, so twice this is a distance; and again, for roundings.
    let distance = _mm512_mul_ps(farthest, _mm512_set1_ps(4.0));
    let [mut enter, mut leave, mut bounded] = [[_mm512_setzero_ps(); 3]; 3];
    for axis in 0..3 {
        let most = _mm512_set1_ps(MOST);
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
