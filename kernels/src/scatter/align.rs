//! Which way brushed surfaces lie: a pass before [`super::respond`], only for lists of which some material
//! is anisotropic and has texture coordinates.
//!
//! A local frame ([`crate::hemisphere::Frame::about`]) depends on the shading normal alone. Here stands by
//! which angle about that normal it has to be turned for its x axis to lie along the direction in which u
//! rises, projected onto the shading normal's plane. Where there are no coordinates, or degenerate ones,
//! it is not turned: the surface is brushed along the frame's own x axis.
//!
//! Cost: [`ALIGN`].

use crate::cost::{Cost, columns, item};
use crate::hemisphere::Frame;
use crate::images::Read;
use crate::lanes::{Fx, LANES, gather, load_u32, padded, store};
use crate::queues::{Aligned, AlignedMut, Listed, PathHitsMut, Surfaces, SurfacesMut};
use crate::surface;
use crate::tables::Tables;
use crate::vec3::Vec3x;

/// Bytes a row: its place, hit, surface and triangle with coordinates read; an angle written.
pub const ALIGN: Cost = Cost::new(
    4 + item::<PathHitsMut<'static>>()
        + columns::<SurfacesMut<'static>>(&["shading", "primitive"])
        + surface::TRIANGLE_BYTES
        + 24,
    item::<AlignedMut<'static>>(),
)
.operations(surface::OPERATIONS + 60);

/// Aligns the listed paths' surfaces, row by row of the list.
pub fn align(listed: Listed, tables: &Tables, surfaces: Surfaces, aligned: &mut AlignedMut) {
    for i in (0..padded(listed.len)).step_by(LANES) {
        let at = load_u32(listed.index, i);
        let weights = (gather(listed.hits.u, at), gather(listed.hits.v, at));
        let primitive = load_u32(surfaces.primitive, i);
        let read = Read::at(tables, primitive, weights, Fx::ZERO, listed.times(at));
        let frame = Frame::about(Vec3x::load(surfaces.shading, i));
        let (mut cos, mut sin) = (Fx::ONE, Fx::ZERO);
        if let Some(read) = read {
            let along = read.point.tangent;
            let (x, y) = (along.dot(frame.tangent), along.dot(frame.bitangent));
            let length2 = x.mul_add(x, y * y);
            let regular = read.point.uv_per_length.simd_gt(Fx::ZERO) & length2.simd_gt(Fx::ZERO);
            let by = Fx::ONE / length2.sqrt();
            cos = regular.select(x * by, cos);
            sin = regular & (y * by);
        }
        store(aligned.cos, i, cos);
        store(aligned.sin, i, sin);
    }
}

/// A turn of the local frame about its z axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    cos: Fx,
    sin: Fx,
}

impl Turn {
    #[inline(always)]
    pub(super) fn load(aligned: &Aligned, i: usize) -> Self {
        Self {
            cos: crate::lanes::load(aligned.cos, i),
            sin: crate::lanes::load(aligned.sin, i),
        }
    }

    /// A direction of the frame in the turned one.
    #[inline(always)]
    pub(super) fn into_turned(self, v: Vec3x) -> Vec3x {
        Vec3x::new(
            v.x.mul_add(self.cos, v.y * self.sin),
            v.y.mul_sub(self.cos, v.x * self.sin),
            v.z,
        )
    }

    /// The way back.
    #[inline(always)]
    pub(super) fn out_of(self, v: Vec3x) -> Vec3x {
        Vec3x::new(
            v.x.mul_sub(self.cos, v.y * self.sin),
            v.y.mul_add(self.cos, v.x * self.sin),
            v.z,
        )
    }
}
