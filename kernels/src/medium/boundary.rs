//! What media do to occlusion rays, and where paths go from one into another.

use super::{Media, UNCHANGED};
use crate::lanes::{
    Fx, LANES, Mask, Ux, as_bits, as_mask, first, gather_u32, load, load_u32, padded, store_u32,
};
use crate::queues::{Listed, PathsMut, ShadowsMut, Surfaces};
use crate::vec3::Vec3x;
use std::ops::Range;

/// The medium on the other side of surfaces from `near`, which are seen from their front or back.
#[inline(always)]
fn behind(media: &Media, near: Ux, front: Mask, material: Ux) -> Ux {
    let inside = gather_u32(media.interior, material);
    let stays = inside.simd_eq(Ux::splat(UNCHANGED));
    let other = as_bits(front).select(inside, gather_u32(media.exterior, material));
    stays.select(near, other)
}

/// Takes from the light of occlusion rays, items `range` of `shadows`, what the media on their way take.
/// Ray `k` of them was cast by row `rows[k]` of the list, which is padded with valid rows. No ray
/// crosses a boundary: surfaces of glass are in the way of light as all others are. `surfaces` are the
/// rows where light passes through the surface, if it does: then rays may start on its other side.
pub fn attenuate(
    range: Range<usize>,
    rows: &[u32],
    listed: Listed,
    medium: &[u32],
    media: &Media,
    surfaces: Option<Surfaces>,
    shadows: &mut ShadowsMut,
) {
    for k in (0..padded(range.len())).step_by(LANES) {
        let busy = first(range.len() - k);
        let i = range.start + k;
        let row = load_u32(rows, k);
        let at = gather_u32(listed.index, row);
        let mut through = gather_u32(medium, at);
        let [x, y, z] = shadows.direction.each_ref().map(|c| load(c, i));
        let segment = Vec3x::new(x, y, z);
        if let Some(surfaces) = &surfaces {
            let normal = Vec3x::gather_columns(surfaces.normal, row);
            let below = as_bits(normal.dot(segment).simd_lt(Fx::ZERO));
            let front = as_mask(gather_u32(surfaces.front, row));
            let material = gather_u32(surfaces.material, row);
            through = below.select(behind(media, through, front, material), through);
        }
        let [x, y, z] = shadows.origin.each_ref().map(|c| load(c, i));
        let origin = Vec3x::new(x, y, z);
        let size = segment.dot(segment).sqrt();
        let direction = segment * (Fx::ONE / size);
        let reach = media.reach(through, origin, direction, load(shadows.t_max, i) * size);
        let left = media.transmittance(through, reach.length);
        let [r, g, b] = shadows.radiance.each_ref().map(|c| load(c, i));
        let light = Vec3x::new(r, g, b);
        // The lanes behind belong to nobody yet.
        let light = Vec3x::select(busy, light.product(left), light);
        light.store(&mut shadows.radiance, i);
    }
}

/// Writes the media of the paths that the listed ones became at surfaces that light passes through: row
/// `k` of the list went on as item `from + k` of `scattered`. Those that stay on the side that they came
/// from stay in their medium.
pub fn cross(
    listed: Listed,
    medium: &[u32],
    media: &Media,
    surfaces: Surfaces,
    scattered: &PathsMut,
    from: usize,
    into: &mut [u32],
) {
    for (k, at, _) in listed.vectors() {
        let near = gather_u32(medium, at);
        let [x, y, z] = scattered.direction.each_ref().map(|c| load(c, from + k));
        let side = Vec3x::load(surfaces.normal, k).dot(Vec3x::new(x, y, z));
        let passed = as_bits(side.simd_lt(Fx::ZERO));
        let front = as_mask(load_u32(surfaces.front, k));
        let beyond = behind(media, near, front, load_u32(surfaces.material, k));
        store_u32(into, from + k, passed.select(beyond, near));
    }
}
