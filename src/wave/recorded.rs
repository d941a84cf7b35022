//! A wave in the middle of a render, stopped between stages: what the stages' benchmarks run on, so that
//! their queues hold what a real scene puts there and not noise.

use super::Wave;
use super::branch::Slots;
use super::generate::Source;
use super::instruments::Instruments;
use super::setup::Setup;
use super::tables::SceneTables;
use crate::effects::Effects;
use crate::film::{Film, Job, SampleBuffer, filter};
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::settings::Settings;
use std::time::Instant;

/// A wave whose queues are full of a scene's paths. Each stage finds what the stage before it left.
pub struct Recorded<'a> {
    wave: Wave<'a>,
    /// For the stages that write what others read.
    other: Wave<'a>,
    job: Job,
    samples: SampleBuffer,
}

/// The stages that can be run again and again, by name, in the order of the loop.
pub const RECORDED_STAGES: [&str; 7] = [
    "generate",
    "intersect",
    "sort",
    "emit",
    "scatter",
    "occlude",
    "roulette",
];

/// Plays the loop for `turns` turns on samples from the middle of the image, and calls `with` with the
/// wave as it then is.
///
/// # Panics
/// If the film has no pixels, or the job ends before (it has as many samples as keep the wave full).
pub fn recorded<T>(
    scene: &Scene,
    geometry: &Geometry,
    settings: &Settings,
    turns: usize,
    with: impl FnOnce(Recorded) -> T,
) -> T {
    let tables = SceneTables::new(scene, settings);
    let effects = Effects::of(scene, settings);
    let filter = filter::shared_table(scene.film.filter);
    let setup = Setup::new(scene, &effects, &tables, geometry, settings, filter);
    let film = Film::new(scene.film.width, scene.film.height, settings.tile);
    let tile_index = film.tiles().len() / 2;
    let tile = film.tiles()[tile_index];
    let job = Job {
        tile_index,
        tile,
        first_sample: 0,
        samples: (setup.capacity * (turns + 2)).div_ceil(tile.pixels() as usize) as u32,
    };
    let wave = || Wave::new(&setup, &Instruments::default(), Instant::now());
    let mut recorded = Recorded {
        wave: wave(),
        other: wave(),
        job,
        samples: SampleBuffer::new(job.slots()),
    };
    let mut source = Source::new(slots(&job));
    for turn in 0..=turns {
        let Recorded {
            wave, samples, job, ..
        } = &mut recorded;
        wave.generate(&mut source, slots(job));
        assert!(wave.paths.room() == 0, "the job keeps the wave full");
        wave.intersect(slots(job));
        wave.travel();
        wave.sort();
        wave.emit(slots(job), samples);
        wave.disperse();
        wave.scatter(slots(job), samples);
        wave.occlude(slots(job), samples);
        if turn < turns {
            wave.roulette(slots(job));
        }
    }
    with(recorded)
}

/// All slots of a job, one a camera sample.
fn slots(job: &Job) -> Slots<'_> {
    Slots::new(job, 0..job.slots(), 1)
}

impl Recorded<'_> {
    /// Runs a stage of [`RECORDED_STAGES`] over what it found in the loop, and returns how many items
    /// it had: 0 if this scene has none for it. `roulette` first copies its paths, which it changes.
    ///
    /// # Panics
    /// If there is no such stage.
    pub fn run(&mut self, stage: &str) -> usize {
        let Self {
            wave,
            other,
            job,
            samples,
        } = self;
        match stage {
            "generate" => {
                other.paths.set_len(0);
                other.generate(&mut Source::new(slots(job)), slots(job));
                other.paths.len()
            }
            "intersect" => {
                wave.intersect(slots(job));
                wave.paths.len()
            }
            "sort" => {
                wave.sort();
                wave.paths.len()
            }
            "emit" => {
                wave.emit(slots(job), samples);
                wave.lists.sky.len() + wave.lists.emission.len()
            }
            "scatter" => {
                wave.scatter(slots(job), samples);
                wave.scattered.len()
            }
            "occlude" => {
                wave.occlude(slots(job), samples);
                wave.shadows.len()
            }
            "roulette" => {
                other.scattered.copy_from(&wave.scattered);
                other.roulette(slots(job));
                wave.scattered.len()
            }
            _ => panic!("no stage {stage}: there are {RECORDED_STAGES:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_finds_the_same_every_time() {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.toml");
        let mut scene = crate::scene::load(scene.as_ref()).expect("it ships");
        (scene.film.width, scene.film.height) = (64, 64);
        let settings = Settings {
            wave: 500,
            max_depth: Some(5),
            ..scene.settings.clone()
        };
        let geometry = Geometry::build(&scene.mesh);
        recorded(&scene, &geometry, &settings, 6, |mut r| {
            for stage in RECORDED_STAGES {
                let first = r.run(stage);
                assert!(first > 0, "{stage}");
                let shadows = r.wave.shadows.view().t_max.to_vec();
                assert_eq!(r.run(stage), first, "{stage}");
                assert_eq!(r.wave.shadows.view().t_max, shadows, "{stage}");
            }
            assert_eq!(r.wave.paths.len(), 500);
            let bounces = &r.wave.paths.view().bounces[..500];
            assert!(
                bounces.iter().any(|b| *b != bounces[0]),
                "paths of all ages"
            );
        });
    }
}
