//! The images that a render writes: which, how, and the writing.

use crate::cli::failure::Failure;
use crate::cli::options;
use crate::cli::stats::Stats;
use crate::cli::summary::plural;
use crate::cli::values;
use huygens::film::Image;
use huygens::film::exr::{ExrOptions, Metadata, write_exr};
use huygens::film::output::{Format, ensure_writable};
use huygens::film::png::{Look, write_png};
use huygens::film::tone::{ToneMap, stops};
use huygens::scene::Scene;
use huygens::settings::Integrator;
use std::path::{Path, PathBuf};

/// What to write.
#[derive(Debug, clap::Args)]
pub(crate) struct OutputOptions {
    /// Image to write: .exr (linear floats) or .png (tone-mapped, for screens); may be given several
    /// times [default: the scene file's stem with .exr and with .png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,

    /// Exposure in stops, -64 to 64: radiance is multiplied by 2^STOPS (PNG only) [default: 0; for
    /// depth, what makes the farthest pixel white]
    #[arg(long, value_name = "STOPS", help_heading = "Output", value_parser = values::stops)]
    #[arg(allow_negative_numbers = true)]
    exposure: Option<f32>,

    /// Tone map (PNG only) [default: filmic for light, none for ao, normals, depth and albedo]
    #[arg(long, value_name = "NAME", help_heading = "Output")]
    tone_map: Option<ToneMap>,

    /// Store half floats (EXR only)
    #[arg(long, help_heading = "Output")]
    half: bool,

    /// Add channels with the variance of each pixel's mean and its number of samples (EXR only)
    #[arg(long, help_heading = "Output")]
    variance: bool,
}

/// An image to write.
#[derive(Debug)]
pub(crate) struct Target {
    pub(crate) path: PathBuf,
    format: Format,
}

impl OutputOptions {
    /// The images to write, in order, each checked as far as it can be before there is anything to
    /// write.
    pub(crate) fn targets(&self, scene: &Path) -> Result<Vec<Target>, Failure> {
        let mut paths = self.output.clone();
        if paths.is_empty() {
            let stem = scene.file_stem().unwrap_or_default();
            for extension in [".exr", ".png"] {
                let mut name = stem.to_owned();
                name.push(extension);
                paths.push(name.into());
            }
        }
        let mut targets = Vec::new();
        for path in paths {
            let format = Format::of(&path)?;
            ensure_writable(&path)?;
            targets.push(Target { path, format });
        }
        Ok(targets)
    }

    /// Warnings about options that do nothing for these images.
    pub(crate) fn needless(&self, targets: &[Target]) -> Vec<String> {
        let without = |format| !targets.iter().any(|t| t.format == format);
        let (no_exr, no_png) = (without(Format::Exr), without(Format::Png));
        [
            ("--half", self.half && no_exr, "no .exr is written"),
            ("--variance", self.variance && no_exr, "no .exr is written"),
            (
                "--exposure",
                self.exposure.is_some() && no_png,
                "no .png is written",
            ),
            (
                "--tone-map",
                self.tone_map.is_some() && no_png,
                "no .png is written",
            ),
        ]
        .into_iter()
        .filter(|(_, needless, _)| *needless)
        .map(|(option, _, why)| format!("{option} does nothing: {why}"))
        .collect()
    }

    /// Writes all images; returns a warning for each that lost something.
    pub(crate) fn write(
        &self,
        targets: &[Target],
        image: &Image,
        scene: &Scene,
        stats: &Stats,
    ) -> Result<Vec<String>, Failure> {
        let metadata = Metadata {
            scene: scene.name.clone(),
            scene_hash: scene.hash,
            spp: if stats.until.is_empty() {
                scene.settings.spp
            } else {
                // Nobody asked for a number.
                image.samples.iter().copied().max().unwrap_or(0)
            },
            seed: scene.settings.seed,
            settings: options::as_options(scene) + &stats.until,
            seconds: stats.seconds.render,
        };
        let options = ExrOptions {
            half: self.half,
            variance: self.variance,
        };
        let look = self.look(scene.settings.integrator, image);
        let mut warnings = Vec::new();
        for Target { path, format } in targets {
            match format {
                Format::Exr => {
                    let cut = write_exr(path, image, &metadata, options)?;
                    if cut > 0 {
                        warnings.push(format!(
                            "{}: {} beyond the range of half floats, cut to 65504",
                            path.display(),
                            plural(cut as u64, "value")
                        ));
                    }
                }
                Format::Png => write_png(path, image.width, image.height, &image.mean, look)?,
            }
        }
        Ok(warnings)
    }

    /// How a PNG shows this integrator's values: light as film would, anything else as it is.
    fn look(&self, integrator: Integrator, image: &Image) -> Look {
        let tone_map = if integrator.is_transport() {
            ToneMap::Filmic
        } else {
            ToneMap::None
        };
        let scale = match (self.exposure, integrator) {
            (Some(exposure), _) => stops(exposure),
            // Distances have no natural white.
            (None, Integrator::Depth) => {
                let farthest = image
                    .mean
                    .as_flattened()
                    .iter()
                    .copied()
                    .fold(0.0, f32::max);
                if farthest > 0.0 {
                    1.0 / f64::from(farthest)
                } else {
                    1.0
                }
            }
            (None, _) => 1.0,
        };
        Look {
            scale,
            tone_map: self.tone_map.unwrap_or(tone_map),
        }
    }
}
