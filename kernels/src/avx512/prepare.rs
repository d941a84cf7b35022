//! Rays of a view, made ready sixteen at a time (`sixteen.rs`), one by one.

use super::simd::{fetch, load_part, store16};
use super::sixteen::{Sixteen, slack};
use super::slot::Ray;
use crate::bvh::Bvh;
use crate::rays::{Rays, Segments};
use crate::vec3::Columns;
use std::arch::x86_64::*;

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
    /// For rays through a tree that is not empty; `answers` as for [`Stage::of`].
    pub(super) fn new(bvh: Bvh, answers: [*const f32; 3]) -> Self {
        Self::of(extent(bvh), answers)
    }

    /// For rays that may meet something up to a coordinate. `answers` are columns whose numbers are asked for
    /// as their rays' turn comes (never read: null will do).
    pub(super) fn of(extent: f32, answers: [*const f32; 3]) -> Self {
        Self {
            rays: [[0.0; 16]; 16],
            leave: [[0.0; 16]; 3],
            extent,
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
    pub(super) fn next(
        &mut self,
        view: &View,
        mut odd: impl FnMut(usize),
    ) -> Option<(usize, (Ray, [f32; 3]))> {
        while self.ready == 0 && self.next < view.len {
            self.prepare(view);
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
    fn prepare(&mut self, view: &View) {
        let View {
            len,
            origin,
            direction,
            t_max,
            leaves,
        } = *view;
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
        let slack = slack(o, d, inverse, self.extent);
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
        let (rows, leave) = sixteen.rows(slack, span, leaves);
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

/// Rays or segments, as [`Rays`] and [`Segments`] have them.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub(super) len: usize,
    pub(super) origin: Columns<'a>,
    pub(super) direction: Columns<'a>,
    /// Where segments end; none of rays.
    pub(super) t_max: Option<&'a [f32]>,
    pub(super) leaves: &'a [u32],
}

impl<'a> View<'a> {
    #[inline]
    pub(super) fn of_rays(rays: &Rays<'a>) -> Self {
        Self {
            len: rays.len,
            origin: rays.origin,
            direction: rays.direction,
            t_max: None,
            leaves: rays.leaves,
        }
    }

    #[inline]
    pub(super) fn of_segments(segments: &Segments<'a>) -> Self {
        Self {
            len: segments.len,
            origin: segments.origin,
            direction: segments.direction,
            t_max: Some(segments.t_max),
            leaves: segments.leaves,
        }
    }
}

/// [`Node::extent`](crate::bvh::Node::extent) of a tree that is not empty.
pub(crate) fn extent(bvh: Bvh) -> f32 {
    bvh.nodes[0].extent()
}
