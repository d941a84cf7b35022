//! A study of a scene for people: a line for each choice, a chart, the advice.

use super::chart::{Chart, Series, letter};
use super::scene::Done;
use crate::cli::summary::plural;
use crate::cli::text::{duration, si};
use huygens::accuracy::scene::{Cost, Family, SceneCurve};
use std::fmt::Write;

/// Columns of a terminal.
const COLUMNS: usize = 100;

/// All that is printed of a study, which has one point at least.
pub(super) fn text(done: &Done) -> String {
    let film = &done.scene.film;
    let mut text = format!(
        "{}, {} x {} pixels, {}\nreference: {}; its own error is {}\n{} at each rung, seed {}; \
         errors are relative\n\n",
        done.scene.name,
        film.width,
        film.height,
        plural(done.threads as u64, "thread"),
        done.truth.what,
        if done.truth.noise > 0.0 {
            percent(done.truth.error)
        } else {
            "not known, and taken to be 0".into()
        },
        plural(done.ladder.repetitions.into(), "render"),
        done.ladder.seed
    );
    let goal = format!("to {}", percent(done.target_error));
    let _ = writeln!(
        text,
        "  {:<21} {:>5} {:>8} {:>7} {:>7} {:>7}  {:<14} {:>7} {:>9}",
        "choice", "spp", "time", "rays", "error", "slope", "95% interval", "effic.", goal
    );
    let mut family = Family::Base;
    for (index, curve) in done.study.curves.iter().enumerate() {
        if curve.family != family {
            family = curve.family;
            let _ = writeln!(text, "{}", curve.family_name());
        }
        line(&mut text, letter(index), curve, done);
    }
    text.push('\n');
    text += &legend(done);
    text.push('\n');
    text += &chart(done);
    text.push('\n');
    text += &wrapped(&done.advice.join(" "));
    if done.ended != "complete" {
        let _ = writeln!(
            text,
            "\nthe {} came before the end of the ladder, {} samples a pixel",
            if done.ended == "budget" {
                "budget's end"
            } else {
                "interrupt"
            },
            done.ladder.last
        );
    }
    text
}

fn line(text: &mut String, letter: char, curve: &SceneCurve, done: &Done) {
    let Some(last) = curve.curve.points.last() else {
        let _ = writeln!(text, "{letter} {:<21} not reached", curve.curve.name);
        return;
    };
    let known = |v: Option<f64>, text: fn(f64) -> String| v.map_or_else(|| "?".to_owned(), text);
    let interval = curve
        .curve
        .slope_interval
        .map_or_else(|| "?".into(), |[low, high]| format!("{low:.3} {high:.3}"));
    let _ = writeln!(
        text,
        "{letter} {:<21} {:>5} {:>8} {:>7} {:>7} {:>7}  {interval:<14} {:>7} {:>9}",
        curve.curve.name,
        last.point.samples,
        duration(last.point.seconds),
        rays(last.rays),
        percent(last.error),
        known(curve.curve.slope, |s| format!("{s:.3}")),
        known(curve.efficiency, efficiency),
        cost(curve.cost_of(done.target_error))
    );
}

/// A number of rays, if they were counted.
pub(super) fn rays(rays: Option<u64>) -> String {
    rays.map_or("?".into(), |n| si(n as f64).trim_end().to_owned())
}

/// An efficiency: two decimals, and more where those would say nothing.
pub(super) fn efficiency(ratio: f64) -> String {
    let decimals = match ratio {
        r if r >= 0.095 => 2,
        r if r >= 0.0095 => 3,
        _ => 4,
    };
    format!("{ratio:.decimals$}")
}

/// What an error costs, in a word: `~` where it lies off the ladder.
pub(super) fn cost(cost: Cost) -> String {
    match cost {
        Cost::Measured(s) => duration(s),
        Cost::Extrapolated(s) => format!("~{}", duration(s)),
        Cost::Never(floor) => format!(">{}", percent(floor)),
        Cost::Unknown => "?".into(),
    }
}

/// A share in per cent, three digits.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = match percent {
        p if p < 9.995 => 2,
        p if p < 99.95 => 1,
        _ => 0,
    };
    format!("{percent:.decimals$}%")
}

fn legend(done: &Done) -> String {
    let mut text = String::new();
    let curves = done.study.curves.iter().enumerate();
    for (index, curve) in curves {
        let options = if curve.options.is_empty() {
            String::new()
        } else {
            format!(" ({})", curve.options)
        };
        let _ = writeln!(text, "{} {}{options}", letter(index), curve.curve.what);
    }
    text
}

/// Error against time, of the choices that make the same image.
fn chart(done: &Done) -> String {
    let shown = |f: Family| {
        matches!(
            f,
            Family::Base | Family::Strategy | Family::Sampler | Family::Lights
        )
    };
    let curves = done.study.curves.iter().enumerate();
    let series = curves
        .filter(|(_, c)| shown(c.family))
        .map(|(index, c)| Series {
            marker: letter(index),
            points: c
                .curve
                .points
                .iter()
                .map(|p| (p.point.seconds, p.error))
                .collect(),
        });
    Chart {
        title: "error against time in seconds",
        series: series.collect(),
        guides: vec![-0.5],
    }
    .draw()
}

/// Lines of a terminal's width.
fn wrapped(paragraph: &str) -> String {
    let mut text = String::new();
    let mut column = 0;
    for word in paragraph.split_whitespace() {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > COLUMNS {
            text.push('\n');
            column = 0;
        }
        if column > 0 {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += length;
    }
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_have_three_digits() {
        let texts = [0.000_123, 0.0123, 0.0999, 0.123, 1.0, 12.3].map(percent);
        assert_eq!(texts, ["0.01%", "1.23%", "9.99%", "12.3%", "100%", "1230%"]);
    }

    #[test]
    fn small_efficiencies_are_told_too() {
        let texts = [12.3, 1.0, 0.1, 0.0123, 0.00123, 0.0].map(efficiency);
        assert_eq!(
            texts,
            ["12.30", "1.00", "0.10", "0.012", "0.0012", "0.0000"]
        );
    }

    #[test]
    fn lines_end_before_the_terminal_does() {
        let text = wrapped(&"word ".repeat(40));
        assert!(text.lines().all(|l| l.len() <= COLUMNS && l.len() > 90));
        assert_eq!(text.split_whitespace().count(), 40);
    }
}
