//! Large pages for large tables.

use bytemuck::Zeroable;

/// Smallest table for which large pages are asked: below, the translation look-aside buffers hold
/// all of it anyway.
const WORTH_IT: usize = 8 << 20;

/// A table of `len` elements of zeros, where the system grants it on pages of 2 MiB. A ray that jumps
/// through hundreds of megabytes then finds the address of nearly every node without walking the
/// page table, and a build asks the system for memory a thousandth as often.
pub(super) fn zeroed<T: Zeroable>(len: usize) -> Vec<T> {
    // Large allocations come from the system as zeros that nobody has touched yet, and pages are made
    // when they are touched.
    let mut table = bytemuck::zeroed_vec(len);
    if len * size_of::<T>() >= WORTH_IT {
        ask_for_large(&mut table);
    }
    table
}

/// A hint: where it cannot be followed, nothing changes.
fn ask_for_large<T>(memory: &mut [T]) {
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
            // mutably; this advice does not change what memory contains.
            unsafe {
                libc::madvise(start.cast(), end - start as usize, libc::MADV_HUGEPAGE);
            }
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = memory;
}
