//! The numbers of `huygens bench`: what `--save` writes. `docs/benchmarks.md` documents the layout.

use crate::cli::failure::Failure;
use crate::cli::system::peak_memory;
use huygens::throughput::measure::{Prepared, Run};
use huygens::throughput::suite::Standard;
use serde::{Deserialize, Serialize};

/// Version of the layout. It grows when a field changes its meaning or goes.
pub(super) const SCHEMA: u32 = 2;

/// One suite at one number of threads and of paths.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Report {
    pub(super) schema: u32,
    program: String,
    version: String,
    /// The machine's cores and architecture.
    cores: usize,
    architecture: String,
    /// As `--threads`: 0 is one for each core.
    pub(super) threads: u16,
    pub(super) wave: u32,
    pub(super) runs: u32,
    /// Geometric mean of the scenes' million samples a processor second.
    pub(super) score: f64,
    /// Of the whole process, in bytes.
    pub(super) peak_memory: Option<u64>,
    pub(super) scenes: Vec<SceneReport>,
}

/// One scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SceneReport {
    pub(super) name: String,
    width: u32,
    height: u32,
    spp: u32,
    max_depth: u32,
    pub(super) triangles: usize,
    pub(super) build_seconds: f64,
    pub(super) build_cpu_seconds: f64,
    /// Bytes at most while it was made and first rendered, beyond what was resident before.
    #[serde(default)]
    pub(super) peak_memory: Option<u64>,
    pub(super) runs: Vec<Run>,
}

impl Report {
    pub(super) fn new(threads: u16, wave: u32, runs: u32) -> Self {
        Self {
            schema: SCHEMA,
            program: "huygens".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            architecture: std::env::consts::ARCH.to_owned(),
            threads,
            wave,
            runs,
            score: 0.0,
            peak_memory: None,
            scenes: Vec::new(),
        }
    }

    /// Adds up what is known once all runs are there. `peak_memory` may know of more than the system now
    /// does, since scenes let its peak begin anew.
    pub(super) fn finish(&mut self) {
        let logs = self.scenes.iter().map(|s| (s.rate() * 1e-6).ln());
        self.score = (logs.sum::<f64>() / self.scenes.len().max(1) as f64).exp();
        self.peak_memory = self.peak_memory.max(peak_memory());
        self.runs = self.scenes.first().map_or(0, |s| s.runs.len() as u32);
    }

    /// Adds the runs of another report of the same suite.
    pub(super) fn append(&mut self, other: Self) -> Result<(), Failure> {
        self.ensure_comparable(&other)?;
        for (own, other) in self.scenes.iter_mut().zip(other.scenes) {
            own.runs.extend(other.runs);
        }
        Ok(())
    }

    /// Refuses what was measured otherwise.
    pub(super) fn ensure_comparable(&self, other: &Self) -> Result<(), Failure> {
        let work = |r: &Self| (r.threads, r.wave);
        if work(self) != work(other) {
            return Err(Failure::input(format!(
                "the numbers to compare with are for --threads {} --wave {}, these for --threads {} \
                 --wave {}",
                self.threads, self.wave, other.threads, other.wave
            )));
        }
        let shape = |s: &SceneReport| (s.width, s.height, s.spp, s.max_depth, s.triangles);
        for own in &self.scenes {
            let same = other.scenes.iter().find(|s| s.name == own.name);
            if same.is_some_and(|s| shape(s) != shape(own)) {
                return Err(Failure::input(format!(
                    "the scene `{}` of the numbers to compare with is another one",
                    own.name
                )));
            }
        }
        Ok(())
    }
}

impl SceneReport {
    pub(super) fn new(standard: &Standard, prepared: &Prepared) -> Self {
        Self {
            name: standard.name.to_owned(),
            width: standard.size[0],
            height: standard.size[1],
            spp: standard.spp,
            max_depth: standard.max_depth,
            triangles: prepared.triangles(),
            build_seconds: prepared.build_seconds,
            build_cpu_seconds: prepared.build_cpu_seconds,
            peak_memory: prepared.peak_memory(),
            runs: Vec::new(),
        }
    }

    /// Median over the runs.
    pub(super) fn median(&self, of: impl Fn(&Run) -> f64) -> f64 {
        let mut values: Vec<f64> = self.runs.iter().map(of).collect();
        values.sort_unstable_by(f64::total_cmp);
        match values.len() {
            0 => 0.0,
            n if n % 2 == 1 => values[n / 2],
            n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
        }
    }

    /// Samples a processor second, median over the runs.
    pub(super) fn rate(&self) -> f64 {
        self.median(|r| r.samples as f64 / r.cpu_seconds)
    }

    /// Share of the run that its workers had something to do, median over the runs: what is missing went
    /// to setting up and to waiting for the last job.
    pub(super) fn at_work(&self) -> f64 {
        self.median(|r| r.worker_seconds / (r.workers.max(1) as f64 * r.seconds))
    }

    /// Least and greatest over the median, of the same.
    pub(super) fn spread(&self) -> [f64; 2] {
        let rates = self.runs.iter().map(|r| r.samples as f64 / r.cpu_seconds);
        let ends = rates.fold([f64::INFINITY, 0.0], |[lo, hi], r| {
            [lo.min(r), f64::max(hi, r)]
        });
        ends.map(|r| r / self.rate())
    }
}
