//! Rounds of the suite: in one process, in a process each, or taking turns with another program's.

use super::report::{Report, SceneReport};
use super::{Args, read};
use crate::cli::failure::Failure;
use crate::cli::system::peak_memory;
use huygens::throughput::measure::Prepared;
use huygens::throughput::suite::Standard;
use miette::{IntoDiagnostic, WrapErr, miette};
use std::path::{Path, PathBuf};

/// Runs the suite for each number of threads and of paths: rounds outside, so that whatever disturbs
/// the machine for a while disturbs all alike.
pub(super) fn in_one_process(args: &Args, suite: &[Standard]) -> Result<Vec<Report>, Failure> {
    let mut reports: Vec<Report> = args
        .threads
        .iter()
        .flat_map(|&t| args.wave.iter().map(move |&w| Report::new(t, w, args.runs)))
        .collect();
    let (mut scenes, mut peak) = (Vec::new(), None);
    for standard in suite {
        let scene = Prepared::new(standard).into_diagnostic();
        let scene = scene.map_err(Failure::Other)?;
        for report in &mut reports {
            // Shows how much memory it takes, too.
            scene.warm_up(usize::from(report.threads), report.wave as usize);
            report.scenes.push(SceneReport::new(standard, &scene));
        }
        peak = peak.max(peak_memory());
        scenes.push(scene);
    }
    for _ in 0..args.runs {
        for (i, scene) in scenes.iter().enumerate() {
            for report in &mut reports {
                let run = scene.run(usize::from(report.threads), report.wave as usize);
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

/// Runs the suite round by round, each in a process of its own: where the system puts a process's
/// pages moves what waits for memory by more than its runs differ, so rounds that shared them would all be
/// off by the same.
pub(super) fn in_processes(args: &Args) -> Result<Report, Failure> {
    let [report] = of_programs(args, &[own()?])?;
    Ok(report)
}

/// Lets `program` and this one run the suite once each, again and again, and returns both reports.
pub(super) fn in_turns(args: &Args, program: &Path) -> Result<[Report; 2], Failure> {
    of_programs(args, &[program.to_owned(), own()?])
}

fn own() -> Result<PathBuf, Failure> {
    let own = std::env::current_exe().into_diagnostic();
    own.map_err(Failure::Other)
}

/// Lets each program run the suite once, again and again: whoever goes first in one round goes last in the
/// next.
fn of_programs<const N: usize>(
    args: &Args,
    programs: &[PathBuf; N],
) -> Result<[Report; N], Failure> {
    let folder = tempfile::tempdir()
        .into_diagnostic()
        .map_err(Failure::Other)?;
    let file = folder.path().join("run.json");
    let mut reports: [Option<Report>; N] = [const { None }; N];
    for round in 0..args.runs {
        for turn in 0..N {
            let which = if round % 2 == 0 { turn } else { N - 1 - turn };
            once(args, &programs[which], &file)?;
            let report = read(&file)?;
            match &mut reports[which] {
                Some(sum) => sum.append(report)?,
                none => *none = Some(report),
            }
        }
    }
    Ok(reports.map(|report| {
        let mut report = report.expect("at least one round");
        report.finish();
        report
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
