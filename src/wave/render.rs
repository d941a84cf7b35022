//! A whole render: sets up, lets the scheduler run, adds up.

use super::account::Account;
use super::setup::Setup;
use super::stats::RenderStats;
use super::tables::SceneTables;
use super::{Control, Wave, scheduler};
use crate::film::{Film, Job, SampleBuffer, filter};
use crate::geometry::Geometry;
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
    let start = Instant::now();
    let size = (scene.film.width, scene.film.height);
    assert_eq!(film.size(), size, "the film is not the scene's");
    let (account, threads) = if settings.integrator == Integrator::Reference {
        let reference = Reference::new(scene, settings);
        let run = || Oracle::new(&reference);
        accounts(scheduler::run(film, settings, control, run), |o| o.account)
    } else {
        let tables = SceneTables::new(scene);
        let filter = filter::shared_table(scene.film.filter);
        let setup = Setup::new(scene, &tables, geometry, settings, filter);
        accounts(
            scheduler::run(film, settings, control, || Wave::new(&setup)),
            |w| w.account,
        )
    };
    let (camera_rays, bounce_rays, shadow_rays) = account.rays();
    let (stages, dropped) = account.report();
    RenderStats {
        seconds: start.elapsed().as_secs_f64(),
        threads,
        samples: control.samples.load(Ordering::Relaxed),
        camera_rays,
        bounce_rays,
        shadow_rays,
        mean_depth: bounce_rays as f64 / camera_rays.max(1) as f64,
        stopped: control.stop.load(Ordering::Relaxed),
        stages,
        dropped,
    }
}

/// All workers' accounts as one, and how many workers there were.
fn accounts<W>(workers: Vec<W>, account: impl Fn(W) -> Account) -> (Account, usize) {
    let threads = workers.len();
    let mut sum = Account::new();
    for worker in workers {
        sum.merge(&account(worker));
    }
    (sum, threads)
}

/// The reference tracer as a worker. It counts no rays and has no stages.
struct Oracle<'a> {
    reference: &'a Reference<'a>,
    account: Account,
}

impl<'a> Oracle<'a> {
    fn new(reference: &'a Reference<'a>) -> Self {
        Self {
            reference,
            account: Account::new(),
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

    fn left_out(&mut self, samples: &[(u32, u32, u32)]) {
        for &at in samples {
            self.account.drop_sample("film", at);
        }
    }
}
