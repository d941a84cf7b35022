//! The choices that a study of a scene compares: one at a time against the scene's own settings, and
//! some together.

use crate::effects::{Effects, light_selection};
use crate::reference::Reference;
use crate::scene::Scene;
use crate::settings::{Integrator, LightSelection, Sampler, Settings, Strategy};
use clap::ValueEnum;
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
    let mut list = List {
        base,
        choices: vec![Choice {
            family: Family::Base,
            name: pair(base),
            what: "the scene's own settings".into(),
            options: String::new(),
            settings: base.clone(),
        }],
    };
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
            Family::Wave => list.waves(),
            Family::Precision if Reference::supports(scene) => list.precision(),
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

/// Strategy and sampler, such as `mis+sobol`.
fn pair(settings: &Settings) -> String {
    format!("{}+{}", word(&settings.strategy), word(&settings.sampler))
}

struct List<'a> {
    base: &'a Settings,
    choices: Vec<Choice>,
}

impl List<'_> {
    /// Adds a choice, unless it is there already under another name.
    fn add(&mut self, family: Family, name: &str, what: &str, options: &str, settings: Settings) {
        if self.choices.iter().any(|c| c.settings == settings) {
            return;
        }
        self.choices.push(Choice {
            family,
            name: name.into(),
            what: what.into(),
            options: options.into(),
            settings,
        });
    }

    fn strategies(&mut self, sampler: Option<Sampler>) {
        for strategy in Strategy::value_variants() {
            let settings = Settings {
                strategy: *strategy,
                sampler: sampler.unwrap_or(self.base.sampler),
                ..self.base.clone()
            };
            let what = match strategy {
                Strategy::Uniform => "directions uniform over the hemisphere",
                Strategy::Cosine => "directions by the cosine",
                Strategy::Light => "lights sampled at every surface, and nothing else",
                Strategy::Mis => "lights sampled, and directions by the cosine, weighted",
            };
            let mut options = format!("--strategy {}", word(strategy));
            let mut family = Family::Strategy;
            if let Some(sampler) = sampler {
                options += &format!(" --sampler {}", word(&sampler));
                family = Family::Combined;
            }
            self.add(family, &pair(&settings), what, &options, settings.clone());
        }
    }

    fn samplers(&mut self) {
        for sampler in Sampler::value_variants() {
            let settings = Settings {
                sampler: *sampler,
                ..self.base.clone()
            };
            let what = match sampler {
                Sampler::Independent => "independent random numbers",
                Sampler::Stratified => "numbers on a jittered grid",
                Sampler::Sobol => "scrambled Sobol points",
                Sampler::BlueNoise => "Sobol points, errors of neighbours apart",
            };
            let options = format!("--sampler {}", word(sampler));
            let name = pair(&settings);
            self.add(Family::Sampler, &name, what, &options, settings);
        }
    }

    /// Only where lights are sampled, and but for the one that the scene's own comes to.
    fn lights(&mut self, scene: &Scene) {
        let effects = Effects::of(scene, self.base).list;
        if !effects.iter().any(|e| e.name == "next-event estimation") {
            return;
        }
        let own = light_selection(scene, self.base).0;
        for (selection, what) in [
            (LightSelection::Uniform, "any light as often as any other"),
            (LightSelection::Power, "lights chosen by their power"),
            (LightSelection::Tree, "lights chosen along a tree over them"),
        ] {
            let settings = Settings {
                light_selection: selection,
                ..self.base.clone()
            };
            if selection == own || light_selection(scene, &settings).0 != selection {
                continue;
            }
            let name = word(&selection);
            let options = format!("--light-selection {name}");
            self.add(
                Family::Lights,
                &format!("lights by {name}"),
                what,
                &options,
                settings,
            );
        }
    }

    fn depths(&mut self) {
        let limit = self.base.depth_limit();
        for depth in [1, 2, 4, 8].into_iter().filter(|d| *d < limit) {
            let settings = Settings {
                max_depth: Some(depth),
                ..self.base.clone()
            };
            let name = format!("max depth {depth}");
            let what = format!("light that scattered at most {depth} times");
            let options = format!("--max-depth {depth}");
            self.add(Family::Depth, &name, &what, &options, settings);
        }
    }

    fn roulettes(&mut self) {
        let usual = Settings::default().survival;
        for (name, what, roulette, survival) in [
            ("off", "paths go on to the maximum depth", false, usual),
            ("on", "faint paths end at random", true, usual),
            (
                "aggressive",
                "faint paths end at random, four times as readily",
                true,
                Settings::AGGRESSIVE,
            ),
        ] {
            let settings = Settings {
                roulette,
                survival,
                ..self.base.clone()
            };
            let options = format!("--roulette {name}");
            let name = format!("roulette {name}");
            self.add(Family::Roulette, &name, what, &options, settings);
        }
    }

    fn splits(&mut self) {
        // N, N^2 and N^3 ways, and as many at once as the last.
        for split in [vec![2], vec![2, 2], vec![2, 2, 2], vec![8]] {
            let settings = Settings {
                split: split.clone(),
                ..self.base.clone()
            };
            let words: Vec<String> = split.iter().map(u32::to_string).collect();
            let name = format!("split {}", words.join(","));
            let what = match &split[..] {
                [n] => format!("{n} ways on from the first surface"),
                several => format!(
                    "{} ways on from each of the first surfaces, {} in all",
                    several[0],
                    several.iter().product::<u32>()
                ),
            };
            let options = format!("--split {}", words.join(","));
            self.add(Family::Split, &name, &what, &options, settings);
        }
    }

    fn waves(&mut self) {
        for wave in [256, 2048, 16_384] {
            let settings = Settings {
                wave,
                ..self.base.clone()
            };
            let name = format!("wave {wave}");
            let what = format!("{wave} paths in a worker's wave");
            let options = format!("--wave {wave}");
            self.add(Family::Wave, &name, &what, &options, settings);
        }
    }

    /// Nothing but the arithmetic and the data structures shall differ from a choice of the wave:
    /// of both, light is found by directions alone.
    fn precision(&mut self) {
        if !matches!(self.base.integrator, Integrator::Path | Integrator::Direct) {
            return;
        }
        let settings = Settings {
            integrator: Integrator::Reference,
            strategy: Strategy::Cosine,
            sampler: Sampler::Independent,
            split: Vec::new(),
            max_depth: Some(self.base.depth_limit()).filter(|&d| d <= Reference::DEEPEST),
            ..self.base.clone()
        };
        self.add(
            Family::Precision,
            "f64 reference",
            "the recursive tracer in f64, light found by directions, every triangle tested",
            "--integrator reference --strategy cosine",
            settings,
        );
    }
}

#[cfg(test)]
mod tests;
