//! Glass, polished and rough: Fresnel's reflectance decides what is reflected and what passes, by B.
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007. A thin wall is
//! two boundaries at one place, between which light goes to and fro: `R + T R T + T R^3 T + ...`
//! comes back, and the rest passes without a bend, spread by roughness as its mirror image. The
//! albedo of single scattering divides all of it (E. Turquin, "Practical multiple scattering
//! compensation for microfacet models", 2019).

use super::Drawn;
use super::facets::{Facets, reflect};
use super::fresnel::{fresnel, refract};
use crate::reference::random::uniform;
use glam::DVec3;
use rand_pcg::rand_core::Rng;

/// A polished boundary or thin wall.
#[derive(Clone, Copy, Debug)]
pub(in crate::reference) struct Glass {
    /// Index of the far side over that of the near side.
    pub(super) eta: f64,
    pub(super) thin: bool,
    /// What is reflected and what passes is multiplied with.
    pub(super) tints: [DVec3; 2],
}

/// A rough one.
#[derive(Clone, Copy, Debug)]
pub(in crate::reference) struct RoughGlass {
    pub(super) polished: Glass,
    pub(super) alpha: f64,
    /// Albedo of single scattering from where light goes to, or 1 where nothing is made up for.
    pub(super) kept: f64,
}

impl Glass {
    /// How far refraction by facets moves a direction, over their slope.
    fn bend(&self) -> f64 {
        (self.eta - 1.0).abs() / self.eta.max(1.0)
    }

    /// Whether light passes a rough boundary as it passes a polished one, the indices being nearly
    /// the same (`docs/bsdf.md`: 0.05).
    pub(super) fn matched(&self) -> bool {
        self.bend() < 0.05 && !self.thin
    }

    fn reflectance(&self, cos: f64) -> f64 {
        let r = fresnel(cos, self.eta, 0.0);
        if self.thin { 2.0 * r / (1.0 + r) } else { r }
    }

    /// Radiance behind the boundary over radiance before it.
    fn compression(&self) -> f64 {
        if self.thin { 1.0 } else { self.eta.powi(-2) }
    }

    /// What passes a polished surface.
    fn pass(&self, o: DVec3) -> Option<Drawn> {
        let straight = if self.thin {
            Some(-o)
        } else {
            refract(o, DVec3::Z, self.eta)
        };
        straight.map(|direction| Drawn {
            direction,
            weight: self.tints[1] * self.compression(),
        })
    }

    pub(super) fn draw(&self, o: DVec3, rng: &mut impl Rng) -> Option<Drawn> {
        if uniform(rng) < self.reflectance(o.z) {
            return Some(Drawn {
                direction: DVec3::new(-o.x, -o.y, o.z),
                weight: self.tints[0],
            });
        }
        self.pass(o)
    }
}

impl RoughGlass {
    fn facets(&self) -> Facets {
        Facets::isotropic(self.alpha)
    }

    /// Reflectance of a facet of normal `m`; where the indices match, of the whole surface.
    fn reflectance(&self, o: DVec3, m: DVec3) -> f64 {
        let cos = if self.polished.matched() {
            o.z
        } else {
            o.dot(m)
        };
        self.polished.reflectance(cos)
    }

    /// Whether what passes is too narrow a lobe for light to be looked for in it: below 0.001
    /// (`docs/bsdf.md`).
    fn narrow(&self) -> bool {
        let glass = &self.polished;
        glass.matched() || (!glass.thin && glass.bend() * self.alpha < 1e-3)
    }

    /// `f |cos_i|` as far as light may be looked for: without what passes in a lobe too narrow.
    pub(super) fn evaluate(&self, o: DVec3, i: DVec3) -> DVec3 {
        let Glass { eta, thin, tints } = self.polished;
        let passes = i.z < 0.0;
        if !passes || thin {
            let up = i * DVec3::new(1.0, 1.0, i.z.signum());
            let m = (o + up).normalize();
            let r = self.reflectance(o, m);
            let (part, tint) = if passes {
                (1.0 - r, tints[1])
            } else {
                (r, tints[0])
            };
            return tint * (part * self.facets().reflection(o, up, m) / self.kept);
        }
        let along = o + eta * i;
        let m = along.normalize_or(DVec3::Z) * along.z.signum();
        if self.narrow() || o.dot(m) <= 0.0 || i.dot(m) >= 0.0 {
            return DVec3::ZERO;
        }
        let part = 1.0 - self.reflectance(o, m);
        tints[1] * (part * self.facets().refraction(o, i, m, eta) / self.kept)
    }

    pub(super) fn draw(&self, o: DVec3, rng: &mut impl Rng) -> Option<Drawn> {
        let Glass { eta, thin, tints } = self.polished;
        let m = self.facets().draw(o, rng);
        let passes = uniform(rng) >= self.reflectance(o, m);
        if passes && self.polished.matched() {
            return self.polished.pass(o);
        }
        let direction = if !passes {
            reflect(o, m)
        } else if thin {
            reflect(o, m) * DVec3::new(1.0, 1.0, -1.0)
        } else {
            refract(o, m, eta)?
        };
        let scale = if passes {
            self.polished.compression()
        } else {
            1.0
        };
        let scale = scale * self.facets().shadowing(o, direction) / self.kept;
        ((direction.z < 0.0) == passes).then_some(Drawn {
            direction,
            weight: tints[usize::from(passes)] * scale,
        })
    }
}
