//! Light transport of the reference: what a ray sees.

use super::Reference;
use super::fog::{Fog, anywhere};
use super::random::uniform;
use super::surface::{Point, colour};
use super::world::{Hit, Ray};
use crate::scene::Bsdf;
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::{PI, TAU};

impl Reference<'_> {
    pub(super) fn radiance(&self, rng: &mut impl Rng, ray: &Ray, depth: u32) -> DVec3 {
        let hit = self.world.closest(ray);
        let Some(fog) = &self.fog else {
            return self.seen(rng, ray, hit, depth);
        };
        let way = hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
        match fog.travel(rng, ray, way) {
            (None, left) => left * self.seen(rng, ray, hit, depth),
            (Some(_), _) if depth >= self.max_depth => DVec3::ZERO,
            (Some(t), weight) => weight * self.in_fog(rng, fog, ray, t, depth),
        }
    }

    /// What is seen of the fog where it scatters light, `t` along a ray.
    fn in_fog(&self, rng: &mut impl Rng, fog: &Fog, ray: &Ray, t: f64, depth: u32) -> DVec3 {
        let origin = ray.origin + t * ray.direction;
        let phase = |to: DVec3| fog.phase(ray.direction.dot(to));
        let delta = self.delta_lights(origin, phase, None);
        let direction = anywhere(rng);
        let next = Ray {
            origin,
            direction,
            leaves: None,
        };
        let weight = phase(direction) * 4.0 * PI;
        delta + weight * self.radiance(rng, &next, depth + 1)
    }

    /// What is seen of what a ray meets.
    fn seen(&self, rng: &mut impl Rng, ray: &Ray, hit: Option<Hit>, depth: u32) -> DVec3 {
        let Some(hit) = hit else {
            return self.lights.beyond(ray.direction);
        };
        let origin = ray.origin + hit.t * ray.direction;
        let (outside, surface) = self.world.surface(hit.surface, origin);
        let front = ray.direction.dot(outside) < 0.0;
        // Copies and spheres have neither images nor interpolated normals.
        let own = hit.surface < self.world.scene.mesh.triangles();
        let point = own.then(|| Point::new(self.world.scene, hit.surface, hit.weights, outside));
        let material = &self.world.scene.materials[surface.material as usize];
        let emitted = if front || surface.two_sided {
            match &point {
                Some(point) => colour(self.world.scene, &material.emission, point.uv),
                None => surface.emission,
            }
        } else {
            DVec3::ZERO
        };
        let albedo = match &material.bsdf {
            Bsdf::Diffuse { reflectance, .. } => match &point {
                Some(point) => colour(self.world.scene, reflectance, point.uv),
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
        let delta = brdf * self.delta_lights(origin, cosine, Some(hit.surface));
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

    /// Irradiance by the lights that no ray finds, at `origin` on surface `leaves` or in the fog, of a
    /// surface that counts it by `cosine`.
    fn delta_lights(
        &self,
        origin: DVec3,
        cosine: impl Fn(DVec3) -> f64,
        leaves: Option<usize>,
    ) -> DVec3 {
        let arriving = self.lights.arriving(origin).map(|light| {
            let cos = cosine(light.direction);
            let ray = Ray {
                origin,
                direction: light.direction,
                leaves,
            };
            let free = cos > 0.0
                && self
                    .world
                    .closest(&ray)
                    .is_none_or(|hit| hit.t >= light.distance);
            if free {
                let fog = self.fog.as_ref();
                let left = fog.map_or(DVec3::ONE, |f| f.transmittance(&ray, light.distance));
                left * light.irradiance * cos
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
}
