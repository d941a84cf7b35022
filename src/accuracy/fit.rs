//! Straight lines through points of log error against log cost.

use crate::estimate::student_quantile;

/// The line `ln y = intercept + slope ln x` of least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Its slope: `y` goes as `x` to this power.
    pub slope: f64,
    /// `ln y` at `x = 1`.
    pub intercept: f64,
    /// Standard error of the slope, from the scatter of the points about the line; unknown of two
    /// points.
    pub slope_error: Option<f64>,
    /// Number of points less 2.
    freedom: u64,
}

/// Fits a line to points `(x, y)` in the logarithms of both. Points that have none (0, negative, not
/// finite) are left out; none if fewer than two different `x` remain.
#[must_use]
pub fn log_log(points: impl IntoIterator<Item = (f64, f64)>) -> Option<Fit> {
    let usable = |v: f64| v > 0.0 && v.is_finite();
    let points: Vec<[f64; 2]> = points
        .into_iter()
        .filter(|&(x, y)| usable(x) && usable(y))
        .map(|(x, y)| [x.ln(), y.ln()])
        .collect();
    let n = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / n;
    let [mean_x, mean_y] = [mean(0), mean(1)];
    let spread: f64 = points.iter().map(|p| (p[0] - mean_x).powi(2)).sum();
    if points.len() < 2 || spread == 0.0 {
        return None;
    }
    let together: f64 = points
        .iter()
        .map(|p| (p[0] - mean_x) * (p[1] - mean_y))
        .sum();
    let slope = together / spread;
    let intercept = mean_y - slope * mean_x;
    let residual = |p: &[f64; 2]| (p[1] - intercept - slope * p[0]).powi(2);
    let scatter: f64 = points.iter().map(residual).sum();
    let freedom = points.len() as u64 - 2;
    Some(Fit {
        slope,
        intercept,
        slope_error: (freedom > 0).then(|| (scatter / freedom as f64 / spread).sqrt()),
        freedom,
    })
}

impl Fit {
    /// The interval that holds the true slope with probability `level` (in 0..1), if the points are
    /// independent, scatter alike about a true line, and nearly normally; by Student's distribution.
    ///
    /// Where the points bend (a rate not reached yet), the scatter includes the bend and the interval
    /// widens by it.
    #[must_use]
    pub fn slope_interval(&self, level: f64) -> Option<[f64; 2]> {
        let half = -student_quantile(0.5 * (1.0 - level), self.freedom) * self.slope_error?;
        Some([self.slope - half, self.slope + half])
    }

    /// The `x` at which the line reaches `y`; not finite where it never does.
    #[must_use]
    pub fn x_at(&self, y: f64) -> f64 {
        ((y.ln() - self.intercept) / self.slope).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{generator, normal_quantile, points::uniform};

    #[test]
    fn a_power_law_is_found() {
        let points = (0..10).map(|k| {
            let x = f64::from(1 << k);
            (x, 3.0 * x.powf(-0.75))
        });
        let fit = log_log(points).expect("a line");
        // A dozen roundings of numbers of the size of ln 512 = 6.2.
        let bound = 12.0 * 8.0 * f64::EPSILON;
        assert!((fit.slope + 0.75).abs() < bound);
        assert!((fit.intercept - 3f64.ln()).abs() < bound);
        assert!((fit.x_at(3.0) - 1.0).abs() < 2.0 * bound);
        assert!(fit.slope_error.expect("ten points") < bound);
    }

    #[test]
    fn points_without_logarithm_are_left_out() {
        let good = [(1.0, 1.0), (2.0, 0.5)];
        let bad = [
            (3.0, 0.0),
            (4.0, f64::NAN),
            (0.0, 1.0),
            (5.0, f64::INFINITY),
        ];
        let fit = log_log(good.into_iter().chain(bad)).expect("a line");
        assert_eq!((fit.slope, fit.slope_error), (-1.0, None));
        assert_eq!(fit.slope_interval(0.95), None);
        assert_eq!(log_log([(1.0, 1.0)]), None);
        assert_eq!(log_log([(2.0, 1.0), (2.0, 3.0)]), None);
        assert_eq!(log_log([]), None);
    }

    #[test]
    fn an_interval_covers_as_often_as_it_says() {
        // 2000 fits to 8 points about a line, normally scattered: covered 1800 +- 5 sigma times,
        // sigma = sqrt(2000 * 0.9 * 0.1) = 13.4 (two-sided 6e-7).
        let mut rng = generator(&[7]);
        let mut covered = 0;
        for _ in 0..2000 {
            let points = (0..8).map(|k| {
                let noise = normal_quantile(uniform(&mut rng).max(f64::MIN_POSITIVE));
                let x = f64::from(1 << k);
                (x, x.powf(-0.5) * (0.1 * noise).exp())
            });
            let fit = log_log(points).expect("a line");
            let [low, high] = fit.slope_interval(0.9).expect("eight points");
            covered += i32::from(low <= -0.5 && -0.5 <= high);
        }
        assert!((covered - 1800).abs() < 67, "{covered}");
    }
}
