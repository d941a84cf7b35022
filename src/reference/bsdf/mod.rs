//! Surface scattering of the reference, one file a kind, in f64 and by the formulas of the sources that
//! `docs/bsdf.md` names, not by the kernels'.
//!
//! All directions are unit vectors in the frame of the shading normal, +z on the side of `o`, where
//! the path came from; `i` is where it goes on. Radiance is what is carried. A kind says what `f
//! |cos_i|` is, for light that is looked for, and draws a direction with its weight `f |cos_i| / pdf`
//! by a sampler of its own.

mod conductor;
mod dielectric;
mod diffuse;
mod energy;
mod facets;
mod fresnel;
mod material;
mod principled;
#[cfg(test)]
mod tests;

pub(super) use material::{Reader, Worn};

use super::random::uniform;
use conductor::{Conductor, Mirror};
use dielectric::{Glass, RoughGlass};
use diffuse::Diffuse;
use glam::DVec3;
use principled::Principled;
use rand_pcg::rand_core::Rng;
use std::f64::consts::TAU;

/// The least width of facets; below, surfaces are polished (`docs/bsdf.md`).
const FLOOR: f64 = 1e-3;

/// A direction and its weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    pub(super) direction: DVec3,
    pub(super) weight: DVec3,
}

/// What a surface does at a point with light towards `o`.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bsdf<'a> {
    Diffuse(Diffuse),
    Mirror(Mirror),
    Conductor(Conductor<'a>),
    Glass(Glass),
    RoughGlass(RoughGlass),
    Principled(Principled),
}

impl Bsdf<'_> {
    /// Whether it reflects diffusely, so that the edge of shadow is softened on smooth normals.
    pub(super) fn is_diffuse(&self) -> bool {
        matches!(self, Self::Diffuse(_))
    }

    /// `f |cos_i|`; 0 for what only its own drawing finds.
    pub(super) fn evaluate(&self, o: DVec3, i: DVec3) -> DVec3 {
        match self {
            Self::Diffuse(diffuse) => diffuse.evaluate(o, i),
            Self::Mirror(_) | Self::Glass(_) => DVec3::ZERO,
            Self::Conductor(metal) => metal.evaluate(o, i),
            Self::RoughGlass(glass) => glass.evaluate(o, i),
            Self::Principled(lobes) => lobes.evaluate(o, i),
        }
    }

    /// Draws where to go on; nothing if the path ends. Diffuse surfaces draw by the cosine, or, if
    /// asked, uniformly.
    pub(super) fn draw(&self, o: DVec3, evenly: bool, rng: &mut impl Rng) -> Option<Drawn> {
        match self {
            Self::Diffuse(diffuse) if evenly => {
                let direction = uniform_direction(rng);
                let weight = diffuse.evaluate(o, direction) * TAU;
                Some(Drawn { direction, weight })
            }
            Self::Diffuse(diffuse) => Some(diffuse.draw(o, rng)),
            Self::Mirror(mirror) => Some(mirror.draw(o)),
            Self::Conductor(metal) => metal.draw(o, rng),
            Self::Glass(glass) => glass.draw(o, rng),
            Self::RoughGlass(glass) => glass.draw(o, rng),
            Self::Principled(lobes) => lobes.draw(o, rng),
        }
    }
}

/// A direction of the upper hemisphere with pdf `cos / pi`.
fn cosine_direction(rng: &mut impl Rng) -> DVec3 {
    // The cosine is never 0.
    at_cosine((1.0 - uniform(rng)).sqrt(), rng)
}

/// A direction of the upper hemisphere with pdf `1 / (2 pi)`.
fn uniform_direction(rng: &mut impl Rng) -> DVec3 {
    at_cosine(1.0 - uniform(rng), rng)
}

fn at_cosine(cos: f64, rng: &mut impl Rng) -> DVec3 {
    let sin = (1.0 - cos * cos).sqrt();
    let (y, x) = (TAU * uniform(rng)).sin_cos();
    DVec3::new(sin * x, sin * y, cos)
}
