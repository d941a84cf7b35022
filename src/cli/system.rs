//! What the operating system knows about this process.

/// The most memory this process has had resident so far, in bytes, where the system tells.
pub(crate) fn peak_memory() -> Option<u64> {
    #[cfg(unix)]
    {
        let mut usage = std::mem::MaybeUninit::<libc::rusage>::zeroed();
        // SAFETY: `usage` is valid for writes of a `rusage`, which is all that getrusage writes;
        // a `rusage` is plain numbers, for which zero is a valid value in any case.
        let usage = unsafe {
            (libc::getrusage(libc::RUSAGE_SELF, usage.as_mut_ptr()) == 0)
                .then(|| usage.assume_init())
        }?;
        // Kilobytes everywhere but on Apple's systems.
        let unit = if cfg!(target_vendor = "apple") {
            1
        } else {
            1024
        };
        u64::try_from(usage.ru_maxrss).ok().map(|n| n * unit)
    }
    #[cfg(not(unix))]
    None
}

/// Whether `bytes` of memory could be had at all. Most systems hand out address space without
/// looking at what is in use, but refuse outright what they could never fill.
pub(crate) fn could_allocate(bytes: u64) -> bool {
    let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
    Vec::<u8>::new().try_reserve_exact(bytes).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn peak_memory_grows_with_what_is_touched() {
        let before = peak_memory().expect("unix tells");
        let block = vec![1u8; 64 << 20];
        assert!(block.iter().map(|&b| u64::from(b)).sum::<u64>() == 64 << 20);
        let after = peak_memory().expect("unix tells");
        assert!(after >= 64 << 20 && after >= before, "{before} to {after}");
    }

    #[test]
    fn no_machine_has_an_exabyte() {
        assert!(could_allocate(1 << 20));
        assert!(!could_allocate(1 << 60));
    }
}
