//! `huygens render`.

use crate::cli::failure::{Failure, warn};
use crate::cli::images::{OutputOptions, Target};
use crate::cli::interrupt::Interrupts;
use crate::cli::load::{Loaded, load};
use crate::cli::options::{self, ImageOptions, SceneOptions, WorkOptions};
use crate::cli::progress::Progress;
use crate::cli::stats::Stats;
use crate::cli::summary::{plural, summary};
use crate::cli::system::{peak_memory, physical_memory};
use crate::cli::text::{bytes, out};
use crate::cli::until::{Rendered, UntilOptions};
use huygens::film::output::ensure_writable;
use huygens::film::{Film, Image};
use huygens::geometry::Geometry;
use huygens::scene::FilmSpec;
use huygens::wave;
use std::path::PathBuf;
use std::time::Instant;

/// Render a scene to images
#[derive(Debug, clap::Args)]
#[command(args_override_self = true)]
pub(crate) struct Args {
    #[command(flatten)]
    scene: SceneOptions,

    /// Write the numbers of the render as JSON (see docs/stats.md)
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,

    /// Print nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,

    #[command(flatten)]
    image: ImageOptions,

    #[command(flatten)]
    until: UntilOptions,

    #[command(flatten)]
    work: WorkOptions,

    #[command(flatten)]
    output: OutputOptions,
}

/// Runs `huygens render`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let start = Instant::now();
    let path = &args.scene.scene;
    let targets = args.output.targets(path)?;
    if let Some(path) = &args.stats {
        ensure_writable(path)?;
    }
    let interrupts = Interrupts::watch()?;
    let progress = Progress::new(args.quiet);

    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.work.threads.map_or(0, usize::from))
        .build()
        .map_err(|e| Failure::Other(miette::miette!("cannot start threads: {e}")))?;
    let Loaded {
        mut scene,
        parse_seconds,
        compile_seconds,
    } = pool.install(|| load(&args.scene, args.image.size, args.work.bvh, progress))?;
    args.image.apply(&mut scene);
    args.until.apply(args.image.spp, &mut scene.settings);
    args.work.apply(&mut scene.settings);
    let mut warnings = scene.warnings.clone();
    warnings.extend(args.image.needless(&scene));
    warnings.extend(args.output.needless(&targets));
    warn(&warnings, args.scene.strict)?;
    ImageOptions::ensure_countable(&scene)?;
    ensure_memory(&scene.film, physical_memory())?;

    let label = format!(
        "build over {}",
        plural(scene.mesh.triangles() as u64, "triangle")
    );
    let build = || pool.install(|| Geometry::build_with(&scene.mesh, scene.settings.bvh));
    let (geometry, build_seconds) = progress.phase(&label, build);

    let film = Film::new(scene.film.width, scene.film.height, scene.settings.tile);
    let control = interrupts.rendering();
    let pixels = u64::from(scene.film.width) * u64::from(scene.film.height);
    if let Some(time) = args.until.time {
        // Set once, here.
        let _ = control.deadline.set(Instant::now() + time);
    }
    let rendered = if args.until.in_rounds(&scene.settings) {
        let rounds = || args.until.render(&scene, &geometry, control);
        progress.phase("render in rounds", rounds).0
    } else {
        let asked = pixels * u64::from(scene.settings.spp);
        let work = || wave::render(&scene, &geometry, &scene.settings, &film, control);
        let render = if args.until.given() {
            progress.phase("render until the time is over", work).0
        } else {
            progress.render(asked, control, work)
        };
        Rendered::at_once(render, &film)
    };
    let interrupted = interrupts.received();
    if rendered.samples == 0 && rendered.stats.stopped {
        let message = "no sample was finished, so nothing is written";
        return Err(if interrupted {
            Failure::Interrupted(message.to_owned())
        } else {
            Failure::Other(miette::miette!(
                "the time was over before a sample was finished"
            ))
        });
    }
    warn(&args.until.missed(&rendered), false)?;

    let Rendered {
        stats: render,
        image,
        error,
        samples,
    } = rendered;
    let mut stats = Stats::new(&scene, path, render, &warnings);
    stats.interrupted = interrupted;
    stats.until(&args.until, error);
    let write = || {
        let image = image.unwrap_or_else(|| film.develop());
        pool.install(|| args.output.write(&targets, &image, &scene, &stats))
    };
    let (written, write_seconds) = progress.phase("write", write);
    warn(&written?, false)?;
    let name = |target: &Target| target.path.display().to_string();
    stats.outputs = targets.iter().map(name).collect();
    stats.seconds.parse = parse_seconds;
    stats.seconds.compile = compile_seconds;
    stats.seconds.build = build_seconds;
    stats.seconds.write = write_seconds;
    stats.seconds.total = start.elapsed().as_secs_f64();
    stats.peak_memory_bytes = peak_memory();
    if let Some(path) = &args.stats {
        stats.write(path)?;
    }
    if !args.quiet {
        out(&summary(&scene.name, &options::as_options(&scene), &stats));
    }
    if stats.interrupted || interrupts.received() {
        let mean = samples as f64 / pixels as f64;
        let of = match scene.settings.spp {
            _ if args.until.given() && args.image.spp.is_none() => String::new(),
            spp => format!(" of {spp}"),
        };
        let message = format!("wrote the image with {mean:.2}{of} samples a pixel");
        return Err(Failure::Interrupted(message));
    }
    Ok(())
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
