//! Quick looks: what a camera ray sees, without light.
//!
//! * normals: the unit geometric normal that faces the camera, `(n + 1) / 2`;
//! * depth: the distance along the ray;
//! * albedo: the diffuse reflectance.

use crate::accumulate::{add, report};
use crate::lanes::{Fx, gather, gather_u32};
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
            Look::Albedo => Vec3x::gather_columns(tables.materials.albedo, surface.material),
        };
        let slot = gather_u32(listed.paths.slot, at);
        report(add(radiance, slot, value, busy), slot, &mut dropped);
    }
}
