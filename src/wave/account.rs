//! The accounting of a render: always on, a few additions a stage call.
//!
//! Time is a chain of laps: a call of a stage lasts from the end of the call before it to its own
//! end. So what lies between two stages (counting items, fetching a job) belongs to the later one,
//! and the laps of a worker add up to its time.

use super::counters::Reading;
use super::instruments::{Instruments, Recorder, Timeline};
use super::stats::{BounceStats, Dropped, StageStats};
use super::tally::{ROWS, Tally};
use crate::effects::Shader;
use huygens_kernels::cost::Cost;
use huygens_kernels::lanes::padded;
use huygens_kernels::visits::{self, NODE_OPERATIONS, TRIANGLE_OPERATIONS, Visits};
use std::time::Instant;

/// The stages, in the order of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Generate,
    Shutter,
    Intersect,
    Travel,
    Sort,
    Sky,
    Emission,
    Branch,
    Disperse,
    Interact,
    Texture,
    Align,
    Light,
    Scatter(Shader),
    Vary,
    Occlude,
    Roulette,
    Film,
}

impl Stage {
    const COUNT: usize = 17 + Shader::ALL.len();

    /// All stages.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let before = [
            Self::Generate,
            Self::Shutter,
            Self::Intersect,
            Self::Travel,
            Self::Sort,
            Self::Sky,
            Self::Emission,
            Self::Branch,
            Self::Disperse,
            Self::Interact,
            Self::Texture,
            Self::Align,
            Self::Light,
        ];
        let shaders = Shader::ALL.into_iter().map(Self::Scatter);
        before.into_iter().chain(shaders).chain([
            Self::Vary,
            Self::Occlude,
            Self::Roulette,
            Self::Film,
        ])
    }

    /// Its place among [`Stage::all`].
    fn index(self) -> usize {
        match self {
            Self::Generate => 0,
            Self::Shutter => 1,
            Self::Intersect => 2,
            Self::Travel => 3,
            Self::Sort => 4,
            Self::Sky => 5,
            Self::Emission => 6,
            Self::Branch => 7,
            Self::Disperse => 8,
            Self::Interact => 9,
            Self::Texture => 10,
            Self::Align => 11,
            Self::Light => 12,
            Self::Scatter(shader) => 13 + shader as usize,
            Self::Vary => Self::COUNT - 4,
            Self::Occlude => Self::COUNT - 3,
            Self::Roulette => Self::COUNT - 2,
            Self::Film => Self::COUNT - 1,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Generate => "generate",
            Self::Shutter => "shutter",
            Self::Intersect => "intersect",
            Self::Travel => "travel",
            Self::Sort => "sort",
            Self::Sky => "shade: sky",
            Self::Emission => "shade: emission",
            Self::Branch => "branch",
            Self::Disperse => "disperse",
            Self::Interact => "interact",
            Self::Texture => "texture",
            Self::Align => "align",
            Self::Light => "sample lights",
            Self::Scatter(shader) => shader.stage(),
            Self::Vary => "texture lights",
            Self::Occlude => "occlude",
            Self::Roulette => "roulette",
            Self::Film => "film",
        }
    }
}

#[derive(Clone, Debug, Default)]
struct Entry {
    calls: u64,
    seconds: f64,
    lanes_issued: u64,
    cost: Cost,
    visits: Visits,
    counted: Option<Reading>,
    rows: Rows,
}

#[derive(Clone, Debug)]
struct Rows([BounceStats; ROWS]);

impl Default for Rows {
    fn default() -> Self {
        Self([BounceStats::default(); ROWS])
    }
}

/// One worker's accounting.
#[derive(Debug)]
pub(crate) struct Account {
    entries: Vec<Entry>,
    dropped: Vec<Dropped>,
    untraceable: Vec<Dropped>,
    lap: Instant,
    recorder: Recorder,
    /// Whether anything is booked.
    counts: bool,
}

impl Account {
    /// For the calling thread, in a render that began at `epoch`. The first lap begins now.
    pub(crate) fn new(instruments: &Instruments, epoch: Instant) -> Self {
        Self {
            entries: vec![Entry::default(); Stage::COUNT],
            dropped: Vec::new(),
            untraceable: Vec::new(),
            lap: Instant::now(),
            recorder: Recorder::new(instruments, epoch),
            counts: !instruments.unaccounted,
        }
    }

    /// Whether calls are booked, and items are to be counted for that.
    pub(crate) fn counts(&self) -> bool {
        self.counts
    }

    /// The tally of a queue's `bounces` column: of nothing, where nothing is booked.
    pub(crate) fn tally(&self, bounces: &[u32]) -> Tally {
        if self.counts {
            Tally::of(bounces, 0)
        } else {
            Tally::default()
        }
    }

    /// Books one call of `stage`, which ends now and began where the last one ended. Time goes to
    /// the bounces by items in (by items out where nothing comes in).
    pub(crate) fn book(&mut self, stage: Stage, items_in: &Tally, items_out: &Tally, cost: Cost) {
        if !self.counts {
            return;
        }
        let end = Instant::now();
        let start = std::mem::replace(&mut self.lap, end);
        let wall = (end - start).as_secs_f64();
        let seconds = self.recorder.processor_seconds().unwrap_or(wall);
        let entry = &mut self.entries[stage.index()];
        let by = if items_in.total > 0 {
            items_in
        } else {
            items_out
        };
        entry.calls += 1;
        entry.seconds += seconds;
        entry.lanes_issued += padded(by.total()) as u64;
        let visits = visits::take();
        let walked = visits.nodes * NODE_OPERATIONS + visits.triangles * TRIANGLE_OPERATIONS;
        entry.cost = entry.cost + cost.operations(cost.operations + walked);
        entry.visits.nodes += visits.nodes;
        entry.visits.triangles += visits.triangles;
        let each = seconds / f64::from(by.total.max(1));
        for row in 0..items_in.depth.max(items_out.depth) {
            let r = &mut entry.rows.0[row];
            r.items_in += u64::from(items_in.rows[row]);
            r.items_out += u64::from(items_out.rows[row]);
            r.lanes_busy += u64::from(by.rows[row]);
            r.seconds += each * f64::from(by.rows[row]);
        }
        self.recorder.record(stage.name(), start, end, by.total);
        if let Some(counted) = self.recorder.count() {
            add_counted(&mut entry.counted, counted);
        }
    }

    /// The calls that its instruments recorded.
    pub(crate) fn take_timeline(&mut self) -> Timeline {
        std::mem::take(&mut self.recorder.timeline)
    }

    /// Books a value that was not finite.
    pub(crate) fn drop_sample(&mut self, stage: &'static str, at: (u32, u32, u32)) {
        book_drop(&mut self.dropped, stage, 1, &[at]);
    }

    /// Books a ray that could not be traced.
    pub(crate) fn lose_ray(&mut self, stage: &'static str, at: (u32, u32, u32)) {
        book_drop(&mut self.untraceable, stage, 1, &[at]);
    }

    /// Adds another worker's accounting.
    pub(crate) fn merge(&mut self, other: &Self) {
        for (a, b) in self.entries.iter_mut().zip(&other.entries) {
            a.calls += b.calls;
            a.seconds += b.seconds;
            a.lanes_issued += b.lanes_issued;
            a.cost = a.cost + b.cost;
            a.visits.nodes += b.visits.nodes;
            a.visits.triangles += b.visits.triangles;
            if let Some(counted) = b.counted {
                add_counted(&mut a.counted, counted);
            }
            for (a, b) in a.rows.0.iter_mut().zip(&b.rows.0) {
                a.items_in += b.items_in;
                a.items_out += b.items_out;
                a.lanes_busy += b.lanes_busy;
                a.seconds += b.seconds;
            }
        }
        for d in &other.dropped {
            book_drop(&mut self.dropped, d.stage, d.count, &d.examples);
        }
        for d in &other.untraceable {
            book_drop(&mut self.untraceable, d.stage, d.count, &d.examples);
        }
    }

    /// Closest-hit rays by bounce 0 and later, and occlusion rays.
    pub(crate) fn rays(&self) -> (u64, u64, u64) {
        let rows = |s: Stage| &self.entries[s.index()].rows.0;
        let after: u64 = rows(Stage::Intersect)[1..].iter().map(|r| r.items_in).sum();
        let shadow = rows(Stage::Occlude).iter().map(|r| r.items_in).sum();
        (rows(Stage::Intersect)[0].items_in, after, shadow)
    }

    /// Values that were dropped, and rays that could not be traced.
    pub(crate) fn losses(&self) -> [Vec<Dropped>; 2] {
        [self.dropped.clone(), self.untraceable.clone()]
    }

    /// Stages that ran.
    pub(crate) fn report(&self) -> Vec<StageStats> {
        let stages = Stage::all().zip(&self.entries).filter(|(_, e)| e.calls > 0);
        let stages = stages.map(|(stage, e)| {
            let depth = e.rows.0.iter().rposition(|r| *r != BounceStats::default());
            let sum = |f: fn(&BounceStats) -> u64| e.rows.0.iter().map(f).sum();
            StageStats {
                name: stage.name(),
                calls: e.calls,
                seconds: e.seconds,
                items_in: sum(|r| r.items_in),
                items_out: sum(|r| r.items_out),
                lanes_busy: sum(|r| r.lanes_busy),
                lanes_issued: e.lanes_issued,
                bytes_read: e.cost.read,
                bytes_written: e.cost.written,
                operations: e.cost.operations,
                nodes_visited: visits::COUNTED.then_some(e.visits.nodes),
                triangles_visited: visits::COUNTED.then_some(e.visits.triangles),
                bounces: e.rows.0[..depth.map_or(0, |d| d + 1)].to_vec(),
                counted: e.counted,
            }
        });
        stages.collect()
    }
}

fn add_counted(sum: &mut Option<Reading>, counted: Reading) {
    let sum = sum.get_or_insert_default();
    for (sum, counted) in sum.iter_mut().zip(counted) {
        *sum += counted;
    }
}

/// Examples kept for each stage.
const EXAMPLES: usize = 8;

fn book_drop(
    dropped: &mut Vec<Dropped>,
    stage: &'static str,
    count: u64,
    examples: &[(u32, u32, u32)],
) {
    let i = dropped
        .iter()
        .position(|d| d.stage == stage)
        .unwrap_or_else(|| {
            dropped.push(Dropped {
                stage,
                count: 0,
                examples: Vec::new(),
            });
            dropped.len() - 1
        });
    dropped[i].count += count;
    let room = EXAMPLES - dropped[i].examples.len();
    dropped[i].examples.extend(examples.iter().take(room));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_has_its_place() {
        let places: Vec<usize> = Stage::all().map(Stage::index).collect();
        assert_eq!(places, (0..Stage::COUNT).collect::<Vec<_>>());
    }

    #[test]
    fn apportioned_seconds_add_up() {
        let mut account = Account::new(&Instruments::default(), Instant::now());
        let tally = Tally::of(&[2, 2, 1, 0, 0, 0, 0], 0);
        account.book(Stage::Intersect, &tally, &tally, Cost::new(3, 4) * 7);
        let stages = account.report();
        assert_eq!((stages[0].bytes_read, stages[0].bytes_written), (21, 28));
        let parts: f64 = stages[0].bounces.iter().map(|b| b.seconds).sum();
        // Three additions and products of numbers of one sign.
        assert!((parts - stages[0].seconds).abs() <= 8.0 * f64::EPSILON * stages[0].seconds);
        assert_eq!(
            stages[0]
                .bounces
                .iter()
                .map(|b| b.items_in)
                .collect::<Vec<_>>(),
            [4, 1, 2]
        );
    }
}
