//! Processor time, the measure of cost that other work on the machine hardly moves.

/// Seconds that all threads of this process have had a processor so far, its own and the system's on
/// its behalf, where the system tells.
#[must_use]
pub fn cpu_seconds() -> Option<f64> {
    #[cfg(unix)]
    {
        let mut time = std::mem::MaybeUninit::<libc::timespec>::zeroed();
        // SAFETY: `time` is valid for writes of a `timespec`, which is all that clock_gettime
        // writes; a `timespec` is plain numbers, for which zero is a valid value in any case.
        let time = unsafe {
            (libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, time.as_mut_ptr()) == 0)
                .then(|| time.assume_init())
        }?;
        Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
    }
    #[cfg(not(unix))]
    None
}
