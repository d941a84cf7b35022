//! Quick looks: what a camera ray sees, without light.
//!
//! * normals: the unit geometric normal that faces the camera, `(n + 1) / 2`;
//! * depth: the distance along the ray;
//! * albedo: the diffuse reflectance, by its image where it has one.

use crate::accumulate::{add, report};
use crate::images::{Images, Read};
use crate::lanes::{Fx, Ux, gather, gather_u32};
use crate::queues::Listed;
use crate::surface::Surface;
use crate::tables::Tables;
use crate::vec3::{ColumnsMut, Vec3x};

/// What a quick look shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Geometric normals.
    Normals,
    /// Distances.
    Depth,
    /// Reflectances.
    Albedo,
}

/// Adds the look of the listed paths to their samples. `dropped` is called with the slot of each value
/// that is not finite.
pub fn look(
    look: Look,
    listed: Listed,
    tables: &Tables,
    radiance: &mut ColumnsMut,
    mut dropped: impl FnMut(u32),
) {
    for (_, at, busy) in listed.vectors() {
        let surface = Surface::met(&listed, &tables.triangles, at);
        let value = match look {
            Look::Normals => {
                let half = Fx::splat(0.5);
                surface.normal.scale_add(half, Vec3x::new(half, half, half))
            }
            Look::Depth => {
                let t = gather(listed.hits.t, at);
                Vec3x::new(t, t, t)
            }
            Look::Albedo => {
                let albedo = Vec3x::gather_columns(tables.materials.albedo, surface.material);
                match &tables.images {
                    Some(images) => albedo.product(colour(&listed, tables, images, &surface, at)),
                    None => albedo,
                }
            }
        };
        let slot = gather_u32(listed.paths.slot, at);
        report(add(radiance, slot, value, busy), slot, &mut dropped);
    }
}

/// What images multiply the reflectance with.
fn colour(listed: &Listed, tables: &Tables, images: &Images, surface: &Surface, at: Ux) -> Vec3x {
    let column = |column: &[f32]| gather(column, at);
    let (u, v, t) = (
        column(listed.hits.u),
        column(listed.hits.v),
        column(listed.hits.t),
    );
    let width = images.cone.width(t, column(listed.paths.pdf));
    let read = Read::at(tables, surface.primitive, (u, v), width, listed.times(at));
    let which = gather_u32(images.albedo, surface.material);
    let (uv, width) = read.map_or(([Fx::ZERO; 2], Fx::ZERO), |r| (r.point.uv, r.width));
    images.textures.sample(which, uv, width)
}
