//! Ambient occlusion.

use super::{Directions, Out, draw};
use crate::hemisphere::to_world;
use crate::lanes::{Fx, Ux, store, store_u32};
use crate::queues::Listed;
use crate::rays::NO_PRIMITIVE;
use crate::sampler::{Block, Sampler};
use crate::surface::Surface;
use crate::tables::Tables;
use crate::vec3::Vec3x;

/// Ambient occlusion: one direction at each hit, unoccluded up to `distance` or not. The estimate of
/// `1/pi * integral of V(w) cos(w)` is `V cos / (pi pdf)`, which the occlusion ray carries as its
/// radiance; the paths end.
pub fn ambient<D: Directions, S: Sampler>(
    listed: Listed,
    tables: &Tables,
    sampler: S,
    distance: f32,
    out: &mut Out,
) {
    let s = &mut out.shadows;
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
    out.shadow_len = listed.len;
}
