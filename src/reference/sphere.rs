//! The oracle's spheres and copies, in the formulas of school.

use super::carried::Carried;
use super::random::uniform;
use super::vector;
use super::world::{Drawn, Ray, Triangle};
use crate::scene::{self, Scene};
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::{PI, TAU};

/// A sphere.
#[derive(Debug)]
pub(super) struct Sphere {
    pub(super) centre: DVec3,
    pub(super) radius: f64,
    pub(super) material: u32,
    /// Rows of the rotation to its own directions.
    pub(super) turn: [DVec3; 3],
}

impl Sphere {
    pub(super) fn new(sphere: &scene::Sphere) -> Self {
        Self {
            centre: vector(sphere.centre),
            radius: sphere.radius.into(),
            material: sphere.material,
            turn: sphere.turn.map(vector),
        }
    }

    /// A point of it: Archimedes' height is uniform.
    pub(super) fn draw(&self, rng: &mut impl Rng) -> Drawn {
        let z = 2.0 * uniform(rng) - 1.0;
        let (y, x) = (TAU * uniform(rng)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        let outside = DVec3::new(r * x, r * y, z);
        Drawn {
            point: self.centre + self.radius * outside,
            outside,
            weights: [0.0; 2],
            area: 4.0 * PI * self.radius * self.radius,
        }
    }

    /// Ray parameters of the hits beyond `nearest`, the first one first. A ray that `leaves` the sphere is
    /// on it: one root is 0, the other is the hit.
    pub(super) fn intersect(
        &self,
        ray: &Ray,
        leaves: bool,
        nearest: f64,
    ) -> impl Iterator<Item = f64> {
        let f = ray.origin - self.centre;
        let half = -f.dot(ray.direction);
        let root = (half * half - (f.length_squared() - self.radius * self.radius)).sqrt();
        let roots = if leaves {
            [0.0, 2.0 * half]
        } else {
            [half - root, half + root]
        };
        // No comparison holds of the root of a negative number.
        roots.into_iter().filter(move |&t| t > nearest)
    }
}

/// The triangles of all instances, placed in the world.
pub(super) fn copies(scene: &Scene) -> impl Iterator<Item = Triangle> + '_ {
    scene.instances.iter().flat_map(move |instance| {
        let mesh = &scene.objects[instance.object as usize].mesh;
        let map = instance.placement.map();
        (0..mesh.triangles()).map(move |i| {
            let material = instance.material.unwrap_or(mesh.material[i]);
            Triangle::new(Carried::of(mesh, i).placed(&map), material)
        })
    })
}
