//! `huygens accuracy`.

mod chart;
mod json;
mod table;

use crate::cli::failure::Failure;
use crate::cli::interrupt::Interrupts;
use crate::cli::options;
use crate::cli::progress::Progress;
use crate::cli::text::{duration, out};
use huygens::accuracy::{End, Ladder, Target, study};
use huygens::film::output::ensure_writable;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Show what accuracy costs in time: error against samples and seconds
#[derive(Debug, clap::Args)]
#[command(args_override_self = true)]
pub(crate) struct Args {
    /// What to study
    #[arg(value_enum)]
    target: Target,

    /// Write the study as JSON (see docs/accuracy.md)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Most samples of an estimate, 64 to 67108864: the end of the ladder, which starts at 64 and
    /// doubles
    #[arg(long, value_name = "N", default_value_t = 1 << 18, allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(64..=1 << 26))]
    samples: u32,

    /// Independent estimates at each rung of the ladder, 2 to 1048576
    #[arg(
        long,
        value_name = "N",
        default_value_t = 64,
        allow_negative_numbers = true
    )]
    #[arg(value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    repetitions: u32,

    /// Seed of the random numbers, 0 to 4294967295
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    seed: u32,

    /// Longest time for the whole study, such as 90s, 500ms or 2m; what is done by then is shown
    /// [default: none]
    #[arg(long, value_name = "TIME", value_parser = options::time)]
    budget: Option<Duration>,

    /// Print nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
}

/// Runs `huygens accuracy`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(path) = &args.json {
        ensure_writable(path)?;
    }
    let interrupts = Interrupts::watch()?;
    let progress = Progress::new(args.quiet);
    let problem = args.target.problem();
    let ladder = Ladder {
        last: args.samples as usize,
        repetitions: args.repetitions,
        seed: args.seed,
        ..Ladder::default()
    };
    let start = Instant::now();
    let control = interrupts.rendering();
    let in_time = || args.budget.is_none_or(|budget| start.elapsed() < budget);
    let go_on = || !control.stop.load(Ordering::Relaxed) && in_time();
    let label = format!("study {}", args.target.name());
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
    let report = json::Report::new(args.target, &problem, &ladder, &study, ended, seconds);
    if let Some(path) = &args.json {
        report.write(path)?;
    }
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

/// The first column of the tables under a heading of docs/accuracy.md.
#[cfg(test)]
pub(crate) fn documented(heading: &str) -> std::collections::BTreeSet<String> {
    let text = include_str!("../../docs/accuracy.md");
    let section = text.split("\n## ").find(|s| s.starts_with(heading));
    let rows = section.expect("the heading").lines();
    rows.filter_map(|row| row.strip_prefix("| `")?.split('`').next())
        .map(str::to_owned)
        .collect()
}
