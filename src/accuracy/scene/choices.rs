//! The choices that a study of a scene compares: one at a time against the scene's own settings, and
//! some together.

mod list;

use crate::reference::Reference;
use crate::scene::Scene;
use crate::settings::{Sampler, Settings};
use clap::ValueEnum;
use list::List;
use serde::Serialize;

/// What a choice is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// What the scene asks for.
    #[value(skip)]
    Base,
    /// How surfaces look for light
    Strategy,
    /// How random numbers are spread over samples
    Sampler,
    /// Strategies with independent random numbers: both choices at once
    Combined,
    /// How lights are chosen where they are sampled
    Lights,
    /// The largest number of scattering events
    Depth,
    /// Whether and how soon paths end at random
    Roulette,
    /// Several ways on from a surface
    Split,
    /// How finely images on surfaces are read
    Textures,
    /// Paths in a worker's wave: the image is the same
    Wave,
    /// The f64 reference tracer instead of the wave
    Precision,
    /// Renders that end at the target error by their own estimate, against their true error
    Target,
}

impl Family {
    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Base => "base".into(),
            other => word(&other),
        }
    }
}

/// Settings to measure, and how they differ from the scene's own.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// What it is about.
    pub family: Family,
    /// Short and unique.
    pub name: String,
    /// What it means, in a line.
    pub what: String,
    /// The options of the command line that make it from the scene's own settings.
    pub options: String,
    /// The settings; samples and seed are the study's.
    pub settings: Settings,
}

/// The scene's own settings, and all choices of these families that differ from them and that the
/// scene can be rendered with.
#[must_use]
pub fn choices(scene: &Scene, families: &[Family]) -> Vec<Choice> {
    let base = &scene.settings;
    let mut list = List::new(base);
    for family in families {
        match family {
            // The settings are the scene's own: `meet_target`.
            Family::Base | Family::Target => {}
            Family::Strategy => list.strategies(None),
            Family::Combined => list.strategies(Some(Sampler::Independent)),
            Family::Sampler => list.samplers(),
            Family::Lights => list.lights(scene),
            Family::Depth => list.depths(),
            Family::Roulette => list.roulettes(),
            Family::Split => list.splits(),
            Family::Textures => list.textures(scene),
            Family::Wave => list.waves(),
            Family::Precision if Reference::supports(scene) => list.precision(scene),
            Family::Precision => {}
        }
    }
    list.choices
}

/// The name of a value on the command line.
pub(super) fn word(value: &impl ValueEnum) -> String {
    let value = value.to_possible_value();
    value.map_or_else(String::new, |v| v.get_name().to_owned())
}

#[cfg(test)]
mod tests;
