//! Scattering: what happens to a path at a surface.
//!
//! * [`plain`]: Lambertian surfaces without textures or interpolated normals, in one pass from hit
//!   to scattered path. Scenes that hold nothing else run nothing else.

//!   between: what the surface is, one sample of its light, and what its BSDF makes of both, one
//!   kernel a kind of BSDF.
//! * [`ambient`]: ambient occlusion.

pub mod ambient;
pub mod interact;
pub mod kinds;
pub mod light_up;
pub mod plain;
pub mod respond;

use crate::hemisphere::{UNIFORM_PDF, cosine_pdf, sample_cosine, sample_uniform};
use crate::lanes::Fx;
use crate::queues::{Identity, PathsMut, ShadowsMut};
use crate::sampler::{Block, Sampler, block};
use crate::vec3::Vec3x;

/// How a direction is drawn over the hemisphere about +z.
pub trait Directions {
    /// A direction from two uniform numbers.
    fn sample(u: Fx, v: Fx) -> Vec3x;
    /// Its pdf in solid angle, from its cosine.
    fn pdf(cos: Fx) -> Fx;
    /// `cos / (pi pdf)`: what a Lambertian albedo is multiplied with.
    fn weight(cos: Fx) -> Fx;
}

/// `pdf = 1 / (2 pi)`.
#[derive(Clone, Copy, Debug)]
pub struct Uniform;
/// `pdf = cos / pi`.
#[derive(Clone, Copy, Debug)]
pub struct Cosine;

impl Directions for Uniform {
    #[inline(always)]
    fn sample(u: Fx, v: Fx) -> Vec3x {
        sample_uniform(u, v)
    }
    #[inline(always)]
    fn pdf(_cos: Fx) -> Fx {
        Fx::splat(UNIFORM_PDF)
    }
    #[inline(always)]
    fn weight(cos: Fx) -> Fx {
        cos + cos
    }
}

impl Directions for Cosine {
    #[inline(always)]
    fn sample(u: Fx, v: Fx) -> Vec3x {
        sample_cosine(u, v)
    }
    #[inline(always)]
    fn pdf(cos: Fx) -> Fx {
        cosine_pdf(cos)
    }
    #[inline(always)]
    fn weight(_cos: Fx) -> Fx {
        Fx::ONE
    }
}

/// Next-event estimation, as a choice at compile time.
pub trait NextEvent {
    /// Whether lights are sampled.
    const LIGHTS: bool;
    /// Whether the direction's pdf is weighed against the light's.
    const WEIGHTED: bool;
}

/// Light is found by directions only.
#[derive(Clone, Copy, Debug)]
pub struct NoLights;
/// Light is found by sampling lights only.
#[derive(Clone, Copy, Debug)]
pub struct LightsAlone;
/// Light is found both ways, weighted.
#[derive(Clone, Copy, Debug)]
pub struct LightsWeighted;

impl NextEvent for NoLights {
    const LIGHTS: bool = false;
    const WEIGHTED: bool = false;
}
impl NextEvent for LightsAlone {
    const LIGHTS: bool = true;
    const WEIGHTED: bool = false;
}
impl NextEvent for LightsWeighted {
    const LIGHTS: bool = true;
    const WEIGHTED: bool = true;
}

/// Where scattered paths and occlusion rays go.
#[derive(Debug)]
pub struct Out<'a> {
    /// Scattered paths: one for each path of a list, in its order, list behind list.
    pub paths: PathsMut<'a>,
    /// Paths already in `paths`.
    pub path_len: usize,
    /// Occlusion rays.
    pub shadows: ShadowsMut<'a>,
    /// Occlusion rays already in `shadows`.
    pub shadow_len: usize,
}

/// The four numbers that `path` draws for `what`.
#[inline(always)]
fn draw<S: Sampler>(sampler: S, path: &Identity, what: Block) -> [Fx; 4] {
    sampler.draw4(path.pixel, path.sample, block(path.bounces, what))
}
