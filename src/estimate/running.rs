//! Mean and variance of a stream of values, in one pass and mergeable.

use super::student_quantile;

/// Count, mean and sum of squared deviations of the values seen so far.
///
/// B. P. Welford's update (Technometrics 4(3), 1962) and the merge of T. Chan, G. Golub and
/// R. LeVeque ("Updating Formulae and a Pairwise Algorithm for Computing Sample Variances", 1979):
/// neither subtracts two large sums, so a small variance about a large mean survives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Running {
    count: u64,
    mean: f64,
    /// Sum of squared deviations from the mean.
    squares: f64,
}

impl Running {
    /// Of no values.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one value. A value that is not finite makes mean and variance so, for good.
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
    }

    /// Adds all that `other` has seen.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let (n, m) = (self.count as f64, other.count as f64);
        let apart = other.mean - self.mean;
        self.count += other.count;
        self.mean += apart * (m / (n + m));
        self.squares += other.squares + apart * apart * (n * m / (n + m));
    }

    /// How many values.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; 0 of none.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The unbiased sample variance; unknown for fewer than two values.
    #[must_use]
    pub fn variance(&self) -> Option<f64> {
        (self.count > 1).then(|| self.squares / (self.count - 1) as f64)
    }

    /// Standard error of the mean; unknown for fewer than two values.
    #[must_use]
    pub fn standard_error(&self) -> Option<f64> {
        self.variance().map(|v| (v / self.count as f64).sqrt())
    }

    /// The interval about the mean that holds the expectation with probability `level` (in 0..1),
    /// by Student's distribution: exact for any number of independent normal values, and by the
    /// central limit theorem for dozens of others, more if they are skewed. Unknown for fewer than
    /// two values.
    #[must_use]
    pub fn confidence_interval(&self, level: f64) -> Option<[f64; 2]> {
        let error = self.standard_error()?;
        let half = -student_quantile(0.5 * (1.0 - level), self.count - 1) * error;
        Some([self.mean - half, self.mean + half])
    }
}

impl Extend<f64> for Running {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, values: I) {
        values.into_iter().for_each(|v| self.push(v));
    }
}

impl FromIterator<f64> for Running {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut running = Self::new();
        running.extend(values);
        running
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_small_variance_about_a_large_mean_survives() {
        // Sums of squares would lose it: 1e9^2 has no room for 1 in 53 bits.
        let values: Running = (0..3000).map(|i| 1e9 + f64::from(i % 3)).collect();
        let exact = 2.0 / 3.0 * 3000.0 / 2999.0;
        let variance = values.variance().unwrap();
        // n roundings of the deviations (1e9 * 2^-53 each) against deviations of 1.
        assert!(
            (variance / exact - 1.0).abs() < 3000.0 * 1e9 * f64::EPSILON,
            "{variance}"
        );
    }

    #[test]
    fn few_values_have_no_variance() {
        assert_eq!(Running::new().variance(), None);
        assert_eq!(
            [1.0].into_iter().collect::<Running>().standard_error(),
            None
        );
        assert_eq!(
            [1.0]
                .into_iter()
                .collect::<Running>()
                .confidence_interval(0.9),
            None
        );
        assert_eq!(
            [1.0, 3.0].into_iter().collect::<Running>().variance(),
            Some(2.0)
        );
    }

    #[test]
    fn an_interval_covers_as_often_as_it_says() {
        // 2000 intervals of level 0.9 over means of 256 uniform numbers: covered binomially often,
        // so 1800 +- 5 sigma with sigma = sqrt(2000 * 0.9 * 0.1) = 13.4 (two-sided 6e-7).
        use rand_pcg::{Pcg64, rand_core::Rng};
        let mut rng = Pcg64::new(1, 2);
        let mut covered = 0;
        for _ in 0..2000 {
            let values: Running = (0..256)
                .map(|_| (rng.next_u64() >> 11) as f64 * (-53f64).exp2())
                .collect();
            let [low, high] = values.confidence_interval(0.9).unwrap();
            covered += i32::from(low <= 0.5 && 0.5 <= high);
        }
        assert!((covered - 1800).abs() < 67, "{covered}");
    }

    proptest! {
        #[test]
        fn merging_equals_two_passes(values in prop::collection::vec(-1e3..1e3f64, 2..200), cut in 0..200usize) {
            let (left, right) = values.split_at(cut.min(values.len()));
            let mut merged: Running = left.iter().copied().collect();
            merged.merge(&right.iter().copied().collect());
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
            // At most a few roundings of the largest magnitude (1e3; its square) a value.
            prop_assert!((merged.mean() - mean).abs() <= 4.0 * n * 1e3 * f64::EPSILON);
            prop_assert!((merged.variance().unwrap() - variance).abs() <= 8.0 * n * 4e6 * f64::EPSILON);
            prop_assert_eq!(merged.count(), values.len() as u64);
        }
    }
}
