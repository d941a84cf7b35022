//! What all workers of a render share: the scene as tables, and the stages' settings.

use super::account::Stage;
use super::branch::{self, Branches};
use super::camera;
use super::extras::Carried;
use super::intersect::Obstacles;
use super::mixtures::Mixtures;
use super::parameters::Parameters;
use super::sampling::AnySampler;
use super::shade::Program;
use super::sort::{Route, Routes, Wanted};
use super::surfaces::{self, Surfaces};
use super::tables::{self, SceneTables};
use crate::effects::{Effects, Shader};
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::settings::{Integrator, Settings};
use huygens_kernels::bare::called_for;
use huygens_kernels::camera::Lens;
use huygens_kernels::motion::CameraMotion;
use huygens_kernels::opacity::Opacities;
use huygens_kernels::roulette::{GAINS, Rules};
use huygens_kernels::scatter::texture::Layout;
use huygens_kernels::tables::Tables;

/// The wave, as assembled for one render.
pub(crate) struct Setup<'a> {
    pub(crate) geometry: &'a Geometry,
    pub(crate) tables: Tables<'a>,
    /// Where some surfaces are not wholly there.
    pub(crate) opacities: Option<Opacities<'a>>,
    /// The shaders that the scene's materials call for, in the order in which they run.
    pub(crate) shaders: Vec<Shader>,
    /// For each of them, what images may vary, where they do.
    pub(crate) textured: Vec<Option<Layout>>,
    /// The shader of which some surfaces are brushed along their texture coordinates.
    pub(crate) aligned: Option<Shader>,
    /// Whether shading normals differ from geometric ones anywhere.
    bends: bool,
    /// Whether lights are not the same all over.
    varying_emission: bool,
    /// Where some materials are mixtures of others.
    pub(crate) mixtures: Option<Mixtures<'a>>,
    /// By material.
    pub(crate) routes: Routes,
    pub(crate) lens: Lens<'a>,
    pub(crate) sampler: AnySampler,
    pub(crate) program: Program,
    pub(crate) wanted: Wanted,
    pub(crate) rules: Rules,
    pub(crate) capacity: usize,
    /// The list of paths that media scattered, if any do.
    pub(crate) medium_list: Option<usize>,
    /// How the camera moves, if it does.
    pub(crate) camera_motion: Option<CameraMotion>,
    /// What paths carry besides.
    pub(crate) carried: Carried,
    /// Branches of a path, by scattering event; none of paths that never branch.
    pub(crate) split: Vec<u32>,
}

impl<'a> Setup<'a> {
    /// Assembles the wave. `filter` is the table of the scene's pixel filter.
    pub(crate) fn new(
        scene: &'a Scene,
        effects: &Effects,
        scene_tables: &'a SceneTables<'a>,
        geometry: &'a Geometry,
        settings: &Settings,
        filter: &'a [f32],
    ) -> Self {
        assert_eq!(effects.left_out(), None, "a bare build");
        let tenth = 0.1 * tables::diagonal(scene) as f32;
        let program = Program::new(
            settings.integrator,
            settings.strategy,
            scene_tables.lights.any(),
            settings.ao_distance.unwrap_or(tenth),
        );
        let limit = if program.is_transport() {
            settings.depth_limit()
        } else {
            1
        };
        let mut split = settings.split.clone();
        split.truncate(usize::try_from(limit).unwrap_or(usize::MAX));
        if !program.is_transport() || branch::leaves(&split) == 1 {
            split.clear();
        }
        let used = |s: &Shader| match s {
            Shader::Mix => false,
            Shader::Medium => effects.scattering_media,
            _ => effects.shaders.contains(s),
        };
        let shaders: Vec<Shader> = Shader::ALL.into_iter().filter(used).collect();
        let medium_list = shaders.iter().position(|s| *s == Shader::Medium);
        let textured = |s: &Shader| {
            let of = effects.textured.contains(s).then_some(s)?;
            let material = effects.shaders.iter().position(|t| t == of)?;
            Some(Parameters::of(&scene.materials[material]).layout)
        };
        let textured = shaders.iter().map(textured).collect();
        let list = |s: &Shader| shaders.iter().position(|t| t == s).unwrap_or(0) as u8;
        let routes = scene.materials.iter().zip(&effects.shaders);
        let routes = routes.map(|(m, shader)| Route {
            emits: m.emits(),
            list: list(shader),
        });
        let mixtures = Mixtures::new(scene, effects, scene_tables, geometry, settings.seed);
        let routes = Routes::new(routes.collect(), mixtures.is_some());
        Self {
            geometry,
            aligned: effects.aligned,
            varying_emission: effects.varying_emission,
            bends: scene.has_normals() || effects.relief,
            tables: scene_tables.view(scene, geometry),
            opacities: scene_tables
                .opacities(scene, geometry, settings.seed)
                .filter(|_| effects.opacity),
            shaders,
            textured,
            mixtures,
            routes,
            lens: Lens {
                camera: camera::in_pixels(&scene.camera, &scene.film),
                filter,
                last_ray: limit == 0,
            },
            sampler: AnySampler::new(settings),
            program,
            wanted: program.wanted(effects),
            rules: Rules {
                random: settings.roulette,
                gain: survival(settings.survival, &split),
                limit,
                mirrors_only: settings.integrator == Integrator::Whitted,
                last_ray: program.last_ray_is_of_use(),
            },
            capacity: settings.wave.max(1),
            medium_list,
            camera_motion: scene.camera_motion.map(|motion| CameraMotion {
                motion,
                pivot: scene.camera.origin,
            }),
            carried: Carried::new(effects),
            split,
        }
    }
}

/// The gain of the roulette at each vertex: a branch is as likely to go on as the path would be alone.
fn survival(usual: f32, split: &[u32]) -> [f32; GAINS] {
    std::array::from_fn(|vertex| {
        let above = &split[..split.len().min(vertex + 1)];
        usual * branch::leaves(above) as f32
    })
}

impl Setup<'_> {
    /// Whether a stage can find work.
    pub(crate) fn runs(&self, stage: Stage) -> bool {
        let transport = self.program.is_transport();
        let mut elaborate = self.shaders.iter().filter(|s| s.has_rows());
        match stage {
            Stage::Generate | Stage::Intersect | Stage::Sort | Stage::Film => true,
            Stage::Sky => self.wanted.sky,
            Stage::Emission => self.wanted.emission,
            Stage::Interact => elaborate.next().is_some(),
            Stage::Texture => self.textured.iter().any(Option::is_some),
            Stage::Align => self.aligned.is_some(),
            Stage::Light => elaborate.any(|&s| self.lights(s)),
            Stage::Scatter(shader) => self.shaders.contains(&shader),
            Stage::Vary => self.varying_emission && self.program.samples_lights(),
            Stage::Occlude => self.casts_shadows(),
            Stage::Branch => !self.split.is_empty(),
            Stage::Shutter => self.carried.times,
            Stage::Travel => self.carried.media,
            Stage::Disperse => self.carried.wavelengths,
            Stage::Roulette => transport,
        }
    }

    /// What rays meet, at their `times` if something moves.
    pub(crate) fn obstacles<'b>(&'b self, times: Option<&'b [f32]>) -> Obstacles<'b> {
        Obstacles {
            geometry: self.geometry,
            opacities: called_for(self.opacities.as_ref()),
            times: called_for(times),
        }
    }

    /// Whether lights are sampled at a shader's surfaces.
    pub(crate) fn lights(&self, shader: Shader) -> bool {
        self.program.samples_lights() && !shader.is_delta()
    }

    /// Whether there are occlusion rays.
    pub(crate) fn casts_shadows(&self) -> bool {
        self.program.samples_lights() || matches!(self.program, Program::Ambient { .. })
    }

    /// The queues for paths that wait to branch, if any do.
    pub(crate) fn branches(&self) -> Option<Branches> {
        self.runs(Stage::Branch)
            .then(|| Branches::new(&self.split, self.capacity, self.carried))
    }

    /// The queues for surfaces that are more than plain diffuse ones, if there are any.
    pub(crate) fn surfaces(&self) -> Option<Surfaces> {
        self.runs(Stage::Interact).then(|| {
            let wanted = surfaces::Wanted {
                lights: self.runs(Stage::Light),
                smooth: self.bends,
                textured: self.runs(Stage::Texture),
                aligned: self.aligned.is_some(),
            };
            Surfaces::new(self.capacity, wanted)
        })
    }
}
