//! `huygens render`.

use crate::cli::failure::{Failure, warn};
use crate::cli::interrupt::Interrupts;
use crate::cli::options::{self, ImageOptions, SceneOptions, WorkOptions};
use crate::cli::progress::Progress;
use crate::cli::stats::Stats;
use crate::cli::summary::{plural, summary};
use crate::cli::system::{peak_memory, physical_memory};
use crate::cli::text::{bytes, out};
use huygens::film::exr::{ExrOptions, Metadata, write_exr};
use huygens::film::output::{Format, OutputError, ensure_writable};
use huygens::film::png::{Look, write_png};
use huygens::film::tone::{ToneMap, stops};
use huygens::film::{Film, Image};
use huygens::geometry::Geometry;
use huygens::scene::{self, FilmSpec, Scene};
use huygens::settings::Integrator;
use huygens::wave;
use miette::IntoDiagnostic;
use std::path::PathBuf;
use std::time::Instant;

/// Render a scene to images
#[derive(Debug, clap::Args)]
#[command(args_override_self = true)]
pub(crate) struct Args {
    #[command(flatten)]
    scene: SceneOptions,

    /// Image to write: .exr (linear floats) or .png (tone-mapped, for screens); may be given several
    /// times [default: the scene file's stem with .exr and with .png, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,

    /// Write the numbers of the render as JSON (see docs/stats.md)
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,

    /// Print nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,

    #[command(flatten)]
    image: ImageOptions,

    #[command(flatten)]
    work: WorkOptions,

    /// Exposure in stops, -64 to 64: radiance is multiplied by 2^STOPS (PNG only) [default: 0; for
    /// depth, what makes the farthest pixel white]
    #[arg(long, value_name = "STOPS", help_heading = "Output", value_parser = options::stops)]
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

/// Runs `huygens render`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let start = Instant::now();
    let outputs = args.outputs()?;
    let interrupts = Interrupts::watch()?;
    let progress = Progress::new(args.quiet);

    let path = &args.scene.scene;
    let load = || scene::load(path).into_diagnostic();
    let (scene, load_seconds) = progress.phase(&format!("load {}", path.display()), load);
    let mut scene = scene.map_err(Failure::Input)?;
    args.image.apply(&mut scene);
    args.work.apply(&mut scene.settings);
    let mut warnings = scene.warnings.clone();
    warnings.extend(args.needless(&scene, &outputs));
    warn(&warnings, args.scene.strict)?;
    ensure_memory(&scene.film, physical_memory())?;

    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(scene.settings.threads)
        .build()
        .map_err(|e| Failure::Other(miette::miette!("cannot start threads: {e}")))?;
    let label = format!(
        "build over {}",
        plural(scene.mesh.triangles() as u64, "triangle")
    );
    let build = || pool.install(|| Geometry::build(&scene.mesh));
    let (geometry, build_seconds) = progress.phase(&label, build);

    let film = Film::new(scene.film.width, scene.film.height, scene.settings.tile);
    let control = interrupts.rendering();
    let pixels = u64::from(scene.film.width) * u64::from(scene.film.height);
    let asked = pixels * u64::from(scene.settings.spp);
    let render = progress.render(asked, control, || {
        wave::render(&scene, &geometry, &scene.settings, &film, control)
    });
    if film.samples() == 0 && render.stopped {
        let message = "no sample was finished, so nothing is written";
        return Err(Failure::Interrupted(message.to_owned()));
    }

    let mut stats = Stats::new(&scene, path, render, &warnings);
    let write = || pool.install(|| args.write(&outputs, &film.develop(), &scene, &stats));
    let (written, write_seconds) = progress.phase("write", write);
    stats.outputs = written.map_err(failure)?;
    stats.seconds.load = load_seconds;
    stats.seconds.build = build_seconds;
    stats.seconds.write = write_seconds;
    stats.seconds.total = start.elapsed().as_secs_f64();
    stats.peak_memory_bytes = peak_memory();
    if let Some(path) = &args.stats {
        stats.write(path).map_err(failure)?;
    }
    if !args.quiet {
        out(&summary(&scene.name, &options::as_options(&scene), &stats));
    }
    if stats.interrupted || interrupts.received() {
        let mean = film.samples() as f64 / pixels as f64;
        let spp = scene.settings.spp;
        let message = format!("wrote the image with {mean:.2} of {spp} samples a pixel");
        return Err(Failure::Interrupted(message));
    }
    Ok(())
}

impl Args {
    /// The images to write, in order, each checked as far as it can be before there is anything to
    /// write.
    fn outputs(&self) -> Result<Vec<(PathBuf, Format)>, Failure> {
        let mut paths = self.output.clone();
        if paths.is_empty() {
            let stem = self.scene.scene.file_stem().unwrap_or_default();
            for extension in [".exr", ".png"] {
                let mut name = stem.to_owned();
                name.push(extension);
                paths.push(name.into());
            }
        }
        let mut outputs = Vec::new();
        for path in paths {
            let format = Format::of(&path).map_err(failure)?;
            ensure_writable(&path).map_err(failure)?;
            outputs.push((path, format));
        }
        if let Some(path) = &self.stats {
            ensure_writable(path).map_err(failure)?;
        }
        Ok(outputs)
    }

    /// Warnings about options that do nothing for these outputs or this integrator.
    fn needless(&self, scene: &Scene, outputs: &[(PathBuf, Format)]) -> Vec<String> {
        let without = |format| !outputs.iter().any(|(_, f)| *f == format);
        let (no_exr, no_png) = (without(Format::Exr), without(Format::Png));
        let ao = scene.settings.integrator == Integrator::Ao;
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
            (
                "--ao-distance",
                self.image.ao_distance.is_some() && !ao,
                "the integrator is not ao",
            ),
        ]
        .into_iter()
        .filter(|(_, needless, _)| *needless)
        .map(|(option, _, why)| format!("{option} does nothing: {why}"))
        .collect()
    }

    /// Writes all images; returns a line about each.
    fn write(
        &self,
        outputs: &[(PathBuf, Format)],
        image: &Image,
        scene: &Scene,
        stats: &Stats,
    ) -> Result<Vec<String>, OutputError> {
        let metadata = Metadata {
            scene: scene.name.clone(),
            scene_hash: scene.hash,
            spp: scene.settings.spp,
            seed: scene.settings.seed,
            settings: options::as_options(scene),
            seconds: stats.seconds.render,
        };
        let options = ExrOptions {
            half: self.half,
            variance: self.variance,
        };
        let look = self.look(scene.settings.integrator, image);
        for (path, format) in outputs {
            match format {
                Format::Exr => {
                    let cut = write_exr(path, image, &metadata, options)?;
                    if cut > 0 {
                        let values = plural(cut as u64, "value");
                        let place = path.display();
                        eprintln!(
                            "warning: {place}: {values} beyond the range of half floats stored as \
                             65504"
                        );
                    }
                }
                Format::Png => write_png(path, image.width, image.height, &image.mean, look)?,
            }
        }
        Ok(outputs
            .iter()
            .map(|(p, _)| p.display().to_string())
            .collect())
    }

    /// How a PNG shows this integrator's values: light as film would, anything else as it is.
    fn look(&self, integrator: Integrator, image: &Image) -> Look {
        let tone_map = match integrator {
            Integrator::Path | Integrator::Direct | Integrator::Reference => ToneMap::Filmic,
            Integrator::Ao | Integrator::Normals | Integrator::Depth | Integrator::Albedo => {
                ToneMap::None
            }
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

fn failure(error: OutputError) -> Failure {
    if error.bad_request {
        Failure::Input(error.into())
    } else {
        Failure::Other(error.into())
    }
}

/// Refuses an image that a machine with `available` bytes of memory could never hold.
fn ensure_memory(film: &FilmSpec, available: Option<u64>) -> Result<(), Failure> {
    let (width, height) = (film.width, film.height);
    let pixel = Film::BYTES_PER_PIXEL + Image::BYTES_PER_PIXEL;
    let needed = u64::from(width) * u64::from(height) * pixel as u64;
    match available {
        Some(available) if needed > available => Err(Failure::input(format!(
            "an image of {width} x {height} pixels needs {} of memory; this machine has {}",
            bytes(needed),
            bytes(available)
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use huygens::scene::Filter;

    #[test]
    fn an_image_beyond_all_memory_is_refused() {
        let film = FilmSpec {
            width: 65_535,
            height: 65_535,
            filter: Filter::Box,
        };
        // Eighty-four bytes a pixel, for the film and the image.
        let failure = ensure_memory(&film, Some(16_000_000_000)).expect_err("too large");
        let Failure::Input(report) = failure else {
            panic!("it is the input that is wrong");
        };
        assert_eq!(
            report.to_string(),
            "an image of 65535 x 65535 pixels needs 361 GB of memory; this machine has 16.0 GB"
        );
        assert!(ensure_memory(&film, Some(84 * 65_535 * 65_535)).is_ok());
        assert!(ensure_memory(&film, None).is_ok());
    }
}
