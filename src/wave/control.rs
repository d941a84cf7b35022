//! How the outside watches and stops a render.

use std::sync::atomic::{AtomicBool, AtomicU64};

/// Shared between a render and whoever watches it. Updated once a job, not in the loop.
#[derive(Debug, Default)]
pub struct Control {
    /// Raise it and every worker stops within a few stages.
    pub stop: AtomicBool,
    /// Camera samples finished so far.
    pub samples: AtomicU64,
    /// Rays traced so far, of all kinds.
    pub rays: AtomicU64,
}
