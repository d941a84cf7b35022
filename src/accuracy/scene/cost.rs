//! What an error costs: time to reach it, and efficiency.

use super::{SceneCurve, ScenePoint};
use crate::accuracy::log_log;
use serde::Serialize;

/// Time to an error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(into = "Fields")]
pub enum Cost {
    /// So many seconds, by interpolation between two rungs.
    Measured(f64),
    /// So many seconds, by the line through the last rungs' errors (or, below the ladder, the first's)
    /// and a sample's time there.
    Extrapolated(f64),
    /// Never: this much error stays, whatever the time.
    Never(f64),
    /// Too little is known.
    Unknown,
}

/// A cost as numbers: null for what there is not.
#[derive(Serialize)]
struct Fields {
    seconds: Option<f64>,
    /// Whether the seconds lie on the ladder.
    measured: bool,
    /// The error that stays, where it is above what was asked for.
    floor: Option<f64>,
}

impl From<Cost> for Fields {
    fn from(cost: Cost) -> Self {
        Self {
            seconds: cost.seconds(),
            measured: matches!(cost, Cost::Measured(_)),
            floor: match cost {
                Cost::Never(floor) => Some(floor),
                _ => None,
            },
        }
    }
}

impl Cost {
    /// The seconds, if there are any.
    #[must_use]
    pub fn seconds(self) -> Option<f64> {
        match self {
            Self::Measured(s) | Self::Extrapolated(s) => Some(s),
            Self::Never(_) | Self::Unknown => None,
        }
    }
}

/// Rungs that a line to the outside goes through.
const LINE: usize = 4;

/// Rungs that an efficiency is the median of.
const LAST: usize = 3;

impl SceneCurve {
    /// The bias that stays, as a relative error: 0 if none is beyond doubt.
    #[must_use]
    pub fn bias(&self) -> f64 {
        let last = self.curve.points.last();
        last.map_or(0.0, |p| p.believed_bias_squared().sqrt())
    }

    /// Time until the relative error is `error`: of the two parts of its square, the bias stays, and the
    /// rest falls along the measured points.
    #[must_use]
    pub fn time_to(&self, error: f64) -> Cost {
        let floor = self.bias();
        // What noise may still add.
        let goal = error * error - floor * floor;
        if goal <= 0.0 {
            return Cost::Never(floor);
        }
        let goal = goal.sqrt();
        let noise = |p: &ScenePoint| (p.error.powi(2) - floor * floor).max(0.0).sqrt();
        let points: Vec<[f64; 3]> = self
            .curve
            .points
            .iter()
            .map(|p| [p.point.samples as f64, noise(p), p.point.seconds])
            .filter(|p| p.iter().all(|v| *v > 0.0))
            .collect();
        let (line, outside) = match points.iter().position(|p| p[1] <= goal) {
            Some(0) => (&points[..points.len().min(LINE)], true),
            Some(at) => (&points[at - 1..=at], false),
            None => (&points[points.len().saturating_sub(LINE)..], true),
        };
        // In samples first: their number is exact, where times scatter with whatever else runs.
        let samples = log_log(line.iter().map(|p| (p[0], p[1])));
        let samples = samples
            .filter(|fit| fit.slope < 0.0)
            .map(|fit| fit.x_at(goal));
        match (samples, line) {
            (Some(n), [first, .., last]) if n.is_finite() => {
                let seconds = |p: &[f64; 3]| n * p[2] / p[0];
                if outside {
                    Cost::Extrapolated(seconds(if n < first[0] { first } else { last }))
                } else {
                    // Between the two rungs' times for a sample.
                    let share = (n / first[0]).ln() / (last[0] / first[0]).ln();
                    let [from, to] = [first, last].map(|p| seconds(p).ln());
                    Cost::Measured((from + share * (to - from)).exp())
                }
            }
            _ => Cost::Unknown,
        }
    }

    /// `1 / (squared error * seconds)` over that of `base`: the median of that at the last rungs that both
    /// reached, so that one render with a very bright path does not decide it.
    #[must_use]
    pub(super) fn efficiency_over(&self, base: &Self) -> Option<f64> {
        let cost = |p: &ScenePoint| p.error * p.error * p.point.seconds;
        let both = base.curve.points.iter().zip(&self.curve.points);
        let ratios = both.map(|(base, own)| cost(base) / cost(own));
        let ratios: Vec<f64> = ratios.collect();
        let mut last = ratios[ratios.len().saturating_sub(LAST)..].to_vec();
        last.retain(|r| r.is_finite() && *r > 0.0);
        last.sort_by(f64::total_cmp);
        let middle = [last.len().checked_sub(1)? / 2, last.len() / 2];
        // Of two in the middle, the geometric mean.
        Some((last[middle[0]] * last[middle[1]]).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::scene::study::tests::curve;

    /// Two parts: a bias of 0.03, and noise of 0.4 / sqrt(seconds).
    fn biased() -> SceneCurve {
        let noise = |t: f64| 0.4 / t.sqrt();
        curve((0..6).map(|k| {
            let t = f64::from(1 << k);
            (t, (noise(t).powi(2) + 0.0009).sqrt(), 0.0009)
        }))
    }

    #[test]
    fn noise_falls_and_bias_stays() {
        let curve = biased();
        // sqrt(0.05^2 - 0.03^2) = 0.04 = 0.4 / sqrt(100): beyond the ladder of 32 s.
        let Cost::Extrapolated(s) = curve.time_to(0.05) else {
            panic!("beyond the ladder")
        };
        // The points lie on the line, to some roundings of logarithms.
        assert!((s / 100.0 - 1.0).abs() < 1e-9, "{s}");
        assert!(matches!(curve.time_to(0.5), Cost::Extrapolated(s) if s < 1.0));
        let Cost::Measured(s) = curve.time_to((0.01f64 + 0.0009).sqrt()) else {
            panic!("on the ladder")
        };
        assert!((s / 16.0 - 1.0).abs() < 1e-9, "{s}");
        assert_eq!(curve.time_to(0.02), Cost::Never(0.0009f64.sqrt()));
    }

    #[test]
    fn one_point_says_little() {
        assert_eq!(curve([(1.0, 0.1, 0.0)]).time_to(0.01), Cost::Unknown);
        assert_eq!(curve([]).time_to(0.01), Cost::Unknown);
    }

    #[test]
    fn efficiency_compares_the_same_rung() {
        let base = curve([(1.0, 0.4, 0.0), (2.0, 0.2, 0.0), (4.0, 0.1, 0.0)]);
        let half = curve([(2.0, 0.4, 0.0), (4.0, 0.2, 0.0)]);
        assert_eq!(half.efficiency_over(&base), Some(0.5));
        assert_eq!(base.efficiency_over(&base), Some(1.0));
        assert_eq!(curve([]).efficiency_over(&base), None);
        // A firefly in the last rung is no news of the choice.
        let lucky = curve([(1.0, 0.4, 0.0), (2.0, 0.2, 0.0), (4.0, 5.0, 0.0)]);
        assert_eq!(lucky.efficiency_over(&base), Some(1.0));
    }
}
