//! What was measured, as tables, and the line that scripts read.

use crate::agree::Agreement;
use crate::builds::Builds;
use crate::measure::{BEST, Measured, OURS, PEERS};
use crate::rounds::Timings;
use crate::statistics::{Spread, median};
use crate::table::Table;

fn ratio(spread: Option<Spread>) -> String {
    spread.map_or_else(String::new, |s| format!("{:.2}", s.median))
}

fn ratio_and_range(spread: Option<Spread>) -> String {
    spread.map_or_else(String::new, |s| {
        format!("{:.2} ({:.2}-{:.2})", s.median, s.low, s.high)
    })
}

/// Rays a second, and how many times as fast as each variant of Embree ours are.
pub(crate) fn rays(all: &[Measured]) -> Table {
    let mut head = vec!["mesh", "rays", "Huygens Mray/s", "/ robust (range)"];
    let others: Vec<String> = PEERS[1..].iter().map(|p| format!("/ {p}")).collect();
    head.extend(others.iter().map(String::as_str));
    head.push("best / HIGH");
    let mut table = Table::new(&head);
    for measured in all {
        for (set, timings) in &measured.timings {
            let rate = timings.rate(OURS).unwrap_or(f64::NAN);
            let mut row = vec![
                measured.name.to_owned(),
                (*set).to_owned(),
                format!("{rate:.2}"),
                ratio_and_range(timings.ratio(OURS, PEERS[0])),
            ];
            row.extend(PEERS[1..].iter().map(|p| ratio(timings.ratio(OURS, p))));
            row.push(ratio(timings.ratio(BEST, "HIGH")));
            table.row(row);
        }
    }
    for set in ["camera", "b1", "b2", "sh1"] {
        let cell = |ours: &str, peer: &str| {
            let m = median_ratio(all, set, ours, peer);
            if m.is_nan() {
                String::new()
            } else {
                format!("{m:.2}")
            }
        };
        let mut row = vec!["**median**".to_owned(), set.to_owned(), String::new()];
        row.extend(PEERS.iter().map(|peer| cell(OURS, peer)));
        row.push(cell(BEST, "HIGH"));
        table.row(row);
    }
    table
}

fn timings<'a>(measured: &'a Measured, set: &str) -> Option<&'a Timings> {
    let found = measured.timings.iter().find(|(name, _)| *name == set);
    found.map(|(_, timings)| timings)
}

/// Median over meshes of the ratio of `ours` to `peer` on `set`.
fn median_ratio(all: &[Measured], set: &str, ours: &str, peer: &str) -> f64 {
    let ratios: Vec<f64> = all
        .iter()
        .filter_map(|m| timings(m, set)?.ratio(ours, peer))
        .map(|s| s.median)
        .collect();
    median(&ratios)
}

/// The last line.
pub(crate) fn last_line(all: &[Measured]) -> String {
    let [b2, sh1] = ["b2", "sh1"].map(|set| median_ratio(all, set, OURS, PEERS[0]));
    format!("median robust-ratio b2 {b2:.2} sh1 {sh1:.2}")
}

/// Triangles, and bytes a triangle of tree and leaves.
pub(crate) fn memory(all: &[Measured]) -> Table {
    let mut table = Table::new(&[
        "bytes a triangle",
        "triangles",
        "Huygens",
        "Embree robust",
        "default",
        "HIGH",
    ]);
    for m in all {
        let mut row = vec![m.name.to_owned(), m.triangles.to_string()];
        row.extend(m.bytes.iter().map(|b| format!("{b:.0}")));
        table.row(row);
    }
    table
}

/// Build speeds by mesh and threads.
pub(crate) fn builds(all: &[(&str, Vec<Builds>)]) -> Table {
    let mut table = Table::new(&[
        "builds, Mtriangles/s",
        "threads",
        "balanced",
        "fast",
        "best",
        "MEDIUM",
        "HIGH",
        "balanced / MEDIUM (range)",
        "by CPU",
        "efficiency balanced (range)",
        "of MEDIUM",
        "CPU/wall balanced, MEDIUM",
        "quiet rounds",
    ]);
    for (name, rows) in all {
        for b in rows {
            let efficiency = |spread| (b.threads > 1).then_some(spread);
            let mut row = vec![(*name).to_owned(), b.threads.to_string()];
            let rates = b.ours.iter().chain([&b.medium, &b.high]);
            row.extend(rates.map(|rate| format!("{rate:.2}")));
            row.extend([
                ratio_and_range(Some(b.ratio)),
                format!("{:.2}", b.cpu_ratio),
                ratio_and_range(efficiency(b.efficiency[0])),
                ratio(efficiency(b.efficiency[1])),
                format!("{:.2}, {:.2}", b.busy[0], b.busy[1]),
                b.quiet.to_string(),
            ]);
            table.row(row);
        }
    }
    table
}

/// The line on builds that scripts read, of the largest number of threads: medians over the meshes
/// whose rounds were quiet, or `n/a`.
pub(crate) fn builds_line(all: &[(&str, Vec<Builds>)]) -> String {
    let last = all.iter().filter_map(|(_, rows)| rows.last());
    let quiet: Vec<&Builds> = last.filter(|b| b.quiet > 0).collect();
    let middle = |of: &dyn Fn(&Builds) -> f64| {
        let values: Vec<f64> = quiet.iter().map(|b| of(b)).collect();
        if values.is_empty() {
            "n/a".to_owned()
        } else {
            format!("{:.2}", median(&values))
        }
    };
    let efficiency = |b: &Builds| {
        if b.threads > 1 {
            b.efficiency[0].median
        } else {
            f64::NAN
        }
    };
    format!(
        "build balanced/medium {} efficiency {}",
        middle(&|b| b.ratio.median),
        middle(&efficiency)
    )
}

/// Whether both sides meet the same things.
pub(crate) fn agreement(all: &[Measured]) -> Table {
    let mut table = Table::new(&[
        "hits",
        "rays",
        "Embree",
        "same",
        "rounding",
        "wrong Huygens",
        "wrong Embree",
        "t off Huygens",
        "t off Embree",
    ]);
    for m in all {
        for (set, by_mode) in &m.agreement {
            for (mode, a) in ["robust", "default"].into_iter().zip(by_mode) {
                let Agreement {
                    same,
                    rounding,
                    wrong,
                    distance,
                } = *a;
                let counts = [same, rounding, wrong[0], wrong[1], distance[0], distance[1]];
                let mut row = vec![m.name.to_owned(), (*set).to_owned(), mode.to_owned()];
                row.extend(counts.iter().map(ToString::to_string));
                table.row(row);
            }
        }
    }
    table
}

/// Shadow rays on which the two disagree.
pub(crate) fn shadows(all: &[Measured]) -> Table {
    let mut table = Table::new(&[
        "sh1, of all",
        "Embree",
        "blocked for Huygens alone",
        "blocked for Embree alone",
    ]);
    for m in all {
        for (mode, (ours, theirs)) in ["robust", "default"].into_iter().zip(m.shadows) {
            table.row(vec![
                m.name.to_owned(),
                mode.to_owned(),
                ours.to_string(),
                theirs.to_string(),
            ]);
        }
    }
    table
}
