//! The choices of each family, added one by one.

use super::{Choice, Family, word};
use crate::effects::{Effects, light_selection};
use crate::reference::Reference;
use crate::scene::Scene;
use crate::settings::{Integrator, LightSelection, Sampler, Settings, Strategy, TextureLod};
use clap::ValueEnum;

/// Choices as they are found.
pub(super) struct List<'a> {
    base: &'a Settings,
    pub(super) choices: Vec<Choice>,
}

impl<'a> List<'a> {
    /// The scene's own settings alone.
    pub(super) fn new(base: &'a Settings) -> Self {
        let own = Choice {
            family: Family::Base,
            name: pair(base),
            what: "the scene's own settings".into(),
            options: String::new(),
            settings: base.clone(),
        };
        Self {
            base,
            choices: vec![own],
        }
    }

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

    pub(super) fn strategies(&mut self, sampler: Option<Sampler>) {
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

    pub(super) fn samplers(&mut self) {
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
    pub(super) fn lights(&mut self, scene: &Scene) {
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

    pub(super) fn depths(&mut self) {
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

    pub(super) fn roulettes(&mut self) {
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

    pub(super) fn splits(&mut self) {
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

    /// Only where there are images to read in two ways.
    pub(super) fn textures(&mut self, scene: &Scene) {
        if !reads_images(scene, self.base) {
            return;
        }
        for (texture_lod, name, what) in [
            (
                TextureLod::Footprint,
                "images by footprint",
                "images averaged over what a ray stands for",
            ),
            (
                TextureLod::Finest,
                "finest images",
                "images read at their finest, however far away",
            ),
        ] {
            let settings = Settings {
                texture_lod,
                ..self.base.clone()
            };
            let options = format!("--texture-lod {}", word(&texture_lod));
            self.add(Family::Textures, name, what, &options, settings);
        }
    }

    pub(super) fn waves(&mut self) {
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
    pub(super) fn precision(&mut self, scene: &Scene) {
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
        let mut what =
            "the recursive tracer in f64, light found by directions, every triangle tested"
                .to_owned();
        if self.base.texture_lod == TextureLod::Footprint && reads_images(scene, self.base) {
            what += ", images read at their finest";
        }
        self.add(
            Family::Precision,
            "f64 reference",
            &what,
            "--integrator reference --strategy cosine",
            settings,
        );
    }
}

/// Whether surfaces read images over footprints, or might.
fn reads_images(scene: &Scene, settings: &Settings) -> bool {
    let effects = Effects::of(scene, settings);
    effects.relief || !effects.textured.is_empty()
}

/// Strategy and sampler, such as `mis+sobol`.
fn pair(settings: &Settings) -> String {
    format!("{}+{}", word(&settings.strategy), word(&settings.sampler))
}
