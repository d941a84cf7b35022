//! Large pages for large tables.

/// Smallest table for which large pages are asked: below, the translation look-aside buffers hold
/// all of it anyway.
const WORTH_IT: usize = 8 << 20;

/// An empty table for `len` elements, where the system grants it on pages of 2 MiB. A ray that jumps
/// through hundreds of megabytes then finds the address of nearly every node without walking the
/// page table.
pub(super) fn table<T: Copy>(len: usize) -> Vec<T> {
    let mut table = Vec::with_capacity(len);
    if len * size_of::<T>() >= WORTH_IT {
        // Before the first write: pages are made when they are touched.
        ask_for_large(table.spare_capacity_mut());
    }
    table
}

/// A hint: where it cannot be followed, nothing changes.
fn ask_for_large<T>(memory: &mut [std::mem::MaybeUninit<T>]) {
    #[cfg(target_os = "linux")]
    {
        const PAGE: usize = 4096;
        let range = memory.as_mut_ptr_range();
        let start = (range.start as usize).next_multiple_of(PAGE);
        let end = range.end as usize / PAGE * PAGE;
        if start < end {
            let skipped = start - range.start as usize;
            let start = range.start.wrapping_byte_add(skipped);
            // SAFETY: the whole pages from `start` to `end` lie in `memory`, which is borrowed
            // mutably and holds nothing yet; this advice does not change what memory contains.
            unsafe {
                libc::madvise(start.cast(), end - start as usize, libc::MADV_HUGEPAGE);
            }
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = memory;
}
