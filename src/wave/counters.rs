//! Hardware and kernel counters of a thread, where the system lets them be read.
//!
//! Linux' perf events, one file descriptor a counter, so that one which this machine does not have
//! (virtual ones often have none of the processor's) leaves the others alone. Where there are more
//! counters than the processor has registers for, the system shares these out in time and counts are
//! scaled up by the share.

/// Names of the counters, in the order of all tables of them.
pub const COUNTERS: [&str; 8] = [
    "cycles",
    "instructions",
    "branch_misses",
    "l1d_misses",
    "llc_misses",
    "dtlb_misses",
    "page_faults",
    "context_switches",
];

/// One reading of all counters, by their place in [`COUNTERS`]; 0 where there is none.
pub(crate) type Reading = [f64; COUNTERS.len()];

pub(crate) use system::Counters;

/// Which counters this thread may read: for each of [`COUNTERS`], nothing or why not.
pub fn available() -> [Result<(), String>; COUNTERS.len()] {
    system::available()
}

#[cfg(target_os = "linux")]
mod system {
    use super::{COUNTERS, Reading};
    use perf_event::events::{Cache, CacheId, CacheOp, CacheResult, Hardware, Software};
    use perf_event::{Builder, Counter};
    use std::io;

    /// The counters of the thread that opened them.
    #[derive(Debug)]
    pub(crate) struct Counters {
        open: Vec<(usize, Counter)>,
    }

    fn open(index: usize) -> io::Result<Counter> {
        let miss = |which| Cache {
            which,
            operation: CacheOp::READ,
            result: CacheResult::MISS,
        };
        let mut builder = match COUNTERS[index] {
            "cycles" => Builder::new(Hardware::CPU_CYCLES),
            "instructions" => Builder::new(Hardware::INSTRUCTIONS),
            "branch_misses" => Builder::new(Hardware::BRANCH_MISSES),
            "l1d_misses" => Builder::new(miss(CacheId::L1D)),
            "llc_misses" => Builder::new(miss(CacheId::LL)),
            "dtlb_misses" => Builder::new(miss(CacheId::DTLB)),
            "page_faults" => Builder::new(Software::PAGE_FAULTS),
            _ => Builder::new(Software::CONTEXT_SWITCHES),
        };
        if COUNTERS[index] == "context_switches" {
            // They happen in the kernel.
            builder.include_kernel();
        }
        let mut counter = builder.build()?;
        counter.enable()?;
        Ok(counter)
    }

    impl Counters {
        /// Opens what can be opened, for the calling thread.
        pub(crate) fn open() -> Self {
            let all = 0..COUNTERS.len();
            let open = all.filter_map(|i| Some((i, open(i).ok()?)));
            Self {
                open: open.collect(),
            }
        }

        /// What they have counted so far.
        pub(crate) fn read(&mut self) -> Reading {
            let mut reading = Reading::default();
            for (index, counter) in &mut self.open {
                if let Ok(read) = counter.read_count_and_time()
                    && read.time_running > 0
                {
                    let share = read.time_enabled as f64 / read.time_running as f64;
                    reading[*index] = read.count as f64 * share;
                }
            }
            reading
        }
    }

    pub(super) fn available() -> [Result<(), String>; COUNTERS.len()] {
        std::array::from_fn(|i| open(i).map(drop).map_err(|e| e.to_string()))
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use super::{COUNTERS, Reading};

    /// The counters of a thread: none on this system.
    #[derive(Debug)]
    pub(crate) struct Counters;

    impl Counters {
        pub(crate) fn open() -> Self {
            Self
        }

        pub(crate) fn read(&mut self) -> Reading {
            Reading::default()
        }
    }

    pub(super) fn available() -> [Result<(), String>; COUNTERS.len()] {
        std::array::from_fn(|_| Err("perf events are a part of Linux".to_owned()))
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// Software counters need no hardware, so wherever the system lets them be read at all they must
    /// count what happens.
    #[test]
    fn page_faults_are_counted_where_they_can_be() {
        let faults = COUNTERS.iter().position(|&c| c == "page_faults").unwrap();
        if let Err(why) = &available()[faults] {
            eprintln!("SKIPPED: no perf events here: {why}");
            return;
        }
        let mut counters = Counters::open();
        let before = counters.read()[faults];
        // More than allocators keep back for reuse, so these pages are new; even where all of them are
        // huge, 64 MiB are 32.
        let pages = vec![1u8; 1 << 26];
        assert!(pages.iter().all(|&b| b == 1));
        assert!(counters.read()[faults] >= before + 8.0);
    }
}
