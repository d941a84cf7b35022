//! From a hit to a surface interaction, and from a surface to a ray that leaves it.
//!
//! *Position*: `p = v0 + u e1 + v e2` with `e1 = v1 - v0`, `e2 = v2 - v0`. Whatever `u` and `v`
//! are, the exact value of that sum lies in the triangle's plane; the computed one is off by at
//! most `gamma(5) * s` in each component, `s = |v0| + u |e1| + v |e2|` (one rounding in each edge,
//! two fused operations, and `gamma(n) = n eps / (1 - n eps)`, `eps = 2^-24`; Higham, *Accuracy and
//! Stability of Numerical Algorithms*, 3.1).
//!
//! *Spawning*: a ray starts at `p + n d`, with `n` the unit geometric normal on the side the ray
//! goes to and `d = |n| . s * gamma(16)`: 5 for the position, 1 for the rounding of the sum itself, 3
//! for `n` not quite of length 1 and for the rounding of `d`, and the rest for the far side's
//! arithmetic, which subtracts that origin from the vertices of a neighbour in the same plane. So
//! the origin is strictly above the plane and no absolute epsilon is needed: the offset scales with
//! the coordinates. M. Pharr, W. Jakob, G. Humphreys, *PBRT* 4th ed., 6.8.
//!
//! The triangle that a ray leaves is also excluded by index, which is exact.

use crate::bare::called_for;
use crate::lanes::{Fx, Mask, Ux, as_mask, gather, gather_rows, gather_u32};
use crate::queues::Listed;
use crate::tables::Triangles;
use crate::vec3::Vec3x;

/// Bytes that an interaction gathers of a triangle: three indices, three vertices, the material.
pub const TRIANGLE_BYTES: usize = 12 + 36 + 4;
/// Operations of an interaction: edges, point and its bound, normal and its side, spawned origin.
pub const OPERATIONS: u64 = 90;

const EPSILON: f32 = 1.0 / 16_777_216.0;

/// `n` roundings in a row, relative: Higham's gamma.
#[inline(always)]
pub(crate) const fn gamma(n: f32) -> f32 {
    n * EPSILON / (1.0 - n * EPSILON)
}

/// `LANES` triangles.
#[derive(Clone, Copy, Debug)]
pub struct Corners {
    /// First vertex.
    pub v0: Vec3x,
    /// Second vertex minus first.
    pub e1: Vec3x,
    /// Third vertex minus first.
    pub e2: Vec3x,
}

impl Corners {
    /// Fetches triangles by index.
    #[inline(always)]
    #[must_use]
    pub fn gather(triangles: &Triangles, primitive: Ux) -> Self {
        let corners = gather_rows(triangles.indices, primitive);
        let [v0, v1, v2] = corners.map(|corner| Vec3x::gather(triangles.vertices, corner));
        Self {
            v0,
            e1: v1 - v0,
            e2: v2 - v0,
        }
    }

    /// Normal of the front side, as long as twice the area.
    ///
    /// The edges are first divided by their largest component, so that neither a tiny nor a huge
    /// triangle loses its normal to underflow or overflow; the length is then that of the scaled
    /// triangle, and only the direction is returned, of unit length.
    #[inline(always)]
    #[must_use]
    pub fn unit_normal(&self) -> Vec3x {
        let scale = self.scale();
        (self.e1 * scale).cross(self.e2 * scale).normalized()
    }

    /// What makes the largest component of the edges 1.
    #[inline(always)]
    #[must_use]
    pub fn scale(&self) -> Fx {
        let largest = self.e1.abs().max_component();
        Fx::ONE / largest.fast_max(self.e2.abs().max_component())
    }

    /// The point with barycentric weights `u`, `v` of the second and third vertex, and the scale
    /// `s` of its rounding error.
    #[inline(always)]
    #[must_use]
    pub fn point(&self, u: Fx, v: Fx) -> (Vec3x, Vec3x) {
        let p = self.e2.scale_add(v, self.e1.scale_add(u, self.v0));
        let s = self
            .e2
            .abs()
            .scale_add(v, self.e1.abs().scale_add(u, self.v0.abs()));
        (p, s)
    }

    /// That point as a place, of no material.
    #[inline(always)]
    #[must_use]
    pub fn place(&self, u: Fx, v: Fx) -> Place {
        let outside = self.unit_normal();
        let (point, s) = self.point(u, v);
        Place {
            point,
            outside,
            clearance: clearance(s, outside),
            material: Ux::ZERO,
        }
    }
}

/// How far along the unit vector `normal`, to either side, a point is off its surface for certain;
/// `s` from [`Corners::point`].
#[inline(always)]
#[must_use]
pub fn clearance(s: Vec3x, normal: Vec3x) -> Fx {
    normal.abs().dot(s) * Fx::splat(gamma(16.0))
}

/// `p` moved off its surface to the side of the unit vector `normal`; `s` from [`Corners::point`].
#[inline(always)]
#[must_use]
pub fn spawn(p: Vec3x, s: Vec3x, normal: Vec3x) -> Vec3x {
    normal.scale_add(clearance(s, normal), p)
}

/// `LANES` surfaces as lights see them.
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// Points on the surfaces, to rounding.
    pub point: Vec3x,
    /// Unit geometric normals, on the side that the paths came from.
    pub normal: Vec3x,
    /// How far along the normal, to either side, rays start; see [`clearance`].
    pub clearance: Fx,
    /// Where light from the other side counts too, because it passes through.
    pub both_sides: Mask,
}

impl Anchor {
    /// Where a ray towards `to` starts: off the surface, on that side of it if light passes through,
    /// else on the near one.
    #[inline(always)]
    #[must_use]
    pub fn start(&self, to: Vec3x) -> Vec3x {
        let below = self.both_sides & self.normal.dot(to).simd_lt(Fx::ZERO);
        let off = below.select(-self.clearance, self.clearance);
        self.normal.scale_add(off, self.point)
    }
}

/// `LANES` points on surfaces.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The points, to rounding.
    pub point: Vec3x,
    /// Unit geometric normals of the front sides.
    pub outside: Vec3x,
    /// How far to either side rays start; see [`clearance`].
    pub clearance: Fx,
    /// Material indices.
    pub material: Ux,
}

impl Place {
    /// Where hits are that are called `primitive`, at `u` and `v`; `times` says when, which matters to
    /// instances that move alone.
    #[inline(always)]
    #[must_use]
    pub fn of(
        triangles: &Triangles,
        primitive: Ux,
        u: Fx,
        v: Fx,
        times: impl FnOnce() -> Option<Fx>,
    ) -> Self {
        if let Some(others) = called_for(triangles.others.as_ref())
            && !others.are_of_world(primitive)
        {
            return others.place(triangles, primitive, u, v, times());
        }
        Self {
            material: gather_u32(triangles.material, primitive),
            ..Corners::gather(triangles, primitive).place(u, v)
        }
    }
}

/// `LANES` surface interactions.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where rays that leave on the near side start: the hit point, offset.
    pub origin: Vec3x,
    /// The hit point itself, to rounding.
    pub point: Vec3x,
    /// How far `origin` is from it; see [`clearance`].
    pub clearance: Fx,
    /// Unit geometric normal on the side that the path came from.
    pub normal: Vec3x,
    /// Whether that side is the front.
    pub front: Mask,
    /// Cosine between `normal` and the direction back along the ray.
    pub cos_o: Fx,
    /// The triangle.
    pub primitive: Ux,
    /// Material index.
    pub material: Ux,
}

impl Surface {
    /// The interaction of rays with unit `direction` at their hits; for `times` see [`Place::of`].
    #[inline(always)]
    #[must_use]
    pub fn at(
        triangles: &Triangles,
        primitive: Ux,
        u: Fx,
        v: Fx,
        direction: Vec3x,
        times: impl FnOnce() -> Option<Fx>,
    ) -> Self {
        let Place {
            point,
            outside,
            clearance,
            material,
        } = Place::of(triangles, primitive, u, v, times);
        let cos = outside.dot(direction);
        let front = cos.simd_lt(Fx::ZERO);
        let normal = Vec3x::select(front, outside, -outside);
        Self {
            origin: normal.scale_add(clearance, point),
            point,
            clearance,
            normal,
            front,
            cos_o: cos.abs(),
            primitive,
            material,
        }
    }

    /// Where the listed paths at places `at` of the queue ended up.
    #[inline(always)]
    #[must_use]
    pub fn met(listed: &Listed, triangles: &Triangles, at: Ux) -> Self {
        let hits = &listed.hits;
        Self::at(
            triangles,
            gather_u32(hits.primitive, at),
            gather(hits.u, at),
            gather(hits.v, at),
            Vec3x::gather_columns(listed.paths.direction, at),
            || listed.times(at),
        )
    }

    /// The surface as lights see it; `both_sides` where light passes through it.
    #[inline(always)]
    #[must_use]
    pub fn anchor(&self, both_sides: Mask) -> Anchor {
        Anchor {
            point: self.point,
            normal: self.normal,
            clearance: self.clearance,
            both_sides,
        }
    }

    /// True where the material emits towards the path.
    #[inline(always)]
    #[must_use]
    pub fn emits_here(&self, two_sided: &[u32]) -> Mask {
        self.front | as_mask(gather_u32(two_sided, self.material))
    }
}
