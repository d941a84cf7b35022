//! What `run.sh` counts the instructions of: each stage of the loop over recorded queues.
//!
//! Without arguments it lists its cases, `scene/stage items`; with a case it runs that stage once, in
//! [`measured`], which is what valgrind is told to count.

use huygens::throughput::measure::Prepared;
use huygens::throughput::suite::{SUITE, Standard};
use huygens::wave::{RECORDED_STAGES, Recorded};

/// Of the suite, those whose making does not take minutes under valgrind.
const SCENES: [&str; 2] = ["box", "interior"];

fn main() {
    // cargo passes `--bench`; what is left is a case.
    let asked = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    let Some(case) = asked else {
        for scene in SCENES {
            for stage in RECORDED_STAGES {
                let items = prepared(scene).recorded(|mut r| r.run(stage));
                if items > 0 {
                    println!("{scene}/{stage} {items}");
                }
            }
        }
        return;
    };
    let (scene, stage) = case.split_once('/').expect("scene/stage");
    prepared(scene).recorded(|mut recorded| {
        // Once before, so that pages and branches are there.
        recorded.run(stage);
        measured_by_valgrind(&mut recorded, stage);
    });
}

#[inline(never)]
fn measured_by_valgrind(recorded: &mut Recorded, stage: &str) {
    std::hint::black_box(recorded.run(std::hint::black_box(stage)));
}

fn prepared(name: &str) -> Prepared {
    let named = |s: &&Standard| s.name == name;
    let standard = SUITE.iter().find(named).expect("a scene of the suite");
    Prepared::new(standard).expect("it can be made")
}
