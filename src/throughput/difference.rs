//! Differences of means of what was observed in turns, or at different times.

use crate::estimate::{Running, student_quantile};

/// The mean of what was observed but for the lowest and highest fifths, where there are enough: a round in which
/// something else took the machine is far off, and would widen an interval more than it tells.
struct Trimmed {
    mean: f64,
    /// Square of its standard error; none where there are too few.
    variance: Option<f64>,
    /// Degrees of freedom of that.
    freedom: u64,
}

/// Observations from which on some are left out: of fewer, their degrees of freedom are worth more.
const ENOUGH: usize = 12;
/// One in so many at each end.
const TRIMMED: usize = 5;

impl Trimmed {
    /// K. Yuen, "The Two-Sample Trimmed t for Unequal Population Variances" (Biometrika 61, 1974): the variance is
    /// that of all with those that are left out moved to the ends of what is kept.
    fn new(mut observed: Vec<f64>) -> Self {
        observed.sort_unstable_by(f64::total_cmp);
        let len = observed.len();
        let out = if len < ENOUGH { 0 } else { len / TRIMMED };
        let kept = &observed[out..len - out];
        let mean: Running = kept.iter().copied().collect();
        let mut moved = mean;
        for _ in 0..out {
            moved.extend([kept[0], kept[kept.len() - 1]]);
        }
        let freedom = kept.len().saturating_sub(1);
        let variance = moved
            .variance()
            .map(|v| v * (len - 1) as f64 / (kept.len() * freedom) as f64);
        Self {
            mean: mean.mean(),
            variance,
            freedom: freedom as u64,
        }
    }
}

/// A difference of means: of the new less that of the old.
pub(super) struct Difference {
    pub(super) mean: f64,
    /// Its standard error; none where there are too few.
    error: Option<f64>,
    /// Degrees of freedom of that.
    freedom: u64,
}

impl Difference {
    /// Of what was observed in turns: old and new of the same number belong together.
    pub(super) fn of_turns(old: &[f64], new: &[f64]) -> Self {
        let differences = old.iter().zip(new).map(|(old, new)| new - old);
        let of = Trimmed::new(differences.collect());
        Self {
            mean: of.mean,
            error: of.variance.map(f64::sqrt),
            freedom: of.freedom,
        }
    }

    /// Of what was observed at different times: Welch's standard error, and the degrees of freedom by
    /// Welch and Satterthwaite, rounded down.
    pub(super) fn of_sessions(old: &[f64], new: &[f64]) -> Self {
        let [old, new] = [old, new].map(|set| Trimmed::new(set.to_vec()));
        let mean = new.mean - old.mean;
        let (Some(a), Some(b)) = (old.variance, new.variance) else {
            return Self {
                mean,
                error: None,
                freedom: 0,
            };
        };
        let freedom = (a + b).powi(2) / (a * a / old.freedom as f64 + b * b / new.freedom as f64);
        Self {
            mean,
            error: Some((a + b).sqrt()),
            // None varies: then the interval is a point, whatever they are.
            freedom: if freedom.is_finite() {
                freedom as u64
            } else {
                1
            },
        }
    }

    /// By how much it may be off; infinite where there are too few.
    pub(super) fn half_interval(&self, significance: f64) -> f64 {
        self.error.map_or(f64::INFINITY, |error| {
            error * student_quantile(1.0 - 0.5 * significance, self.freedom)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What moves both alike is no noise where they took turns, and is in sessions, whose sets may differ in
    /// size; Welch's example by hand: 1, 2, 3 against 3, 5.
    #[test]
    fn turns_belong_together_and_sessions_do_not() {
        let (old, new) = ([1.0, 5.0, 9.0], [2.0, 6.0, 10.0]);
        let turns = Difference::of_turns(&old, &new);
        assert_eq!(
            (turns.mean, turns.error, turns.freedom),
            (1.0, Some(0.0), 2)
        );
        let sessions = Difference::of_sessions(&old, &new);
        assert_eq!((sessions.mean, sessions.freedom), (1.0, 4));
        assert!((sessions.error.unwrap() - (32.0_f64 / 3.0).sqrt()).abs() < 1e-14);
        // Variances of the means 1/3 and 1: (4/3)^2 / (1/18 + 1) = 1.68 degrees of freedom.
        let other = Difference::of_sessions(&[1.0, 2.0, 3.0], &[3.0, 5.0]);
        assert_eq!((other.mean, other.freedom), (2.0, 1));
        assert!((other.error.unwrap() - (4.0_f64 / 3.0).sqrt()).abs() < 1e-14);
    }

    /// Yuen's numbers by hand: of fifteen, three at each end move to the next; nine are left.
    #[test]
    fn trimmed_means_leave_the_ends_out() {
        let values: Vec<f64> = (0..15).map(|i| f64::from(i * i)).collect();
        let of = Trimmed::new(values);
        let kept: f64 = (3..12).map(|i| f64::from(i * i)).sum();
        assert_eq!((of.mean, of.freedom), (kept / 9.0, 8));
        let moved: Running = (0..15)
            .map(|i: i32| f64::from(i.clamp(3, 11).pow(2)))
            .collect();
        let expected = moved.variance().unwrap() * 14.0 / (9.0 * 8.0);
        assert!((of.variance.unwrap() / expected - 1.0).abs() < 1e-14);
        // The plain standard error where there are few.
        let of = Trimmed::new(vec![4.0, 1.0, 2.0, 1.0]);
        assert_eq!((of.mean, of.freedom), (2.0, 3));
        assert!((of.variance.unwrap() - 0.5).abs() < 1e-14);
    }
}
