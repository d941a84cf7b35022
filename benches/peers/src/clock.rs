//! Clocks. On a shared machine wall time misleads: rays are timed by what the thread was given.

use std::time::Instant;

fn read(clock: libc::clockid_t) -> f64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: `time` is a valid place for one `timespec`, which is all that the call writes.
    let failed = unsafe { libc::clock_gettime(clock, &raw mut time) };
    assert_eq!(failed, 0, "every Linux has CPU clocks");
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// CPU seconds of this thread while `work` ran.
pub(crate) fn thread_seconds(work: impl FnOnce()) -> f64 {
    let start = read(libc::CLOCK_THREAD_CPUTIME_ID);
    work();
    read(libc::CLOCK_THREAD_CPUTIME_ID) - start
}

/// Seconds on the wall, and of all the process's threads, while `work` ran; and its result.
pub(crate) fn wall_and_process<T>(work: impl FnOnce() -> T) -> (f64, f64, T) {
    let (wall, process) = (Instant::now(), read(libc::CLOCK_PROCESS_CPUTIME_ID));
    let result = work();
    let process = read(libc::CLOCK_PROCESS_CPUTIME_ID) - process;
    (wall.elapsed().as_secs_f64(), process, result)
}
