//! What the accounting of a render costs: runs with and without it, in turn.

use super::Args;
use crate::cli::failure::Failure;
use crate::cli::text::out;
use huygens::estimate::sidak;
use huygens::throughput::compare::{Comparison, Rounds, SIGNIFICANCE, compare_costs};
use huygens::throughput::measure::Prepared;
use huygens::throughput::suite::Standard;
use huygens::wave::Instruments;
use miette::IntoDiagnostic;
use std::fmt::Write;

/// What it may cost, as a ratio of processor times.
const ALLOWED: f64 = 1.01;
/// Processor seconds without the accounting, and with it.
type Pairs = [Vec<f64>; 2];

/// Measures it on each scene of `suite` and prints it; an error if it surely is more than allowed.
pub(super) fn run(args: &Args, suite: &[Standard]) -> Result<(), Failure> {
    let mut scenes = Vec::new();
    for standard in suite {
        let prepared = Prepared::new(standard).into_diagnostic();
        scenes.push((
            standard.name,
            pairs(args, &prepared.map_err(Failure::Other)?),
        ));
    }
    let (text, surely_more) = report(&scenes);
    out(&text);
    if surely_more {
        return Err(Failure::Slower(
            "the accounting costs more than 1 %".to_owned(),
        ));
    }
    Ok(())
}

/// Processor seconds without the accounting and with it, run by run, after one each that does not count.
fn pairs(args: &Args, scene: &Prepared) -> Pairs {
    let mut pairs = Pairs::default();
    for round in 0..=args.runs {
        let first = usize::from(round % 2 == 0);
        for with in [first, 1 - first] {
            let instruments = Instruments {
                unaccounted: with == 0,
                ..Instruments::default()
            };
            let (threads, wave) = (usize::from(args.threads[0]), args.wave[0] as usize);
            let run = scene.run_with(threads, wave, &instruments);
            if round > 0 {
                pairs[with].push(run.cpu_seconds);
            }
        }
    }
    pairs
}

/// The table, and whether the interval over all scenes lies above what is allowed.
fn report(scenes: &[(&str, Pairs)]) -> (String, bool) {
    let each = sidak(SIGNIFICANCE, scenes.len().max(1));
    let compared = |(name, [without, with]): &(&str, Pairs)| {
        compare_costs(name, [without, with], Rounds::InTurns, each, 0.0)
    };
    let mut rows: Vec<Comparison> = scenes.iter().map(compared).collect();
    // Over all scenes: round by round, the geometric mean of the scenes' ratios.
    let rounds = scenes.iter().map(|(_, p)| p[0].len()).min().unwrap_or(0);
    let mean = |which: usize, round: usize| {
        let logs = scenes.iter().map(|(_, pairs)| pairs[which][round].ln());
        (logs.sum::<f64>() / scenes.len() as f64).exp()
    };
    let [without, with] = [0, 1].map(|w| (0..rounds).map(|r| mean(w, r)).collect::<Vec<f64>>());
    let all = compare_costs(
        "all scenes",
        [&without, &with],
        Rounds::InTurns,
        SIGNIFICANCE,
        0.0,
    );
    let surely_more = all.interval[0] > ALLOWED;
    rows.push(all);
    let mut text = format!(
        "processor time with the accounting over that without, in turns, {rounds} pairs a scene; \
         intervals hold with probability {}\n",
        1.0 - SIGNIFICANCE
    );
    for row in &rows {
        let [low, high] = row.interval;
        let _ = writeln!(
            text,
            "{:<12} {:.4} ({low:.4} to {high:.4})",
            row.name, row.ratio
        );
    }
    let _ = match &rows[rows.len() - 1].interval {
        [_, high] if *high < ALLOWED => writeln!(text, "below 1 %"),
        [low, _] if *low > ALLOWED => writeln!(text, "above 1 %"),
        _ => writeln!(text, "more pairs are needed to tell it from 1 %"),
    };
    (text, surely_more)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs of a machine that slows down by 3% a round, with a cost of the accounting.
    fn scene(cost: f64) -> Pairs {
        let base = |round: i32| 1.03f64.powi(round);
        let wobble = |round: i32| 1.0 + 1e-3 * f64::from(round % 3 - 1);
        [
            (0..9).map(base).collect(),
            (0..9).map(|r| base(r) * cost * wobble(r)).collect(),
        ]
    }

    #[test]
    fn a_cost_is_told_from_one_per_cent() {
        let (text, more) = report(&[("box", scene(1.002)), ("mesh", scene(0.999))]);
        assert!(text.contains("\nbox          1.0020 (") && !more, "{text}");
        assert!(text.ends_with("below 1 %\n"), "{text}");
        let (text, more) = report(&[("box", scene(1.05))]);
        assert!(more && text.ends_with("above 1 %\n"), "{text}");
        let few = [("box", [vec![1.0], vec![2.0]])];
        let (text, more) = report(&few);
        assert!(text.contains("more pairs are needed") && !more, "{text}");
    }
}
