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

impl RenderStats {
    /// Adds a render that followed, of the same scene with the same stages under the same control.
    pub fn merge(&mut self, later: Self) {
        self.seconds += later.seconds;
        let cpu = self.cpu_seconds.zip(later.cpu_seconds).map(|(a, b)| a + b);
        self.cpu_seconds = if self.threads == 0 {
            later.cpu_seconds
        } else {
            cpu
        };
        self.worker_seconds += later.worker_seconds;
        self.threads = self.threads.max(later.threads);
        // The control counts on.
        self.samples = later.samples;
        self.camera_rays += later.camera_rays;
        self.bounce_rays += later.bounce_rays;
        self.shadow_rays += later.shadow_rays;
        self.mean_depth = self.bounce_rays as f64 / self.camera_rays.max(1) as f64;
        self.stopped |= later.stopped;
        for stage in later.stages {
            match self.stages.iter_mut().find(|s| s.name == stage.name) {
                Some(known) => known.merge(&stage),
                None => self.stages.push(stage),
            }
        }
        for (all, more) in [
            (&mut self.dropped, later.dropped),
            (&mut self.untraceable, later.untraceable),
        ] {
            for loss in more {
                match all.iter_mut().find(|d| d.stage == loss.stage) {
                    Some(known) => known.count += loss.count,
                    None => all.push(loss),
                }
            }
        }
    }
}

impl StageStats {
    fn merge(&mut self, later: &Self) {
        self.calls += later.calls;
        self.seconds += later.seconds;
        self.items_in += later.items_in;
        self.items_out += later.items_out;
        self.lanes_busy += later.lanes_busy;
        self.lanes_issued += later.lanes_issued;
        self.bytes_read += later.bytes_read;
        self.bytes_written += later.bytes_written;
        let depth = self.bounces.len().max(later.bounces.len());
        self.bounces.resize(depth, BounceStats::default());
        for (a, b) in self.bounces.iter_mut().zip(&later.bounces) {
            a.items_in += b.items_in;
            a.items_out += b.items_out;
            a.lanes_busy += b.lanes_busy;
            a.seconds += b.seconds;
        }
    }
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
