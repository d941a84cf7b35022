//! One run of a scene, timed.

use super::suite::Standard;
use super::{memory_yardstick, yardstick};
use crate::film::Film;
use crate::geometry::Geometry;
use crate::processor::cpu_seconds;
use crate::resident;
use crate::scene::{self, Scene, SceneError};
use crate::settings::Settings;
use crate::wave::{self, Control, Instruments};
use serde::{Deserialize, Serialize};
use std::io;
use std::time::Instant;

/// A scene that is ready to be rendered, and what that took.
#[derive(Debug)]
pub struct Prepared {
    scene: Scene,
    geometry: Geometry,
    /// Wall-clock seconds of building the acceleration structure.
    pub build_seconds: f64,
    /// Processor seconds of it.
    pub build_cpu_seconds: f64,
    /// Bytes resident before it was made, where the system tells, and lets the peak begin anew.
    before: Option<u64>,
}

/// Why a scene could not be made ready.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// Its files could not be written.
    #[error("cannot write the scene: {0}")]
    Io(#[from] io::Error),
    /// Its files could not be read.
    #[error("cannot load the scene: {0}")]
    Scene(#[from] SceneError),
}

/// One run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Run {
    /// Wall-clock seconds of rendering.
    pub seconds: f64,
    /// Processor seconds of rendering.
    pub cpu_seconds: f64,
    /// Processor seconds of the yardstick, mean of before and after.
    pub yardstick_seconds: f64,
    /// The same of the yardstick that waits for memory.
    #[serde(default)]
    pub memory_seconds: f64,
    /// Worker threads.
    #[serde(default)]
    pub workers: usize,
    /// Seconds by the wall clock that the workers had, all added up.
    #[serde(default)]
    pub worker_seconds: f64,
    /// Camera samples.
    pub samples: u64,
    /// Camera rays.
    pub camera_rays: u64,
    /// Rays after a scattering event.
    pub bounce_rays: u64,
    /// Occlusion rays.
    pub shadow_rays: u64,
    /// Processor nanoseconds an item of each stage, in the order of the loop.
    pub stages: Vec<StageTime>,
}

/// What an item costs a stage.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StageTime {
    /// The stage's name.
    pub name: String,
    /// Processor nanoseconds an item.
    pub nanoseconds: f64,
    /// Its share of the run, 0 to 1.
    pub share: f64,
}

impl Prepared {
    /// Makes a scene of the suite ready, in a temporary folder.
    ///
    /// # Errors
    /// If the folder cannot be written, or the program cannot read its own scene.
    pub fn new(standard: &Standard) -> Result<Self, PrepareError> {
        // Its table stays, and is no scene's.
        let _ = memory_yardstick();
        resident::give_back();
        let before = resident::now().filter(|_| resident::forget_peak());
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("scene.toml");
        std::fs::write(&file, (standard.make)(folder.path())?)?;
        let mut scene = scene::load(&file)?;
        let aspect = f64::from(standard.size[0]) / f64::from(standard.size[1]);
        [scene.film.width, scene.film.height] = standard.size;
        if let Some(extent) = scene.camera.projection.extent_mut() {
            extent.half_width = (f64::from(extent.half_height) * aspect) as f32;
        }
        scene.settings.spp = standard.spp;
        scene.settings.max_depth = Some(standard.max_depth);
        let (start, cpu) = (Instant::now(), cpu_seconds());
        let geometry = Geometry::of(&scene, scene.settings.bvh);
        let build_seconds = start.elapsed().as_secs_f64();
        let build_cpu = cpu.zip(cpu_seconds()).map(|(from, to)| to - from);
        Ok(Self {
            scene,
            geometry,
            build_seconds,
            build_cpu_seconds: build_cpu.unwrap_or(build_seconds),
            before,
        })
    }

    /// Triangles, those of objects counted once: what the tree was built over.
    #[must_use]
    pub fn triangles(&self) -> usize {
        let objects = self.scene.objects.iter().map(|o| o.mesh.triangles());
        self.scene.mesh.triangles() + objects.sum::<usize>()
    }

    /// The most bytes that were resident since it began to be made, beyond those that were before;
    /// of use until the next one is made.
    #[must_use]
    pub fn peak_memory(&self) -> Option<u64> {
        Some(resident::peak()?.saturating_sub(self.before?))
    }

    /// Calls `with` with a wave of this scene in the middle of a render, for benchmarks of its stages.
    pub fn recorded<T>(&self, with: impl FnOnce(wave::Recorded) -> T) -> T {
        // Enough turns for paths of many ages, as most of a render has.
        let (settings, turns) = (&self.scene.settings, 12);
        wave::recorded(&self.scene, &self.geometry, settings, turns, with)
    }

    /// Renders an eighth of the samples, which warms caches, pages and the clock up, with as many workers and
    /// paths as the runs that follow.
    pub fn warm_up(&self, threads: usize, wave: usize) {
        let spp = self.scene.settings.spp.div_ceil(8);
        self.render(threads, wave, spp, &Instruments::default());
    }

    /// Renders once with `threads` workers (0: one a core) and waves of `wave` paths; stages are timed by
    /// the processor's time.
    #[must_use]
    pub fn run(&self, threads: usize, wave: usize) -> Run {
        let instruments = Instruments {
            processor_time: true,
            ..Instruments::default()
        };
        self.run_with(threads, wave, &instruments)
    }

    /// [`Prepared::run`] with these instruments.
    #[must_use]
    pub fn run_with(&self, threads: usize, wave: usize, instruments: &Instruments) -> Run {
        let yardsticks = || [yardstick(), memory_yardstick()];
        let before = yardsticks();
        let stats = self.render(threads, wave, self.scene.settings.spp, instruments);
        let after = yardsticks();
        let all: f64 = stats.stages.iter().map(|s| s.seconds).sum();
        let items = |s: &wave::StageStats| match s.items_in {
            0 => s.items_out,
            n => n,
        };
        let stage = |s: &wave::StageStats| StageTime {
            name: s.name.to_owned(),
            nanoseconds: s.seconds * 1e9 / items(s).max(1) as f64,
            share: s.seconds / all,
        };
        Run {
            seconds: stats.seconds,
            cpu_seconds: stats.cpu_seconds.unwrap_or(stats.seconds),
            yardstick_seconds: 0.5 * (before[0] + after[0]),
            memory_seconds: 0.5 * (before[1] + after[1]),
            workers: stats.threads,
            worker_seconds: stats.worker_seconds,
            samples: stats.samples,
            camera_rays: stats.camera_rays,
            bounce_rays: stats.bounce_rays,
            shadow_rays: stats.shadow_rays,
            stages: stats.stages.iter().map(stage).collect(),
        }
    }

    fn render(
        &self,
        threads: usize,
        wave: usize,
        spp: u32,
        instruments: &Instruments,
    ) -> wave::RenderStats {
        let settings = Settings {
            threads,
            wave,
            spp,
            ..self.scene.settings.clone()
        };
        let film = &self.scene.film;
        let film = Film::new(film.width, film.height, settings.tile);
        let control = Control::default();
        wave::render_with(
            &self.scene,
            &self.geometry,
            &settings,
            &film,
            &control,
            instruments,
        )
    }
}
