//! Instruments that a render can carry besides its accounting: a timeline and counters.

use super::counters::{Counters, Reading};
use crate::processor::thread_cpu_seconds;
use serde::Serialize;
use std::time::Instant;

/// What is recorded besides the accounting. By default nothing, and then it costs nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Instruments {
    /// Most slices that a worker's timeline holds; later ones are counted and left out.
    pub slices: usize,
    /// Whether counters are read at the end of each call of a stage (see
    /// [`COUNTERS`](super::COUNTERS)).
    pub counters: bool,
    /// Whether stages are timed by the thread's processor time instead of the wall clock: for
    /// comparing times on a busy machine. A call of a stage then costs some 200 ns more.
    pub processor_time: bool,
    /// Whether the accounting is left out, to measure what it costs: the render then knows of no
    /// stages and no rays.
    pub unaccounted: bool,
}

/// One call of a stage.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Slice {
    /// The stage's name.
    pub stage: &'static str,
    /// Seconds from the start of the render to its start.
    pub start: f64,
    /// Seconds that it took.
    pub seconds: f64,
    /// Items in; out, where nothing goes in.
    pub items: u32,
}

/// What one worker did, call by call.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Timeline {
    /// Calls in order.
    pub slices: Vec<Slice>,
    /// Calls after the timeline was full.
    pub left_out: u64,
}

/// A worker's own instruments.
#[derive(Debug)]
pub(super) struct Recorder {
    epoch: Instant,
    room: usize,
    pub(super) timeline: Timeline,
    counters: Option<(Counters, Reading)>,
    /// Processor time at the end of the last call, if stages are timed by it.
    processor: Option<f64>,
}

impl Recorder {
    /// For the calling thread; `epoch` is the start of the render.
    pub(super) fn new(instruments: &Instruments, epoch: Instant) -> Self {
        Self {
            epoch,
            room: instruments.slices,
            timeline: Timeline::default(),
            processor: instruments
                .processor_time
                .then(thread_cpu_seconds)
                .flatten(),
            counters: instruments.counters.then(|| {
                let mut counters = Counters::open();
                let first = counters.read();
                (counters, first)
            }),
        }
    }

    /// Records a call from `start` to `end`.
    pub(super) fn record(&mut self, stage: &'static str, start: Instant, end: Instant, items: u32) {
        if self.timeline.slices.len() < self.room {
            self.timeline.slices.push(Slice {
                stage,
                start: (start - self.epoch).as_secs_f64(),
                seconds: (end - start).as_secs_f64(),
                items,
            });
        } else if self.room > 0 {
            self.timeline.left_out += 1;
        }
    }

    /// Processor seconds since the last call, if stages are timed by them.
    pub(super) fn processor_seconds(&mut self) -> Option<f64> {
        let last = self.processor.as_mut()?;
        let now = thread_cpu_seconds()?;
        let since = now - *last;
        *last = now;
        Some(since)
    }

    /// What was counted since the last call, if counters are read.
    pub(super) fn count(&mut self) -> Option<Reading> {
        let (counters, last) = self.counters.as_mut()?;
        let now = counters.read();
        let since = std::array::from_fn(|i| now[i] - last[i]);
        *last = now;
        Some(since)
    }
}
