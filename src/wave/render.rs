//! A whole render: sets up, lets the scheduler run, adds up.

use super::account::Account;
use super::instruments::{Instruments, Timeline};
use super::setup::Setup;
use super::stats::RenderStats;
use super::tables::SceneTables;
use super::{Control, Wave, scheduler};
use crate::effects::Effects;
use crate::film::{Film, Job, SampleBuffer, filter};
use crate::geometry::Geometry;
use crate::processor::cpu_seconds;
use crate::reference::Reference;
use crate::scene::Scene;
use crate::settings::{Integrator, Settings};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Renders all samples of `settings` onto `film`, which has the size of the scene's film. Returns
/// early, with whole samples only on the film, when `control` is stopped.
///
/// # Panics
/// If `film` is of another size than the scene says.
pub fn render(
    scene: &Scene,
    geometry: &Geometry,
    settings: &Settings,
    film: &Film,
    control: &Control,
) -> RenderStats {
    render_with(
        scene,
        geometry,
        settings,
        film,
        control,
        &Instruments::default(),
    )
}

/// [`render`] with instruments.
///
/// # Panics
/// If `film` is of another size than the scene says.
pub fn render_with(
    scene: &Scene,
    geometry: &Geometry,
    settings: &Settings,
    film: &Film,
    control: &Control,
    instruments: &Instruments,
) -> RenderStats {
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let size = (scene.film.width, scene.film.height);
    assert_eq!(film.size(), size, "the film is not the scene's");
    let all = if settings.integrator == Integrator::Reference {
        let reference = Reference::new(scene, settings);
        let worker = || Oracle::new(&reference, start);
        let workers = scheduler::run(film, settings, control, worker);
        Accounts::new(workers.into_iter().map(|(o, s)| (o.account, s)), start)
    } else {
        let tables = SceneTables::new(scene, settings);
        let filter = filter::shared_table(scene.film.filter);
        let effects = Effects::of(scene, settings);
        let setup = Setup::new(scene, &effects, &tables, geometry, settings, filter);
        let worker = || Wave::new(&setup, instruments, start);
        let workers = scheduler::run(film, settings, control, worker);
        Accounts::new(workers.into_iter().map(|(w, s)| (w.account, s)), start)
    };
    let (camera_rays, bounce_rays, shadow_rays) = all.sum.rays();
    let [dropped, untraceable] = all.sum.losses();
    RenderStats {
        seconds: start.elapsed().as_secs_f64(),
        cpu_seconds: cpu.zip(cpu_seconds()).map(|(from, to)| to - from),
        worker_seconds: all.seconds,
        threads: all.timelines.len(),
        samples: control.samples.load(Ordering::Relaxed),
        camera_rays,
        bounce_rays,
        shadow_rays,
        mean_depth: bounce_rays as f64 / camera_rays.max(1) as f64,
        stopped: control.stop.load(Ordering::Relaxed),
        stages: all.sum.report(),
        dropped,
        untraceable,
        timelines: all.timelines,
    }
}

/// All workers' accounts: their sum, their time and their timelines.
struct Accounts {
    sum: Account,
    seconds: f64,
    timelines: Vec<Timeline>,
}

impl Accounts {
    fn new(workers: impl Iterator<Item = (Account, f64)>, start: Instant) -> Self {
        let mut all = Self {
            sum: Account::new(&Instruments::default(), start),
            seconds: 0.0,
            timelines: Vec::new(),
        };
        for (mut account, seconds) in workers {
            all.sum.merge(&account);
            all.seconds += seconds;
            all.timelines.push(account.take_timeline());
        }
        all
    }
}

/// The reference tracer as a worker. It counts no rays and has no stages.
struct Oracle<'a> {
    reference: &'a Reference<'a>,
    account: Account,
}

impl<'a> Oracle<'a> {
    fn new(reference: &'a Reference<'a>, epoch: Instant) -> Self {
        Self {
            reference,
            account: Account::new(&Instruments::default(), epoch),
        }
    }
}

impl scheduler::Worker for Oracle<'_> {
    fn trace(&mut self, job: &Job, samples: &mut SampleBuffer, stop: &AtomicBool) -> bool {
        self.reference.render_job(job, samples, stop)
    }

    fn rays(&mut self) -> u64 {
        0
    }

    fn committed(&mut self, _samples: usize, left_out: &[(u32, u32, u32)]) {
        for &at in left_out {
            self.account.drop_sample("film", at);
        }
    }
}
