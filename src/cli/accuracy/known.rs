//! `huygens accuracy` of an integral whose value is known.

use super::{Args, json, pages, table};
use crate::cli::failure::Failure;
use crate::cli::interrupt::Interrupts;
use crate::cli::progress::Progress;
use crate::cli::text::{duration, out};
use huygens::accuracy::{End, Ladder, Target, study};
use std::sync::atomic::Ordering;
use std::time::Instant;

pub(super) fn run(args: &Args, target: Target) -> Result<(), Failure> {
    let interrupts = Interrupts::watch()?;
    let progress = Progress::new(args.quiet);
    let problem = target.problem();
    let default = Ladder::default();
    let ladder = Ladder {
        last: args.samples.map_or(default.last, |n| n as usize),
        repetitions: args.repetitions.unwrap_or(default.repetitions),
        seed: args.image.seed.unwrap_or(default.seed),
        ..default
    };
    let start = Instant::now();
    let control = interrupts.rendering();
    let in_time = || args.budget.is_none_or(|budget| start.elapsed() < budget);
    let go_on = || !control.stop.load(Ordering::Relaxed) && in_time();
    let label = format!("study {}", target.name());
    let (study, seconds) = progress.phase(&label, || study(&problem, &ladder, go_on));

    let ended = match study.end {
        End::Complete => "complete",
        End::Stopped if interrupts.received() => "interrupted",
        End::Stopped => "budget",
    };
    let reached = study.curves[0].points.len();
    let Some(last) = ladder.rungs().take(reached).last() else {
        return Err(match (ended, args.budget) {
            ("budget", Some(budget)) => Failure::input(format!(
                "the budget of {} is too short for the first {} samples",
                duration(budget.as_secs_f64()),
                ladder.first
            )),
            _ => Failure::Interrupted("no rung was finished, so there is nothing to show".into()),
        });
    };
    let report = json::Report::new(target, &problem, &ladder, &study, ended, seconds);
    if let Some(path) = &args.json {
        report.write(path)?;
    }
    args.write_pages(&pages::known(&problem, &ladder, &study))?;
    if !args.quiet {
        out(&table::text(&problem, &ladder, &study));
        if ended == "budget" {
            out(&format!(
                "\nthe budget ended it after {last} of {} samples\n",
                ladder.last
            ));
        }
    }
    if ended == "interrupted" {
        let message = format!(
            "showed what there is, up to {last} of {} samples",
            ladder.last
        );
        return Err(Failure::Interrupted(message));
    }
    Ok(())
}
