//! Processor time, the measure of cost that other work on the machine hardly moves.

/// Seconds that all threads of this process have had a processor so far, its own and the system's on
/// its behalf, where the system tells.
#[must_use]
pub fn cpu_seconds() -> Option<f64> {
    #[cfg(unix)]
    return clock(libc::CLOCK_PROCESS_CPUTIME_ID);
    #[cfg(not(unix))]
    None
}

/// The same for the calling thread.
#[must_use]
pub fn thread_cpu_seconds() -> Option<f64> {
    #[cfg(unix)]
    return clock(libc::CLOCK_THREAD_CPUTIME_ID);
    #[cfg(not(unix))]
    None
}

#[cfg(unix)]
fn clock(id: libc::clockid_t) -> Option<f64> {
    let mut time = std::mem::MaybeUninit::<libc::timespec>::zeroed();
    // SAFETY: `time` is valid for writes of a `timespec`, which is all that clock_gettime writes; a
    // `timespec` is plain numbers, for which zero is a valid value in any case.
    let time =
        unsafe { (libc::clock_gettime(id, time.as_mut_ptr()) == 0).then(|| time.assume_init()) }?;
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_thread_has_no_more_time_than_its_process() {
        let before = [cpu_seconds(), thread_cpu_seconds()].map(|t| t.expect("unix tells"));
        let work: u64 = (0..3_000_000u64).map(|i| std::hint::black_box(i) ^ 5).sum();
        let after = [cpu_seconds(), thread_cpu_seconds()].map(|t| t.expect("unix tells"));
        assert!(work > 0 && after[1] > before[1]);
        assert!(after[0] >= after[1]);
    }
}
