//! Emission found by a path: at a surface, or by leaving the scene.
//!
//! A path that scattered and then finds a light weighs what it finds by the power heuristic against
//! next-event estimation, where that is in use; both pdfs in solid angle (see `light`). A camera ray
//! is the only way to see a light directly and weighs 1.
//!
//! Cost: [`SURFACE`], [`SKY`], [`UNOCCLUDED`].

use crate::accumulate::{add, report};
use crate::cost::{Cost, columns, item};
use crate::hemisphere::UNIFORM_PDF;
use crate::lanes::{Fx, LANES, Mask, Ux, as_mask, first, gather, gather_u32, load_u32, padded};
use crate::light::{area_to_solid_angle, sky_radiance};
use crate::mis::power_heuristic;
use crate::queues::{LAST_RAY, Listed, OcclusionMut, PathHitsMut, PathsMut, ShadowsMut};
use crate::surface::{self, Surface};
use crate::tables::Tables;
use crate::vec3::{ColumnsMut, Vec3x};

/// A sample's radiance.
const SAMPLE: Cost = Cost::new(12, 12);
/// Bytes of the path that weighing and adding what it found takes.
const PATH: usize =
    4 + columns::<PathsMut<'static>>(&["direction", "throughput", "pdf", "slot", "bounces"]);

/// A path at an emitting surface: its place, path, hit, triangle, material (emission,
/// sides, pdf) and sample.
pub const SURFACE: Cost = Cost::new(
    PATH + item::<PathHitsMut<'static>>() + surface::TRIANGLE_BYTES + 20 + SAMPLE.read as usize,
    SAMPLE.written as usize,
)
.operations(surface::OPERATIONS + 30);
/// A path that left the scene: its place, path and sample.
pub const SKY: Cost =
    Cost::new(PATH + SAMPLE.read as usize, SAMPLE.written as usize).operations(25);
/// An occlusion ray's light: answer, slot, radiance and sample.
pub const UNOCCLUDED: Cost = Cost::new(
    item::<OcclusionMut<'static>>()
        + columns::<ShadowsMut<'static>>(&["slot", "radiance"])
        + SAMPLE.read as usize,
    SAMPLE.written as usize,
)
.operations(6);

#[inline(always)]
fn from_camera(bounces: Ux) -> Mask {
    as_mask((bounces & Ux::splat(!LAST_RAY)).simd_eq(Ux::splat(0)))
}

/// What found emission weighs: with `MIS`, the power heuristic's share; else everything.
#[inline(always)]
fn weigh<const MIS: bool>(camera: Mask, pdf: Fx, light_pdf: Fx) -> Fx {
    if MIS {
        camera.select(Fx::ONE, power_heuristic(pdf, light_pdf))
    } else {
        Fx::ONE
    }
}

/// Adds the emission of the surfaces that the listed paths hit. `dropped` is called with the slot of
/// each value that is not finite.
pub fn surface_emission<const MIS: bool>(
    listed: Listed,
    tables: &Tables,
    radiance: &mut ColumnsMut,
    mut dropped: impl FnMut(u32),
) {
    let paths = listed.paths;
    for (_, at, busy) in listed.vectors() {
        let surface = Surface::met(&listed, &tables.triangles, at);
        let emits = busy & surface.emits_here(tables.materials.two_sided);
        let camera = from_camera(gather_u32(paths.bounces, at));
        // The pdf with which next-event estimation at the ray's start would have drawn this point:
        // along the ray, which is a unit vector, so the parameter is the distance.
        let t = gather(listed.hits.t, at);
        let area_pdf = gather(tables.materials.area_pdf, surface.material);
        let light_pdf = area_to_solid_angle(area_pdf, t * t, surface.cos_o);
        let weight = weigh::<MIS>(camera, gather(paths.pdf, at), light_pdf);
        let emitted = Vec3x::gather_columns(tables.materials.emission, surface.material);
        let value = Vec3x::gather_columns(paths.throughput, at).product(emitted) * weight;
        let slot = gather_u32(paths.slot, at);
        report(add(radiance, slot, value, emits), slot, &mut dropped);
    }
}

/// Adds the sky to the listed paths, which left the scene. As [`surface_emission`].
pub fn sky_emission<const MIS: bool>(
    listed: Listed,
    tables: &Tables,
    radiance: &mut ColumnsMut,
    mut dropped: impl FnMut(u32),
) {
    let paths = listed.paths;
    let light_pdf = Fx::splat(tables.lights.sky_selection * UNIFORM_PDF);
    for (_, at, busy) in listed.vectors() {
        let camera = from_camera(gather_u32(paths.bounces, at));
        let weight = weigh::<MIS>(camera, gather(paths.pdf, at), light_pdf);
        let sky = sky_radiance(&tables.lights, Vec3x::gather_columns(paths.direction, at));
        let value = Vec3x::gather_columns(paths.throughput, at).product(sky) * weight;
        let slot = gather_u32(paths.slot, at);
        report(add(radiance, slot, value, busy), slot, &mut dropped);
    }
}

/// Adds the radiance of occlusion rays that met nothing.
pub fn unoccluded(
    n: usize,
    occluded: &[u32],
    slots: &[u32],
    carried: [&[f32]; 3],
    radiance: &mut ColumnsMut,
    mut dropped: impl FnMut(u32),
) {
    for i in (0..padded(n)).step_by(LANES) {
        let free = as_mask(load_u32(occluded, i).simd_eq(Ux::splat(0)));
        let slot = load_u32(slots, i);
        let value = Vec3x::load(carried, i);
        report(
            add(radiance, slot, value, first(n - i) & free),
            slot,
            &mut dropped,
        );
    }
}
