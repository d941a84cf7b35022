//! Studies of integrals as pages, and what all pages share: what `--html` and `--svg` write.

use crate::cli::text::duration;
use huygens::accuracy::report::{Cell, Fact, Line, Mark, Page, Plot, Table};
use huygens::accuracy::{Curve, Ladder, Point, Problem, Study};

/// The page of a study of an integral.
pub(super) fn known(problem: &Problem, ladder: &Ladder, study: &Study) -> Page {
    let mut guides: Vec<f64> = study
        .curves
        .iter()
        .filter_map(|c| c.expected_slope)
        .collect();
    guides.sort_by(|a, b| b.total_cmp(a));
    guides.dedup();
    let plot = |name: &str, along: &str, x: fn(&Point) -> f64| Plot {
        name: name.into(),
        title: format!("Error against {along}"),
        axes: [along.into(), "error (root mean square)".into()],
        lines: study.curves.iter().map(|c| known_line(c, x)).collect(),
        guides: guides.clone(),
    };
    Page {
        title: format!("What accuracy costs: {}", problem.what),
        summary: vec![format!(
            "{} estimates at each rung, of {}, which is {}.",
            ladder.repetitions, problem.what, problem.exact
        )],
        facts: facts(&[("seed", ladder.seed.to_string())]),
        plots: vec![
            plot("error-samples", "samples", |p| p.samples as f64),
            plot("error-time", "seconds", |p| p.seconds),
        ],
        table: Table {
            columns: columns(&[
                ("estimator", "name"),
                ("what", "what it does"),
                ("samples", "on the last rung"),
                ("time", "of one estimate there"),
                ("error", "root mean square there"),
                ("slope", "power of the samples that the error goes with"),
                ("theory", "that power for many samples"),
            ]),
            rows: study.curves.iter().filter_map(known_row).collect(),
        },
        ..Page::default()
    }
}

fn known_line(curve: &Curve, x: fn(&Point) -> f64) -> Line {
    let mark = |p: &Point| Mark {
        at: [x(p), p.rmse],
        tip: format!(
            "{}\n{} samples, {}\nerror {:.3e}",
            curve.name,
            p.samples,
            duration(p.seconds),
            p.rmse
        ),
    };
    Line {
        name: curve.name.clone(),
        group: String::new(),
        marks: curve.points.iter().map(mark).collect(),
    }
}

fn known_row(curve: &Curve) -> Option<Vec<Cell>> {
    let last = curve.points.last()?;
    Some(vec![
        Cell::text(&curve.name),
        Cell::text(&curve.what),
        Cell::number(Some(last.samples as f64), last.samples.to_string()),
        Cell::number(Some(last.seconds), duration(last.seconds)),
        Cell::number(Some(last.rmse), format!("{:.2e}", last.rmse)),
        slope(curve.slope),
        slope(curve.expected_slope),
    ])
}

/// A slope, if it is known.
pub(super) fn slope(slope: Option<f64>) -> Cell {
    Cell::number(slope, slope.map_or("?".into(), |s| format!("{s:.3}")))
}

/// The facts of every study, with some of its own.
pub(super) fn facts(own: &[(&str, String)]) -> Vec<Fact> {
    let fact = |name: &str, value: String, code| Fact {
        name: name.into(),
        value,
        code,
    };
    let version = concat!("huygens ", env!("CARGO_PKG_VERSION")).to_owned();
    let mut facts = vec![fact("command", super::command(), true)];
    facts.extend(
        own.iter()
            .map(|(n, v)| fact(n, v.clone(), *n == "settings")),
    );
    facts.push(fact("machine", super::machine(), false));
    facts.push(fact("program", version, false));
    facts
}

/// Columns by name and meaning.
pub(super) fn columns(all: &[(&str, &str)]) -> Vec<(String, String)> {
    let own = |(name, meaning): &(&str, &str)| ((*name).to_owned(), (*meaning).to_owned());
    all.iter().map(own).collect()
}
