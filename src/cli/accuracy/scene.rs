//! `huygens accuracy` of a scene.

use super::{Args, scene_json, scene_page, scene_table};
use crate::cli::failure::{Failure, warn};
use crate::cli::interrupt::Interrupts;
use crate::cli::load::load;
use crate::cli::options::{ImageOptions, SceneOptions};
use crate::cli::progress::Progress;
use crate::cli::text::{duration, out};
use clap::ValueEnum;
use huygens::accuracy::scene::{
    Family, SceneStudy, Stage, Strips, Target, Truth, TruthError, choices, meet_target, strips,
    study_scene,
};
use huygens::accuracy::{End, Ladder};
use huygens::film::exr::read_exr;
use huygens::geometry::Geometry;
use huygens::scene::{FilmSpec, Scene};
use huygens::settings::Integrator;
use huygens::wave::Control;
use miette::Report;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// End of the ladder in samples a pixel.
const LAST: u32 = 64;
/// Renders at each rung.
const REPETITIONS: u32 = 4;
/// Error whose cost decides.
const TARGET_ERROR: f64 = 0.02;
/// Pixels of an image whose size nobody says.
const PIXELS: f64 = 128.0 * 128.0;
/// The share of the budget that goes to a reference at most.
const REFERENCE: f64 = 0.4;

/// The share of the budget that renders to the target error have at most.
const TARGET: f64 = 0.2;

/// A study that is done, as it is shown.
pub(super) struct Done<'a> {
    pub(super) scene: &'a Scene,
    pub(super) file: &'a Path,
    pub(super) truth: &'a Truth,
    pub(super) ladder: &'a Ladder,
    pub(super) target_error: f64,
    pub(super) study: &'a SceneStudy,
    pub(super) strips: Option<Strips>,
    /// Sentences.
    pub(super) advice: Vec<String>,
    pub(super) threads: usize,
    /// `complete`, `budget` or `interrupted`.
    pub(super) ended: &'static str,
    pub(super) seconds: f64,
}

pub(super) fn run(args: &Args, path: &Path) -> Result<(), Failure> {
    let start = Instant::now();
    let interrupts = Interrupts::watch()?;
    let progress = Progress::new(args.quiet);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.work.threads.map_or(0, usize::from))
        .build()
        .map_err(|e| Failure::Other(miette::miette!("cannot start threads: {e}")))?;
    let options = SceneOptions {
        scene: path.to_owned(),
        strict: args.scene.strict,
        max_memory: args.scene.max_memory,
    };
    let loaded = pool.install(|| load(&options, args.image.size, args.work.bvh, progress))?;
    let mut scene = loaded.scene;
    let image = ImageOptions {
        size: Some(size(args, &scene.film)?),
        ..args.image.clone()
    };
    image.apply(&mut scene);
    args.work.apply(&mut scene.settings);
    let mut warnings = scene.warnings.clone();
    warnings.extend(image.needless(&scene));
    warn(&warnings, args.scene.strict)?;
    scene.settings.spp = args.image.spp.unwrap_or(LAST);
    ImageOptions::ensure_countable(&scene)?;
    if !matches!(
        scene.settings.integrator,
        Integrator::Path | Integrator::Direct
    ) {
        return Err(Failure::input(
            "only the integrators path and direct can be studied; the others have no choices",
        ));
    }
    let build = || pool.install(|| Geometry::of(&scene, scene.settings.bvh));
    let (geometry, _) = progress.phase("build", build);

    let families = args.scene.vary.clone();
    let families = families.unwrap_or_else(|| Family::value_variants().to_vec());
    let choices = choices(&scene, &families);
    let ladder = Ladder {
        first: 1,
        last: args.image.spp.unwrap_or(LAST) as usize,
        repetitions: args.repetitions.unwrap_or(REPETITIONS),
        seed: scene.settings.seed,
    };
    let target_error = args.scene.target_error.unwrap_or(TARGET_ERROR);
    let control = interrupts.rendering();
    if let Some(budget) = args.budget {
        // Set once, here.
        let _ = control.deadline.set(start + budget);
    }
    let bar = progress.share();
    let stage = Stage {
        scene: &scene,
        geometry: &geometry,
        control,
        progress: &|what, share| bar.show(what, share),
    };
    let truth = truth(args, path, &stage, start)?;
    let wants_strips = args.html.is_some();
    let for_strips = |curves: &[_]| {
        if wants_strips {
            Strips::seconds_of(curves) * choices.len() as f64
        } else {
            0.0
        }
    };
    let wants_target = families.contains(&Family::Target);
    let for_target = |curves: &[_]| {
        let most = args
            .budget
            .map_or(f64::INFINITY, |b| TARGET * b.as_secs_f64());
        let all = f64::from(ladder.repetitions) * Target::seconds_of(curves, target_error);
        if wants_target { all.min(most) } else { 0.0 }
    };
    let reserve = |curves: &[_]| for_strips(curves) + for_target(curves);
    let mut study = study_scene(&stage, &truth, &choices, &ladder, target_error, reserve);
    if wants_target {
        let foreseen = Target::seconds_of(&study.curves, target_error);
        let reserve = for_strips(&study.curves);
        let renders = ladder.repetitions;
        study.target = meet_target(&stage, &truth, target_error, renders, foreseen, reserve);
    }
    let strips = wants_strips.then(|| strips(&stage, &truth, &choices, &study.curves));
    drop(bar);
    let ended = match study.end {
        _ if interrupts.received() => "interrupted",
        End::Complete => "complete",
        End::Stopped => "budget",
    };
    if study.measured().next().is_none() {
        return Err(nothing(args, ended));
    }
    let done = Done {
        scene: &scene,
        file: path,
        truth: &truth,
        ladder: &ladder,
        target_error,
        study: &study,
        strips,
        advice: huygens::accuracy::scene::advice(&study, target_error, duration),
        threads: pool.current_num_threads(),
        ended,
        seconds: start.elapsed().as_secs_f64(),
    };
    show(args, &done)
}

fn show(args: &Args, done: &Done) -> Result<(), Failure> {
    if let Some(path) = &args.json {
        scene_json::Report::new(done).write(path)?;
    }
    args.write_pages(&scene_page::page(done)?)?;
    if !args.quiet {
        out(&scene_table::text(done));
    }
    if done.ended == "interrupted" {
        return Err(Failure::Interrupted("showed what there is".into()));
    }
    Ok(())
}

/// The image's size: as asked, or the reference's, or the scene's shape with few pixels.
fn size(args: &Args, film: &FilmSpec) -> Result<(u32, u32), Failure> {
    if let Some(size) = args.image.size {
        return Ok(size);
    }
    if let Some(path) = &args.scene.reference {
        let reference = read_exr(path).map_err(|e| Failure::Input(Report::new(e)))?;
        return Ok((reference.width, reference.height));
    }
    let (width, height) = (f64::from(film.width), f64::from(film.height));
    let scale = (PIXELS / (width * height)).sqrt().min(1.0);
    let side = |pixels: f64| (pixels * scale).round().max(1.0) as u32;
    Ok((side(width), side(height)))
}

/// The reference: given, kept beside the scene, or made (and kept there).
fn truth(args: &Args, scene: &Path, stage: &Stage, start: Instant) -> Result<Truth, Failure> {
    let wrong = |e: TruthError| match e {
        TruthError::Stopped => nothing(args, ended(stage.control, args.budget, start)),
        other => Failure::Input(Report::new(other)),
    };
    if let Some(path) = &args.scene.reference {
        return Truth::given(path, stage.scene).map_err(wrong);
    }
    let target = args.scene.target_error.unwrap_or(TARGET_ERROR);
    let error = args.scene.reference_error.unwrap_or(0.5 * target);
    let kept = kept(scene, &stage.scene.film);
    let cached = || Truth::cached(&kept, stage.scene, error);
    if let Some(truth) = (!args.scene.no_cache).then(cached).flatten() {
        return Ok(truth);
    }
    let deadline = args.budget.map(|b| start + b.mul_f64(REFERENCE));
    let truth = Truth::make(stage, error, deadline).map_err(wrong)?;
    if truth.error > error {
        warn(
            &[format!(
                "the reference was stopped at an error of {:.2}%, short of {:.2}%: its noise is \
                 taken out of the errors, as far as it is known",
                100.0 * truth.error,
                100.0 * error
            )],
            false,
        )?;
    }
    if !args.scene.no_cache
        && let Err(e) = truth.store(&kept, stage.scene)
    {
        warn(&[format!("the reference is not kept: {e}")], false)?;
    }
    Ok(truth)
}

/// Where the reference of a scene is kept.
fn kept(scene: &Path, film: &FilmSpec) -> PathBuf {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    let name = format!("{stem}.reference-{}x{}.exr", film.width, film.height);
    scene.with_file_name(name)
}

fn ended(control: &Control, budget: Option<Duration>, start: Instant) -> &'static str {
    let over = budget.is_some_and(|b| start.elapsed() >= b);
    if over || !control.stop.load(Ordering::Relaxed) {
        "budget"
    } else {
        "interrupted"
    }
}

/// What to say when there is nothing to show.
fn nothing(args: &Args, ended: &str) -> Failure {
    match (ended, args.budget) {
        ("budget", Some(budget)) => Failure::Input(miette::miette!(
            help = "give it more, a smaller --size, or a --reference",
            "the budget of {} is too short for a reference and the first rung",
            duration(budget.as_secs_f64())
        )),
        _ => Failure::Interrupted("no rung was finished, so there is nothing to show".into()),
    }
}
