//! BSDFs in lanes: evaluate, sample and pdf, one family a file.
//!
//! Everything here happens in the local frame of a surface, whose z axis is the shading normal on
//! the side of `o`, so that `o.z > 0`; `o` (omega_o) points to where the path came from, `i`
//! (omega_i) to where it goes next, both unit vectors away from the surface. `i.z > 0` is
//! reflected, `i.z < 0` transmitted. Values are for radiance, as a path from the camera carries
//! it: what is transmitted into a medium of relative index `eta` is divided by `eta^2`. Cosines
//! are part of every value, and every pdf is in solid angle.
//!
//! A family is a struct of lanes with its parameters already gathered. What it guarantees, for
//! `o.z > 0` and parameters in its stated domain:
//!
//! * `evaluate` gives a finite value `>= 0` and a finite pdf `>= 0`, for any unit `i`;
//! * `sample` with `u` in `[0, 1 - 2^-24]` gives finite numbers in all lanes; where a lane is valid,
//!   its direction is a unit vector (to rounding), its pdf is positive and what `evaluate` would
//!   say of that direction to rounding (or [`DELTA_PDF`]), and its weight is value over pdf; where
//!   it is not, weight and pdf are 0.

use crate::lanes::{Fx, Mask};
use crate::vec3::Vec3x;

mod conductor;
mod dielectric;
mod diffuse;
mod energy;
pub mod fresnel;
mod ggx;
mod refraction;

pub use conductor::{RoughConductor, SmoothConductor};
pub use dielectric::{RoughDielectric, SmoothDielectric};
pub use diffuse::{Lambert, RoughDiffuse};
pub use energy::{ReflectionEnergy, TransmissionEnergy};
pub use ggx::ALPHA_FLOOR;

/// The pdf of a direction out of a delta distribution: light sampling cannot find it, so the power
/// heuristic gives it the weight 1, which it does with this number and no branch.
pub const DELTA_PDF: f32 = f32::INFINITY;

/// A BSDF for a pair of directions.
#[derive(Clone, Copy, Debug)]
pub struct Evaluated {
    /// `f |cos_i|`, red, green and blue; 0 for a delta distribution.
    pub value: Vec3x,
    /// Pdf with which `sample` draws the direction, in solid angle; 0 where it cannot.
    pub pdf: Fx,
}

/// A direction drawn from a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct Sampled {
    /// Unit vector, local.
    pub direction: Vec3x,
    /// `f |cos_i| / pdf`: what the throughput is multiplied with. 0 where not valid.
    pub weight: Vec3x,
    /// Pdf of the direction in solid angle, or [`DELTA_PDF`]. 0 where not valid.
    pub pdf: Fx,
    /// False where the draw left no direction, as when a facet reflects below the surface: the
    /// path ends there. The probability of it is what the pdf lacks to integrate to 1.
    pub valid: Mask,
}

/// A family of BSDFs, one a lane.
pub trait Bsdf {
    /// Value and pdf of going on along `i`, having come from `o`.
    fn evaluate(&self, o: Vec3x, i: Vec3x) -> Evaluated;
    /// Draws where to go on, having come from `o`; `u` in `[0, 1 - 2^-24]`.
    fn sample(&self, o: Vec3x, u: [Fx; 3]) -> Sampled;
}

impl Evaluated {
    /// Neither value nor pdf: what a delta distribution says of any direction.
    #[inline(always)]
    #[must_use]
    pub fn nothing() -> Self {
        Self {
            value: Vec3x::splat([0.0; 3]),
            pdf: Fx::ZERO,
        }
    }

    /// Value and pdf where `mask` is true, 0 elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn keep(self, mask: Mask) -> Self {
        Self {
            value: self.value.keep(mask),
            pdf: mask & self.pdf,
        }
    }
}

impl Sampled {
    /// Weight and pdf where `valid` is true, 0 elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn new(direction: Vec3x, weight: Vec3x, pdf: Fx, valid: Mask) -> Self {
        Self {
            direction,
            weight: weight.keep(valid),
            pdf: valid & pdf,
            valid,
        }
    }
}
