//! How the outside watches and stops a render.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// Shared between a render and whoever watches it. Updated once a job, not in the loop.
#[derive(Debug, Default)]
pub struct Control {
    /// Raise it and every worker stops within a few stages.
    pub stop: AtomicBool,
    /// Camera samples finished so far.
    pub samples: AtomicU64,
    /// Rays traced so far, of all kinds.
    pub rays: AtomicU64,
    /// When to stop, if ever. Looked at before each job.
    pub deadline: OnceLock<Instant>,
}

impl Control {
    /// Whether to stop: raises `stop` if the deadline is over.
    pub fn stops(&self) -> bool {
        if self.deadline.get().is_some_and(|d| Instant::now() >= *d) {
            self.stop.store(true, Ordering::Relaxed);
        }
        self.stop.load(Ordering::Relaxed)
    }

    /// Counts from nothing again, for the next of several renders under one control.
    pub fn restart(&self) {
        self.samples.store(0, Ordering::Relaxed);
        self.rays.store(0, Ordering::Relaxed);
    }
}
