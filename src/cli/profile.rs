//! `huygens profile`.

mod text;

use crate::cli::failure::{Failure, warn};
use crate::cli::json;
use crate::cli::load::load;
use crate::cli::options::{self, ImageOptions, SceneOptions, WorkOptions};
use crate::cli::progress::Progress;
use crate::cli::text::out;
use crate::cli::values;
use huygens::film::Film;
use huygens::film::output::{ensure_writable, write_atomically};
use huygens::geometry::Geometry;
use huygens::profile::limits::Limits;
use huygens::profile::{Row, roofline, rows, trace};
use huygens::scene::Scene;
use huygens::wave::{self, COUNTERS, Control, Instruments, RenderStats, available_counters};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Version of the JSON layout, as in `--stats`.
const SCHEMA: u32 = 1;

/// Render for a while and say where the time goes, kernel by kernel
#[derive(Debug, clap::Args)]
#[command(args_override_self = true)]
pub(crate) struct Args {
    #[command(flatten)]
    scene: SceneOptions,

    /// How long to render: a number and ms, s, m or h
    #[arg(long, value_name = "TIME", value_parser = values::time, default_value = "5s")]
    time: Duration,

    /// Write the numbers as JSON (see docs/profiling.md)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Write a timeline, for Perfetto or chrome://tracing: a row a worker, a slice a call of a stage
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,

    /// Most slices of a worker's row in the timeline, 1 to 10000000
    #[arg(
        long,
        value_name = "N",
        default_value_t = 50_000,
        allow_negative_numbers = true
    )]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    trace_slices: u32,

    /// Write the roofline as SVG
    #[arg(long, value_name = "FILE")]
    roofline: Option<PathBuf>,

    #[command(flatten)]
    image: ImageOptions,

    #[command(flatten)]
    work: WorkOptions,
}

/// What a profile says, as JSON.
#[derive(Debug, Serialize)]
struct Profile {
    schema: u32,
    program: &'static str,
    version: &'static str,
    scene: String,
    settings: String,
    threads: usize,
    wave: usize,
    seconds: f64,
    cpu_seconds: Option<f64>,
    worker_seconds: f64,
    samples: u64,
    rays: u64,
    limits: Limits,
    /// Why a counter cannot be read, by its name; null for those that can.
    counters: BTreeMap<&'static str, Option<String>>,
    visits_counted: bool,
    kernels: Vec<Row>,
    bounces: Vec<Bounce>,
}

/// How full the queues are, by bounce.
#[derive(Clone, Copy, Debug, Serialize)]
struct Bounce {
    /// Rays that looked for their closest hit after so many scattering events.
    rays: u64,
    /// Occlusion rays cast after it.
    shadow_rays: u64,
}

/// Runs `huygens profile`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    for path in [&args.json, &args.trace, &args.roofline]
        .into_iter()
        .flatten()
    {
        ensure_writable(path)?;
    }
    let progress = Progress::new(false);
    let mut scene = load(&args.scene, args.image.size, args.work.bvh, progress)?.scene;
    args.image.apply(&mut scene);
    args.work.apply(&mut scene.settings);
    let mut warnings = scene.warnings.clone();
    warnings.extend(args.image.needless(&scene));
    warn(&warnings, args.scene.strict)?;
    let build = || Geometry::of(&scene, scene.settings.bvh);
    let (geometry, _) = progress.phase("build", build);
    let (limits, _) = progress.phase("measure the machine", Limits::measure);
    let available = available_counters();
    let instruments = Instruments {
        slices: args
            .trace
            .as_ref()
            .map_or(0, |_| args.trace_slices as usize),
        counters: available.iter().any(Result::is_ok),
        ..Instruments::default()
    };
    let go = || render(&scene, &geometry, args.time, instruments);
    let (render, _) = progress.phase(&format!("render for {:?}", args.time), go);

    let readable = available.each_ref().map(Result::is_ok);
    let kernels = rows(&render, readable);
    let profile = Profile {
        schema: SCHEMA,
        program: "huygens",
        version: env!("CARGO_PKG_VERSION"),
        scene: scene.name.clone(),
        settings: options::as_options(&scene),
        threads: render.threads,
        wave: scene.settings.wave,
        seconds: render.seconds,
        cpu_seconds: render.cpu_seconds,
        worker_seconds: render.worker_seconds,
        samples: render.samples,
        rays: render.camera_rays + render.bounce_rays + render.shadow_rays,
        limits,
        counters: COUNTERS
            .into_iter()
            .zip(available.into_iter().map(Result::err))
            .collect(),
        visits_counted: huygens_kernels::visits::COUNTED,
        kernels,
        bounces: bounces(&render),
    };
    out(&profile.text());
    if let Some(path) = &args.json {
        json::write(path, &profile)?;
    }
    if let Some(path) = &args.trace {
        write_atomically(path, |to| trace::write(to, &scene.name, &render.timelines))?;
    }
    if let Some(path) = &args.roofline {
        let title = format!("{}: roofline of one core", scene.name);
        let svg = roofline::svg(&limits, &profile.kernels, &title);
        write_atomically(path, |to| to.write_all(svg.as_bytes()))?;
    }
    Ok(())
}

/// Renders the scene again and again, with another seed each time, until the time is over. The
/// timeline is that of the first render.
fn render(
    scene: &Scene,
    geometry: &Geometry,
    time: Duration,
    instruments: Instruments,
) -> RenderStats {
    let end = Instant::now() + time;
    let mut sum = RenderStats::default();
    let mut settings = scene.settings.clone();
    while Instant::now() < end {
        let film = Film::new(scene.film.width, scene.film.height, settings.tile);
        let control = Control::default();
        let first = sum.threads == 0;
        let instruments = Instruments {
            slices: if first { instruments.slices } else { 0 },
            ..instruments
        };
        let stats = std::thread::scope(|scope| {
            let (finished, wait) = std::sync::mpsc::channel::<()>();
            let control = &control;
            scope.spawn(move || {
                // Ends when the render does, by an error, or when the time is over.
                let left = end.saturating_duration_since(Instant::now());
                if wait.recv_timeout(left) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
                    control.stop.store(true, Ordering::Relaxed);
                }
            });
            let stats = wave::render_with(scene, geometry, &settings, &film, control, &instruments);
            drop(finished);
            stats
        });
        sum.add(stats);
        settings.seed = settings.seed.wrapping_add(1);
    }
    sum
}

/// Rays by bounce.
fn bounces(render: &RenderStats) -> Vec<Bounce> {
    let of = |name: &str| {
        let stage = render.stages.iter().find(|s| s.name == name);
        stage.map_or(&[][..], |s| &s.bounces)
    };
    let (rays, shadows) = (of("intersect"), of("occlude"));
    let items = |of: &[wave::BounceStats], i: usize| of.get(i).map_or(0, |b| b.items_in);
    (0..rays.len().max(shadows.len()))
        .map(|i| Bounce {
            rays: items(rays, i),
            shadow_rays: items(shadows, i),
        })
        .collect()
}

#[cfg(test)]
mod tests;
