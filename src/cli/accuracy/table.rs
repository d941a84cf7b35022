//! A study for people: error and time at each rung, the slopes, two charts.

use super::chart::{Chart, Series, letter};
use crate::cli::text::{duration, si};
use huygens::accuracy::{Curve, Ladder, Point, Problem, Study};
use std::fmt::Write;

/// The error, relative to the result, whose cost is told.
const GOAL: f64 = 1e-3;

/// No number of samples is told beyond this one: nobody will take them.
const BEYOND: f64 = 1e15;

/// All that is printed of `study`, which has one rung at least.
pub(crate) fn text(problem: &Problem, ladder: &Ladder, study: &Study) -> String {
    let mut text = format!(
        "{}, exactly {}\n{} estimates at each rung, seed {}; error is the root mean square\n\n",
        problem.what, problem.exact, ladder.repetitions, ladder.seed
    );
    rungs(&mut text, ladder, &study.curves);
    text.push('\n');
    slopes(&mut text, problem.exact, &study.curves);
    if study.curves[0].points.len() > 1 {
        for (title, x) in [
            ("error against samples", samples as fn(&Point) -> f64),
            ("error against time in seconds", seconds),
        ] {
            text.push('\n');
            text += &chart(title, x, &study.curves);
        }
    }
    text
}

fn samples(point: &Point) -> f64 {
    point.samples as f64
}

fn seconds(point: &Point) -> f64 {
    point.seconds
}

/// A line for each rung; error and time for each curve.
fn rungs(text: &mut String, ladder: &Ladder, curves: &[Curve]) {
    let mut names = format!("{:>9}", "");
    for (index, curve) in curves.iter().enumerate() {
        let name = format!("{} {}", letter(index), curve.name);
        let _ = write!(names, "  {name:^16}");
    }
    let _ = write!(text, "{}\n{:>9}", names.trim_end(), "samples");
    for _ in curves {
        let _ = write!(text, "  {:>7} {:>8}", "error", "time");
    }
    text.push('\n');
    let mut rounded = false;
    let reached = curves[0].points.len();
    for (rung, samples) in ladder.rungs().take(reached).enumerate() {
        let _ = write!(text, "{samples:>9}");
        for curve in curves {
            let p = &curve.points[rung];
            rounded |= p.samples != samples as u64;
            let _ = write!(text, "  {:>7.1e} {:>8}", p.rmse, duration(p.seconds));
        }
        text.push('\n');
    }
    if rounded {
        let note = "jittered takes the square or cube next to the number of samples";
        let _ = writeln!(text, "{:>9}  {note}", "");
    }
}

/// A line for each curve: fitted slope, theory, cost of a sample, cost of an error.
fn slopes(text: &mut String, exact: f64, curves: &[Curve]) {
    let _ = writeln!(
        text,
        "{:<12} {:>6}  {:<16} {:>6} {:>9}   for an error of {}%",
        "",
        "slope",
        "95% interval",
        "theory",
        "a sample",
        100.0 * GOAL
    );
    for (index, curve) in curves.iter().enumerate() {
        let number = |v: Option<f64>| v.map_or_else(|| "?".into(), |v| format!("{v:.3}"));
        let interval = curve
            .slope_interval
            .map_or_else(|| "?".into(), |[low, high]| format!("{low:.3} {high:.3}"));
        let last = curve.points.last().expect("a rung at least");
        let _ = writeln!(
            text,
            "{} {:<10} {:>6}  {:<16} {:>6} {:>9}   {}",
            letter(index),
            curve.name,
            number(curve.slope),
            interval,
            number(curve.expected_slope),
            duration(last.seconds / last.samples as f64),
            cost(curve, GOAL * exact.abs())
        );
    }
    for (index, curve) in curves.iter().enumerate() {
        let _ = writeln!(text, "{} {}: {}", letter(index), curve.name, curve.what);
    }
}

/// Samples and time to an error, by the fitted line; marked `~` where that lies off the ladder.
fn cost(curve: &Curve, error: f64) -> String {
    let needed = curve.fit().map_or(f64::NAN, |fit| fit.x_at(error).max(1.0));
    if needed.is_nan() {
        return "?".into();
    }
    if needed > BEYOND {
        return format!("more than {} samples", si(BEYOND));
    }
    let (first, last) = (&curve.points[0], curve.points.last().expect("a rung"));
    // Where the ladder ends, the cost of a sample has settled.
    let seconds = needed * last.seconds / last.samples as f64;
    let outside = needed < samples(first) || needed > samples(last);
    let about = if outside { "~" } else { "" };
    let needed = si(needed.round());
    format!(
        "{about}{} samples, {about}{}",
        needed.trim_end(),
        duration(seconds)
    )
}

/// The curves against `x`, with the slopes that theory has for them.
fn chart(title: &str, x: impl Fn(&Point) -> f64, curves: &[Curve]) -> String {
    let series = curves.iter().enumerate().map(|(index, curve)| Series {
        marker: letter(index),
        points: curve.points.iter().map(|p| (x(p), p.rmse)).collect(),
    });
    let mut guides: Vec<f64> = curves.iter().filter_map(|c| c.expected_slope).collect();
    guides.sort_by(|a, b| b.total_cmp(a));
    guides.dedup();
    Chart {
        title,
        series: series.collect(),
        guides,
    }
    .draw()
}

#[cfg(test)]
mod tests {
    use super::*;
    use huygens::accuracy::{Target, study};

    #[test]
    fn every_target_fits_a_terminal_and_names_its_curves() {
        for target in Target::ALL {
            let problem = target.problem();
            let ladder = Ladder {
                last: 256,
                repetitions: 2,
                ..Ladder::default()
            };
            let study = study(&problem, &ladder, || true);
            let text = text(&problem, &ladder, &study);
            for (index, curve) in study.curves.iter().enumerate() {
                let line = format!("{} {}: {}\n", letter(index), curve.name, curve.what);
                assert!(text.contains(&line));
            }
            for line in text.lines() {
                assert!(line.chars().count() <= 100, "{target:?}: {line}");
            }
        }
    }

    #[test]
    fn one_rung_has_no_slope_and_no_chart() {
        let ladder = Ladder {
            last: 64,
            repetitions: 2,
            ..Ladder::default()
        };
        let problem = Target::Integral.problem();
        let text = text(&problem, &ladder, &study(&problem, &ladder, || true));
        assert!(
            text.contains("a uniform         ?  ?                -0.500"),
            "{text}"
        );
        assert!(!text.contains("against"), "{text}");
    }
}
