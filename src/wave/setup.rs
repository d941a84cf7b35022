//! What all workers of a render share: the scene as tables, and the stages' settings.

use super::camera;
use super::sampling::AnySampler;
use super::shade::Program;
use super::sort::Wanted;
use super::tables::{self, SceneTables};
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::settings::Settings;
use huygens_kernels::camera::Lens;
use huygens_kernels::roulette::Rules;
use huygens_kernels::tables::Tables;

/// The wave, as assembled for one render.
pub(crate) struct Setup<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) tables: Tables<'a>,
    pub(crate) emits: Vec<bool>,
    pub(crate) lens: Lens<'a>,
    pub(crate) sampler: AnySampler,
    pub(crate) program: Program,
    pub(crate) wanted: Wanted,
    pub(crate) rules: Rules,
    pub(crate) capacity: usize,
}

impl<'a> Setup<'a> {
    /// Assembles the wave. `filter` is the table of the scene's pixel filter.
    pub(crate) fn new(
        scene: &'a Scene,
        scene_tables: &'a SceneTables,
        geometry: &'a Geometry,
        settings: &Settings,
        filter: &'a [f32],
    ) -> Self {
        let tenth = 0.1 * tables::diagonal(&scene.mesh) as f32;
        let program = Program::new(
            settings.integrator,
            settings.strategy,
            scene_tables.has_lights(),
            settings.ao_distance.unwrap_or(tenth),
        );
        let limit = if program.is_transport() {
            settings.depth_limit()
        } else {
            1
        };
        let sky = scene.sky.is_some_and(|sky| sky.shines());
        Self {
            geometry,
            tables: scene_tables.view(scene),
            emits: scene
                .materials
                .iter()
                .map(crate::scene::Material::emits)
                .collect(),
            lens: Lens {
                camera: camera::in_pixels(&scene.camera, &scene.film),
                filter,
                last_ray: limit == 0,
            },
            sampler: AnySampler::new(settings),
            program,
            wanted: program.wanted(sky),
            rules: Rules {
                random: settings.roulette,
                gain: settings.survival,
                limit,
                last_ray: program.last_ray_is_of_use(),
            },
            capacity: settings.wave.max(1),
        }
    }
}
