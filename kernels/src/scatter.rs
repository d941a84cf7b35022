//! Lambertian scattering: hemisphere sampling with PDF weighting, and next-event estimation.
//!
//! A Lambertian BSDF is `albedo / pi`. For every path at a surface with unit normal `n`:
//!
//! * a direction `w` on the hemisphere about `n`, drawn with pdf `p(w)`; the path goes on with
//!   `throughput *= (albedo / pi) cos(n, w) / p(w)`;
//! * with next-event estimation, one point on one light: an occlusion ray that carries
//!   `throughput * (albedo / pi) * L * cos(n, w_l) / p_l(w_l)`, times the power heuristic's weight
//!   where `p` could have found that light too.
//!
//! Both pdfs are in solid angle. Paths come in through an index list and leave in its order, dense:
//! lanes that can carry nothing more (a black surface) leave with throughput 0, which roulette ends.
//! Occlusion rays that can carry nothing are not made.
//!
//! Cost: [`SCATTER`] a path, [`SHADOW`] an occlusion ray.

use crate::compact::Kept;
use crate::cost::{Cost, columns, item};
use crate::hemisphere::{UNIFORM_PDF, cosine_pdf, sample_cosine, sample_uniform, to_world};
use crate::lanes::{Fx, Ux, as_mask, store, store_u32};
use crate::light::sample_light;
use crate::math::INV_PI;
use crate::mis::power_heuristic;
use crate::queues::{Identity, Listed, PathHitsMut, PathsMut, ShadowsMut};
use crate::rays::NO_PRIMITIVE;
use crate::sampler::{Block, Sampler, block};
use crate::surface::{self, Surface};
use crate::tables::Tables;
use crate::vec3::Vec3x;

/// A scattered path: its place, direction, throughput and identity, hit, triangle and albedo
/// read; the path written.
pub const SCATTER: Cost = Cost::new(
    4 + columns::<PathsMut<'static>>(&[
        "direction",
        "throughput",
        "slot",
        "pixel",
        "sample",
        "bounces",
    ]) + item::<PathHitsMut<'static>>()
        + surface::TRIANGLE_BYTES
        + 12,
    item::<PathsMut<'static>>(),
)
.operations(surface::OPERATIONS + 90);
/// An occlusion ray: the light's entry (12), triangle and material (20) read; the ray written.
pub const SHADOW: Cost = Cost::new(
    12 + surface::TRIANGLE_BYTES + 20,
    item::<ShadowsMut<'static>>(),
);

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
    /// Scattered paths, written from the front: one for each path of the list, in its order.
    pub paths: PathsMut<'a>,
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

/// Scatters the listed paths. Returns the number of occlusion rays then in `out.shadows`.
pub fn scatter<D: Directions, N: NextEvent, S: Sampler>(
    listed: Listed,
    tables: &Tables,
    sampler: S,
    mut out: Out,
) -> usize {
    for (i, at, busy) in listed.vectors() {
        let surface = Surface::met(&listed, &tables.triangles, at);
        let primitive = surface.primitive;
        let albedo = Vec3x::gather_columns(tables.materials.albedo, surface.material);
        let reflected = Vec3x::gather_columns(listed.paths.throughput, at).product(albedo);
        let path = listed.paths.identity(at);

        let [u, v, ..] = draw(sampler, &path, Block::Direction);
        let local = D::sample(u, v);
        let next = to_world(surface.normal, local);
        let p = &mut out.paths;
        surface.origin.store(&mut p.origin, i);
        next.store(&mut p.direction, i);
        (reflected * D::weight(local.z)).store(&mut p.throughput, i);
        store(p.pdf, i, D::pdf(local.z));
        store_u32(p.leaves, i, primitive);
        store_u32(p.slot, i, path.slot);
        store_u32(p.pixel, i, path.pixel);
        store_u32(p.sample, i, path.sample);
        store_u32(p.bounces, i, path.bounces + Ux::ONE);

        if N::LIGHTS {
            let u = draw(sampler, &path, Block::Light);
            let light = sample_light(tables, surface.origin, surface.normal, u);
            let cos = surface.normal.dot(light.direction);
            let weight = if N::WEIGHTED {
                power_heuristic(light.pdf, D::pdf(cos))
            } else {
                Fx::ONE
            };
            let factor = cos * Fx::splat(INV_PI) * weight / light.pdf;
            let radiance = reflected.product(light.radiance) * factor;
            let carries = busy
                & light.valid
                & cos.simd_gt(Fx::ZERO)
                & !as_mask(light.primitive.simd_eq(primitive))
                & radiance.max_component().simd_gt(Fx::ZERO);
            let kept = Kept::new(carries);
            let to = out.shadow_len;
            let s = &mut out.shadows;
            kept.store3(&mut s.origin, to, surface.origin);
            kept.store3(&mut s.direction, to, light.segment);
            kept.store(s.t_max, to, light.t_max);
            kept.store3(&mut s.radiance, to, radiance);
            kept.store_u32(s.leaves, to, primitive);
            kept.store_u32(s.reaches, to, light.primitive);
            kept.store_u32(s.slot, to, path.slot);
            kept.store_u32(s.bounces, to, path.bounces);
            out.shadow_len += kept.count;
        }
    }
    out.shadow_len
}

/// Ambient occlusion: one direction at each hit, unoccluded up to `distance` or not. The estimate of
/// `1/pi * integral of V(w) cos(w)` is `V cos / (pi pdf)`, which the occlusion ray carries as its
/// radiance; the paths end. Arguments as for [`scatter`]; returns the number of occlusion rays.
pub fn ambient<D: Directions, S: Sampler>(
    listed: Listed,
    tables: &Tables,
    sampler: S,
    distance: f32,
    mut s: ShadowsMut,
) -> usize {
    for (i, at, _) in listed.vectors() {
        let surface = Surface::met(&listed, &tables.triangles, at);
        let path = listed.paths.identity(at);
        let [u, v, ..] = draw(sampler, &path, Block::Direction);
        let local = D::sample(u, v);
        let weight = D::weight(local.z);
        surface.origin.store(&mut s.origin, i);
        to_world(surface.normal, local).store(&mut s.direction, i);
        store(s.t_max, i, Fx::splat(distance));
        Vec3x::new(weight, weight, weight).store(&mut s.radiance, i);
        store_u32(s.leaves, i, surface.primitive);
        store_u32(s.reaches, i, Ux::splat(NO_PRIMITIVE));
        store_u32(s.slot, i, path.slot);
        store_u32(s.bounces, i, path.bounces);
    }
    listed.len
}
