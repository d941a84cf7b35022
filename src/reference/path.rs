//! Light transport of the reference: what a ray sees.

use super::Reference;
use super::bsdf::Reader;
use super::random::uniform;
use super::surface::Frame;
use super::world::{Hit, Ray};
use crate::scene::Bsdf;
use glam::DVec3;
use rand_pcg::rand_core::Rng;

/// Where a path goes on, and what it sees there is multiplied with.
struct Next {
    ray: Ray,
    weight: DVec3,
}

impl Reference<'_> {
    pub(super) fn radiance(&self, rng: &mut impl Rng, ray: &Ray, depth: u32) -> DVec3 {
        let Some(hit) = self.world.closest(rng, ray) else {
            return self.lights.beyond(ray.direction);
        };
        match self.scatter(rng, ray, &hit, depth) {
            (seen, None) => seen,
            (seen, Some(next)) => seen + next.weight * self.radiance(rng, &next.ray, depth + 1),
        }
    }

    /// What is seen of a hit without going on, and where to go on.
    #[inline(never)] // keeps what the recursion puts on the stack small
    fn scatter(
        &self,
        rng: &mut impl Rng,
        ray: &Ray,
        hit: &Hit,
        depth: u32,
    ) -> (DVec3, Option<Next>) {
        let scene = self.world.scene;
        let origin = ray.origin + hit.t * ray.direction;
        let (outside, worn) = self.world.surface(hit.surface, origin);
        let front = ray.direction.dot(outside) < 0.0;
        let part = self.part(rng, hit, outside, worn);
        let met = &scene.materials[part as usize];
        let point = self.world.point(hit, outside, met);
        let read = Reader {
            point: Some((scene, &point)),
        };
        let surface = &scene.materials[worn as usize];
        let emitted = if front || surface.two_sided {
            read.colour(&surface.emission)
        } else {
            DVec3::ZERO
        };
        if depth >= self.max_depth {
            return (emitted, None);
        }
        let normal = if front { outside } else { -outside };
        let shading = point.towards(front, normal, -ray.direction);
        let frame = Frame::about(shading);
        let omega_o = frame.local(-ray.direction);
        let bsdf = self.materials[part as usize].bsdf(&read, omega_o, front);
        // What becomes of light where triangles are dark, and on the wrong side of either normal.
        let factor = |omega_i: DVec3, cos: f64| {
            if cos * omega_i.dot(normal) <= 0.0 {
                0.0
            } else if bsdf.is_diffuse() {
                point.terminator(shading, normal, omega_i)
            } else {
                1.0
            }
        };
        let response = |omega_i: DVec3| {
            let local = frame.local(omega_i);
            factor(omega_i, local.z) * bsdf.evaluate(omega_o, local)
        };
        let seen = emitted + self.delta_lights(rng, origin, response, hit.surface);
        let next = bsdf.draw(omega_o, self.uniform, rng).and_then(|drawn| {
            let direction = frame.world(drawn.direction);
            let weight = factor(direction, drawn.direction.z) * drawn.weight;
            let ray = Ray {
                origin,
                direction,
                leaves: Some(hit.surface),
            };
            (weight != DVec3::ZERO).then_some(Next { ray, weight })
        });
        (seen, next)
    }

    /// The material that a path meets of `worn`: of a mixture, one of its parts.
    fn part(&self, rng: &mut impl Rng, hit: &Hit, outside: DVec3, mut worn: u32) -> u32 {
        let scene = self.world.scene;
        while let Bsdf::Mix {
            first,
            second,
            amount,
        } = &scene.materials[worn as usize].bsdf
        {
            let share = self.world.number(hit, outside, amount);
            worn = if uniform(rng) < share {
                *second
            } else {
                *first
            };
        }
        worn
    }

    /// What is reflected or passes of the lights that no ray finds, at `origin` on surface `leaves`.
    fn delta_lights(
        &self,
        rng: &mut impl Rng,
        origin: DVec3,
        response: impl Fn(DVec3) -> DVec3,
        leaves: usize,
    ) -> DVec3 {
        let arriving = self.lights.arriving(origin).map(|light| {
            let response = response(light.direction);
            let ray = Ray {
                origin,
                direction: light.direction,
                leaves: Some(leaves),
            };
            let free = response != DVec3::ZERO
                && self
                    .world
                    .closest(rng, &ray)
                    .is_none_or(|hit| hit.t >= light.distance);
            if free {
                light.irradiance * response
            } else {
                DVec3::ZERO
            }
        });
        arriving.sum()
    }
}
