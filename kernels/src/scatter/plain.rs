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
//! Bytes: [`SCATTER`] a path, [`SHADOW`] an occlusion ray.

use super::{Cast, Directions, NextEvent, Out, Scattered, draw};
use crate::cost::{Cost, columns, item};
use crate::hemisphere::to_world;
use crate::lanes::{Fx, as_mask};
use crate::light::sample_light;
use crate::math::INV_PI;
use crate::prefetch::Ahead;
use crate::queues::{Listed, PathHitsMut, PathsMut, ShadowsMut};
use crate::sampler::{Block, Sampler};
use crate::surface::{self, Surface};
use crate::tables::Tables;
use crate::vec3::Vec3x;

/// Bytes a scattered path: its place, direction, throughput and identity, hit, triangle and albedo
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
/// Bytes an occlusion ray: the light's entry (12), triangle and material (20) read; the ray written.
pub const SHADOW: Cost = Cost::new(
    12 + surface::TRIANGLE_BYTES + 20,
    item::<ShadowsMut<'static>>(),
)
.operations(130);

/// Scatters the listed paths behind the paths and occlusion rays that `out` already holds.
pub fn scatter<D: Directions, N: NextEvent, S: Sampler>(
    listed: Listed,
    tables: &Tables,
    sampler: S,
    out: &mut Out,
) {
    let ahead = Ahead::new(listed, &tables.triangles);
    for (i, at, busy) in listed.vectors() {
        ahead.at(i);
        let surface = Surface::met(&listed, &tables.triangles, at);
        let primitive = surface.primitive;
        let albedo = Vec3x::gather_columns(tables.materials.albedo, surface.material);
        let reflected = Vec3x::gather_columns(listed.paths.throughput, at).product(albedo);
        let path = listed.paths.identity(at);

        let [u, v, ..] = draw(sampler, &path, Block::Direction);
        let local = D::sample(u, v);
        let next = to_world(surface.normal, local);
        let ray = Scattered {
            origin: surface.origin,
            direction: next,
            throughput: reflected * D::weight(local.z),
            pdf: D::pdf(local.z),
            leaves: primitive,
            marks: 0,
        };
        out.scatter(i, &path, &ray);

        if N::LIGHTS {
            let u = draw(sampler, &path, Block::Light);
            let light = sample_light(tables, &surface.anchor(Fx::ZERO), u);
            let cos = surface.normal.dot(light.direction);
            let weight = if N::WEIGHTED {
                light.weight(D::pdf(cos))
            } else {
                Fx::ONE
            };
            let factor = cos * Fx::splat(INV_PI) * weight / light.pdf;
            let radiance = reflected.product(light.radiance) * factor;
            let carries = busy
                & light.valid
                & cos.simd_gt(Fx::ZERO)
                & !as_mask(light.primitive.simd_eq(primitive))
                & radiance.any_light();
            let ray = Cast {
                origin: light.origin,
                segment: light.segment,
                t_max: light.t_max,
                leaves: primitive,
                reaches: light.primitive,
                radiance,
            };
            out.cast(carries, &path, &ray);
        }
    }
    out.path_len += listed.len;
}
