//! One rung of one choice: independent renders, compared with the reference.

use super::{Stage, Truth, seed_of};
use crate::accuracy::{Picture, Point, Rung, difference, flip};
use crate::estimate::Running;
use crate::settings::Settings;
use serde::Serialize;

/// What is known of a choice at a number of samples. Errors are of linear radiance, over pixels and
/// channels; the noise of the reference is taken out of the squared ones. Relative errors are weighed
/// as in relMSE ([`Truth::weight`]).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScenePoint {
    /// Samples a pixel, seconds of a render (the quickest), root of the mean squared error; the mean
    /// error over the image, and its standard error with the reference's noise in it.
    #[serde(flatten)]
    pub point: Point,
    /// Root of the mean squared relative error.
    pub error: f64,
    /// Its standard error, from the scatter of the renders.
    pub error_error: f64,
    /// Rays of a render, of all kinds; none where they are not counted, by the f64 tracer.
    pub rays: Option<u64>,
    /// Mean relative variance of the renders: the part of the squared error that more samples reduce.
    pub variance: f64,
    /// Mean squared relative difference of the renders' expectation from the reference: the part that
    /// stays. An unbiased estimate, so it may be negative where there is none.
    pub bias_squared: f64,
    /// Its standard error, from the scatter of the pixels.
    pub bias_squared_error: f64,
    /// Mean of FLIP over the renders; none in builds without it.
    pub flip: Option<f64>,
}

impl Rung for ScenePoint {
    fn samples_and_error(&self) -> (f64, f64) {
        (self.point.samples as f64, self.error)
    }
}

/// Bias of this many standard errors is believed. Pixels' squares are skewed, so it is more than the
/// two of a normal variable.
const BELIEVED: f64 = 4.0;

impl ScenePoint {
    /// The squared bias if it is beyond doubt, else 0.
    #[must_use]
    pub fn believed_bias_squared(&self) -> f64 {
        if self.bias_squared > BELIEVED * self.bias_squared_error {
            self.bias_squared
        } else {
            0.0
        }
    }
}

/// Renders `settings` as often as `repetitions` says, with seeds that `name` gives, and compares. None
/// if it was stopped.
pub(super) fn measure(
    stage: &Stage,
    truth: &Truth,
    settings: &Settings,
    name: [u64; 3],
    repetitions: u32,
) -> Option<ScenePoint> {
    let mut pixels = vec![[Running::new(); 3]; stage.pixels()];
    let (mut squares, mut means, mut relative) = (Running::new(), Running::new(), Running::new());
    let mut seen = Running::new();
    let mut seconds = f64::INFINITY;
    let mut rays = 0;
    for repetition in 0..repetitions {
        let [a, b, c] = name;
        let settings = Settings {
            seed: seed_of(&[a, b, c, u64::from(repetition)]),
            ..settings.clone()
        };
        let (image, stats) = stage.render(&settings)?;
        // Whatever else a machine does only ever adds.
        seconds = seconds.min(stats.seconds);
        rays += stats.camera_rays + stats.bounce_rays + stats.shadow_rays;
        // Of one size, and the film leaves out what is not finite.
        let against = difference(Picture::from(&image), truth.picture()).ok()?;
        squares.push(against.mse);
        means.push(against.bias.iter().sum::<f64>() / 3.0);
        relative.push(truth.relative_mse(&image.mean));
        if let Some(flip) = flip(Picture::from(&image), truth.picture()) {
            seen.push(flip);
        }
        for (pixel, value) in pixels.iter_mut().zip(&image.mean) {
            (0..3).for_each(|c| pixel[c].push(value[c].into()));
        }
    }
    let (variance, bias) = split(&pixels, truth);
    let rmse = (squares.mean() - truth.noise).max(0.0).sqrt();
    let error = (relative.mean() - truth.relative_noise).max(0.0).sqrt();
    // The mean over the image has the mean variance over the number of values.
    let of_truth = truth.noise / (3.0 * pixels.len() as f64);
    let of_means = means.standard_error().unwrap_or(f64::INFINITY).powi(2);
    Some(ScenePoint {
        point: Point {
            samples: settings.spp.into(),
            seconds,
            rmse,
            bias: means.mean(),
            bias_error: (of_means + of_truth).sqrt(),
        },
        error,
        // The derivative of a square root.
        error_error: 0.5 * relative.standard_error().unwrap_or(f64::INFINITY) / error,
        rays: Some(rays / u64::from(repetitions)).filter(|&n| n > 0),
        variance,
        bias_squared: bias.mean(),
        bias_squared_error: bias.standard_error().unwrap_or(f64::INFINITY),
        flip: (seen.count() > 0).then(|| seen.mean()),
    })
}

/// The squared relative error in its two parts: the mean variance of a render, and the squared bias
/// of each pixel. With `m` the mean of `R` renders of a pixel and `s^2` their variance, the square of
/// `m` less the reference has the expectation `bias^2 + s^2 / R + v`, with `v` the variance of the
/// reference.
fn split(pixels: &[[Running; 3]], truth: &Truth) -> (f64, Running) {
    let (mut variance, mut bias) = (Running::new(), Running::new());
    let reference = truth.image.mean.iter().zip(&truth.image.variance);
    let reference = reference.zip(&truth.weight);
    for (pixel, ((mean, noise), weight)) in pixels.iter().zip(reference) {
        let mut squares = 0.0;
        for c in 0..3 {
            let s2 = pixel[c].variance().unwrap_or(f64::INFINITY);
            variance.push(weight[c] * s2);
            let apart = (pixel[c].mean() - f64::from(mean[c])).powi(2);
            let noise = s2 / pixel[c].count() as f64 + f64::from(noise[c]);
            squares += weight[c] * (apart - noise);
        }
        // A pixel's channels go together: one value for all of them.
        bias.push(squares / 3.0);
    }
    (variance.mean(), bias)
}
