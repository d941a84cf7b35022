//! The study: every estimator of a problem, up a ladder of samples, several times over.

use super::fit::{Fit, log_log};
use super::targets::{Method, Problem};
use crate::estimate::{Running, generator};
use serde::Serialize;
use std::time::Instant;

/// Level of the intervals in studies.
pub const LEVEL: f64 = 0.95;

/// Which numbers of samples are tried, how often, and with which random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ladder {
    /// Samples of the first rung.
    pub first: usize,
    /// Most samples of the last rung; each rung has twice those of the one before.
    pub last: usize,
    /// Independent estimates at each rung. The error is known to one part in `sqrt(2 repetitions)`.
    pub repetitions: u32,
    /// Seed of the random numbers.
    pub seed: u32,
}

impl Default for Ladder {
    /// From 64 to 262144 samples, 64 times, seed 0.
    fn default() -> Self {
        Self {
            first: 64,
            last: 1 << 18,
            repetitions: 64,
            seed: 0,
        }
    }
}

impl Ladder {
    /// The numbers of samples, rising; at least the first.
    pub fn rungs(&self) -> impl Iterator<Item = usize> {
        let last = self.last;
        let double = move |n: &usize| n.checked_mul(2).filter(|&n| n <= last);
        std::iter::successors(Some(self.first), double)
    }
}

/// What a study found.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// One an estimator, in the problem's order, all with the same number of points.
    pub curves: Vec<Curve>,
    /// Whether it got to the end of its ladder.
    pub end: End,
}

/// How a study ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// At the end of the ladder.
    Complete,
    /// It was told to stop; points are missing, but those that are there are whole.
    Stopped,
}

/// Error against cost of one estimator; `P` is what is known of a rung.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve<P = Point> {
    /// The estimator.
    pub name: String,
    /// What it does, in a line.
    pub what: String,
    /// By rising number of samples.
    pub points: Vec<P>,
    /// The power of the samples that the error goes with, fitted; none of fewer than two points.
    pub slope: Option<f64>,
    /// Its interval, at level [`LEVEL`]; none of fewer than three points.
    pub slope_interval: Option<[f64; 2]>,
    /// What theory says of it, for many samples.
    pub expected_slope: Option<f64>,
}

/// One rung of one estimator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Samples of one estimate. Stratified in `d` dimensions: the `d`-th power next to the rung's.
    pub samples: u64,
    /// Wall-clock seconds of one estimate: the median over the repetitions, which an interruption by
    /// other programs does not reach.
    pub seconds: f64,
    /// Root of the mean squared error over the repetitions.
    pub rmse: f64,
    /// Mean error over the repetitions.
    pub bias: f64,
    /// Standard error of that mean.
    pub bias_error: f64,
}

/// What a curve is fitted through.
pub trait Rung {
    /// Samples of an estimate, and its error.
    fn samples_and_error(&self) -> (f64, f64);
}

impl Rung for Point {
    fn samples_and_error(&self) -> (f64, f64) {
        (self.samples as f64, self.rmse)
    }
}

impl<P: Rung> Curve<P> {
    /// A curve with nothing on it yet. `expected_slope` is the power of the samples that the error is
    /// known to go with, if it is.
    #[must_use]
    pub fn new(name: &str, what: &str, expected_slope: Option<f64>) -> Self {
        Self {
            name: name.into(),
            what: what.into(),
            points: Vec::new(),
            slope: None,
            slope_interval: None,
            expected_slope,
        }
    }

    /// The line through its error against samples.
    #[must_use]
    pub fn fit(&self) -> Option<Fit> {
        log_log(self.points.iter().map(Rung::samples_and_error))
    }

    pub(super) fn finish(&mut self) {
        let fit = self.fit();
        self.slope = fit.map(|f| f.slope);
        self.slope_interval = fit.and_then(|f| f.slope_interval(LEVEL));
    }
}

/// Runs every method of `problem` up the ladder, rung by rung, on the calling thread. Before each
/// estimate `go_on` is asked; a rung that it cuts is left out, of all methods.
///
/// All but the seconds is a function of problem, seed, rung and repetition: a longer ladder has the
/// same points where both have them. The repetitions of a rung, and the rungs, are independent.
///
/// # Panics
/// If the ladder starts at 0 samples or has fewer than two repetitions.
#[must_use]
pub fn study(problem: &Problem, ladder: &Ladder, mut go_on: impl FnMut() -> bool) -> Study {
    assert!(ladder.first > 0 && ladder.repetitions > 1, "{ladder:?}");
    let mut study = Study {
        curves: problem.methods.iter().map(Method::curve).collect(),
        end: End::Complete,
    };
    for (rung, samples) in ladder.rungs().enumerate() {
        let mut row = Vec::new();
        for (index, method) in problem.methods.iter().enumerate() {
            let name = [u64::from(ladder.seed), index as u64, rung as u64];
            let Some(point) = measure(problem.exact, method, samples, name, ladder, &mut go_on)
            else {
                study.end = End::Stopped;
                break;
            };
            row.push(point);
        }
        if study.end == End::Stopped {
            break;
        }
        for (curve, point) in study.curves.iter_mut().zip(row) {
            curve.points.push(point);
        }
    }
    study.curves.iter_mut().for_each(Curve::finish);
    study
}

/// One point of a curve; none if told to stop.
fn measure(
    exact: f64,
    method: &Method,
    samples: usize,
    [seed, index, rung]: [u64; 3],
    ladder: &Ladder,
    go_on: &mut impl FnMut() -> bool,
) -> Option<Point> {
    let (mut errors, mut squares) = (Running::new(), Running::new());
    let mut seconds = Vec::new();
    let mut taken = 0;
    for repetition in 0..ladder.repetitions {
        if !go_on() {
            return None;
        }
        let start = Instant::now();
        let mut rng = generator(&[seed, index, rung, u64::from(repetition)]);
        let estimate = (method.estimate)(&mut rng, samples);
        seconds.push(start.elapsed().as_secs_f64());
        taken = estimate.samples;
        let error = estimate.value - exact;
        errors.push(error);
        squares.push(error * error);
    }
    Some(Point {
        samples: taken as u64,
        seconds: median(&mut seconds),
        rmse: squares.mean().sqrt(),
        bias: errors.mean(),
        bias_error: errors.standard_error().expect("two repetitions at least"),
    })
}

pub(super) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    0.5 * (values[(values.len() - 1) / 2] + values[middle])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::Target;

    fn ladder(last: usize) -> Ladder {
        Ladder {
            last,
            repetitions: 8,
            ..Ladder::default()
        }
    }

    fn without_seconds(mut study: Study) -> Study {
        let points = study.curves.iter_mut().flat_map(|c| &mut c.points);
        points.for_each(|p| p.seconds = 0.0);
        study
    }

    #[test]
    fn medians() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 100.0]), 3.0);
    }

    #[test]
    fn rungs_double_up_to_the_last() {
        let rungs = |first, last| -> Vec<usize> {
            let ladder = Ladder {
                first,
                last,
                ..ladder(0)
            };
            ladder.rungs().collect()
        };
        assert_eq!(rungs(64, 256), [64, 128, 256]);
        assert_eq!(rungs(64, 511), [64, 128, 256]);
        assert_eq!(rungs(64, 1), [64]);
        assert_eq!(rungs(1 << (usize::BITS - 1), usize::MAX).len(), 1);
    }

    #[test]
    fn all_but_the_seconds_is_a_function_of_the_seed() {
        for target in Target::ALL {
            let run = |seed| {
                let ladder = Ladder {
                    seed,
                    ..ladder(256)
                };
                without_seconds(study(&target.problem(), &ladder, || true))
            };
            assert_eq!(run(3), run(3));
            for (a, b) in run(3).curves.iter().zip(&run(4).curves) {
                for (a, b) in a.points.iter().zip(&b.points) {
                    assert_ne!(a.rmse, b.rmse);
                }
            }
        }
    }

    #[test]
    fn a_study_that_is_stopped_has_whole_rungs_and_they_are_those_of_a_full_one() {
        let problem = Target::Pi.problem();
        let full = without_seconds(study(&problem, &ladder(1024), || true));
        assert_eq!(full.end, End::Complete);
        for budget in [0, 1, 8 * 3, 8 * 3 + 5, 8 * 9] {
            let mut left = budget;
            let cut = study(&problem, &ladder(1024), || {
                left -= 1;
                left >= 0
            });
            assert_eq!(cut.end, End::Stopped);
            let rungs = budget as usize / (8 * problem.methods.len());
            for (cut, full) in without_seconds(cut).curves.iter().zip(&full.curves) {
                assert_eq!(cut.points, full.points[..rungs]);
                assert_eq!(cut.slope.is_some(), rungs >= 2);
                assert_eq!(cut.slope_interval.is_some(), rungs >= 3);
            }
        }
    }
}
