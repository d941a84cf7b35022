//! Scattering: what happens to a path at a surface.
//!
//! * [`plain`]: Lambertian surfaces without textures or interpolated normals, in one pass from hit
//!   to scattered path. Scenes that hold nothing else run nothing else.
//! * [`interact`], [`texture`], [`align`], [`light_up`], [`respond`]: all others, in passes with queues
//!   in between: what the surface is, what images say of it, which way it is brushed, one sample of its light, and what its BSDF
//!   makes of all that, one kernel a kind of BSDF.
//! * [`disperse`]: what a path becomes before it meets a dispersive surface.
//! * [`medium`]: scattering in a medium, without a surface.
//! * [`ambient`]: ambient occlusion.

pub mod align;
pub mod ambient;
pub mod disperse;
pub mod interact;
pub mod kinds;
pub mod light_up;
pub mod medium;
pub mod plain;
pub mod respond;
pub mod texture;

use crate::compact::Kept;
use crate::hemisphere::{UNIFORM_PDF, cosine_pdf, sample_cosine, sample_uniform};
use crate::lanes::{Fx, Mask, Ux, store, store_u32};
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

/// A vector of scattered rays: what a path takes on beside its identity.
struct Scattered {
    origin: Vec3x,
    direction: Vec3x,
    throughput: Vec3x,
    pdf: Fx,
    leaves: Ux,
    /// Set in `bounces` beside the count.
    marks: u32,
}

/// A vector of occlusion rays, without the identity of their paths.
struct Cast {
    origin: Vec3x,
    segment: Vec3x,
    t_max: Fx,
    leaves: Ux,
    reaches: Ux,
    radiance: Vec3x,
}

impl Out<'_> {
    /// Writes item `i` and on of a list behind the lists before it. Whoever has written a whole list
    /// raises `path_len`.
    #[inline(always)]
    fn scatter(&mut self, i: usize, path: &Identity, ray: &Scattered) {
        let to = self.path_len + i;
        let p = &mut self.paths;
        ray.origin.store(&mut p.origin, to);
        ray.direction.store(&mut p.direction, to);
        ray.throughput.store(&mut p.throughput, to);
        store(p.pdf, to, ray.pdf);
        store_u32(p.leaves, to, ray.leaves);
        store_u32(p.slot, to, path.slot);
        store_u32(p.pixel, to, path.pixel);
        store_u32(p.sample, to, path.sample);
        store_u32(
            p.bounces,
            to,
            (path.bounces + Ux::ONE) | Ux::splat(ray.marks),
        );
    }

    /// Appends the occlusion rays in the lanes that `carry` light.
    #[inline(always)]
    fn cast(&mut self, carry: Mask, path: &Identity, ray: &Cast) {
        let kept = Kept::new(carry);
        let to = self.shadow_len;
        let s = &mut self.shadows;
        kept.store3(&mut s.origin, to, ray.origin);
        kept.store3(&mut s.direction, to, ray.segment);
        kept.store(s.t_max, to, ray.t_max);
        kept.store3(&mut s.radiance, to, ray.radiance);
        kept.store_u32(s.leaves, to, ray.leaves);
        kept.store_u32(s.reaches, to, ray.reaches);
        kept.store_u32(s.slot, to, path.slot);
        kept.store_u32(s.bounces, to, path.bounces);
        self.shadow_len += kept.count;
    }
}

/// The four numbers that `path` draws for `what`.
#[inline(always)]
fn draw<S: Sampler>(sampler: S, path: &Identity, what: Block) -> [Fx; 4] {
    sampler.draw4(path.pixel, path.sample, block(path.bounces, what))
}
