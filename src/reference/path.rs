//! Light transport of the reference: what a ray sees.

use super::Reference;
use super::bsdf::Reader;
use super::fog::{Fog, anywhere};
use super::random::uniform;
use super::surface::Frame;
use super::world::{Hit, Ray};
use crate::scene::Bsdf;
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::PI;

/// The medium that a path is in.
type Within<'a> = Option<&'a Fog>;

/// Where a path goes on, and what it sees there is multiplied with.
struct Next<'a> {
    ray: Ray,
    within: Within<'a>,
    weight: DVec3,
    /// Whether what surfaces emit there was summed already.
    lit: bool,
}

impl Reference<'_> {
    /// What `ray` sees, which starts in `within`; `lit` if what surfaces emit is not to be seen.
    pub(super) fn radiance(
        &self,
        rng: &mut impl Rng,
        ray: &Ray,
        within: Within,
        depth: u32,
        lit: bool,
    ) -> DVec3 {
        let hit = self.world.closest(rng, ray);
        let Some(fog) = within else {
            return self.met(rng, ray, within, hit, depth, lit);
        };
        let way = hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
        match fog.travel(rng, ray, way) {
            (None, left) => left * self.met(rng, ray, within, hit, depth, lit),
            (Some(_), _) if depth >= self.manner.max_depth => DVec3::ZERO,
            (Some(t), weight) => weight * self.in_fog(rng, fog, ray, t, depth),
        }
    }

    /// What is seen of a medium where it scatters light, `t` along a ray.
    fn in_fog(&self, rng: &mut impl Rng, fog: &Fog, ray: &Ray, t: f64, depth: u32) -> DVec3 {
        let origin = ray.origin + t * ray.direction;
        let phase = |to: DVec3| fog.phase(ray.direction.dot(to));
        let response = |to: DVec3| DVec3::splat(phase(to));
        let delta = self.delta_lights(rng, origin, response, |_| Some(fog), None);
        let direction = anywhere(rng);
        let next = Ray {
            origin,
            direction,
            leaves: None,
        };
        let weight = phase(direction) * 4.0 * PI;
        delta + weight * self.radiance(rng, &next, Some(fog), depth + 1, false)
    }

    /// What lies behind the surface of a material, for who comes from its front in `within`: what it is
    /// filled with; from its back, the outside. Through what is thin nobody gets anywhere else.
    fn behind<'a>(&'a self, bsdf: &Bsdf, front: bool, within: Within<'a>) -> Within<'a> {
        match bsdf {
            Bsdf::Dielectric(glass) if glass.thin => within,
            Bsdf::Principled(p) if p.thin => within,
            _ if !front => self.fog.as_ref(),
            Bsdf::Dielectric(glass) => glass.interior.map(|i| &self.media[i as usize]),
            _ => None,
        }
    }

    /// What is seen of what a ray meets.
    fn met(
        &self,
        rng: &mut impl Rng,
        ray: &Ray,
        within: Within,
        hit: Option<Hit>,
        depth: u32,
        lit: bool,
    ) -> DVec3 {
        let Some(hit) = hit else {
            return self.lights.beyond(ray.direction);
        };
        let (mut seen, emitted, next) = self.scatter(rng, ray, within, &hit, depth);
        if !lit {
            seen += emitted;
        }
        if let Some(next) = next {
            let seen_there = self.radiance(rng, &next.ray, next.within, depth + 1, next.lit);
            seen += next.weight * seen_there;
        }
        seen
    }

    /// At a hit, what light that is looked for comes from there, what is emitted, and where to go on.
    #[inline(never)] // keeps what the recursion puts on the stack small
    fn scatter<'a>(
        &'a self,
        rng: &mut impl Rng,
        ray: &Ray,
        within: Within<'a>,
        hit: &Hit,
        depth: u32,
    ) -> (DVec3, DVec3, Option<Next<'a>>) {
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
        let frame = Frame::about(shading);
        let omega_o = frame.local(-ray.direction);
        let bsdf = self.materials[part as usize].bsdf(&read, omega_o, front);
        let behind = self.behind(&met.bsdf, front, within);
        let side = |direction: DVec3| {
            if direction.dot(normal) < 0.0 {
                behind
            } else {
                within
            }
        };
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
        let mut seen = self.delta_lights(rng, origin, response, side, Some(hit.surface));
        let lit = self.manner.samples_lights && bsdf.is_diffuse();
        if lit {
            seen += self.emitters(rng, origin, response, side, hit.surface);
        }
        let next = bsdf
            .draw(omega_o, self.manner.uniform, rng)
            .and_then(|drawn| {
                let direction = frame.world(drawn.direction);
                let weight = factor(direction, drawn.direction.z) * drawn.weight;
                let ray = Ray {
                    origin,
                    direction,
                    leaves: Some(hit.surface),
                };
                (weight != DVec3::ZERO).then_some(Next {
                    ray,
                    within: side(direction),
                    weight,
                    lit,
                })
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
    fn emitters<'a>(
        &self,
        rng: &mut impl Rng,
        origin: DVec3,
        response: impl Fn(DVec3) -> DVec3,
        side: impl Fn(DVec3) -> Within<'a>,
        leaves: usize,
    ) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for &emitter in &self.emitters {
            let drawn = self.world.point_on(emitter, rng);
            let to = drawn.point - origin;
            let direction = to.normalize();
            let facing = -direction.dot(drawn.outside);
            let there = Hit {
                surface: emitter,
                t: 0.0,
                weights: drawn.weights,
            };
            let radiance = self.world.emitted(&there, drawn.outside, facing > 0.0);
            let response = response(direction);
            if emitter == leaves || radiance * response == DVec3::ZERO {
                continue;
            }
            let ray = Ray {
                origin,
                direction,
                leaves: Some(leaves),
            };
            let met = self.world.closest(rng, &ray);
            // Of a round emitter, the near side.
            let reached = met.is_some_and(|hit| {
                hit.surface == emitter && (hit.t / to.length() - 1.0).abs() < 1e-6
            });
            if reached {
                let seen = facing.abs() * drawn.area / to.length_squared();
                sum += left(side(direction), &ray, to.length()) * radiance * response * seen;
            }
        }
        sum
    }

    /// What is reflected or passes of the lights that no ray finds, at `origin` on surface `leaves` or in
    /// a medium; `side` says which lies that way.
    fn delta_lights<'a>(
        &self,
        rng: &mut impl Rng,
        origin: DVec3,
        response: impl Fn(DVec3) -> DVec3,
        side: impl Fn(DVec3) -> Within<'a>,
        leaves: Option<usize>,
    ) -> DVec3 {
        let arriving = self.lights.arriving(origin).map(|light| {
            let response = response(light.direction);
            let ray = Ray {
                origin,
                direction: light.direction,
                leaves,
            };
            let free = response != DVec3::ZERO
                && self
                    .world
                    .closest(rng, &ray)
                    .is_none_or(|hit| hit.t >= light.distance);
            if free {
                left(side(light.direction), &ray, light.distance) * light.irradiance * response
            } else {
                DVec3::ZERO
            }
        });
        arriving.sum()
    }
}

/// What is left of light over the first `way` of a ray in a medium.
fn left(within: Within, ray: &Ray, way: f64) -> DVec3 {
    within.map_or(DVec3::ONE, |medium| medium.transmittance(ray, way))
}
