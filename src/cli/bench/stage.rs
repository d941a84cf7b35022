//! Stages by themselves, over recorded queues: what `benches/instructions/run.sh` counts.

use crate::cli::failure::Failure;
use crate::cli::text::out;
use huygens::throughput::measure::Prepared;
use huygens::throughput::suite::{SUITE, Standard};
use huygens::wave::{RECORDED_STAGES, Recorded};
use miette::IntoDiagnostic;

/// Of the suite, scenes that are made in no time, also under an emulator.
const SCENES: [&str; 2] = ["box", "interior"];

/// Runs `scene/stage` and prints it with its items; one after the other, if `case` is empty.
pub(super) fn run(case: &str) -> Result<(), Failure> {
    if case.is_empty() {
        let mut scenes = SUITE.iter().filter(|s| SCENES.contains(&s.name));
        return scenes.try_for_each(|scene| count(scene, &RECORDED_STAGES));
    }
    let known = case.split_once('/').and_then(|(scene, stage)| {
        let named = |s: &&Standard| s.name == scene && SCENES.contains(&scene);
        let scene = SUITE.iter().find(named)?;
        Some((scene, *RECORDED_STAGES.iter().find(|s| **s == stage)?))
    });
    match known {
        Some((scene, stage)) => count(scene, &[stage]),
        None => Err(Failure::input(format!(
            "--stage: found {case}, expected a scene ({}) and a stage ({}), as box/sort",
            SCENES.join(", "),
            RECORDED_STAGES.join(", ")
        ))),
    }
}

fn count(scene: &Standard, stages: &[&str]) -> Result<(), Failure> {
    let prepared = Prepared::new(scene).into_diagnostic();
    let prepared = prepared.map_err(Failure::Other)?;
    prepared.recorded(|mut recorded| {
        for stage in stages {
            // Once before, so that pages are there and branches are known.
            recorded.run(stage);
            let items = counted(&mut recorded, stage);
            out(&format!("{}/{stage} {items}\n", scene.name));
        }
    });
    Ok(())
}

/// What is counted: a function of its own, whose name tools are told.
#[inline(never)]
fn counted(recorded: &mut Recorded, stage: &str) -> usize {
    std::hint::black_box(recorded.run(std::hint::black_box(stage)))
}
