//! Media for the oracle: outside of all glass, perhaps within a box, and inside of some.
//!
//! A distance is drawn for one of the three channels at random, all alike probable, and weighed by
//! what all of them would have drawn; directions after a scattering event are uniform over the sphere,
//! weighed by the phase function as Henyey and Greenstein wrote it.

use super::random::uniform;
use super::vector;
use super::world::Ray;
use crate::scene::{self, Bsdf, Material, Scene};
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::{PI, TAU};

/// Where a ray runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Within {
    /// Outside of all glass.
    Outside,
    /// In glass that is filled with nothing.
    Clear,
    /// In glass that is filled with a medium of the scene.
    Filled(u32),
}

impl Within {
    /// What lies behind a surface of `material`, seen from `near` it and from its front or back.
    pub(super) fn behind(self, material: &Material, front: bool) -> Self {
        let thin = match &material.bsdf {
            Bsdf::Dielectric(glass) => glass.thin,
            Bsdf::Principled(p) => p.thin,
            _ => false,
        };
        match (thin, front) {
            (true, _) => self,
            (false, true) => material.interior().map_or(Self::Clear, Self::Filled),
            (false, false) => material.exterior().map_or(Self::Outside, Self::Filled),
        }
    }
}

/// The media of a scene.
#[derive(Debug)]
pub(super) struct Media {
    fog: Option<Medium>,
    inside: Vec<Medium>,
}

impl Media {
    pub(super) fn new(scene: &Scene) -> Self {
        let fog = scene.fog.as_ref().map(|fog| Medium {
            bounds: fog.bounds.map(|corners| corners.map(vector)),
            ..Medium::new(&scene.media[fog.medium as usize])
        });
        Self {
            fog,
            inside: scene.media.iter().map(Medium::new).collect(),
        }
    }

    /// What a ray runs through.
    pub(super) fn of(&self, ray: &Ray) -> Option<&Medium> {
        match ray.within {
            Within::Outside => self.fog.as_ref(),
            Within::Clear => None,
            Within::Filled(i) => self.inside.get(i as usize),
        }
    }
}

/// One of them.
#[derive(Debug)]
pub(super) struct Medium {
    extinction: DVec3,
    scattering: DVec3,
    g: f64,
    bounds: Option<[DVec3; 2]>,
}

impl Medium {
    fn new(medium: &scene::Medium) -> Self {
        let scattering = vector(medium.scattering);
        Self {
            extinction: vector(medium.absorption) + scattering,
            scattering,
            g: medium.g.into(),
            bounds: None,
        }
    }

    /// What it leaves of light over a part of a ray.
    fn left(&self, length: f64) -> DVec3 {
        let along = |sigma: f64| {
            if sigma > 0.0 {
                (-sigma * length).exp()
            } else {
                1.0
            }
        };
        DVec3::from_array(self.extinction.to_array().map(along))
    }

    /// Where the first `way` of a ray enters it, and for how long it stays.
    fn part(&self, ray: &Ray, way: f64) -> (f64, f64) {
        let Some([low, high]) = self.bounds else {
            return (0.0, way);
        };
        let (mut enter, mut leave) = (0.0, way);
        for axis in 0..3 {
            let (o, d) = (ray.origin[axis], ray.direction[axis]);
            let mut between = [low[axis], high[axis]].map(|plane| (plane - o) / d);
            between.sort_by(f64::total_cmp);
            enter = between[0].max(enter);
            leave = between[1].min(leave);
        }
        (enter, (leave - enter).max(0.0))
    }

    /// What is left of light over the first `way` of a ray.
    pub(super) fn transmittance(&self, ray: &Ray, way: f64) -> DVec3 {
        self.left(self.part(ray, way).1)
    }

    /// Takes a ray through it, up to what it meets after `way`: where it is scattered on the way,
    /// if it is, and what light is multiplied with.
    pub(super) fn travel(&self, rng: &mut impl Rng, ray: &Ray, way: f64) -> (Option<f64>, DVec3) {
        let (enter, length) = self.part(ray, way);
        if self.scattering == DVec3::ZERO {
            return (None, self.left(length));
        }
        let channel = ((3.0 * uniform(rng)) as usize).min(2);
        let distance = -(1.0 - uniform(rng)).ln() / self.extinction[channel];
        let mean = |v: DVec3| v.element_sum() / 3.0;
        // 0 / 0 is no distance.
        if distance < length {
            let left = self.left(distance);
            let density = mean(self.extinction * left);
            (Some(enter + distance), self.scattering * left / density)
        } else {
            let left = self.left(length);
            (None, left / mean(left))
        }
    }

    /// The phase function, per steradian, for light that turns by an angle of this cosine.
    pub(super) fn phase(&self, cos: f64) -> f64 {
        let g = self.g;
        (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
    }
}

/// A direction uniform over the sphere.
pub(super) fn anywhere(rng: &mut impl Rng) -> DVec3 {
    let (z, phi) = (1.0 - 2.0 * uniform(rng), TAU * uniform(rng));
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * phi.cos(), r * phi.sin(), z)
}
