//! The choices that a study of a scene compares: one at a time against the scene's own settings, and
//! some together.

use crate::reference::Reference;
use crate::scene::Scene;
use crate::settings::{Integrator, Sampler, Settings, Strategy};
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
            Family::Base => {}
            Family::Strategy => list.strategies(None),
            Family::Combined => list.strategies(Some(Sampler::Independent)),
            Family::Sampler => list.samplers(),
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
        for split in [vec![4], vec![16], vec![4, 4]] {
            let settings = Settings {
                split: split.clone(),
                ..self.base.clone()
            };
            let words: Vec<String> = split.iter().map(u32::to_string).collect();
            let name = format!("split {}", words.join(","));
            let what = match &split[..] {
                [n] => format!("{n} ways on from the first surface"),
                several => format!(
                    "{} ways on from the first surface, each with {} from the next",
                    several[0], several[1]
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
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn scene(change: impl FnOnce(&mut Settings)) -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.toml");
        let mut scene = crate::scene::load(path.as_ref()).expect("it ships");
        change(&mut scene.settings);
        scene
    }

    fn names(scene: &Scene, families: &[Family]) -> Vec<String> {
        let choices = choices(scene, families);
        choices.into_iter().map(|c| c.name).collect()
    }

    #[test]
    fn every_choice_has_a_name_of_its_own_and_settings_of_its_own() {
        let scene = scene(|_| {});
        let all = choices(&scene, Family::value_variants());
        let names: BTreeSet<&str> = all.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names.len(), all.len());
        for (i, a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|b| a.settings != b.settings), "{a:?}");
        }
    }

    #[test]
    fn the_base_comes_first_and_is_not_repeated() {
        let names = names(&scene(|_| {}), &[Family::Strategy]);
        let expected = ["mis+sobol", "uniform+sobol", "cosine+sobol", "light+sobol"];
        assert_eq!(names, expected);
    }

    #[test]
    fn depths_stay_below_the_scenes_own() {
        let names = names(&scene(|s| s.max_depth = Some(4)), &[Family::Depth]);
        assert_eq!(names, ["mis+sobol", "max depth 1", "max depth 2"]);
    }
}
