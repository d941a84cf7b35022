//! The error of every estimator of `huygens accuracy` falls as theory says.

mod common;

use common::statistics::threshold;
use huygens::accuracy::{Ladder, Target, study};
use huygens::estimate::student_quantile;

/// Chance that all of it fails although all is right.
const SIGNIFICANCE: f64 = 1e-3;

#[test]
fn slopes_are_those_of_theory() {
    let ladder = Ladder {
        last: 1 << 14,
        repetitions: 256,
        ..Ladder::default()
    };
    let mut curves = 0;
    for target in Target::ALL {
        for curve in study(&target.problem(), &ladder, || true).curves {
            curves += 1;
            let expected = curve.expected_slope.expect("every target's is known");
            let slope = curve.slope.expect("nine points");
            // Standard deviation of the slope if each squared error is a square of a normal variable:
            // ln rmse has variance 1/(2 repetitions), the abscissas are k ln 2.
            let rungs = curve.points.len() as f64;
            let spread = 2f64.ln().powi(2) * rungs * (rungs * rungs - 1.0) / 12.0;
            let deviation = (0.5 / f64::from(ladder.repetitions) / spread).sqrt();
            let limit = threshold(SIGNIFICANCE, 25) * deviation;
            // Sharp enough for what is promised: -0.5 +- 0.05.
            assert!(limit < 0.05, "{limit}");
            let off = (slope - expected).abs();
            assert!(
                off <= limit,
                "{target:?}, {}: slope {slope}, expected {expected} +- {limit}",
                curve.name
            );
            // The interval that is printed holds the theory too, at a level that allows for their
            // number: stretched from its 95% to that.
            let [low, high] = curve.slope_interval.expect("nine points");
            let freedom = curve.points.len() as u64 - 2;
            let stretch = student_quantile(0.5 * SIGNIFICANCE / 25.0, freedom)
                / student_quantile(0.025, freedom);
            let half = 0.5 * (high - low) * stretch;
            assert!(off <= half, "{target:?}, {}: {slope} +- {half}", curve.name);
        }
    }
    assert!(
        (20..=25).contains(&curves),
        "{curves} curves: correct the number above"
    );
}

/// The better density has the smaller error at every rung, and strata beat independent points.
#[test]
fn methods_rank_as_their_variances() {
    let ladder = Ladder {
        last: 1 << 12,
        repetitions: 256,
        ..Ladder::default()
    };
    for (target, ranking) in [
        (Target::Pi, &["jittered", "latin", "darts"][..]),
        (Target::Integral, &["jittered", "linear", "uniform"]),
        (Target::Peak, &["table", "lorentz", "uniform"]),
        (Target::Box, &["latin", "jittered", "uniform"]),
        (
            Target::Hemisphere,
            &["jittered", "cosine", "uniform", "sphere"],
        ),
    ] {
        let study = study(&target.problem(), &ladder, || true);
        let errors = |name: &str| -> Vec<f64> {
            let curve = study
                .curves
                .iter()
                .find(|c| c.name == name)
                .expect("a curve");
            curve.points.iter().map(|p| p.rmse).collect()
        };
        for pair in ranking.windows(2) {
            for (better, worse) in errors(pair[0]).iter().zip(errors(pair[1])) {
                assert!(*better < worse, "{target:?}: {pair:?}, {better} {worse}");
            }
        }
    }
}
