//! The oracle: a scalar, recursive path tracer in f64 that the wave is tested against.
//!
//! It estimates the rendering equation (J. Kajiya, SIGGRAPH 1986) as textbooks first write it,
//!
//! ```text
//! Li(ray, depth) = Le + f(omega_o, omega_i) * cos_theta_i * Li(next ray, depth + 1) / pdf(omega_i)
//! ```
//!
//! with one direction at every surface, no roulette, no queue and no acceleration structure: every ray
//! is tested against every triangle, so it is for scenes of a few hundred triangles at most. Light is
//! found by directions; but that of lights which no direction finds is summed at every surface, and, if
//! asked (`--strategy light` or `mis`), that of all emissive surfaces at every diffuse one. It shares no
//! code with the kernels, on purpose:
//! triangle test, frame, sampling, filter, camera and random numbers are its own.
//!
//! What it means by its words is what the wave means: a path scatters at most
//! [`Settings::depth_limit`] times, and 0 shows emission only; a surface emits from its front, from
//! both sides if its material says so; surfaces scatter as their materials say (`bsdf`), with the
//! shading normals, images and masks that materials and meshes ask for (`surface`); a ray that meets
//! nothing sees the sky. Media it knows (`media`), outside of glass and inside. Where something moves
//! or disperses light, every sample is that of a scene frozen at one moment, in light of one wavelength.

mod bsdf;
mod camera;
mod carried;
mod lights;
mod media;
mod path;
mod random;
mod sphere;
mod surface;
mod wavelength;
mod world;

use crate::film::{Job, SampleBuffer};
use crate::scene::Scene;
use crate::settings::{Settings, Strategy};
use bsdf::Worn;
use glam::DVec3;
use lights::Lights;
use media::{Media, Within};
use rand_pcg::rand_core::Rng;
use random::{filter_offset, generator, uniform};
use std::sync::atomic::{AtomicBool, Ordering};
use world::{Ray, World};

/// The reference renderer of one scene.
#[derive(Debug)]
pub struct Reference<'a> {
    world: World<'a>,
    lights: Lights<'a>,
    media: Media,
    materials: Vec<Worn<'a>>,
    manner: Manner,
    emitters: Vec<usize>,
}

/// What the reference follows of a render's settings.
#[derive(Clone, Copy, Debug)]
struct Manner {
    seed: u32,
    max_depth: u32,
    uniform: bool,
    samples_lights: bool,
}

impl<'a> Reference<'a> {
    /// Deepest recursion, at a good 256 bytes a level: within half of a thread's usual stack of 2 MiB.
    /// What is cut at an albedo of 0.99 is below e^-20 of the answer.
    pub const DEEPEST: u32 = 2048;

    /// Most triangles and spheres for which testing them all is bearable: a few microseconds a ray.
    const MOST_TRIANGLES: usize = 1024;

    /// Whether the reference renders `scene`, as the wave would and in bearable time.
    #[must_use]
    pub fn supports(scene: &Scene) -> bool {
        let copies = scene.instances.iter();
        let copied = copies.map(|copy| scene.objects[copy.object as usize].mesh.triangles());
        let triangles = scene.mesh.triangles() + copied.sum::<usize>();
        triangles + scene.spheres.len() <= Self::MOST_TRIANGLES
            && scene.beyond_reference().is_none()
    }

    /// Prepares `scene`. Of `settings` it follows `seed`, the depth limit (at most 2048, since each
    /// scattering event is a level of recursion) and `strategy`, which is about diffuse surfaces:
    /// `uniform` draws directions uniformly, all others by the cosine; with `light` and `mis` the light
    /// of all emissive surfaces is summed there, by a point on each, instead of found by directions.
    #[must_use]
    pub fn new(scene: &'a Scene, settings: &Settings) -> Self {
        let unbounded = Settings {
            roulette: false,
            ..settings.clone()
        };
        let materials = scene.materials.iter().map(Worn::new).collect();
        Self::of(
            scene,
            materials,
            Manner {
                seed: settings.seed,
                max_depth: unbounded.depth_limit().min(Self::DEEPEST),
                uniform: settings.strategy == Strategy::Uniform,
                samples_lights: matches!(settings.strategy, Strategy::Light | Strategy::Mis),
            },
        )
    }

    fn of(scene: &'a Scene, materials: Vec<Worn<'a>>, manner: Manner) -> Self {
        let world = World::new(scene);
        Self {
            emitters: world.emitters(),
            world,
            lights: Lights::new(scene),
            media: Media::new(scene),
            materials,
            manner,
        }
    }

    /// One estimate of the radiance (W/m^2/sr; red, green, blue) that arrives at `origin` against
    /// the unit vector `direction`, after `depth` scattering events: 0 for a camera ray.
    pub fn li(
        &self,
        rng: &mut impl Rng,
        origin: [f64; 3],
        direction: [f64; 3],
        depth: u32,
    ) -> [f64; 3] {
        let ray = Ray {
            origin: origin.into(),
            direction: direction.into(),
            leaves: None,
            within: Within::Outside,
        };
        self.radiance(rng, &ray, depth, false).into()
    }

    /// Renders the samples of `job` into their slots of `out`, which must have room for them. Returns
    /// false, with slots missing, if `stop` is raised before it is done.
    ///
    /// A sample is a function of (seed, pixel, sample index) alone, so the image does not depend
    /// on how it is cut into jobs.
    pub fn render_job(&self, job: &Job, out: &mut SampleBuffer, stop: &AtomicBool) -> bool {
        for slot in 0..job.slots() {
            if stop.load(Ordering::Relaxed) {
                return false;
            }
            let (x, y, sample) = job.sample_of(slot as u32);
            let radiance = self.render_sample(x, y, sample);
            for (column, value) in out.radiance.iter_mut().zip(radiance) {
                column[slot] = value as f32;
            }
        }
        true
    }

    /// Radiance of one camera sample of pixel (`x`, `y`), from the top left corner.
    #[must_use]
    pub fn render_sample(&self, x: u32, y: u32, sample: u32) -> [f64; 3] {
        let mut rng = generator([self.manner.seed, x, y, sample]);
        let filter = self.world.scene.film.filter;
        let x = f64::from(x) + 0.5 + filter_offset(filter, &mut rng);
        let y = f64::from(y) + 0.5 + filter_offset(filter, &mut rng);
        let scene = self.world.scene;
        let (moves, disperses) = (scene.moves().is_some(), scene.disperses());
        if !moves && !disperses {
            let ray = camera::ray(scene, x, y, &mut rng);
            return self.radiance(&mut rng, &ray, 0, false).into();
        }
        // Everything at one moment, in light of one wavelength, made anew for every sample: slow, and
        // sure.
        let mut now = scene.clone();
        let mut weight = DVec3::ONE;
        if moves {
            now = now.frozen(uniform(&mut rng));
        }
        if disperses {
            let drawn = wavelength::draw(&mut rng);
            now = now.at_wavelength(drawn.nanometres);
            weight = drawn.weight;
        }
        let ray = camera::ray(&now, x, y, &mut rng);
        let worn = self.materials.iter().zip(&now.materials);
        let materials = worn.map(|(worn, m)| worn.at(m)).collect();
        let now = Reference::of(&now, materials, self.manner);
        (weight * now.radiance(&mut rng, &ray, 0, false)).into()
    }
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}
