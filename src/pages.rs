//! Large tables on large pages.
//!
//! A ray that jumps through hundreds of megabytes finds the address of nearly every node without
//! walking the page table if pages are of 2 MiB, and a build asks the system for memory a 512th
//! as often. Linux grants such pages where it is asked before a page is touched. So what is asked for must
//! come untouched, as memory mapped anew does. What the allocator is asked for in zeros may be memory that was
//! used before, which one thread then clears.

use bytemuck::Pod;
use memmap2::MmapMut;
use rayon::prelude::*;
use std::ops::{Deref, DerefMut};

/// Smallest table that is worth it, in bytes: below, the translation look-aside buffers hold all of it
/// anyway.
const WORTH_IT: usize = 2 << 20;
/// A large page.
const PAGE: usize = 2 << 20;
/// A page no larger than any that may be had in its place.
const SMALL: usize = 4 << 10;

/// A table of plain elements, in memory of its own where it is large.
pub(crate) struct Table<T>(Memory<T>);

enum Memory<T> {
    Small(Vec<T>),
    /// From its first whole page on, so many elements.
    Large(MmapMut, usize),
}

impl<T: Pod> Table<T> {
    /// `len` elements of zeros that nobody has touched yet, if they are many.
    pub(crate) fn zeroed(len: usize) -> Self {
        let map = map(len * size_of::<T>());
        Self(match map {
            Some(map) => Memory::Large(map, len),
            None => Memory::Small(bytemuck::zeroed_vec(len)),
        })
    }

    /// `len` elements in the memory of a table that is done with, if that is large and has room for them.
    /// What they are at first is anything.
    pub(crate) fn in_place_of<U: Pod>(old: Table<U>, len: usize) -> Self {
        match old.0 {
            Memory::Large(map, _) if whole::<T>(&map).len() >= len => Self(Memory::Large(map, len)),
            other => {
                // Given back first, not held beside what is taken.
                drop(other);
                Self::zeroed(len)
            }
        }
    }

    /// Has the system clear the table's memory, on the current rayon pool, a large page a task: whoever
    /// first writes to one has it cleared, and if two do at once, both do all the work.
    pub(crate) fn clear(&mut self)
    where
        T: Send,
    {
        if let Memory::Large(map, len) = &mut self.0 {
            let first = before(map);
            let bytes = &mut map[first..][..*len * size_of::<T>()];
            let small = |page: &mut [u8]| page.iter_mut().step_by(SMALL).for_each(|byte| *byte = 0);
            bytes.par_chunks_mut(PAGE).for_each(small);
        }
    }

    /// Appends elements.
    pub(crate) fn extend(&mut self, more: impl ExactSizeIterator<Item = T>) {
        let old = self.len();
        let new = old + more.len();
        match &mut self.0 {
            Memory::Small(elements) if new * size_of::<T>() < WORTH_IT => {
                elements.extend(more);
                return;
            }
            Memory::Large(map, len) if whole::<T>(map).len() >= new => *len = new,
            _ => {
                // Twice as much, so that elements move but a few times. What is not touched costs
                // nothing.
                let mut grown = Self::zeroed(new.max(2 * old));
                grown[..old].copy_from_slice(self);
                match &mut grown.0 {
                    Memory::Small(elements) => elements.truncate(new),
                    Memory::Large(_, len) => *len = new,
                }
                *self = grown;
            }
        }
        for (element, value) in self[old..].iter_mut().zip(more) {
            *element = value;
        }
    }
}

/// A mapping with room for so many bytes from its first whole page on; none if that is not worth it or
/// not to be had.
fn map(bytes: usize) -> Option<MmapMut> {
    if bytes < WORTH_IT {
        return None;
    }
    let map = MmapMut::map_anon(bytes.checked_add(2 * PAGE)?).ok()?;
    // A page is cleared whole, however little of it is used: the last one had better be small ones where
    // most of it would be for nothing.
    #[cfg(target_os = "linux")]
    {
        let large = (bytes + PAGE / 2) / PAGE * PAGE;
        // A hint: where it cannot be followed, nothing changes.
        let _ = map.advise_range(memmap2::Advice::HugePage, before(&map), large);
    }
    Some(map)
}

/// Bytes before a mapping's first whole page.
fn before(map: &MmapMut) -> usize {
    map.as_ptr().align_offset(PAGE).min(map.len())
}

fn whole<T: Pod>(map: &MmapMut) -> &[T] {
    let bytes = &map[before(map)..];
    bytemuck::cast_slice(&bytes[..bytes.len() / size_of::<T>() * size_of::<T>()])
}

fn whole_mut<T: Pod>(map: &mut MmapMut) -> &mut [T] {
    let first = before(map);
    let bytes = &mut map[first..];
    let len = bytes.len() / size_of::<T>() * size_of::<T>();
    bytemuck::cast_slice_mut(&mut bytes[..len])
}

impl<T: Pod> Deref for Table<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match &self.0 {
            Memory::Small(elements) => elements,
            Memory::Large(map, len) => &whole(map)[..*len],
        }
    }
}

impl<T: Pod> DerefMut for Table<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        match &mut self.0 {
            Memory::Small(elements) => elements,
            Memory::Large(map, len) => &mut whole_mut(map)[..*len],
        }
    }
}

/// Where it is, on whatever pages.
impl<T> From<Vec<T>> for Table<T> {
    fn from(elements: Vec<T>) -> Self {
        Self(Memory::Small(elements))
    }
}

impl<T> Default for Table<T> {
    fn default() -> Self {
        Self(Memory::Small(Vec::new()))
    }
}

impl<T: Pod> std::fmt::Debug for Table<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} elements", self.len())
    }
}

/// Large pages for those parts of memory, if it is large, that nobody has touched yet: zeros that are only
/// ever read then take no memory, and one page for many.
pub(crate) fn large_where_untouched<T>(memory: &[T]) {
    #[cfg(target_os = "linux")]
    if size_of_val(memory) >= WORTH_IT {
        advise(memory, libc::MADV_HUGEPAGE);
    }
    #[cfg(not(target_os = "linux"))]
    let _ = memory;
}

/// Puts memory that is written already onto large pages, if it is large. What it holds stays.
pub(crate) fn onto_large<T>(memory: &[T]) {
    large_where_untouched(memory);
    #[cfg(target_os = "linux")]
    if size_of_val(memory) >= WORTH_IT {
        // `MADV_COLLAPSE` of Linux 6.1: not all of libc's targets name it.
        const COLLAPSE: libc::c_int = 25;
        advise(memory, COLLAPSE);
    }
}

/// A hint about the whole pages of `memory`: where it cannot be followed, nothing changes. One of those that do
/// not change what memory holds, please.
#[cfg(target_os = "linux")]
fn advise<T>(memory: &[T], advice: libc::c_int) {
    let range = memory.as_ptr_range();
    let start = range.start.addr().next_multiple_of(SMALL);
    let end = range.end.addr() / SMALL * SMALL;
    if start < end {
        let start = range.start.with_addr(start);
        // SAFETY: the whole pages from `start` to `end` lie in `memory`, and this advice does not change what
        // they hold.
        unsafe {
            libc::madvise(start.cast_mut().cast(), end - start.addr(), advice);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table grown bit by bit holds what was put in, however often it moved.
    #[test]
    fn what_is_appended_stays() {
        let mut table = Table::<[u64; 8]>::default();
        let mut expected = Vec::new();
        for part in 0..40u64 {
            let more = (0..part * 300).map(|i| [part, i, 0, 0, 0, 0, 0, 1]);
            expected.extend(more.clone());
            table.extend(more.collect::<Vec<_>>().into_iter());
            assert_eq!(table.len(), expected.len());
        }
        assert!(matches!(table.0, Memory::Large(..)), "{table:?}");
        assert!(table[..] == expected[..]);
    }

    #[test]
    fn large_tables_are_zeros_and_begin_on_a_large_page() {
        for len in [0, 1, 99, PAGE / 64, 3 * PAGE / 64 + 1] {
            let mut table = Table::<[u64; 8]>::zeroed(len);
            assert_eq!(table.len(), len);
            assert!(table.iter().flatten().all(|&x| x == 0));
            table.fill([7; 8]);
            assert!(table.iter().flatten().all(|&x| x == 7));
            if len * 64 >= WORTH_IT {
                assert_eq!(table.as_ptr().align_offset(PAGE), 0);
            }
        }
    }
}
