//! Light transport of the reference: what a ray sees.

use super::Reference;
use super::bsdf::Reader;
use super::media::{Medium, Within, anywhere};
use super::random::uniform;
use super::surface::Frame;
use super::world::{Hit, Ray};
use crate::scene::Bsdf;
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::PI;

/// Where rays set out: from a surface, or in a medium.
struct Start {
    origin: DVec3,
    leaves: Option<usize>,
    /// The surface's unit normal on the near side.
    normal: DVec3,
    /// What is on the near side, and what behind.
    sides: [Within; 2],
}

impl Start {
    fn ray(&self, direction: DVec3) -> Ray {
        let behind = self.normal.dot(direction) < 0.0;
        Ray {
            origin: self.origin,
            direction,
            leaves: self.leaves,
            within: self.sides[usize::from(behind)],
        }
    }
}

/// Where a path goes on, and what it sees there is multiplied with.
struct Next {
    ray: Ray,
    weight: DVec3,
    /// Whether what surfaces emit there was summed already.
    lit: bool,
}

impl Reference<'_> {
    /// What `ray` sees; `lit` if what surfaces emit is not to be seen.
    pub(super) fn radiance(&self, rng: &mut impl Rng, ray: &Ray, depth: u32, lit: bool) -> DVec3 {
        let hit = self.world.closest(rng, ray);
        let Some(medium) = self.media.of(ray) else {
            return self.met(rng, ray, hit, depth, lit);
        };
        let way = hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
        match medium.travel(rng, ray, way) {
            (None, left) => left * self.met(rng, ray, hit, depth, lit),
            (Some(_), _) if depth >= self.manner.max_depth => DVec3::ZERO,
            (Some(t), weight) => weight * self.in_medium(rng, medium, ray, t, depth),
        }
    }

    /// What is seen of a medium where it scatters light, `t` along a ray.
    fn in_medium(
        &self,
        rng: &mut impl Rng,
        medium: &Medium,
        ray: &Ray,
        t: f64,
        depth: u32,
    ) -> DVec3 {
        let start = Start {
            origin: ray.origin + t * ray.direction,
            leaves: None,
            normal: DVec3::ZERO,
            sides: [ray.within; 2],
        };
        let phase = |to: DVec3| medium.phase(ray.direction.dot(to));
        let delta = self.delta_lights(rng, &start, |to| DVec3::splat(phase(to)));
        let direction = anywhere(rng);
        let weight = phase(direction) * 4.0 * PI;
        let next = start.ray(direction);
        delta + weight * self.radiance(rng, &next, depth + 1, false)
    }

    /// What is left of light over the first `way` of a ray.
    fn left(&self, ray: &Ray, way: f64) -> DVec3 {
        let medium = self.media.of(ray);
        medium.map_or(DVec3::ONE, |medium| medium.transmittance(ray, way))
    }

    /// What is seen of what a ray meets.
    fn met(&self, rng: &mut impl Rng, ray: &Ray, hit: Option<Hit>, depth: u32, lit: bool) -> DVec3 {
        let Some(hit) = hit else {
            return self.lights.beyond(ray.direction);
        };
        let (mut seen, emitted, next) = self.scatter(rng, ray, &hit, depth);
        if !lit {
            seen += emitted;
        }
        if let Some(Next { ray, weight, lit }) = next {
            seen += weight * self.radiance(rng, &ray, depth + 1, lit);
        }
        seen
    }

    /// At a hit, what light that is looked for comes from there, what is emitted, and where to go on.
    #[inline(never)] // keeps what the recursion puts on the stack small
    fn scatter(
        &self,
        rng: &mut impl Rng,
        ray: &Ray,
        hit: &Hit,
        depth: u32,
    ) -> (DVec3, DVec3, Option<Next>) {
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
        let emitted = self.world.emitted(hit, outside, front);
        if depth >= self.manner.max_depth {
            return (DVec3::ZERO, emitted, None);
        }
        let normal = if front { outside } else { -outside };
        let shading = point.towards(front, normal, -ray.direction);
        let frame = Frame::about(shading, point.along);
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
        let start = Start {
            origin,
            leaves: Some(hit.surface),
            normal,
            sides: [ray.within, ray.within.behind(met, front)],
        };
        let mut seen = self.delta_lights(rng, &start, response);
        let lit = self.manner.samples_lights && bsdf.is_diffuse();
        if lit {
            seen += self.emitters(rng, &start, response);
        }
        let next = bsdf
            .draw(omega_o, self.manner.uniform, rng)
            .and_then(|drawn| {
                let direction = frame.world(drawn.direction);
                let weight = factor(direction, drawn.direction.z) * drawn.weight;
                let ray = start.ray(direction);
                (weight != DVec3::ZERO).then_some(Next { ray, weight, lit })
            });
        (seen, emitted, next)
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

    /// What is reflected of all that surfaces emit, by one point on each.
    fn emitters(
        &self,
        rng: &mut impl Rng,
        start: &Start,
        response: impl Fn(DVec3) -> DVec3,
    ) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for &emitter in &self.emitters {
            let drawn = self.world.point_on(emitter, rng);
            let to = drawn.point - start.origin;
            let direction = to.normalize();
            let facing = -direction.dot(drawn.outside);
            let there = Hit {
                surface: emitter,
                t: 0.0,
                weights: drawn.weights,
            };
            let radiance = self.world.emitted(&there, drawn.outside, facing > 0.0);
            let response = response(direction);
            if start.leaves == Some(emitter) || radiance * response == DVec3::ZERO {
                continue;
            }
            let ray = start.ray(direction);
            let met = self.world.closest(rng, &ray);
            // Of a round emitter, the near side.
            let reached = met.is_some_and(|hit| {
                hit.surface == emitter && (hit.t / to.length() - 1.0).abs() < 1e-6
            });
            if reached {
                let seen = facing.abs() * drawn.area / to.length_squared();
                sum += self.left(&ray, to.length()) * radiance * response * seen;
            }
        }
        sum
    }

    /// What is reflected or passes of the lights that no ray finds, at a surface or in a medium.
    fn delta_lights(
        &self,
        rng: &mut impl Rng,
        start: &Start,
        response: impl Fn(DVec3) -> DVec3,
    ) -> DVec3 {
        let arriving = self.lights.arriving(start.origin).map(|light| {
            let response = response(light.direction);
            let ray = start.ray(light.direction);
            let free = response != DVec3::ZERO
                && self
                    .world
                    .closest(rng, &ray)
                    .is_none_or(|hit| hit.t >= light.distance);
            if free {
                self.left(&ray, light.distance) * light.irradiance * response
            } else {
                DVec3::ZERO
            }
        });
        arriving.sum()
    }
}
