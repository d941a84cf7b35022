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
    /// Adds another render, as if its workers had gone on with it: all that is counted or timed is
    /// summed up; timelines are those of the first.
    pub fn add(&mut self, other: Self) {
        if self.threads == 0 {
            *self = other;
            return;
        }
        self.seconds += other.seconds;
        self.cpu_seconds = self.cpu_seconds.zip(other.cpu_seconds).map(|(a, b)| a + b);
        self.worker_seconds += other.worker_seconds;
        self.samples += other.samples;
        self.camera_rays += other.camera_rays;
        self.bounce_rays += other.bounce_rays;
        self.shadow_rays += other.shadow_rays;
        self.mean_depth = self.bounce_rays as f64 / self.camera_rays.max(1) as f64;
        self.stopped |= other.stopped;
        for stage in other.stages {
            match self.stages.iter_mut().find(|s| s.name == stage.name) {
                Some(own) => own.add(&stage),
                None => self.stages.push(stage),
            }
        }
        for (all, more) in [
            (&mut self.dropped, other.dropped),
            (&mut self.untraceable, other.untraceable),
        ] {
            for loss in more {
                match all.iter_mut().find(|d| d.stage == loss.stage) {
                    Some(known) => known.count += loss.count,
                    None => all.push(loss),
                }
            }
        }
    }

    /// Adds a render that followed on the same film under the same control, which counts the samples
    /// of both.
    pub fn follow(&mut self, later: Self) {
        let (samples, threads) = (later.samples, later.threads.max(self.threads));
        self.add(later);
        self.samples = samples;
        self.threads = threads;
    }
}

impl StageStats {
    fn add(&mut self, other: &Self) {
        self.calls += other.calls;
        self.seconds += other.seconds;
        self.items_in += other.items_in;
        self.items_out += other.items_out;
        self.lanes_busy += other.lanes_busy;
        self.lanes_issued += other.lanes_issued;
        self.bytes_read += other.bytes_read;
        self.bytes_written += other.bytes_written;
        self.operations += other.operations;
        let sum = |a: Option<u64>, b: Option<u64>| a.zip(b).map(|(a, b)| a + b);
        self.nodes_visited = sum(self.nodes_visited, other.nodes_visited);
        self.triangles_visited = sum(self.triangles_visited, other.triangles_visited);
        let depth = self.bounces.len().max(other.bounces.len());
        self.bounces.resize(depth, BounceStats::default());
        for (a, b) in self.bounces.iter_mut().zip(&other.bounces) {
            a.items_in += b.items_in;
            a.items_out += b.items_out;
            a.lanes_busy += b.lanes_busy;
            a.seconds += b.seconds;
        }
        self.counted = match (self.counted, other.counted) {
            (Some(a), Some(b)) => Some(std::array::from_fn(|i| a[i] + b[i])),
            (a, b) => a.or(b),
        };
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
    /// Operations on `f32`, as the kernels declare them; those of traversal only where visits are
    /// counted.
    pub operations: u64,
    /// Nodes of the tree that rays were tested against, in builds that count it (feature `visits`).
    pub nodes_visited: Option<u64>,
    /// The same for triangles, unused places of blocks among them.
    pub triangles_visited: Option<u64>,
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
