//! Where the time of a render goes, kernel by kernel, beside what the machine could do.
//!
//! [`Row`] is made of a render's accounting ([`crate::wave::RenderStats`]); [`limits`] measures the
//! machine; [`roofline`] sets one against the other; [`trace`] writes timelines that trace viewers
//! open.

pub mod limits;
pub mod roofline;
pub mod trace;

use crate::wave::{COUNTERS, RenderStats, StageStats};
use serde::Serialize;
use std::collections::BTreeMap;

/// One kernel over a render. Rates are those of one worker: items over the worker's time in the
/// kernel.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The stage's name.
    pub name: &'static str,
    /// Seconds of worker time.
    pub seconds: f64,
    /// Its share of all stages' time, 0 to 1.
    pub share: f64,
    /// Calls.
    pub calls: u64,
    /// Items in; out, for a stage that nothing goes into.
    pub items: u64,
    /// Nanoseconds an item.
    pub nanoseconds: f64,
    /// Items a second.
    pub per_second: f64,
    /// Share of the SIMD lanes processed that held an item, 0 to 1.
    pub occupancy: f64,
    /// Bytes an item, read and written, as declared.
    pub bytes: f64,
    /// Those bytes over the time, in GB (10^9) a second.
    pub gigabytes_per_second: f64,
    /// `f32` operations an item, as declared; null where none are, as for traversal in a build that
    /// counts no visits.
    pub operations: Option<f64>,
    /// Those operations over the time, in 10^9 a second.
    pub gigaoperations_per_second: Option<f64>,
    /// Nodes an item was tested against, in builds that count it.
    pub nodes: Option<f64>,
    /// Triangles an item was tested against, in builds that count it.
    pub triangles: Option<f64>,
    /// Counts an item, by name ([`COUNTERS`]); only those that could be read.
    pub counted: BTreeMap<&'static str, f64>,
}

impl Row {
    /// The row of `stage`, whose share is of `all` seconds. `readable` says which counters are.
    #[must_use]
    pub fn new(stage: &StageStats, all: f64, readable: [bool; COUNTERS.len()]) -> Self {
        let items = if stage.items_in > 0 {
            stage.items_in
        } else {
            stage.items_out
        };
        let each = |value: f64| value / (items.max(1)) as f64;
        let rate = |value: f64| {
            if stage.seconds > 0.0 {
                value / stage.seconds
            } else {
                0.0
            }
        };
        let bytes = (stage.bytes_read + stage.bytes_written) as f64;
        let traversal = matches!(stage.name, "intersect" | "occlude");
        let known = stage.operations > 0 && (!traversal || stage.nodes_visited.is_some());
        let operations = known.then_some(stage.operations as f64);
        let count = |n: Option<u64>| n.filter(|_| traversal).map(|n| each(n as f64));
        let counted = stage.counted.iter().flat_map(|counted| {
            let named = COUNTERS.into_iter().zip(counted).zip(readable);
            named.filter_map(|((name, &count), readable)| readable.then_some((name, each(count))))
        });
        Self {
            name: stage.name,
            seconds: stage.seconds,
            share: if all > 0.0 { stage.seconds / all } else { 0.0 },
            calls: stage.calls,
            items,
            nanoseconds: each(stage.seconds * 1e9),
            per_second: rate(items as f64),
            occupancy: stage.lanes_busy as f64 / stage.lanes_issued.max(1) as f64,
            bytes: each(bytes),
            gigabytes_per_second: rate(bytes * 1e-9),
            operations: operations.map(each),
            gigaoperations_per_second: operations.map(|o| rate(o * 1e-9)),
            nodes: count(stage.nodes_visited),
            triangles: count(stage.triangles_visited),
            counted: counted.collect(),
        }
    }
}

/// The rows of all stages, in the order of the loop.
#[must_use]
pub fn rows(render: &RenderStats, readable: [bool; COUNTERS.len()]) -> Vec<Row> {
    let all = render.stages.iter().map(|s| s.seconds).sum();
    let stages = render.stages.iter();
    stages.map(|s| Row::new(s, all, readable)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_what_the_stage_says_by_item_and_by_second() {
        let stage = StageStats {
            name: "roulette",
            calls: 2,
            seconds: 0.5,
            items_in: 1000,
            lanes_busy: 1000,
            lanes_issued: 1250,
            bytes_read: 60_000,
            bytes_written: 40_000,
            operations: 12_000,
            counted: Some([4000.0, 8000.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
            ..StageStats::default()
        };
        let mut readable = [false; COUNTERS.len()];
        readable[1] = true;
        let row = Row::new(&stage, 2.0, readable);
        assert_eq!(
            (row.share, row.nanoseconds, row.per_second),
            (0.25, 5e5, 2e3)
        );
        assert_eq!((row.occupancy, row.bytes), (0.8, 100.0));
        assert_eq!(row.operations, Some(12.0));
        assert_eq!(row.counted, BTreeMap::from([("instructions", 8.0)]));
    }

    #[test]
    fn what_traversal_computes_is_unknown_unless_visits_are_counted() {
        let mut stage = StageStats {
            name: "intersect",
            items_in: 10,
            seconds: 1.0,
            operations: 0,
            ..StageStats::default()
        };
        assert_eq!(Row::new(&stage, 1.0, [false; 8]).operations, None);
        (stage.nodes_visited, stage.triangles_visited) = (Some(50), Some(20));
        stage.operations = 8000;
        let row = Row::new(&stage, 1.0, [false; 8]);
        assert_eq!((row.nodes, row.triangles), (Some(5.0), Some(2.0)));
        assert_eq!(row.operations, Some(800.0));
    }
}
