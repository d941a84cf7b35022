//! `--stats`: the numbers of a render for scripts. The layout is an interface: `docs/stats.md`
//! documents it, and a test holds the two together.

use crate::cli::json;
use crate::cli::until::UntilOptions;
use huygens::effects::light_selection;
use huygens::film::output::OutputError;
use huygens::scene::{Filter, Scene};
use huygens::settings::{Integrator, LightSelection, Preset, Sampler, Strategy, TextureLod};
use huygens::wave::Dropped;
use huygens::wave::{RenderStats, StageStats};
use serde::Serialize;
use std::path::Path;

/// Version of the layout. It grows when a field changes its meaning or goes; new fields may appear
/// without that.
pub(crate) const SCHEMA: u32 = 2;

/// The whole file.
#[derive(Debug, Serialize)]
pub(crate) struct Stats {
    schema: u32,
    program: &'static str,
    version: &'static str,
    scene: SceneStats,
    image: ImageStats,
    settings: SettingsStats,
    pub(crate) seconds: Seconds,
    pub(crate) samples: Samples,
    pub(crate) rays: Rays,
    /// Mean number of scattering events on a path.
    pub(crate) mean_depth: f64,
    pub(crate) threads: usize,
    pub(crate) peak_memory_bytes: Option<u64>,
    pub(crate) interrupted: bool,
    /// The relative error asked for.
    target_error: Option<f64>,
    /// Seconds of rendering asked for.
    time: Option<f64>,
    /// The relative error, if it was estimated.
    pub(crate) error: Option<f64>,
    /// How the image's end was asked for, as options.
    #[serde(skip)]
    pub(crate) until: String,
    pub(crate) dropped: DroppedStats,
    pub(crate) untraceable: DroppedStats,
    warnings: Vec<String>,
    pub(crate) outputs: Vec<String>,
    pub(crate) stages: Vec<StageStats>,
}

#[derive(Debug, Serialize)]
struct SceneStats {
    name: String,
    file: String,
    hash: String,
    triangles: usize,
    vertices: usize,
    materials: usize,
}

#[derive(Debug, Serialize)]
struct ImageStats {
    width: u32,
    height: u32,
    filter: Filter,
}

#[derive(Debug, Serialize)]
struct SettingsStats {
    integrator: Integrator,
    strategy: Strategy,
    light_selection: LightSelection,
    sampler: Sampler,
    spp: u32,
    max_depth: Option<u32>,
    roulette: bool,
    survival: f32,
    split: Vec<u32>,
    seed: u32,
    texture_lod: TextureLod,
    ao_distance: Option<f32>,
    bvh: Preset,
    wave: usize,
    tile: u32,
}

/// Wall-clock seconds of each phase, and what the render's went to.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Seconds {
    pub(crate) parse: f64,
    pub(crate) compile: f64,
    pub(crate) build: f64,
    pub(crate) render: f64,
    /// Processor seconds of the render.
    render_cpu: Option<f64>,
    /// Seconds of all workers.
    workers: f64,
    pub(crate) write: f64,
    pub(crate) total: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Samples {
    pub(crate) done: u64,
    asked: u64,
    pub(crate) per_second: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Rays {
    pub(crate) camera: u64,
    pub(crate) bounce: u64,
    pub(crate) shadow: u64,
    total: u64,
    pub(crate) per_second: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct DroppedStats {
    pub(crate) total: u64,
    pub(crate) stages: Vec<Dropped>,
}

impl DroppedStats {
    fn new(stages: Vec<Dropped>) -> Self {
        Self {
            total: stages.iter().map(|d| d.count).sum(),
            stages,
        }
    }
}

impl Stats {
    /// The numbers of `render`, a render of `scene` from `file`; what follows it is still empty.
    pub(crate) fn new(
        scene: &Scene,
        file: &Path,
        render: RenderStats,
        warnings: &[String],
    ) -> Self {
        let s = &scene.settings;
        let per_second = |n: u64| {
            if render.seconds > 0.0 {
                n as f64 / render.seconds
            } else {
                0.0
            }
        };
        let rays = render.camera_rays + render.bounce_rays + render.shadow_rays;
        let pixels = u64::from(scene.film.width) * u64::from(scene.film.height);
        Self {
            schema: SCHEMA,
            program: "huygens",
            version: env!("CARGO_PKG_VERSION"),
            scene: SceneStats {
                name: scene.name.clone(),
                file: file.display().to_string(),
                hash: blake3::Hash::from_bytes(scene.hash).to_hex().to_string(),
                triangles: scene.stored_triangles(),
                vertices: scene.mesh.vertices.len(),
                materials: scene.materials.len(),
            },
            image: ImageStats {
                width: scene.film.width,
                height: scene.film.height,
                filter: scene.film.filter,
            },
            settings: SettingsStats {
                integrator: s.integrator,
                strategy: s.strategy,
                light_selection: light_selection(scene, s).0,
                sampler: s.sampler,
                spp: s.spp,
                max_depth: s.max_depth,
                roulette: s.roulette,
                survival: s.survival,
                split: s.split.clone(),
                seed: s.seed,
                texture_lod: s.texture_lod,
                ao_distance: s.ao_distance,
                bvh: s.bvh,
                wave: s.wave,
                tile: s.tile,
            },
            seconds: Seconds {
                render: render.seconds,
                render_cpu: render.cpu_seconds,
                workers: render.worker_seconds,
                ..Seconds::default()
            },
            samples: Samples {
                done: render.samples,
                asked: pixels * u64::from(s.spp),
                per_second: per_second(render.samples),
            },
            rays: Rays {
                camera: render.camera_rays,
                bounce: render.bounce_rays,
                shadow: render.shadow_rays,
                total: rays,
                per_second: per_second(rays),
            },
            mean_depth: render.mean_depth,
            threads: render.threads,
            peak_memory_bytes: None,
            interrupted: render.stopped,
            target_error: None,
            time: None,
            error: None,
            until: String::new(),
            dropped: DroppedStats::new(render.dropped),
            untraceable: DroppedStats::new(render.untraceable),
            warnings: warnings.to_vec(),
            outputs: Vec::new(),
            stages: render.stages,
        }
    }

    /// How its end was asked for, and the error that came of it.
    pub(crate) fn until(&mut self, until: &UntilOptions, error: Option<f64>) {
        self.target_error = until.target_error;
        self.time = until.time.map(|t| t.as_secs_f64());
        self.error = error;
        self.until = until.as_options();
    }

    /// Writes them to `path`, atomically.
    pub(crate) fn write(&self, path: &Path) -> Result<(), OutputError> {
        json::write(path, self)
    }
}

#[cfg(test)]
pub(crate) mod tests;
