//! What a render reports of itself.

use super::counters::COUNTERS;
use super::instruments::Timeline;
use serde::Serialize;

/// What a render did.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RenderStats {
    /// Wall-clock seconds in [`crate::wave::render`].
    pub seconds: f64,
    /// Processor seconds of this process in the meantime, where the system tells.
    pub cpu_seconds: Option<f64>,
    /// Seconds that the workers had, all added up. The stages' seconds are what it went to.
    pub worker_seconds: f64,
    /// Worker threads used.
    pub threads: usize,
    /// Camera samples finished.
    pub samples: u64,
    /// Camera rays traced.
    pub camera_rays: u64,
    /// Rays traced after a scattering event.
    pub bounce_rays: u64,
    /// Occlusion rays traced.
    pub shadow_rays: u64,
    /// Mean number of closest-hit rays on a path, minus 1.
    pub mean_depth: f64,
    /// Whether it was stopped before its last sample.
    pub stopped: bool,
    /// Stages in the order of the loop.
    pub stages: Vec<StageStats>,
    /// Contributions or samples left out because they were not finite, by stage.
    pub dropped: Vec<Dropped>,
    /// Rays that could not be traced, and what they carried with them, by stage: a component of
    /// theirs was not finite, or they had no direction.
    pub untraceable: Vec<Dropped>,
    /// What each worker did, call by call, where that was asked for.
    #[serde(skip)]
    pub timelines: Vec<Timeline>,
}

/// One stage over the whole render, all workers added up.
#[derive(Clone, Debug, Default, Serialize)]
pub struct StageStats {
    /// Stage name.
    pub name: &'static str,
    /// Times it ran.
    pub calls: u64,
    /// Seconds of worker time.
    pub seconds: f64,
    /// Items read.
    pub items_in: u64,
    /// Items appended to the queues behind it.
    pub items_out: u64,
    /// Lanes that held an item.
    pub lanes_busy: u64,
    /// Lanes processed, busy or not.
    pub lanes_issued: u64,
    /// Bytes read from queues and tables, as the kernels declare them; trees are not in it.
    pub bytes_read: u64,
    /// Bytes written to queues and samples, as the kernels declare them.
    pub bytes_written: u64,
    /// The same by bounce: element `b` is for paths that have scattered `b` times; the last one
    /// also holds all deeper ones.
    pub bounces: Vec<BounceStats>,
    /// Counts by [`COUNTERS`](super::COUNTERS), where that was asked for.
    #[serde(skip)]
    pub counted: Option<[f64; COUNTERS.len()]>,
}

/// A stage's share that belongs to one bounce. Calls that hold several bounces are apportioned by
/// items.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BounceStats {
    /// Items read.
    pub items_in: u64,
    /// Items appended to the queues behind it.
    pub items_out: u64,
    /// Lanes that held an item.
    pub lanes_busy: u64,
    /// Seconds of worker time, apportioned by items.
    pub seconds: f64,
}

/// A value that was not finite and was left out, or a ray that could not be traced.
#[derive(Clone, Debug, Serialize)]
pub struct Dropped {
    /// The stage that met it.
    pub stage: &'static str,
    /// How many in all.
    pub count: u64,
    /// The first few, as (x, y, sample).
    pub examples: Vec<(u32, u32, u32)>,
}
