//! What accuracy costs in a scene: choices of settings, measured against a reference image.
//!
//! ```text
//! choices ---+
//!            +--> study: rung by rung, several renders each --> curves --> advice
//! truth -----+        (measure: error, bias, variance)     |-> strips: images at equal time
//!            |                                             |
//!            +--> target: renders that end by themselves --+
//! ```

mod advice;
mod choices;
mod cost;
mod measure;
mod strips;
mod study;
mod target;
mod truth;
mod weight;

pub use advice::advice;
pub use choices::{Choice, Family, choices};
pub use cost::Cost;
pub use measure::ScenePoint;
pub use strips::{Strip, Strips, strips};
pub use study::{SceneCurve, SceneStudy, study_scene};
pub use target::{Target, Verdict, meet_target};
pub use truth::{Truth, TruthError};

use crate::estimate::{Rng, generator};
use crate::film::{Film, Image};
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::wave::{self, Control, RenderStats};
use std::time::Instant;

/// Where renders of a study happen, and who watches them.
pub struct Stage<'a> {
    /// The scene; its settings are those that choices differ from.
    pub scene: &'a Scene,
    /// The scene's geometry.
    pub geometry: &'a Geometry,
    /// Stops the study: by its flag, or by its deadline.
    pub control: &'a Control,
    /// Told now and then what is being done, and which share of all is done.
    pub progress: &'a dyn Fn(&str, f64),
}

impl Stage<'_> {
    /// Renders the scene. None if it was stopped before the end.
    fn render(&self, settings: &Settings) -> Option<(Image, RenderStats)> {
        if self.control.stops() {
            return None;
        }
        self.control.restart();
        let film = Film::new(self.scene.film.width, self.scene.film.height, settings.tile);
        let stats = wave::render(self.scene, self.geometry, settings, &film, self.control);
        (!stats.stopped).then(|| (film.develop(), stats))
    }

    /// Seconds before the deadline; infinite without one.
    fn seconds_left(&self) -> f64 {
        let deadline = self.control.deadline.get();
        deadline.map_or(f64::INFINITY, |d| {
            d.saturating_duration_since(Instant::now()).as_secs_f64()
        })
    }

    /// Pixels of the image.
    fn pixels(&self) -> usize {
        self.scene.film.width as usize * self.scene.film.height as usize
    }
}

/// The seed of a render, from what it is for: different renders are independent of each other.
fn seed_of(words: &[u64]) -> u32 {
    generator(words).next_u32()
}
