//! The oracle: a scalar, recursive path tracer in f64 that the wave is tested against.
//!
//! It estimates the rendering equation (J. Kajiya, SIGGRAPH 1986) as textbooks first write it,
//!
//! ```text
//! Li(ray, depth) = Le + f(omega_o, omega_i) * cos_theta_i * Li(next ray, depth + 1) / pdf(omega_i)
//! ```
//!
//! with one direction from the hemisphere at every surface, no next-event estimation but of lights
//! that no direction finds (all of which are summed over at every surface), no roulette, no queue and no acceleration structure: every ray is tested against every triangle, so it is
//! for scenes of a few hundred triangles at most. It shares no code with the kernels, on purpose:
//! triangle test, frame, sampling, filter, camera and random numbers are its own.
//!
//! What it means by its words is what the wave means: a path scatters at most
//! [`Settings::depth_limit`] times, and 0 shows emission only; a surface emits from its front, from
//! both sides if its material says so; Lambertian surfaces reflect on both sides, with the shading
//! normals, images and masks that their materials and meshes ask for (`surface`); a ray that meets
//! nothing sees the sky.

mod camera;
mod lights;
mod sphere;
mod surface;

use self::surface::{Point, colour, presence};
use crate::film::{Job, SampleBuffer};
use crate::scene::{Bsdf, Filter, Scene};
use crate::settings::{Settings, Strategy};
use glam::DVec3;
use lights::Lights;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use sphere::Sphere;
use std::f64::consts::{PI, TAU};
use std::sync::atomic::{AtomicBool, Ordering};

/// The reference renderer of one scene.
#[derive(Debug)]
pub struct Reference<'a> {
    scene: &'a Scene,
    triangles: Vec<Triangle>,
    /// Numbered after the triangles.
    spheres: Vec<Sphere>,
    lights: Lights<'a>,
    seed: u32,
    max_depth: u32,
    uniform: bool,
    nearest: f64,
}

#[derive(Debug)]
struct Triangle {
    corner: DVec3,
    edges: [DVec3; 2],
    normal: DVec3,
    worn: Worn,
}

/// What a material does.
#[derive(Debug)]
struct Worn {
    albedo: DVec3,
    emission: DVec3,
    two_sided: bool,
    material: u32,
}

struct Ray {
    origin: DVec3,
    direction: DVec3,
    leaves: Option<usize>,
}

struct Hit {
    /// A triangle, or behind the triangles a sphere.
    surface: usize,
    t: f64,
    /// Barycentric weights of the second and third corner.
    weights: [f64; 2],
}

impl<'a> Reference<'a> {
    /// Deepest recursion, at a good 256 bytes a level: within half of a thread's usual stack of 2 MiB.
    /// What is cut at an albedo of 0.99 is below e^-20 of the answer.
    pub const DEEPEST: u32 = 2048;

    /// Most triangles for which testing them all is bearable: a few microseconds a ray.
    const MOST_TRIANGLES: usize = 1024;

    /// Whether the reference renders `scene`, as the wave would and in bearable time.
    #[must_use]
    pub fn supports(scene: &Scene) -> bool {
        scene.mesh.triangles() <= Self::MOST_TRIANGLES && scene.beyond_reference().is_none()
    }

    /// Prepares `scene`. Of `settings` it follows `seed`, the depth limit (at most 2048, since each
    /// scattering event is a level of recursion) and `strategy`: `uniform` draws directions
    /// uniformly; all others draw them by the cosine, for the reference looks for light on the
    /// hemisphere only.
    #[must_use]
    pub fn new(scene: &'a Scene, settings: &Settings) -> Self {
        let mesh = &scene.mesh;
        let triangles = (0..mesh.triangles())
            .map(|i| Triangle::new(mesh.corners(i).map(vector), scene, mesh.material[i]))
            .chain(sphere::copies(scene));
        let spheres = scene.spheres.iter().map(|s| Sphere::new(s, scene));
        let unbounded = Settings {
            roulette: false,
            ..settings.clone()
        };
        let bounds = scene.bounds().unwrap_or_default();
        let [low, high] = bounds.map(|corner| corner.abs().max_element());
        Self {
            scene,
            triangles: triangles.collect(),
            spheres: spheres.collect(),
            lights: Lights::new(scene),
            seed: settings.seed,
            max_depth: unbounded.depth_limit().min(Self::DEEPEST),
            uniform: settings.strategy == Strategy::Uniform,
            // A hit point is off its plane by a few roundings of the largest coordinate: 2^-48 of
            // that covers them sixteenfold, and lies as far below what f32 vertices resolve as
            // those lie below 1.
            nearest: low.max(high) * (-48f64).exp2(),
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
        };
        self.radiance(rng, &ray, depth).into()
    }

    fn radiance(&self, rng: &mut impl Rng, ray: &Ray, depth: u32) -> DVec3 {
        let Some(hit) = self.closest(rng, ray) else {
            return self.lights.beyond(ray.direction);
        };
        let origin = ray.origin + hit.t * ray.direction;
        let (outside, surface) = self.surface(hit.surface, origin);
        let front = ray.direction.dot(outside) < 0.0;
        // Copies and spheres have neither images nor interpolated normals.
        let own = hit.surface < self.scene.mesh.triangles();
        let point = own.then(|| Point::new(self.scene, hit.surface, hit.weights, outside));
        let material = &self.scene.materials[surface.material as usize];
        let emitted = if front || surface.two_sided {
            match &point {
                Some(point) => colour(self.scene, &material.emission, point.uv),
                None => surface.emission,
            }
        } else {
            DVec3::ZERO
        };
        let albedo = match &material.bsdf {
            Bsdf::Diffuse { reflectance, .. } => match &point {
                Some(point) => colour(self.scene, reflectance, point.uv),
                None => surface.albedo,
            },
            _ => surface.albedo,
        };
        if depth >= self.max_depth || albedo == DVec3::ZERO {
            return emitted;
        }
        let normal = if front { outside } else { -outside };
        let shading = match &point {
            Some(point) => point.towards(front, normal, -ray.direction),
            None => normal,
        };
        let (omega_i, pdf) = self.sample_hemisphere(rng, shading);
        let brdf = albedo / PI;
        // The cosine that counts, with what becomes of it where triangles are dark.
        let cosine = |omega_i: DVec3| {
            let factor = match &point {
                Some(point) => point.terminator(shading, normal, omega_i),
                None => 1.0,
            };
            factor * omega_i.dot(shading).max(0.0)
        };
        let delta = brdf * self.delta_lights(rng, origin, cosine, hit.surface);
        let weight = cosine(omega_i) / pdf;
        if weight == 0.0 {
            return emitted + delta;
        }
        let next = Ray {
            origin,
            direction: omega_i,
            leaves: Some(hit.surface),
        };
        emitted + delta + brdf * self.radiance(rng, &next, depth + 1) * weight
    }

    /// Irradiance by the lights that no ray finds, at `origin` on surface `leaves`.
    fn delta_lights(
        &self,
        rng: &mut impl Rng,
        origin: DVec3,
        cosine: impl Fn(DVec3) -> f64,
        leaves: usize,
    ) -> DVec3 {
        let arriving = self.lights.arriving(origin).map(|light| {
            let cos = cosine(light.direction);
            let ray = Ray {
                origin,
                direction: light.direction,
                leaves: Some(leaves),
            };
            let free = cos > 0.0
                && self
                    .closest(rng, &ray)
                    .is_none_or(|hit| hit.t >= light.distance);
            if free {
                light.irradiance * cos
            } else {
                DVec3::ZERO
            }
        });
        arriving.sum()
    }

    /// A unit vector on the side of `normal` and its pdf in solid angle, which is positive.
    fn sample_hemisphere(&self, rng: &mut impl Rng, normal: DVec3) -> (DVec3, f64) {
        let (u, phi) = (1.0 - uniform(rng), TAU * uniform(rng)); // u in (0, 1]
        let (cos, pdf) = if self.uniform {
            (u, 1.0 / TAU)
        } else {
            (u.sqrt(), u.sqrt() / PI)
        };
        let sin = (1.0 - cos * cos).sqrt();
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let local = (sin * phi.cos(), sin * phi.sin());
        (tangent * local.0 + bitangent * local.1 + normal * cos, pdf)
    }

    /// The closest hit over all surfaces.
    ///
    /// A ray that leaves a surface meets neither the triangle that it leaves nor anything nearer
    /// than the rounding of its origin; a sphere that it leaves only at its far side.
    #[inline(never)] // keeps what the recursion puts on the stack small
    fn closest(&self, rng: &mut impl Rng, ray: &Ray) -> Option<Hit> {
        let nearest = if ray.leaves.is_some() {
            self.nearest
        } else {
            0.0
        };
        let mut closest: Option<Hit> = None;
        for (i, triangle) in self.triangles.iter().enumerate() {
            let farthest = closest.as_ref().map_or(f64::INFINITY, |hit| hit.t);
            if let Some((t, weights)) = triangle.intersect(ray)
                && nearest < t
                && t < farthest
                && ray.leaves != Some(i)
                && self.is_there(rng, i, weights)
            {
                closest = Some(Hit {
                    surface: i,
                    t,
                    weights,
                });
            }
        }
        for (i, sphere) in self.spheres.iter().enumerate() {
            let surface = self.triangles.len() + i;
            let farthest = closest.as_ref().map_or(f64::INFINITY, |hit| hit.t);
            let leaves = ray.leaves == Some(surface);
            if let Some(t) = sphere.intersect(ray, leaves, nearest)
                && t < farthest
            {
                closest = Some(Hit {
                    surface,
                    t,
                    weights: [0.0; 2],
                });
            }
        }
        closest
    }

    /// Whether a triangle is there for a ray, at these weights: of partial opacity, by chance.
    fn is_there(&self, rng: &mut impl Rng, i: usize, weights: [f64; 2]) -> bool {
        // Copies are wholly there.
        let own = i < self.scene.mesh.triangles();
        let presence = if own {
            presence(self.scene, i, weights)
        } else {
            1.0
        };
        presence >= 1.0 || (presence > 0.0 && uniform(rng) < presence)
    }

    /// The unit normal of a surface's front at a point of it, and what it wears.
    fn surface(&self, surface: usize, point: DVec3) -> (DVec3, &Worn) {
        match self.triangles.get(surface) {
            Some(triangle) => (triangle.normal, &triangle.worn),
            None => {
                let sphere = &self.spheres[surface - self.triangles.len()];
                ((point - sphere.centre).normalize(), &sphere.worn)
            }
        }
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
        let mut rng = generator([self.seed, x, y, sample]);
        let filter = self.scene.film.filter;
        let x = f64::from(x) + 0.5 + filter_offset(filter, &mut rng);
        let y = f64::from(y) + 0.5 + filter_offset(filter, &mut rng);
        let ray = camera::ray(self.scene, x, y, &mut rng);
        self.radiance(&mut rng, &ray, 0).into()
    }
}

impl Worn {
    fn new(scene: &Scene, index: u32) -> Self {
        let material = &scene.materials[index as usize];
        Self {
            albedo: vector(material.albedo(&scene.materials)),
            emission: vector(material.emission.factor),
            two_sided: material.two_sided,
            material: index,
        }
    }
}

impl Triangle {
    fn new([a, b, c]: [DVec3; 3], scene: &Scene, material: u32) -> Self {
        Self {
            corner: a,
            edges: [b - a, c - a],
            normal: (b - a).cross(c - a).normalize(),
            worn: Worn::new(scene, material),
        }
    }

    /// Ray parameter and weights of the plane's hit if it lies in the triangle, edges included (T. Moeller,
    /// B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997).
    fn intersect(&self, ray: &Ray) -> Option<(f64, [f64; 2])> {
        let [e1, e2] = self.edges;
        let p = ray.direction.cross(e2);
        let s = ray.origin - self.corner;
        let q = s.cross(e1);
        let determinant = e1.dot(p);
        let u = s.dot(p) / determinant;
        let v = ray.direction.dot(q) / determinant;
        let t = e2.dot(q) / determinant;
        // A ray in the plane gives 0 / 0 or infinities, and no comparison with those holds.
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t < f64::INFINITY).then_some((t, [u, v]))
    }
}

/// An offset from the pixel's centre with the filter's density, by rejection.
fn filter_offset(filter: Filter, rng: &mut impl Rng) -> f64 {
    let radius = match filter {
        Filter::Box => 0.5,
        Filter::Tent => 1.0,
        Filter::Gaussian => 1.5,
        Filter::BlackmanHarris => 1.65,
    };
    loop {
        let x = radius * (2.0 * uniform(rng) - 1.0);
        let height = match filter {
            Filter::Box => 1.0,
            Filter::Tent => 1.0 - x.abs(),
            Filter::Gaussian => (-0.5 * (x / 0.5).powi(2)).exp(),
            Filter::BlackmanHarris => {
                let a = PI * x / radius;
                0.35875 + 0.48829 * a.cos() + 0.14128 * (2.0 * a).cos() + 0.01168 * (3.0 * a).cos()
            }
        };
        if uniform(rng) < height {
            return x;
        }
    }
}

/// A generator for four words: started where SplitMix64's finalizer scatters them.
fn generator(words: [u32; 4]) -> Pcg64 {
    let mut state = [0u64; 2];
    for word in words {
        let mixed = mix(state[1] ^ u64::from(word));
        state = [state[1], mixed];
    }
    let join = |a: u64, b: u64| (u128::from(a) << 64) | u128::from(b);
    Pcg64::new(join(state[1], state[0]), join(state[0], state[1]))
}

/// G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Uniform on the multiples of 2^-53 in [0, 1).
fn uniform(rng: &mut impl Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 * (-53f64).exp2()
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Running;

    #[test]
    fn filter_offsets_have_the_moments_of_their_density() {
        // Densities as in the windows' own definitions, over their whole support.
        let gaussian = |x: f64| (-2.0 * x * x).exp();
        let blackman_harris = |x: f64| {
            let n = (x / 1.65 + 1.0) * PI;
            0.35875 - 0.48829 * n.cos() + 0.14128 * (2.0 * n).cos() - 0.01168 * (3.0 * n).cos()
        };
        let variance = |f: &dyn Fn(f64) -> f64, radius: f64| {
            let (mut weight, mut square) = (0.0, 0.0);
            for i in 0..10_000 {
                let x = radius * ((f64::from(i) + 0.5) / 5_000.0 - 1.0);
                weight += f(x);
                square += f(x) * x * x;
            }
            square / weight
        };
        for (filter, expected) in [
            (Filter::Box, 1.0 / 12.0),
            (Filter::Tent, 1.0 / 6.0),
            (Filter::Gaussian, variance(&gaussian, 1.5)),
            (Filter::BlackmanHarris, variance(&blackman_harris, 1.65)),
        ] {
            let mut rng = generator([7, filter as u32, 0, 0]);
            let (mut first, mut second) = (Running::new(), Running::new());
            for _ in 0..100_000 {
                let x = filter_offset(filter, &mut rng);
                first.push(x);
                second.push(x * x);
            }
            // Eight tests at 1e-5 together: 4.8 standard errors each; the quadrature is exact to
            // 1e-8, far below those (1e-3 of the variance).
            let level = 1.0 - 1e-5 / 8.0;
            for (moment, expected) in [(first, 0.0), (second, expected)] {
                let [low, high] = moment.confidence_interval(level).unwrap();
                assert!(
                    low <= expected && expected <= high,
                    "{filter:?}: {moment:?}, {expected}"
                );
            }
        }
    }

    #[test]
    fn generators_of_neighbours_are_unrelated() {
        // First numbers of 64 x 64 neighbouring pixels and samples: mean and correlation.
        let first = |x, s| uniform(&mut generator([0, x, 3, s])) - 0.5;
        let products: Running = (0..64)
            .flat_map(|x| (0..64).map(move |s| first(x, s) * first(x, s + 1)))
            .collect();
        let values: Running = (0..64)
            .flat_map(|x| (0..64).map(move |s| first(x, s)))
            .collect();
        for moment in [products, values] {
            let [low, high] = moment.confidence_interval(1.0 - 1e-5).unwrap();
            assert!(low <= 0.0 && 0.0 <= high, "{moment:?}");
        }
    }
}
