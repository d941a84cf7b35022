//! The study: every choice up the ladder, as far as the time allows.

use super::choices::word;
use super::measure::measure;
use super::{Choice, Cost, Family, ScenePoint, Stage, Target, Truth};
use crate::accuracy::{Curve, End, Ladder};
use crate::settings::{Sampler, Settings};
use serde::Serialize;

/// Relative errors whose cost is told, besides the goal.
const ERRORS: [f64; 6] = [0.2, 0.1, 0.05, 0.02, 0.01, 0.005];

/// Error against cost of one choice.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneCurve {
    /// Name, points and slope.
    #[serde(flatten)]
    pub curve: Curve<ScenePoint>,
    /// What the choice is about.
    pub family: Family,
    /// The options that make it.
    pub options: String,
    /// `1 / (squared error * seconds)` over that of the scene's own settings: the median at the last three
    /// rungs of both.
    pub efficiency: Option<f64>,
    /// Relative errors, falling, and what each costs.
    pub time_to_error: Vec<TimeToError>,
    /// Whether the time left did not suffice for the next rung.
    pub cut: bool,
}

/// What an error costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TimeToError {
    /// Root of the mean squared relative error.
    pub error: f64,
    /// What it takes.
    #[serde(flatten)]
    pub cost: Cost,
}

/// What a study of a scene found.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneStudy {
    /// One a choice, the scene's own settings first. Those without a point were not reached.
    pub curves: Vec<SceneCurve>,
    /// Whether it was stopped. A ladder that the time cuts short is [`End::Stopped`] too.
    pub end: End,
    /// What renders that end by their error come to, if that was asked for and found
    /// ([`super::meet_target`]).
    pub target: Option<Target>,
}

impl SceneStudy {
    /// The curves that have points.
    pub fn measured(&self) -> impl Iterator<Item = &SceneCurve> {
        self.curves.iter().filter(|c| !c.curve.points.is_empty())
    }
}

/// Runs every choice up the ladder of samples a pixel, a rung of all of them before the next. Before
/// each rung the choices that it would take longest for are left where they are, until the rest is
/// likely to fit into the time before the deadline less `reserve` seconds. `goal` is one more relative
/// error whose cost is told.
///
/// All but the seconds, and how far each choice gets, is a function of scene, choices, ladder and
/// reference. All renders are independent of each other.
///
/// # Panics
/// If there is no choice, the ladder starts at 0 samples or has fewer than two repetitions.
#[must_use]
pub fn study_scene(
    stage: &Stage,
    truth: &Truth,
    choices: &[Choice],
    ladder: &Ladder,
    goal: f64,
    reserve: impl Fn(&[SceneCurve]) -> f64,
) -> SceneStudy {
    assert!(!choices.is_empty() && ladder.first > 0 && ladder.repetitions > 1);
    let mut curves: Vec<SceneCurve> = choices.iter().map(SceneCurve::new).collect();
    let mut end = End::Complete;
    let all = (ladder.rungs().sum::<usize>() * choices.len()) as f64;
    let mut done = 0.0;
    'rungs: for (rung, samples) in ladder.rungs().enumerate() {
        if stage.control.deadline.get().is_some() {
            let left = stage.seconds_left() - reserve(&curves);
            cut(&mut curves, ladder.repetitions, left);
        }
        for (choice, curve) in choices.iter().zip(&mut curves) {
            if curve.cut {
                end = End::Stopped;
                continue;
            }
            let label = format!("{}, {samples} samples a pixel", choice.name);
            (stage.progress)(&label, done / all);
            let settings = Settings {
                spp: u32::try_from(samples).unwrap_or(u32::MAX),
                ..choice.settings.clone()
            };
            // By name: a choice has the same numbers whatever it is compared with.
            let name = blake3::hash(choice.name.as_bytes());
            let name = u64::from_le_bytes(std::array::from_fn(|i| name.as_bytes()[i]));
            let name = [u64::from(ladder.seed), name, rung as u64];
            let Some(point) = measure(stage, truth, &settings, name, ladder.repetitions) else {
                end = End::Stopped;
                break 'rungs;
            };
            curve.curve.points.push(point);
            done += samples as f64;
        }
    }
    for curve in &mut curves {
        curve.finish(goal);
    }
    let base = curves[0].clone();
    for curve in &mut curves {
        curve.efficiency = curve.efficiency_over(&base);
    }
    SceneStudy {
        curves,
        end,
        target: None,
    }
}

/// What a rung may take beyond what is foreseen, on a machine that does other things too.
const MARGIN: f64 = 1.2;

/// Cuts the dearest curves until the next rung of the others takes at most `left` seconds, if twice
/// the samples take twice the time and a margin.
fn cut(curves: &mut [SceneCurve], repetitions: u32, left: f64) {
    let next = |c: &SceneCurve| {
        let last = c.curve.points.last().map_or(0.0, |p| p.point.seconds);
        MARGIN * 2.0 * last * f64::from(repetitions)
    };
    loop {
        let going = curves.iter().filter(|c| !c.cut);
        if going.clone().map(next).sum::<f64>() <= left || going.count() == 0 {
            return;
        }
        let open = curves.iter_mut().filter(|c| !c.cut);
        if let Some(dearest) = open.max_by(|a, b| next(a).total_cmp(&next(b))) {
            dearest.cut = true;
        }
    }
}

impl SceneCurve {
    fn new(choice: &Choice) -> Self {
        // Where errors are independent of sample to sample, theory knows the slope; not where a
        // choice is biased.
        let independent = choice.settings.sampler == Sampler::Independent;
        let biased = matches!(choice.family, Family::Depth | Family::Textures);
        let slope = (independent && !biased).then_some(-0.5);
        Self {
            curve: Curve::new(&choice.name, &choice.what, slope),
            family: choice.family,
            options: choice.options.clone(),
            efficiency: None,
            time_to_error: Vec::new(),
            cut: false,
        }
    }

    fn finish(&mut self, goal: f64) {
        self.curve.finish();
        let mut errors: Vec<f64> = ERRORS.into_iter().chain([goal]).collect();
        errors.sort_by(|a, b| b.total_cmp(a));
        errors.dedup();
        let cost = |error: f64| TimeToError {
            error,
            cost: self.time_to(error),
        };
        self.time_to_error = errors.into_iter().map(cost).collect();
    }

    /// What the error costs, if it is among those told.
    #[must_use]
    pub fn cost_of(&self, error: f64) -> Cost {
        let found = self.time_to_error.iter().find(|t| t.error == error);
        found.map_or(Cost::Unknown, |t| t.cost)
    }

    /// The family as the command line says it.
    #[must_use]
    pub fn family_name(&self) -> String {
        match self.family {
            Family::Base => self.family.name(),
            other => word(&other),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::accuracy::Point;

    /// A curve through (seconds, rmse, squared bias), the latter beyond doubt if it is not 0.
    pub(in crate::accuracy) fn curve(
        points: impl IntoIterator<Item = (f64, f64, f64)>,
    ) -> SceneCurve {
        let points = points.into_iter().enumerate();
        let points = points.map(|(k, (seconds, rmse, bias_squared))| ScenePoint {
            point: Point {
                samples: 1 << k,
                seconds,
                rmse,
                bias: 0.0,
                bias_error: 0.0,
            },
            error: rmse,
            error_error: 0.0,
            rays: Some(1),
            variance: rmse * rmse - bias_squared,
            bias_squared,
            bias_squared_error: 0.0,
            flip: None,
        });
        SceneCurve {
            curve: Curve {
                points: points.collect(),
                ..Curve::new("a", "b", None)
            },
            family: Family::Base,
            options: String::new(),
            efficiency: None,
            time_to_error: Vec::new(),
            cut: false,
        }
    }

    #[test]
    fn the_dearest_are_cut_until_the_rest_fits() {
        let costs = [1.0, 50.0, 3.0, 20.0];
        let made = |left: f64| {
            let mut curves: Vec<SceneCurve> =
                costs.iter().map(|&s| curve([(s, 0.1, 0.0)])).collect();
            cut(&mut curves, 2, left);
            curves.iter().map(|c| c.cut).collect::<Vec<_>>()
        };
        // Twice the time, twice, and the margin.
        assert_eq!(made(MARGIN * 4.0 * 74.1), [false; 4]);
        assert_eq!(made(MARGIN * 4.0 * 73.0), [false, true, false, false]);
        assert_eq!(made(MARGIN * 4.0 * 23.0), [false, true, false, true]);
        assert_eq!(made(MARGIN * 3.9), [true; 4]);
    }
}
