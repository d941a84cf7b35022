//! Metals: the mirror, and facets of GGX with Fresnel's reflectance. What leaves after more than one
//! facet is made up for as in C. Kulla, A. Conty, "Revisiting Physically Based Shading at
//! Imageworks", SIGGRAPH 2017 course.

use super::energy::Loss;
use super::facets::{Facets, reflect};
use super::fresnel::fresnel_rgb;
use super::{Drawn, cosine_direction};
use crate::reference::random::uniform;
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::PI;

/// A polished metal.
#[derive(Clone, Copy, Debug)]
pub(in crate::reference) struct Mirror {
    pub(super) eta: DVec3,
    pub(super) k: DVec3,
    pub(super) tint: DVec3,
}

/// A rough metal.
#[derive(Clone, Copy, Debug)]
pub(in crate::reference) struct Conductor<'a> {
    pub(super) polished: Mirror,
    pub(super) facets: Facets,
    /// What single scattering loses, and Fresnel's mean reflectance, where it is made up for.
    pub(super) again: Option<(&'a Loss, DVec3)>,
}

/// How often light that has met more than one facet is drawn, where there is any.
const AGAIN: f64 = 0.25;

impl Mirror {
    fn reflectance(&self, cos: f64) -> DVec3 {
        self.tint * fresnel_rgb(cos, self.eta, self.k)
    }

    pub(super) fn draw(&self, o: DVec3) -> Drawn {
        Drawn {
            direction: DVec3::new(-o.x, -o.y, o.z),
            weight: self.reflectance(o.z),
        }
    }
}

impl Conductor<'_> {
    /// `pi f` of the light that has met more than one facet.
    fn again(&self, o: DVec3, i: DVec3) -> DVec3 {
        let Some((loss, fresnel)) = self.again else {
            return DVec3::ZERO;
        };
        if loss.mean <= 0.0 {
            return DVec3::ZERO;
        }
        let kept = 1.0 - loss.mean;
        let colour = fresnel * fresnel * kept / (DVec3::ONE - fresnel * loss.mean);
        self.polished.tint * colour * (loss.of(o) * loss.of(i) / loss.mean)
    }

    /// `f |cos_i|`.
    pub(super) fn evaluate(&self, o: DVec3, i: DVec3) -> DVec3 {
        if i.z <= 0.0 {
            return DVec3::ZERO;
        }
        let m = (o + i).normalize();
        let once = self.polished.reflectance(o.dot(m)) * self.facets.reflection(o, i, m);
        once + self.again(o, i) * i.z / PI
    }

    pub(super) fn draw(&self, o: DVec3, rng: &mut impl Rng) -> Option<Drawn> {
        let chance = self.again.map_or(0.0, |_| AGAIN);
        if uniform(rng) < chance {
            let direction = cosine_direction(rng);
            let weight = self.again(o, direction) / chance;
            return Some(Drawn { direction, weight });
        }
        let m = self.facets.draw(o, rng);
        let direction = reflect(o, m);
        let weight = self.polished.reflectance(o.dot(m)) * self.facets.shadowing(o, direction);
        (direction.z > 0.0).then_some(Drawn {
            direction,
            weight: weight / (1.0 - chance),
        })
    }
}
