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

/// What some work took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lap {
    /// Seconds on the wall.
    pub(crate) wall: f64,
    /// CPU seconds of all the process's threads.
    pub(crate) process: f64,
    /// CPU seconds of everything else on this machine. The system counts in hundredths, so that one
    /// lap says little and may say less than nothing; sums of many do not drift.
    pub(crate) others: f64,
}

/// What `work` takes, and its result.
pub(crate) fn lap<T>(work: impl FnOnce() -> T) -> (Lap, T) {
    let (machine, process) = (machine_seconds(), read(libc::CLOCK_PROCESS_CPUTIME_ID));
    let wall = Instant::now();
    let result = work();
    let wall = wall.elapsed().as_secs_f64();
    let process = read(libc::CLOCK_PROCESS_CPUTIME_ID) - process;
    let lap = Lap {
        wall,
        process,
        others: machine_seconds() - machine - process,
    };
    (lap, result)
}

/// CPU seconds that all processors of this machine have spent on anything; 0 where it does not say.
fn machine_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/stat").unwrap_or_default();
    let line = stat.lines().next().unwrap_or_default();
    let ticks: Vec<f64> = line.split(' ').filter_map(|t| t.parse().ok()).collect();
    // user, nice, system; then idle and waiting; then interrupts, and what a hypervisor took.
    let busy = |range: std::ops::Range<usize>| -> f64 {
        ticks.get(range).map_or(0.0, |ticks| ticks.iter().sum())
    };
    0.01 * (busy(0..3) + busy(5..8))
}
