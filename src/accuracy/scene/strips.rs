//! What each choice shows for the same time.

use super::{Choice, SceneCurve, Stage, Truth, seed_of};
use crate::settings::Settings;

/// Names the seeds of strips among all seeds.
const TAG: u64 = 0x7374_7269;

/// The time of a strip, as a share of that of the scene's own settings at their last rung.
const SHARE: f64 = 0.25;

/// Images at equal time.
#[derive(Clone, Debug, PartialEq)]
pub struct Strips {
    /// The seconds that each should take.
    pub seconds: f64,
    /// One a choice that was measured.
    pub strips: Vec<Strip>,
}

/// What one choice shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// The choice's.
    pub name: String,
    /// Samples a pixel, one at least.
    pub samples: u32,
    /// Seconds that it took.
    pub seconds: f64,
    /// Root of the mean squared relative error, the reference's noise taken out.
    pub error: f64,
    /// The image.
    pub pixels: Vec<[f32; 3]>,
}

impl Strips {
    /// Seconds that a strip should take after these measurements.
    #[must_use]
    pub fn seconds_of(curves: &[SceneCurve]) -> f64 {
        let last = curves.first().and_then(|base| base.curve.points.last());
        last.map_or(0.0, |p| SHARE * p.point.seconds)
    }
}

/// Renders every measured choice for as long as a strip should take, by what a sample took it before.
/// Those that are stopped are missing.
#[must_use]
pub fn strips(stage: &Stage, truth: &Truth, choices: &[Choice], curves: &[SceneCurve]) -> Strips {
    let seconds = Strips::seconds_of(curves);
    let measured = choices.iter().zip(curves);
    let strip = |(choice, curve): (&Choice, &SceneCurve)| {
        let last = curve.curve.points.last()?.point;
        (stage.progress)(&format!("{}, for {seconds:.2} s", choice.name), 1.0);
        let samples = seconds * last.samples as f64 / last.seconds;
        let settings = Settings {
            spp: samples.clamp(1.0, f64::from(i32::MAX)) as u32,
            seed: seed_of(&[u64::from(choice.settings.seed), TAG]),
            ..choice.settings.clone()
        };
        let (image, stats) = stage.render(&settings)?;
        Some(Strip {
            name: choice.name.clone(),
            samples: settings.spp,
            seconds: stats.seconds,
            error: (truth.relative_mse(&image.mean) - truth.relative_noise)
                .max(0.0)
                .sqrt(),
            pixels: image.mean,
        })
    };
    Strips {
        seconds,
        strips: measured.filter_map(strip).collect(),
    }
}
