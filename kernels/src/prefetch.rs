//! Asking for what a kernel will read before it does.
//!
//! A surface kernel reads a triangle's indices and then, by them, its vertices. In a mesh that no cache
//! holds those are two waits for memory in a row for every vector, longer than the rest of its work. What
//! is asked for a vector or two ahead is there when it is needed.

use crate::lanes::LANES;
use crate::queues::Listed;
use crate::tables::Triangles;

/// Triangles from which on their tables (52 bytes each, more or less) do not fit a second-level cache.
const WORTH_IT: usize = 1 << 15;

/// Whether these tables are too large to be near anyway.
#[must_use]
pub fn is_worth_it(triangles: &Triangles) -> bool {
    triangles.indices.len() >= WORTH_IT
}

/// What the hits of a list will make a kernel read.
#[derive(Clone, Copy, Debug)]
pub struct Ahead<'l, 't> {
    listed: Listed<'l>,
    /// `None` if all is near anyway.
    triangles: Option<Triangles<'t>>,
}

impl<'l, 't> Ahead<'l, 't> {
    /// For the surfaces of `listed`.
    #[inline]
    #[must_use]
    pub fn new(listed: Listed<'l>, triangles: &Triangles<'t>) -> Self {
        let ahead = Self {
            listed,
            triangles: is_worth_it(triangles).then_some(*triangles),
        };
        ahead.ask_for_indices(0);
        ahead.ask_for_indices(LANES);
        ahead.ask_for_vertices(0);
        ahead
    }

    /// To be called when the kernel comes to item `i` of the list.
    #[inline(always)]
    pub fn at(&self, i: usize) {
        if self.triangles.is_some() {
            self.ask_for_indices(i + 2 * LANES);
            self.ask_for_vertices(i + LANES);
        }
    }

    fn ask_for_indices(&self, i: usize) {
        let Some(triangles) = &self.triangles else {
            return;
        };
        for primitive in self.primitives(i) {
            ask_for(triangles.indices, primitive);
            ask_for(triangles.material, primitive);
        }
    }

    fn ask_for_vertices(&self, i: usize) {
        let Some(triangles) = &self.triangles else {
            return;
        };
        for primitive in self.primitives(i) {
            // Others than triangles of the world have numbers beyond the table.
            if let Some(corners) = triangles.indices.get(primitive as usize) {
                for &corner in corners {
                    ask_for(triangles.vertices, corner);
                }
            }
        }
    }

    /// What the vector of paths from item `i` on met; none beyond the end of the list.
    #[inline(always)]
    fn primitives(&self, i: usize) -> impl Iterator<Item = u32> + '_ {
        let end = self.listed.len.min(i + LANES);
        let places = self.listed.index.get(i..end).unwrap_or_default();
        let primitive = self.listed.hits.primitive;
        places
            .iter()
            .filter_map(|&at| primitive.get(at as usize).copied())
    }
}

/// Brings row `i` of a table near, if there is one and the processor can.
#[inline(always)]
pub fn ask_for<T>(table: &[T], i: u32) {
    #[cfg(target_arch = "x86_64")]
    if let Some(row) = table.get(i as usize) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing as far as the program can tell.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(row).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (table, i);
}
