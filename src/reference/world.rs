//! What the reference's rays meet: triangles and spheres, all of which every ray is tested against.

use super::carried::Carried;
use super::media::Within;
use super::random::uniform;
use super::sphere::{Sphere, copies};
use super::surface::{Point, colour, number, presence};
use crate::scene::{Material, Scene, Textured};
use glam::{DVec2, DVec3};
use rand_pcg::rand_core::Rng;

/// A point drawn on a surface, evenly.
pub(super) struct Drawn {
    pub(super) point: DVec3,
    /// Unit normal of the front there.
    pub(super) outside: DVec3,
    /// Of a triangle; see [`Hit::weights`].
    pub(super) weights: [f64; 2],
    /// Area of the whole surface.
    pub(super) area: f64,
}

/// The surfaces of a scene.
#[derive(Debug)]
pub(super) struct World<'a> {
    pub(super) scene: &'a Scene,
    triangles: Vec<Triangle>,
    /// Numbered after the triangles.
    spheres: Vec<Sphere>,
    nearest: f64,
}

#[derive(Debug)]
pub(super) struct Triangle {
    corner: DVec3,
    edges: [DVec3; 2],
    normal: DVec3,
    material: u32,
    carried: Carried,
}

pub(super) struct Ray {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) leaves: Option<usize>,
    pub(super) within: Within,
}

pub(super) struct Hit {
    /// A triangle, or behind the triangles a sphere.
    pub(super) surface: usize,
    pub(super) t: f64,
    /// Barycentric weights of the second and third corner.
    pub(super) weights: [f64; 2],
}

impl<'a> World<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let mesh = &scene.mesh;
        let triangles = (0..mesh.triangles())
            .map(|i| Triangle::new(Carried::of(mesh, i), mesh.material[i]))
            .chain(copies(scene));
        let spheres = scene.spheres.iter().map(Sphere::new);
        let bounds = scene.bounds().unwrap_or_default();
        let [low, high] = bounds.map(|corner| corner.abs().max_element());
        Self {
            scene,
            triangles: triangles.collect(),
            spheres: spheres.collect(),
            // A hit point is off its plane by a few roundings of the largest coordinate: 2^-48 of
            // that covers them sixteenfold, and lies as far below what f32 vertices resolve as
            // those lie below 1.
            nearest: low.max(high) * (-48f64).exp2(),
        }
    }

    /// The closest hit over all surfaces.
    ///
    /// A ray that leaves a surface meets neither the triangle that it leaves nor anything nearer
    /// than the rounding of its origin; a sphere that it leaves only at its far side.
    #[inline(never)] // keeps what the recursion puts on the stack small
    pub(super) fn closest(&self, rng: &mut impl Rng, ray: &Ray) -> Option<Hit> {
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

    /// The surfaces that emit.
    pub(super) fn emitters(&self) -> Vec<usize> {
        let triangles = self.triangles.iter().map(|t| t.material);
        let materials = triangles.chain(self.spheres.iter().map(|s| s.material));
        let emits = |m: u32| self.scene.materials[m as usize].emits();
        let emitting = materials.enumerate().filter(|(_, m)| emits(*m));
        emitting.map(|(i, _)| i).collect()
    }

    /// A point of a surface.
    pub(super) fn point_on(&self, surface: usize, rng: &mut impl Rng) -> Drawn {
        match self.triangles.get(surface) {
            Some(triangle) => {
                // Half of the square is folded onto the triangle.
                let (mut u, mut v) = (uniform(rng), uniform(rng));
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let [a, b] = triangle.edges;
                Drawn {
                    point: triangle.corner + u * a + v * b,
                    outside: triangle.normal,
                    weights: [u, v],
                    area: 0.5 * a.cross(b).length(),
                }
            }
            None => self.spheres[surface - self.triangles.len()].draw(rng),
        }
    }

    /// What is emitted to one side where a front's unit normal is `outside`.
    pub(super) fn emitted(&self, hit: &Hit, outside: DVec3, front: bool) -> DVec3 {
        let material = match self.triangles.get(hit.surface) {
            Some(triangle) => triangle.material,
            None => self.spheres[hit.surface - self.triangles.len()].material,
        };
        let material = &self.scene.materials[material as usize];
        if !front && !material.two_sided {
            return DVec3::ZERO;
        }
        colour(self.scene, &material.emission, self.uv(hit, outside))
    }

    /// Whether a triangle is there for a ray, at these weights: of partial opacity, by chance.
    fn is_there(&self, rng: &mut impl Rng, i: usize, weights: [f64; 2]) -> bool {
        let triangle = &self.triangles[i];
        let material = &self.scene.materials[triangle.material as usize];
        let presence = presence(self.scene, material, triangle.carried.uv(weights));
        presence >= 1.0 || (presence > 0.0 && uniform(rng) < presence)
    }

    /// A hit on a front whose unit normal is `outside`, as `material` shows it.
    pub(super) fn point(&self, hit: &Hit, outside: DVec3, material: &Material) -> Point {
        match self.triangles.get(hit.surface) {
            Some(t) => Point::new(self.scene, &t.carried, hit.weights, outside, material),
            None => {
                let sphere = &self.spheres[hit.surface - self.triangles.len()];
                Point::on_sphere(self.scene, outside, sphere.radius, material)
            }
        }
    }

    /// A number at a hit on a front whose unit normal is `outside`, by its image.
    pub(super) fn number(&self, hit: &Hit, outside: DVec3, value: &Textured<f32>) -> f64 {
        number(self.scene, value, self.uv(hit, outside))
    }

    /// Texture coordinates of a hit.
    fn uv(&self, hit: &Hit, outside: DVec3) -> DVec2 {
        let plain = Material::diffuse("", [0.0; 3], [0.0; 3]);
        self.point(hit, outside, &plain).uv
    }

    /// The unit normal of a surface's front at a point of it, and the material that it wears.
    pub(super) fn surface(&self, surface: usize, point: DVec3) -> (DVec3, u32) {
        match self.triangles.get(surface) {
            Some(triangle) => (triangle.normal, triangle.material),
            None => {
                let sphere = &self.spheres[surface - self.triangles.len()];
                ((point - sphere.centre).normalize(), sphere.material)
            }
        }
    }
}

impl Triangle {
    pub(super) fn new(carried: Carried, material: u32) -> Self {
        let [a, b, c] = carried.places;
        Self {
            carried,
            corner: a,
            edges: [b - a, c - a],
            normal: (b - a).cross(c - a).normalize(),
            material,
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
