//! From hits to surface interactions: the first of three passes over surfaces that are more than
//! plain diffuse ones.
//!
//! Bytes: [`INTERACT`].

use super::draw;
use crate::cost::{Cost, columns, item};
use crate::hemisphere::Frame;
use crate::interpolate::{Interpolated, towards};
use crate::lanes::{Fx, Ux, as_bits, gather, gather_u32, store, store_u32};
use crate::prefetch::Ahead;
use crate::queues::{DrawnMut, Listed, PathHitsMut, PathsMut, SmoothMut, SurfacesMut};
use crate::sampler::{Block, Sampler};
use crate::surface::{self, Place};
use crate::tables::Tables;
use crate::vec3::Vec3x;

/// Bytes a path: its place, direction and identity, hit and triangle read; a row written.
pub const INTERACT: Cost = Cost::new(
    4 + columns::<PathsMut<'static>>(&["direction", "slot", "pixel", "sample", "bounces"])
        + item::<PathHitsMut<'static>>()
        + surface::TRIANGLE_BYTES,
    item::<SurfacesMut<'static>>() + item::<DrawnMut<'static>>(),
)
.operations(surface::OPERATIONS);

/// Writes what the listed paths met, and the numbers that they use there, row by row of the list.
/// Normals are interpolated where both the tables' attributes and `smooth` are there.
pub fn interact<S: Sampler>(
    listed: Listed,
    tables: &Tables,
    sampler: S,
    mut surfaces: SurfacesMut,
    mut drawn: DrawnMut,
    mut smooth: Option<SmoothMut>,
) {
    let ahead = Ahead::new(listed, &tables.triangles);
    for (i, at, _) in listed.vectors() {
        ahead.at(i);
        let direction = Vec3x::gather_columns(listed.paths.direction, at);
        let primitive: Ux = gather_u32(listed.hits.primitive, at);
        let (u, v) = (gather(listed.hits.u, at), gather(listed.hits.v, at));
        let place = Place::of(&tables.triangles, primitive, u, v, || listed.times(at));
        let outside = place.outside;
        let front = outside.dot(direction).simd_lt(Fx::ZERO);
        let normal = Vec3x::select(front, outside, -outside);
        let mut shading = normal;
        if let (Some(attributes), Some(smooth)) = (&tables.attributes, &mut smooth) {
            let bent = Interpolated::met(
                &tables.triangles,
                attributes,
                primitive,
                || outside,
                (u, v),
                || listed.times(at),
            );
            let facing = Vec3x::select(front, bent.normal, -bent.normal);
            shading = towards(facing, normal, -direction);
            store(smooth.coherence, i, bent.coherence);
        }
        let s = &mut surfaces;
        place.point.store(&mut s.point, i);
        store(s.clearance, i, place.clearance);
        normal.store(&mut s.normal, i);
        shading.store(&mut s.shading, i);
        let local = Frame::about(shading).to_local(-direction);
        local.store(&mut s.omega_o, i);
        store_u32(s.front, i, as_bits(front));
        store_u32(s.primitive, i, primitive);
        let material = match listed.material {
            Some(met) => gather_u32(met, at),
            None => place.material,
        };
        store_u32(s.material, i, material);

        let path = listed.paths.identity(at);
        let [x, y, _, choice] = draw(sampler, &path, Block::Direction);
        Vec3x::new(x, y, choice).store(&mut drawn.direction, i);
        let [select, keep, u, v] = draw(sampler, &path, Block::Light);
        store(drawn.select, i, select);
        store(drawn.keep, i, keep);
        store(drawn.u, i, u);
        store(drawn.v, i, v);
    }
}
