//! The owner of a queue's columns.

use bytemuck::{Pod, Zeroable};
use huygens_kernels::compact::Kept;
use huygens_kernels::lanes::LANES;
use huygens_kernels::soa::Layout;
use std::marker::PhantomData;

/// One cache line of words: the unit of alignment.
#[repr(C, align(64))]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Line([u32; 16]);

const LINE: usize = 16;

/// A fixed-capacity queue: the columns that `L` declares, in one allocation, made once.
///
/// Items are `0..len`. Each column starts on a cache line of its own and has room for one vector
/// more than the capacity, for stores of whole vectors. Columns lie an odd number of cache lines
/// apart, so that the same item of different columns falls into different sets of the cache even
/// where the capacity is a power of two.
pub(crate) struct Queue<L> {
    lines: Vec<Line>,
    stride: usize,
    capacity: usize,
    len: usize,
    layout: PhantomData<L>,
}

impl<L: Layout> Queue<L> {
    pub(crate) fn new(capacity: usize) -> Self {
        let lines = (capacity + LANES).div_ceil(LINE) | 1;
        Self {
            lines: vec![Line::zeroed(); lines * L::WORDS],
            stride: lines * LINE,
            capacity,
            len: 0,
            layout: PhantomData,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Items that fit.
    pub(crate) fn capacity(&self) -> usize {
        self.capacity
    }

    /// Items that still fit.
    pub(crate) fn room(&self) -> usize {
        self.capacity - self.len
    }

    /// Declares the first `len` items written.
    pub(crate) fn set_len(&mut self, len: usize) {
        assert!(
            len <= self.capacity,
            "a queue's capacity holds every item it is given"
        );
        self.len = len;
    }

    /// Takes over what another queue of the same capacity holds.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.lines.copy_from_slice(&other.lines);
        self.len = other.len;
    }

    /// All columns, padding included.
    pub(crate) fn view(&self) -> L::View<'_> {
        L::view(bytemuck::cast_slice(&self.lines).chunks_exact(self.stride))
    }

    /// All columns, padding included.
    pub(crate) fn view_mut(&mut self) -> L::ViewMut<'_> {
        L::view_mut(bytemuck::cast_slice_mut(&mut self.lines).chunks_exact_mut(self.stride))
    }

    /// Appends items of `from`, by index, all columns at a time.
    pub(crate) fn append_rows(&mut self, from: &Self, rows: &[u32]) {
        let start = self.len;
        self.set_len(start + rows.len());
        let source: &[u32] = bytemuck::cast_slice(&from.lines);
        let target: &mut [u32] = bytemuck::cast_slice_mut(&mut self.lines);
        let columns = source
            .chunks_exact(from.stride)
            .zip(target.chunks_exact_mut(self.stride));
        for (source, target) in columns {
            for (to, &row) in target[start..].iter_mut().zip(rows) {
                *to = source[row as usize];
            }
        }
    }

    /// Appends the lanes `kept` of each of `from`'s vectors, in order: compaction, all columns at a
    /// time. `kept[i]` is for items `LANES * i ..`.
    pub(crate) fn append_kept(&mut self, from: &Self, kept: &[Kept]) {
        let start = self.len;
        let total: usize = kept.iter().map(|k| k.count).sum();
        self.set_len(start + total);
        let source: &[u32] = bytemuck::cast_slice(&from.lines);
        let target: &mut [u32] = bytemuck::cast_slice_mut(&mut self.lines);
        let columns = source
            .chunks_exact(from.stride)
            .zip(target.chunks_exact_mut(self.stride));
        for (source, target) in columns {
            let mut to = start;
            for (i, k) in kept.iter().enumerate() {
                k.move_words(source, i * LANES, target, to);
                to += k.count;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use huygens_kernels::lanes::{Ux, as_mask, first};
    use huygens_kernels::queues::OcclusionMut;

    #[test]
    fn appending_keeps_the_order_and_drops_the_rest() {
        let n = 3 * LANES + 3;
        let mut from = Queue::<OcclusionMut>::new(n);
        for (i, word) in from.view_mut().occluded.iter_mut().enumerate().take(n) {
            *word = i as u32;
        }
        from.set_len(n);
        let kept: Vec<Kept> = (0..n.div_ceil(LANES))
            .map(|i| {
                let odd = (huygens_kernels::lanes::iota(0) & Ux::ONE).simd_eq(Ux::ONE);
                Kept::new(as_mask(odd) & first(n - i * LANES))
            })
            .collect();
        let mut to = Queue::<OcclusionMut>::new(n);
        to.append_kept(&from, &kept);
        let odd: Vec<u32> = (0..n as u32).filter(|i| i % 2 == 1).collect();
        assert_eq!(&to.view().occluded[..to.len()], &odd[..]);
    }

    #[test]
    #[should_panic(expected = "capacity")]
    fn a_queue_never_grows() {
        Queue::<OcclusionMut>::new(8).set_len(9);
    }

    #[test]
    fn columns_start_on_cache_lines_in_different_sets() {
        let queue = Queue::<huygens_kernels::queues::PathsMut>::new(4096);
        assert_eq!(queue.lines.as_ptr() as usize % 64, 0);
        assert_eq!(queue.stride / LINE % 2, 1);
    }
}
