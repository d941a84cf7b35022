//! `huygens bench`.

mod accounting;
mod report;
mod rounds;
mod stage;
mod text;

use crate::cli::failure::Failure;
use crate::cli::json;
use crate::cli::text::out;
use huygens::film::output::ensure_writable;
use huygens::throughput::compare::{
    Comparison, Rounds, SESSIONS_FLOOR, TURNS_FLOOR, Verdict, compare, memory_change,
};
use huygens::throughput::suite::{SUITE, Standard};
use miette::{IntoDiagnostic, WrapErr};
use report::Report;
use std::path::{Path, PathBuf};

/// Measure throughput on the standard scenes
#[derive(Debug, clap::Args)]
#[command(args_override_self = true)]
#[command(after_help = "Exit code 3: slower than what it was compared with, beyond --threshold.")]
pub(crate) struct Args {
    /// Run one stage over queues recorded from a scene, for tools that count instructions (see
    /// docs/benchmarks.md); without a value, one after the other
    #[arg(long, value_name = "SCENE/STAGE", num_args = 0..=1, default_missing_value = "")]
    stage: Option<String>,

    /// Measure what the accounting of stages costs: runs with and without it, in turns
    #[arg(long, conflicts_with_all = ["stage", "save", "compare", "against"])]
    accounting: bool,

    /// Only scenes whose name contains this
    #[arg(long, value_name = "TEXT")]
    filter: Option<String>,

    /// Rounds, 1 to 1000: one run of each scene, after one that does not count, in a process of its own
    #[arg(
        long,
        value_name = "N",
        default_value_t = 9,
        allow_negative_numbers = true
    )]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,

    /// An eighth of the samples: for a first look
    #[arg(long)]
    quick: bool,

    /// Worker threads, 0 to 1024 (0: one for each core); several, as 1,2,4, for a sweep
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "0")]
    #[arg(value_parser = clap::value_parser!(u16).range(0..=1024), allow_negative_numbers = true)]
    threads: Vec<u16>,

    /// Paths in a worker's wave, 64 to 1048576; several, as 512,2048, for a sweep
    #[arg(
        long,
        value_name = "N,...",
        value_delimiter = ',',
        default_value = "4096"
    )]
    #[arg(value_parser = clap::value_parser!(u32).range(64..=1 << 20), allow_negative_numbers = true)]
    wave: Vec<u32>,

    /// Write the numbers as JSON (see docs/benchmarks.md)
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,

    /// Compare with numbers that --save wrote
    #[arg(long, value_name = "FILE", conflicts_with = "against")]
    compare: Option<PathBuf>,

    /// Compare with another build of this program, whose runs take turns with this one's
    #[arg(long, value_name = "PROGRAM")]
    against: Option<PathBuf>,

    /// Per cent that it may be slower than what it is compared with, 0 to 1000
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0, value_parser = percent)]
    #[arg(allow_negative_numbers = true)]
    threshold: f64,
}

fn percent(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok();
    number
        .filter(|v| (0.0..=1000.0).contains(v))
        .ok_or_else(|| "expected a number of per cent from 0 to 1000".to_owned())
}

/// Runs `huygens bench`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(path) = &args.save {
        ensure_writable(path)?;
    }
    if let Some(case) = &args.stage {
        return stage::run(case);
    }
    let sweep = args.threads.len() > 1 || args.wave.len() > 1;
    if sweep && (args.compare.is_some() || args.against.is_some() || args.accounting) {
        let message = "a sweep cannot be compared: give one number of threads and one of paths";
        return Err(Failure::input(message));
    }
    let old = args.compare.as_deref().map(read).transpose()?;
    let chosen = |s: &&Standard| {
        args.filter
            .as_ref()
            .is_none_or(|f| s.name.contains(f.as_str()))
    };
    let suite = SUITE.iter().filter(chosen).map(|s| Standard {
        spp: if args.quick { s.spp.div_ceil(8) } else { s.spp },
        ..*s
    });
    let suite: Vec<Standard> = suite.collect();
    if suite.is_empty() {
        let names: Vec<&str> = SUITE.iter().map(|s| s.name).collect();
        return Err(Failure::input(format!(
            "no scene of the suite is named like `{}`; there are {}",
            args.filter.as_deref().unwrap_or_default(),
            names.join(", ")
        )));
    }
    if args.accounting {
        return accounting::run(args, &suite);
    }
    if let Some(program) = &args.against {
        let [old, new] = rounds::in_turns(args, program)?;
        finish(args, &new)?;
        return verdict(args, &old, &new);
    }
    let reports = if sweep || args.runs == 1 {
        rounds::in_one_process(args, &suite)?
    } else {
        vec![rounds::in_processes(args)?]
    };
    for report in &reports {
        out(&report.text());
    }
    if sweep {
        out(&text::sweep(&reports));
    }
    finish(args, &reports[0])?;
    match old {
        Some(old) => verdict(args, &old, &reports[0]),
        None => Ok(()),
    }
}

/// Reads numbers that `--save` wrote.
fn read(path: &Path) -> Result<Report, Failure> {
    let name = path.display();
    let text = std::fs::read_to_string(path).into_diagnostic();
    let text = text
        .wrap_err_with(|| format!("cannot read {name}"))
        .map_err(Failure::Input)?;
    let report: Report = serde_json::from_str(&text)
        .into_diagnostic()
        .wrap_err_with(|| format!("{name} holds no numbers of huygens bench"))
        .map_err(Failure::Input)?;
    if report.schema != report::SCHEMA {
        return Err(Failure::input(format!(
            "{name}: found schema {}, expected {}: save it again with this version",
            report.schema,
            report::SCHEMA
        )));
    }
    Ok(report)
}

fn finish(args: &Args, report: &Report) -> Result<(), Failure> {
    if let Some(path) = &args.save {
        json::write(path, report)?;
    }
    Ok(())
}

/// Prints the comparison; an error beyond the threshold.
fn verdict(args: &Args, old: &Report, new: &Report) -> Result<(), Failure> {
    old.ensure_comparable(new)?;
    let scenes: Vec<_> = old
        .scenes
        .iter()
        .filter_map(|o| {
            let n = new.scenes.iter().find(|n| n.name == o.name)?;
            Some((o.name.as_str(), &o.runs[..], &n.runs[..]))
        })
        .collect();
    // Where runs took turns, memory changed for both.
    let (rounds, floor) = if args.against.is_some() {
        (Rounds::InTurns, TURNS_FLOOR)
    } else {
        let floor = SESSIONS_FLOOR.max(memory_change(&scenes));
        (Rounds::InSessions, floor)
    };
    let found = compare(&scenes, rounds, floor);
    out(&text::comparison(&found, floor));
    let beyond = 1.0 + args.threshold / 100.0;
    let slow = |c: &&Comparison| c.verdict == Verdict::Slower && c.ratio > beyond;
    let slow: Vec<&str> = found.iter().filter(slow).map(|c| c.name.as_str()).collect();
    if slow.is_empty() {
        return Ok(());
    }
    Err(Failure::Slower(format!(
        "more than {} % slower: {}",
        args.threshold,
        slow.join(", ")
    )))
}
