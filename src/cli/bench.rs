//! `huygens bench`.

mod accounting;
mod report;
mod stage;
mod text;

use crate::cli::failure::Failure;
use crate::cli::json;
use crate::cli::system::peak_memory;
use crate::cli::text::out;
use huygens::film::output::ensure_writable;
use huygens::throughput::compare::{
    Comparison, SESSIONS_FLOOR, TURNS_FLOOR, Verdict, compare, memory_change,
};
use huygens::throughput::measure::Prepared;
use huygens::throughput::suite::{SUITE, Standard};
use miette::{IntoDiagnostic, WrapErr, miette};
use report::{Report, SceneReport};
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

    /// Runs of each scene, 1 to 1000, in turn, after one that does not count
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
        default_value = "2048"
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
        let [old, new] = take_turns(args, program)?;
        finish(args, &new)?;
        return verdict(args, &old, &new);
    }
    let reports = measure(args, &suite)?;
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

/// Runs the suite for each number of threads and of paths: rounds outside, so that whatever disturbs
/// the machine for a while disturbs all alike.
fn measure(args: &Args, suite: &[Standard]) -> Result<Vec<Report>, Failure> {
    let mut reports: Vec<Report> = args
        .threads
        .iter()
        .flat_map(|&t| args.wave.iter().map(move |&w| Report::new(t, w, args.runs)))
        .collect();
    let run = |scene: &Prepared, report: &Report| {
        scene.run(usize::from(report.threads), report.wave as usize)
    };
    let (mut scenes, mut peak) = (Vec::new(), None);
    for standard in suite {
        let scene = Prepared::new(standard).into_diagnostic();
        let scene = scene.map_err(Failure::Other)?;
        for report in &mut reports {
            // Warms caches, pages and the clock up, and shows how much memory it takes.
            run(&scene, report);
            report.scenes.push(SceneReport::new(standard, &scene));
        }
        peak = peak.max(peak_memory());
        scenes.push(scene);
    }
    for _ in 0..args.runs {
        for (i, scene) in scenes.iter().enumerate() {
            for report in &mut reports {
                let run = run(scene, report);
                report.scenes[i].runs.push(run);
            }
        }
    }
    for report in &mut reports {
        report.peak_memory = peak;
        report.finish();
    }
    Ok(reports)
}

/// Lets `program` and this one run the suite once each, again and again, and returns both reports.
fn take_turns(args: &Args, program: &Path) -> Result<[Report; 2], Failure> {
    let own = std::env::current_exe()
        .into_diagnostic()
        .map_err(Failure::Other)?;
    let folder = tempfile::tempdir()
        .into_diagnostic()
        .map_err(Failure::Other)?;
    let mut reports: [Option<Report>; 2] = [None, None];
    for round in 0..args.runs {
        for turn in 0..2 {
            // Whoever goes first in one round goes second in the next.
            let which = (round as usize + turn) % 2;
            let program = [program, &own][which];
            let file = folder.path().join("run.json");
            once(args, program, &file)?;
            let report = read(&file)?;
            match &mut reports[which] {
                Some(sum) => sum.append(report)?,
                none => *none = Some(report),
            }
        }
    }
    Ok(reports.map(|r| {
        let mut r = r.expect("at least one round");
        r.finish();
        r
    }))
}

/// One round of the suite by a program of this kind, saved to `file`.
fn once(args: &Args, program: &Path, file: &Path) -> Result<(), Failure> {
    let mut command = std::process::Command::new(program);
    command.args(["bench", "--runs", "1"]);
    command.args(["--threads", &args.threads[0].to_string()]);
    command.args(["--wave", &args.wave[0].to_string()]);
    command.arg("--save").arg(file);
    if args.quick {
        command.arg("--quick");
    }
    if let Some(filter) = &args.filter {
        command.args(["--filter", filter]);
    }
    let name = program.display();
    let output = command.output().into_diagnostic();
    let output = output
        .wrap_err_with(|| format!("cannot run {name}"))
        .map_err(Failure::Input)?;
    if output.status.success() {
        return Ok(());
    }
    let error = String::from_utf8_lossy(&output.stderr);
    Err(Failure::Input(miette!(
        "{name} does not run this suite ({}): {}",
        output.status,
        error.trim()
    )))
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
    let floor = if args.against.is_some() {
        TURNS_FLOOR
    } else {
        SESSIONS_FLOOR.max(memory_change(&scenes))
    };
    let found = compare(&scenes, floor);
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
