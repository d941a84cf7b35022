//! Options that several subcommands share.

use crate::cli::failure::Failure;
use crate::cli::memory;
use crate::cli::values::{self, Depth, Split};
use clap::{Args, ValueEnum};
use huygens::scene::{Filter, Scene};
use huygens::settings::{
    Integrator, LightSelection, Preset, Sampler, Settings, Strategy, TextureLod,
};
use std::path::PathBuf;

/// The scene, and how strictly it is taken.
#[derive(Debug, Args)]
pub(crate) struct SceneOptions {
    /// Scene file: a native .toml scene, or a bare .obj or .ply
    pub(crate) scene: PathBuf,

    /// Treat every warning about the scene or the options as an error (exit code 2)
    #[arg(long)]
    pub(crate) strict: bool,

    /// Refuse a scene that would need more memory than this, before reading it; such as 800M or 4G
    #[arg(long, value_name = "SIZE", value_parser = memory::parse, allow_negative_numbers = true)]
    pub(crate) max_memory: Option<u64>,
}

/// What the image depends on. Whatever is left out comes from the scene file, or else from the
/// defaults.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Image (default: what the scene file says)")]
pub(crate) struct ImageOptions {
    /// Samples a pixel, 1 to 2147483647 [if the scene says nothing: 64]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=i64::from(i32::MAX)))]
    pub(crate) spp: Option<u32>,

    /// Image size in pixels, each side 1 to 65535; keeps the vertical field of view
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<(u32, u32)>,

    /// Largest number of scattering events on a path, 0 to 2147483647, or none
    #[arg(long, value_name = "N|none", value_parser = values::depth, allow_negative_numbers = true)]
    pub(crate) max_depth: Option<Depth>,

    /// What is computed for each sample
    #[arg(long, value_name = "NAME")]
    pub(crate) integrator: Option<Integrator>,

    /// How a surface looks for light
    #[arg(long, value_name = "NAME")]
    pub(crate) strategy: Option<Strategy>,

    /// How lights are chosen where they are sampled
    #[arg(long, value_name = "NAME")]
    pub(crate) light_selection: Option<LightSelection>,

    /// How the random numbers are spread over a pixel's samples
    #[arg(long, value_name = "NAME")]
    pub(crate) sampler: Option<Sampler>,

    /// Whether paths end at random by their throughput; aggressive: sooner than usual
    #[arg(long, value_name = "on|off|aggressive", hide_possible_values = true)]
    pub(crate) roulette: Option<Roulette>,

    /// Ways on from the first surface, and after commas from each of those at the next, and so on:
    /// at most 8 numbers, each at least 1, whose product is at most 65536
    #[arg(long, value_name = "N[,N...]", value_parser = values::split)]
    pub(crate) split: Option<Split>,

    /// Seed of the random numbers, 0 to 4294967295
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<u32>,

    /// How finely images on surfaces are read
    #[arg(long, value_name = "NAME")]
    pub(crate) texture_lod: Option<TextureLod>,

    /// Pixel filter
    #[arg(long, value_name = "NAME")]
    pub(crate) filter: Option<Filter>,

    /// Occlusion distance of the integrator ao in scene units, above 0 [if the scene says nothing:
    /// a tenth of the scene's diagonal]
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, allow_negative_numbers = true)]
    pub(crate) ao_distance: Option<f32>,
}

/// How the work is done; the image does not depend on it.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Work (the image does not depend on it)")]
pub(crate) struct WorkOptions {
    /// How much work goes into the tree over the triangles [if the scene says nothing: balanced]
    #[arg(long, value_name = "NAME")]
    pub(crate) bvh: Option<Preset>,

    /// Worker threads, 0 to 1024; 0: one for each core
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u16).range(0..=1024))]
    pub(crate) threads: Option<u16>,

    /// Paths in a worker's wave, 64 to 1048576 [if the scene says nothing: 4096]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(64..=1 << 20))]
    pub(crate) wave: Option<u32>,

    /// Edge of a tile in pixels, 1 to 1024 [if the scene says nothing: 32]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) tile: Option<u32>,
}

/// How readily paths end at random.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Roulette {
    On,
    Off,
    Aggressive,
}

impl ImageOptions {
    /// Puts these options over those of the scene.
    pub(crate) fn apply(&self, scene: &mut Scene) {
        if let Some((width, height)) = self.size {
            let old = (u64::from(scene.film.width), u64::from(scene.film.height));
            // The same shape at another resolution is the same camera, to the last bit.
            if u64::from(width) * old.1 != u64::from(height) * old.0 {
                let aspect = f64::from(width) / f64::from(height);
                // A panorama spans all directions at any shape.
                if let Some(extent) = scene.camera.projection.extent_mut() {
                    extent.half_width = (f64::from(extent.half_height) * aspect) as f32;
                }
            }
            (scene.film.width, scene.film.height) = (width, height);
        }
        scene.film.filter = self.filter.unwrap_or(scene.film.filter);
        let s = &mut scene.settings;
        s.spp = self.spp.unwrap_or(s.spp);
        s.max_depth = self.max_depth.map_or(s.max_depth, |d| d.0);
        if let Some(integrator) = self.integrator {
            s.integrator = integrator;
            if integrator == Integrator::Whitted && self.spp.is_none() {
                s.spp = 1;
            }
        }
        s.strategy = self.strategy.unwrap_or(s.strategy);
        s.light_selection = self.light_selection.unwrap_or(s.light_selection);
        s.sampler = self.sampler.unwrap_or(s.sampler);
        if let Some(roulette) = self.roulette {
            s.roulette = roulette != Roulette::Off;
            s.survival = match roulette {
                Roulette::Aggressive => Settings::AGGRESSIVE,
                Roulette::On | Roulette::Off => Settings::default().survival,
            };
        }
        if let Some(split) = &self.split {
            s.split.clone_from(&split.0);
        }
        s.seed = self.seed.unwrap_or(s.seed);
        s.texture_lod = self.texture_lod.unwrap_or(s.texture_lod);
        s.ao_distance = self.ao_distance.or(s.ao_distance);
    }

    /// The options that were given, by name.
    pub(crate) fn given(&self) -> Vec<&'static str> {
        given(&[
            ("--spp", self.spp.is_some()),
            ("--size", self.size.is_some()),
            ("--max-depth", self.max_depth.is_some()),
            ("--integrator", self.integrator.is_some()),
            ("--strategy", self.strategy.is_some()),
            ("--light-selection", self.light_selection.is_some()),
            ("--sampler", self.sampler.is_some()),
            ("--roulette", self.roulette.is_some()),
            ("--split", self.split.is_some()),
            ("--seed", self.seed.is_some()),
            ("--texture-lod", self.texture_lod.is_some()),
            ("--filter", self.filter.is_some()),
            ("--ao-distance", self.ao_distance.is_some()),
        ])
    }

    /// Refuses what cannot be counted, of a scene over which these options have been put.
    pub(crate) fn ensure_countable(scene: &Scene) -> Result<(), Failure> {
        let s = &scene.settings;
        let branches: u64 = s.split.iter().map(|&n| u64::from(n)).product();
        let all = branches.saturating_mul(u64::from(s.spp));
        if all <= i32::MAX as u64 {
            return Ok(());
        }
        Err(Failure::input(format!(
            "{} samples of {branches} branches each are too many; expected at most {} branches in all",
            s.spp,
            i32::MAX
        )))
    }

    /// Warnings about options that do nothing for `scene`, over which they have been put.
    pub(crate) fn needless(&self, scene: &Scene) -> Vec<String> {
        let integrator = scene.settings.integrator;
        let no_ao = self.ao_distance.is_some() && integrator != Integrator::Ao;
        let reference = self.sampler.is_some() && integrator == Integrator::Reference;
        let whitted = self.strategy.is_some() && integrator == Integrator::Whitted;
        let whole =
            self.texture_lod == Some(TextureLod::Footprint) && integrator == Integrator::Reference;
        let one_way = self.split.is_some()
            && (!integrator.is_transport() || integrator == Integrator::Reference);
        [
            (
                no_ao,
                "--ao-distance does nothing: the integrator is not ao",
            ),
            (
                reference,
                "--sampler does nothing: the integrator reference has numbers of its own",
            ),
            (
                whitted,
                "--strategy does nothing: the integrator whitted samples lights alone",
            ),
            (
                whole,
                "--texture-lod does nothing: the integrator reference reads images at their finest",
            ),
            (
                one_way,
                "--split does nothing: paths of this integrator never branch",
            ),
        ]
        .into_iter()
        .filter(|(needless, _)| *needless)
        .map(|(_, message)| message.to_owned())
        .collect()
    }
}

impl WorkOptions {
    /// The options that were given, by name.
    pub(crate) fn given(&self) -> Vec<&'static str> {
        given(&[
            ("--bvh", self.bvh.is_some()),
            ("--threads", self.threads.is_some()),
            ("--wave", self.wave.is_some()),
            ("--tile", self.tile.is_some()),
        ])
    }

    /// Puts these options over those of the scene.
    pub(crate) fn apply(&self, s: &mut Settings) {
        s.bvh = self.bvh.unwrap_or(s.bvh);
        s.threads = self.threads.map_or(s.threads, usize::from);
        s.wave = self.wave.map_or(s.wave, |w| w as usize);
        s.tile = self.tile.unwrap_or(s.tile);
    }
}

/// Everything that the image depends on besides the scene's contents, as options that would ask for
/// it again.
pub(crate) fn as_options(scene: &Scene) -> String {
    let s = &scene.settings;
    let name = |v: Option<clap::builder::PossibleValue>| {
        v.map_or_else(String::new, |v| v.get_name().to_owned())
    };
    let mut text = format!(
        "--size {}x{} --spp {} --max-depth {} --integrator {} --strategy {} \
         --light-selection {} --sampler {} --roulette {} --seed {} --filter {}",
        scene.film.width,
        scene.film.height,
        s.spp,
        s.max_depth.map_or("none".to_owned(), |d| d.to_string()),
        name(s.integrator.to_possible_value()),
        name(s.strategy.to_possible_value()),
        name(s.light_selection.to_possible_value()),
        name(s.sampler.to_possible_value()),
        roulette(s),
        s.seed,
        name(scene.film.filter.to_possible_value()),
    );
    if !s.split.is_empty() {
        text += &format!(" --split {}", values::list(&s.split));
    }
    if s.texture_lod != TextureLod::default() {
        text += &format!(" --texture-lod {}", name(s.texture_lod.to_possible_value()));
    }
    if let Some(distance) = s.ao_distance {
        text += &format!(" --ao-distance {distance}");
    }
    text
}

/// The roulette as its option says it.
pub(crate) fn roulette(s: &Settings) -> &'static str {
    match s {
        _ if !s.roulette => "off",
        _ if s.survival == Settings::AGGRESSIVE => "aggressive",
        _ => "on",
    }
}

/// The names of those options that were given.
pub(crate) fn given(options: &[(&'static str, bool)]) -> Vec<&'static str> {
    let given = options.iter().filter(|(_, given)| *given);
    given.map(|(name, _)| *name).collect()
}
