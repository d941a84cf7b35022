//! `--target-error` and `--time`: renders that end by themselves.

use crate::cli::values;
use huygens::accuracy::{Goal, render_rounds};
use huygens::film::{Film, Image};
use huygens::geometry::Geometry;
use huygens::scene::Scene;
use huygens::settings::{Sampler, Settings};
use huygens::wave::{Control, RenderStats};
use std::time::Duration;

/// When to end, besides at the last sample.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "End (--spp, if given, is the most samples then)")]
pub(crate) struct UntilOptions {
    /// End when the relative error is this, by estimate, such as 2% or 0.02; noisy parts of the image
    /// get more samples than others
    #[arg(long, value_name = "ERROR", value_parser = values::share)]
    #[arg(allow_negative_numbers = true)]
    pub(crate) target_error: Option<f64>,

    /// End after rendering for this long, such as 60s, 10m or 8h
    #[arg(long, value_name = "TIME", value_parser = values::time)]
    #[arg(allow_negative_numbers = true)]
    pub(crate) time: Option<Duration>,
}

/// A render that has ended.
pub(crate) struct Rendered {
    pub(crate) stats: RenderStats,
    /// The image, if it is not on the film.
    pub(crate) image: Option<Image>,
    /// Its relative error by estimate, if there is one.
    pub(crate) error: Option<f64>,
    /// Samples in the image.
    pub(crate) samples: u64,
}

impl Rendered {
    /// All samples onto `film`.
    pub(crate) fn at_once(stats: RenderStats, film: &Film) -> Self {
        Self {
            stats,
            image: None,
            error: None,
            samples: film.samples(),
        }
    }
}

impl UntilOptions {
    /// Whether any of them was given.
    pub(crate) fn given(&self) -> bool {
        self.target_error.is_some() || self.time.is_some()
    }

    /// Lifts the scene's number of samples, unless one was asked for with them.
    pub(crate) fn apply(&self, spp: Option<u32>, settings: &mut Settings) {
        if self.given() && spp.is_none() {
            let branches: u32 = settings.split.iter().product();
            settings.spp = i32::MAX as u32 / branches.max(1);
        }
    }

    /// Whether the render goes in rounds. By the clock alone, it need not where a sampler knows no end
    /// of its samples: one long sequence is better than many short ones.
    pub(crate) fn in_rounds(&self, settings: &Settings) -> bool {
        let endless = matches!(settings.sampler, Sampler::Independent | Sampler::Sobol);
        self.target_error.is_some() || (self.time.is_some() && !endless)
    }

    /// Renders in rounds.
    pub(crate) fn render(&self, scene: &Scene, geometry: &Geometry, control: &Control) -> Rendered {
        let goal = Goal {
            error: self.target_error,
            spp: scene.settings.spp,
        };
        let rounds = render_rounds(scene, geometry, &scene.settings, goal, control);
        Rendered {
            samples: rounds.image.samples.iter().map(|&n| u64::from(n)).sum(),
            stats: rounds.stats,
            image: Some(rounds.image),
            error: Some(rounds.error).filter(|e| e.is_finite()),
        }
    }

    /// A warning if the error that was asked for was not reached.
    pub(crate) fn missed(&self, rendered: &Rendered) -> Vec<String> {
        let missed = |goal: f64| match rendered.error {
            Some(error) if error <= goal => None,
            Some(error) => Some(format!(
                "the error is {:.2}% by estimate, short of the {:.2}% asked for",
                100.0 * error,
                100.0 * goal
            )),
            None => Some("too few samples to estimate an error".to_owned()),
        };
        self.target_error.and_then(missed).into_iter().collect()
    }

    /// The options, as they would be typed.
    pub(crate) fn as_options(&self) -> String {
        let mut text = String::new();
        if let Some(error) = self.target_error {
            text += &format!(" --target-error {error}");
        }
        if let Some(time) = self.time {
            text += &format!(" --time {}s", time.as_secs_f64());
        }
        text
    }
}
