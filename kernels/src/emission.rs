//! Emission found by a path: at a surface, or by leaving the scene.
//!
//! A path that scattered and then finds a light weighs what it finds by the power heuristic against
//! next-event estimation, where that is in use; both pdfs in solid angle (see `light`). Where the path's
//! pdf is infinite, for camera rays and delta lobes, there is no other way and it weighs 1.
//!
//! Cost: [`SURFACE`], [`SKY`], [`UNOCCLUDED`].

use crate::accumulate::{add, report};
use crate::cost::{Cost, columns, item};
use crate::lanes::{Fx, LANES, Ux, as_mask, first, gather, gather_u32, load_u32, padded};
use crate::light::{Departure, beyond, surface_pdf, varied_emission};
use crate::mis::power_heuristic;
use crate::queues::{Listed, OcclusionMut, PathHitsMut, PathsMut, ShadowsMut};
use crate::surface::{self, Surface};
use crate::tables::Tables;
use crate::vec3::{ColumnsMut, Vec3x};

/// A sample's radiance.
const SAMPLE: Cost = Cost::new(12, 12);
/// Bytes of the path that weighing and adding what it found takes.
const PATH: usize = 4 + columns::<PathsMut<'static>>(&[
    "origin",
    "direction",
    "throughput",
    "pdf",
    "leaves",
    "slot",
    "bounces",
]);

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

/// What found emission weighs: with `MIS`, the power heuristic's share; else everything, whatever
/// the light's pdf.
#[inline(always)]
fn weigh<const MIS: bool>(pdf: Fx, light_pdf: impl FnOnce() -> Fx) -> Fx {
    if MIS {
        let light_pdf = light_pdf();
        // Not left to the heuristic: a light seen along its plane has an infinite pdf too.
        let alone = pdf.simd_eq(Fx::splat(f32::INFINITY));
        alone.select(Fx::ONE, power_heuristic(pdf, light_pdf))
    } else {
        Fx::ONE
    }
}

/// Adds the emission of the surfaces that the listed paths hit, with `IMAGES` as images vary it.
/// `dropped` is called with the slot of each value that is not finite.
pub fn surface_emission<const MIS: bool, const IMAGES: bool>(
    listed: Listed,
    tables: &Tables,
    radiance: &mut ColumnsMut,
    mut dropped: impl FnMut(u32),
) {
    let paths = listed.paths;
    for (_, at, busy) in listed.vectors() {
        let surface = Surface::met(&listed, &tables.triangles, at);
        let emits = busy & surface.emits_here(tables.materials.two_sided);
        // The ray's direction is a unit vector, so the parameter is the distance.
        let t = gather(listed.hits.t, at);
        let from = Departure::of(&paths, at);
        let light_pdf = || surface_pdf(tables, &from, &surface, t);
        let weight = weigh::<MIS>(gather(paths.pdf, at), light_pdf);
        let mut emitted = Vec3x::gather_columns(tables.materials.emission, surface.material);
        if let Some(images) = tables.images.as_ref().filter(|_| IMAGES) {
            let (u, v) = (gather(listed.hits.u, at), gather(listed.hits.v, at));
            let (primitive, material) = (surface.primitive, surface.material);
            let share = varied_emission(tables, images, primitive, material, emits, u, v);
            emitted = emitted.product(share);
        }
        let value = Vec3x::gather_columns(paths.throughput, at).product(emitted) * weight;
        let slot = gather_u32(paths.slot, at);
        report(add(radiance, slot, value, emits), slot, &mut dropped);
    }
}

/// Adds the sky, and discs in it, to the listed paths, which left the scene. As [`surface_emission`].
pub fn sky_emission<const MIS: bool>(
    listed: Listed,
    tables: &Tables,
    radiance: &mut ColumnsMut,
    mut dropped: impl FnMut(u32),
) {
    let paths = listed.paths;
    for (_, at, busy) in listed.vectors() {
        let from = Departure::of(&paths, at);
        let pdf = gather(paths.pdf, at);
        let mut sky = Vec3x::splat([0.0; 3]);
        beyond(tables, &from, |radiance, light_pdf| {
            sky += radiance * weigh::<MIS>(pdf, || light_pdf);
        });
        let value = Vec3x::gather_columns(paths.throughput, at).product(sky);
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
