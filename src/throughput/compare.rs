//! What may be said about two sets of runs.
//!
//! Run `i` of one is set against run `i` of the other: the logarithm of the ratio of their costs (see
//! [`super`]) is one observation. From `n` of them follows Student's interval of the mean; all
//! quantities that are compared share one significance (Šidák), so that two sets of one program differ
//! anywhere with at most that probability, as far as runs are independent.
//!
//! They are not, quite: two sessions of one program differ by a few per cent in where the system put
//! its pages and who shared its caches. So a difference is only called one if the interval excludes
//! the *floor* as well, which is smaller where the runs of both took turns.

use super::measure::Run;
use crate::estimate::{Running, sidak, student_quantile};
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
    costs: Vec<f64>,
}

/// A scene's costs: the whole per sample, then each large stage per item.
fn series(scene: &str, runs: &[Run]) -> Vec<Series> {
    let whole = |r: &Run| r.cpu_seconds / r.samples.max(1) as f64 / r.yardstick_seconds;
    let mut all = vec![Series {
        name: scene.to_owned(),
        costs: runs.iter().map(whole).collect(),
    }];
    let stages = runs.first().map_or(&[][..], |r| &r.stages);
    for (i, stage) in stages.iter().enumerate() {
        if stage.share >= LARGE_STAGE {
            let cost = |r: &Run| Some(r.stages.get(i)?.nanoseconds / r.yardstick_seconds);
            all.push(Series {
                name: format!("{scene}: {}", stage.name),
                costs: runs.iter().filter_map(cost).collect(),
            });
        }
    }
    all
}

/// Compares the runs of each scene that both have: (scene, old runs, new runs).
#[must_use]
pub fn compare(scenes: &[(&str, &[Run], &[Run])], floor: f64) -> Vec<Comparison> {
    let pairs: Vec<(Series, Series)> = scenes
        .iter()
        .flat_map(|&(name, old, new)| {
            let new = series(name, new);
            let with = |o: Series| {
                let n = new.iter().find(|n| n.name == o.name)?;
                Some((o, n.clone()))
            };
            series(name, old)
                .into_iter()
                .filter_map(with)
                .collect::<Vec<_>>()
        })
        .collect();
    let each = sidak(SIGNIFICANCE, pairs.len().max(1));
    let one = |(old, new): &(Series, Series)| {
        compare_costs(&old.name, &old.costs, &new.costs, each, floor)
    };
    pairs.iter().map(one).collect()
}

fn compare_costs(
    name: &str,
    old: &[f64],
    new: &[f64],
    significance: f64,
    floor: f64,
) -> Comparison {
    let mut logs = Running::new();
    for (old, new) in old.iter().zip(new) {
        logs.push((new / old).ln());
    }
    let half = match logs.standard_error() {
        Some(error) => {
            error * student_quantile(1.0 - 0.5 * significance, logs.count().saturating_sub(1))
        }
        None => f64::INFINITY,
    };
    let interval = [logs.mean() - half, logs.mean() + half];
    let verdict = if interval[0] > floor.ln_1p() {
        Verdict::Slower
    } else if interval[1] < -floor.ln_1p() {
        Verdict::Faster
    } else {
        Verdict::NoDifference
    };
    Comparison {
        name: name.to_owned(),
        ratio: logs.mean().exp(),
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
        let mut rng = generator(&[seed]);
        (0..9)
            .map(|i| {
                let mut wobble = || 1.0 + noise * (points::uniform(&mut rng) - 0.5);
                let machine = 1.0 + 0.1 * f64::from(i);
                Run {
                    seconds: 9.0,
                    cpu_seconds: machine * wobble(),
                    yardstick_seconds: machine,
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

    #[test]
    fn one_program_against_itself_shows_no_difference() {
        let differs = |seed: &u64| {
            let (old, new) = (runs(2 * seed, 0.1, 1.0), runs(2 * seed + 1, 0.1, 1.0));
            let found = compare(&[("a", &old, &new)], 0.0);
            found.iter().any(|c| c.verdict != Verdict::NoDifference)
        };
        // At a significance of 1% more than 5 of 100 would be a chance of 1 in 1,900; and not all
        // noise may be called none.
        let wrong = (0..100).filter(differs).count();
        assert!((1..=5).contains(&wrong), "{wrong}");
    }

    #[test]
    fn a_stage_that_got_slower_is_named() {
        let (old, new) = (runs(1, 0.05, 1.0), runs(2, 0.05, 1.1));
        let found = compare(&[("a", &old, &new)], SESSIONS_FLOOR);
        let names: Vec<&str> = found.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["a", "a: intersect"], "small stages are left out");
        assert_eq!(found[0].verdict, Verdict::NoDifference);
        assert_eq!(found[1].verdict, Verdict::Slower);
        assert!(found[1].interval[0] < 1.1 && 1.1 < found[1].interval[1]);
        let back = compare(&[("a", &new, &old)], SESSIONS_FLOOR);
        assert_eq!(back[1].verdict, Verdict::Faster);
    }

    #[test]
    fn one_run_says_nothing() {
        let (old, new) = (runs(1, 0.05, 1.0), runs(2, 0.05, 5.0));
        let found = compare(&[("a", &old[..1], &new[..1])], 0.0);
        assert!(found.iter().all(|c| c.verdict == Verdict::NoDifference));
    }
}
