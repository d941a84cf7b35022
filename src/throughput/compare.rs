//! What may be said about two sets of runs.
//!
//! What is compared are logarithms of costs (see [`super`]). Where the runs of both *took turns*, run `i` of
//! one is set against run `i` of the other: each difference is an observation, and from `n` of them follows
//! Student's interval of their mean. Where they are two *sessions*, runs of the same number have nothing in
//! common, and the interval is that of the difference of two means by Welch (1947), whose sets need
//! neither the same size nor the same spread. Means are trimmed ones where there are a dozen rounds (Yuen
//! 1974), since now and then something else takes the machine for a while. All quantities that are compared share one significance
//! (Šidák), so that two sets of one program differ anywhere with at most that probability, as far as runs
//! are independent.
//!
//! They are not, quite: who shares caches and memory differs from one quarter of an hour to the next. So a
//! difference is only called one if the interval excludes the *floor* as well, which is smaller where the
//! runs of both took turns, and larger where memory became slower or faster in between.

use super::difference::Difference;
use super::measure::Run;
use crate::estimate::sidak;
use serde::{Deserialize, Serialize};

/// Probability of finding any difference between two sets of one program.
pub const SIGNIFICANCE: f64 = 0.01;
/// Smallest relative difference that counts between runs that took turns.
pub const TURNS_FLOOR: f64 = 0.01;
/// Smallest relative difference that counts between two sessions.
pub const SESSIONS_FLOOR: f64 = 0.04;
/// Share of a run from which on a stage is compared by itself.
const LARGE_STAGE: f64 = 0.05;

/// What is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The new one is faster.
    Faster,
    /// The new one is slower.
    Slower,
    /// Nothing can be said.
    NoDifference,
}

/// A scene's name, its old runs and its new ones.
pub type Scene<'a> = (&'a str, &'a [Run], &'a [Run]);

/// How two sets of runs came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounds {
    /// One of each, again and again.
    InTurns,
    /// All of one, and at another time all of the other.
    InSessions,
}

/// One quantity of both sets.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// What: a scene, or a scene's stage.
    pub name: String,
    /// Time of the new over that of the old: above 1, the new one is slower.
    pub ratio: f64,
    /// Interval of the ratio, at the shared significance.
    pub interval: [f64; 2],
    /// What is said.
    pub verdict: Verdict,
}

/// Costs of one quantity, run by run.
#[derive(Clone, Debug)]
struct Series {
    name: String,
    /// The stage's name; none for the whole.
    stage: Option<String>,
    costs: Vec<f64>,
}

/// A scene's costs: the whole per sample, then each large stage per item.
fn series(scene: &str, runs: &[Run]) -> Vec<Series> {
    let whole = |r: &Run| r.cpu_seconds / r.samples.max(1) as f64 / r.yardstick_seconds;
    let mut all = vec![Series {
        name: scene.to_owned(),
        stage: None,
        costs: runs.iter().map(whole).collect(),
    }];
    let stages = runs.first().map_or(&[][..], |r| &r.stages);
    for (i, stage) in stages.iter().enumerate() {
        let cost = |r: &Run| Some(r.stages.get(i)?.nanoseconds / r.yardstick_seconds);
        all.push(Series {
            name: format!("{scene}: {}", stage.name),
            stage: Some(stage.name.clone()),
            costs: runs.iter().filter_map(cost).collect(),
        });
    }
    all
}

/// Whether the stage takes a large share of these runs, on average; the whole does.
fn is_large(stage: Option<&str>, runs: &[Run]) -> bool {
    let Some(name) = stage else { return true };
    let share = |r: &Run| Some(r.stages.iter().find(|s| s.name == name)?.share);
    let shares = runs.iter().filter_map(share);
    shares.sum::<f64>() >= LARGE_STAGE * runs.len() as f64
}

/// The same quantity of several scenes as one, which noise of single scenes moves less: run by run, the
/// geometric mean of its costs.
fn all_scenes<'a>(of: impl Iterator<Item = &'a Series>) -> Series {
    let of: Vec<&Series> = of.collect();
    let runs = of.iter().map(|s| s.costs.len()).min().unwrap_or(0);
    let stage = of.first().and_then(|s| s.stage.clone());
    let mean = |run: usize| {
        let logs = of.iter().map(|s| s.costs[run].ln());
        (logs.sum::<f64>() / of.len() as f64).exp()
    };
    Series {
        name: match &stage {
            Some(stage) => format!("all scenes: {stage}"),
            None => "all scenes".to_owned(),
        },
        stage,
        costs: (0..runs).map(mean).collect(),
    }
}

/// Compares the runs of each scene that both have: (scene, old runs, new runs); and what several scenes
/// have in common over all of them. Of the stages, those that take a large share of the old runs.
#[must_use]
pub fn compare(scenes: &[Scene], rounds: Rounds, floor: f64) -> Vec<Comparison> {
    let mut pairs: Vec<(Series, Series)> = scenes
        .iter()
        .flat_map(|&(name, old, new)| {
            let new = series(name, new);
            let with = |o: Series| {
                let n = new.iter().find(|n| n.name == o.name)?;
                Some((o, n.clone()))
            };
            series(name, old)
                .into_iter()
                .filter(|o| is_large(o.stage.as_deref(), old))
                .filter_map(with)
                .collect::<Vec<_>>()
        })
        .collect();
    let mut common: Vec<Option<String>> = Vec::new();
    for (old, _) in &pairs {
        let several = pairs.iter().filter(|p| p.0.stage == old.stage).count() > 1;
        if several && !common.contains(&old.stage) {
            common.push(old.stage.clone());
        }
    }
    let of = |stage: &Option<String>| {
        let same = || pairs.iter().filter(|p| p.0.stage == *stage);
        (
            all_scenes(same().map(|p| &p.0)),
            all_scenes(same().map(|p| &p.1)),
        )
    };
    let common: Vec<(Series, Series)> = common.iter().map(of).collect();
    pairs.extend(common);
    let each = sidak(SIGNIFICANCE, pairs.len().max(1));
    let one = |(old, new): &(Series, Series)| {
        compare_costs(&old.name, [&old.costs, &new.costs], rounds, each, floor)
    };
    pairs.iter().map(one).collect()
}

/// By how much memory may have become slower or faster, against the yardstick, from the old session to the
/// new, at most with the shared significance: relative, 0 where the old runs do not tell. No smaller
/// difference between two sessions need be the program's.
#[must_use]
pub fn memory_change(scenes: &[Scene]) -> f64 {
    // Over all scenes: round by round, the mean.
    let latencies = |set: Vec<&[Run]>| {
        let latency = |run: &Run| (run.memory_seconds / run.yardstick_seconds).ln();
        let rounds = set.iter().map(|runs| runs.len()).min().unwrap_or(0);
        let mean =
            |round| set.iter().map(|runs| latency(&runs[round])).sum::<f64>() / set.len() as f64;
        (0..rounds).map(mean).collect::<Vec<f64>>()
    };
    let old = latencies(scenes.iter().map(|s| s.1).collect());
    let new = latencies(scenes.iter().map(|s| s.2).collect());
    let difference = Difference::of_sessions(&old, &new);
    // One run tells no interval, and then no verdict needs a floor.
    let half = difference.half_interval(SIGNIFICANCE);
    let most = difference.mean.abs() + if half.is_finite() { half } else { 0.0 };
    if most.is_finite() { most.exp_m1() } else { 0.0 }
}

/// Compares the costs of one quantity, old and new, at a significance of its own.
#[must_use]
pub fn compare_costs(
    name: &str,
    costs: [&[f64]; 2],
    rounds: Rounds,
    significance: f64,
    floor: f64,
) -> Comparison {
    let [old, new] = costs.map(|set| set.iter().map(|c| c.ln()).collect::<Vec<f64>>());
    let of = match rounds {
        Rounds::InTurns => Difference::of_turns(&old, &new),
        Rounds::InSessions => Difference::of_sessions(&old, &new),
    };
    let half = of.half_interval(significance);
    let interval = [of.mean - half, of.mean + half];
    let verdict = if interval[0] > floor.ln_1p() {
        Verdict::Slower
    } else if interval[1] < -floor.ln_1p() {
        Verdict::Faster
    } else {
        Verdict::NoDifference
    };
    Comparison {
        name: name.to_owned(),
        ratio: of.mean.exp(),
        interval: interval.map(f64::exp),
        verdict,
    }
}

#[cfg(test)]
mod tests {
    use super::super::measure::StageTime;
    use super::*;
    use crate::estimate::{generator, points};

    /// Runs whose costs vary by `noise` about 1 (and of the stage by `stage`), on a machine that drifts.
    fn runs(seed: u64, noise: f64, stage: f64) -> Vec<Run> {
        so_many(9, seed, noise, stage, 1.0)
    }

    /// So many, where memory is so many times slower.
    fn so_many(count: u32, seed: u64, noise: f64, stage: f64, memory: f64) -> Vec<Run> {
        let mut rng = generator(&[seed]);
        (0..count)
            .map(|i| {
                let mut wobble = || 1.0 + noise * (points::uniform(&mut rng) - 0.5);
                let machine = 1.0 + 0.1 * f64::from(i);
                Run {
                    seconds: 9.0,
                    cpu_seconds: machine * wobble(),
                    yardstick_seconds: machine,
                    memory_seconds: 2.0 * machine * memory,
                    workers: 1,
                    worker_seconds: 9.0,
                    samples: 1000,
                    camera_rays: 1000,
                    bounce_rays: 0,
                    shadow_rays: 0,
                    stages: vec![
                        StageTime {
                            name: "intersect".into(),
                            nanoseconds: 100.0 * machine * stage * wobble(),
                            share: 0.9,
                        },
                        StageTime {
                            name: "sort".into(),
                            nanoseconds: machine,
                            share: 0.01,
                        },
                    ],
                }
            })
            .collect()
    }

    const BOTH: [Rounds; 2] = [Rounds::InTurns, Rounds::InSessions];

    #[test]
    fn one_program_against_itself_shows_no_difference() {
        // With few rounds, and with enough for some to be left out.
        for (rounds, count) in BOTH.into_iter().flat_map(|r| [(r, 9), (r, 18)]) {
            let differs = |seed: &u64| {
                let [old, new] = [0, 1].map(|i| so_many(count, 2 * seed + i, 0.1, 1.0, 1.0));
                let found = compare(&[("a", &old, &new)], rounds, 0.0);
                found.iter().any(|c| c.verdict != Verdict::NoDifference)
            };
            // At a significance of 1%, 800 have 8 on average, and 2 to 16 but for a chance of 1 in 200:
            // not all noise may be called none.
            let wrong = (0..800).filter(differs).count();
            assert!((2..=16).contains(&wrong), "{rounds:?}: {wrong}");
        }
    }

    #[test]
    fn a_round_in_which_something_else_took_the_machine_counts_for_little() {
        let (old, mut new) = (
            so_many(18, 1, 0.05, 1.0, 1.0),
            so_many(18, 2, 0.05, 1.1, 1.0),
        );
        let names_it = |new: &[Run], rounds| {
            let found = compare(&[("a", &old, new)], rounds, SESSIONS_FLOOR);
            found[1].name == "a: intersect" && found[1].verdict == Verdict::Slower
        };
        new[4].stages[0].nanoseconds *= 3.0;
        for rounds in BOTH {
            assert!(names_it(&new, rounds), "{rounds:?}");
            assert!(
                !names_it(&new[..11], rounds),
                "{rounds:?}: too few to leave any out"
            );
        }
    }

    #[test]
    fn a_stage_that_got_slower_is_named() {
        for rounds in BOTH {
            let (old, new) = (runs(1, 0.05, 1.0), runs(2, 0.05, 1.1));
            let found = compare(&[("a", &old, &new)], rounds, SESSIONS_FLOOR);
            let names: Vec<&str> = found.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, ["a", "a: intersect"], "small stages are left out");
            assert_eq!(found[0].verdict, Verdict::NoDifference);
            assert_eq!(found[1].verdict, Verdict::Slower);
            assert!(found[1].interval[0] < 1.1 && 1.1 < found[1].interval[1]);
            let back = compare(&[("a", &new, &old)], rounds, SESSIONS_FLOOR);
            assert_eq!(back[1].verdict, Verdict::Faster);
        }
    }

    #[test]
    fn what_no_scene_shows_by_itself_all_of_them_may() {
        let scenes: Vec<_> = (0..8)
            .map(|i| (runs(2 * i, 0.1, 1.0), runs(2 * i + 1, 0.1, 1.1)))
            .collect();
        let names = ["a", "b", "c", "d", "e", "f", "g", "h"];
        let scenes = names.into_iter().zip(&scenes);
        let scenes: Vec<_> = scenes
            .map(|(n, (old, new))| (n, &old[..], &new[..]))
            .collect();
        let found = compare(&scenes, Rounds::InTurns, SESSIONS_FLOOR);
        assert_eq!(found.len(), 18);
        let verdict = |name: &str| {
            let of = found.iter().find(|c| c.name == name);
            of.expect("compared").verdict
        };
        assert_eq!(verdict("all scenes"), Verdict::NoDifference);
        assert_eq!(verdict("all scenes: intersect"), Verdict::Slower);
        let alone = found.iter().filter(|c| c.name.len() < 14);
        assert!(alone.clone().count() > 8);
        let shown = alone.filter(|c| c.verdict == Verdict::Slower).count();
        assert!(shown < 8, "one scene alone mostly shows nothing");
    }

    #[test]
    fn memory_that_got_slower_is_seen_whatever_the_processor_does() {
        let old = runs(1, 0.05, 1.0);
        let change = |new: &[Run]| memory_change(&[("a", &old, new), ("b", &old, new)]);
        // A few roundings.
        assert!(change(&runs(2, 0.05, 1.0)) < 1e-12);
        for memory in [1.2, 1.0 / 1.2] {
            let seen = change(&so_many(9, 3, 0.05, 1.0, memory));
            assert!((seen - 0.2).abs() < 1e-12, "{seen}");
        }
        let mut unknown = old.clone();
        unknown.iter_mut().for_each(|r| r.memory_seconds = 0.0);
        assert_eq!(memory_change(&[("a", &unknown, &old)]), 0.0);
    }

    #[test]
    fn one_run_says_nothing() {
        let (old, new) = (runs(1, 0.05, 1.0), runs(2, 0.05, 5.0));
        for rounds in BOTH {
            let found = compare(&[("a", &old[..1], &new[..1])], rounds, 0.0);
            assert!(found.iter().all(|c| c.verdict == Verdict::NoDifference));
        }
    }
}
