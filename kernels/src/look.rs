//! Quick looks: what a camera ray sees, without light.
//!
//! * normals: the unit geometric normal that faces the camera, `(n + 1) / 2`;
//! * depth: the distance along the ray;
//! * albedo: the diffuse reflectance.

use crate::accumulate::add;
use crate::lanes::{Fx, LANES, first, gather, gather_u32, load_u32, padded};
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

/// Adds the look of the listed paths to their samples.
pub fn look(look: Look, listed: Listed, tables: &Tables, radiance: &mut ColumnsMut) {
    let Listed {
        index,
        len: n,
        paths,
        hits,
    } = listed;
    for i in (0..padded(n)).step_by(LANES) {
        let at = load_u32(index, i);
        let direction = Vec3x::gather_columns(paths.direction, at);
        let primitive = gather_u32(hits.primitive, at);
        let (u, v) = (gather(hits.u, at), gather(hits.v, at));
        let surface = Surface::at(&tables.triangles, primitive, u, v, direction);
        let value = match look {
            Look::Normals => {
                let half = Fx::splat(0.5);
                surface.normal.scale_add(half, Vec3x::new(half, half, half))
            }
            Look::Depth => {
                let t = gather(hits.t, at);
                Vec3x::new(t, t, t)
            }
            Look::Albedo => Vec3x::gather_columns(tables.materials.albedo, surface.material),
        };
        let _ = add(radiance, gather_u32(paths.slot, at), value, first(n - i));
    }
}
