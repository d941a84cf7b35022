//! Every stage of the loop over queues recorded from real scenes: items a second by the wall clock.
//!
//!     cargo bench --bench kernels [-- FILTER]
//!
//! The queues are those of a wave in the middle of a render (`wave::recorded`), so that paths have all
//! ages, rays go where scattering sent them and lights are hit as often as they are. A case is
//! `scene/stage`; one that a scene has no items for is not there.

use divan::Bencher;
use divan::counter::ItemsCount;
use huygens::throughput::measure::Prepared;
use huygens::throughput::suite::SUITE;
use huygens::wave::RECORDED_STAGES;
use std::sync::OnceLock;

fn main() {
    divan::main();
}

/// `scene/stage`, for all that have something to do.
fn cases() -> Vec<String> {
    let has_items = |scene: &str, stage: &str| prepared(scene).recorded(|mut r| r.run(stage)) > 0;
    let of = |scene: &'static str| {
        let stages = RECORDED_STAGES.into_iter();
        stages
            .filter(move |stage| has_items(scene, stage))
            .map(move |stage| format!("{scene}/{stage}"))
    };
    SUITE.iter().flat_map(|s| of(s.name)).collect()
}

#[divan::bench(args = cases())]
fn stage(bencher: Bencher, case: &str) {
    let (scene, stage) = case.split_once('/').expect("scene/stage");
    prepared(scene).recorded(|mut recorded| {
        let items = recorded.run(stage);
        bencher
            .counter(ItemsCount::new(items))
            .bench_local(|| recorded.run(stage));
    });
}

/// A scene of the suite, made once.
fn prepared(name: &str) -> &'static Prepared {
    static ALL: OnceLock<Vec<Prepared>> = OnceLock::new();
    let make = |s| Prepared::new(s).expect("the suite's scenes can be made");
    let all = ALL.get_or_init(|| SUITE.iter().map(make).collect());
    let place = SUITE.iter().position(|s| s.name == name);
    &all[place.expect("a scene of the suite")]
}
