//! The views that intersection kernels read and write: rays in, hits or occlusion out.
//!
//! All columns of a view have the same length, at least `padded(len)`.

use crate::cost::{Cost, columns, item};
use crate::queues::{OcclusionMut, PathHitsMut, PathsMut, ShadowsMut};
use crate::vec3::Columns;

/// No triangle: what a ray that misses reports, and what a ray that excludes none carries.
pub const NO_PRIMITIVE: u32 = u32::MAX;

/// A closest-hit query, the tree's not counted.
pub const CLOSEST: Cost = Cost::new(
    columns::<PathsMut<'static>>(&["origin", "direction", "leaves"]),
    item::<PathHitsMut<'static>>(),
);

/// An occlusion query, the tree's not counted.
pub const OCCLUSION: Cost = Cost::new(
    columns::<ShadowsMut<'static>>(&["origin", "direction", "t_max", "leaves", "reaches"]),
    item::<OcclusionMut<'static>>(),
);

/// Rays for a closest-hit query: `origin + t * direction`, `t > 0`.
///
/// Directions need not be normalised; zero, negative-zero and denormal components are ordinary
/// input. A ray never hits the triangle it `leaves`.
#[derive(Clone, Copy, Debug)]
pub struct Rays<'a> {
    /// Rays in the view.
    pub len: usize,
    /// World-space origins.
    pub origin: Columns<'a>,
    /// World-space directions.
    pub direction: Columns<'a>,
    /// The triangle each ray starts on, or [`NO_PRIMITIVE`].
    pub leaves: &'a [u32],
}

/// Closest hits, element `i` for ray `i`.
///
/// The hit point is `(1 - u - v) * v0 + u * v1 + v * v2`. Where `primitive` is [`NO_PRIMITIVE`]
/// the others are unspecified.
#[derive(Debug)]
pub struct Hits<'a> {
    /// Index of the triangle hit, or [`NO_PRIMITIVE`].
    pub primitive: &'a mut [u32],
    /// Ray parameter of the hit, in units of the direction's length.
    pub t: &'a mut [f32],
    /// Barycentric weight of the second vertex.
    pub u: &'a mut [f32],
    /// Barycentric weight of the third vertex.
    pub v: &'a mut [f32],
}

/// Rays for an occlusion query: is there a triangle at `0 < t < t_max`, other than the two named?
#[derive(Clone, Copy, Debug)]
pub struct Segments<'a> {
    /// Segments in the view.
    pub len: usize,
    /// World-space origins.
    pub origin: Columns<'a>,
    /// World-space directions, of any length.
    pub direction: Columns<'a>,
    /// Upper end of the ray parameter, in units of the direction's length; may be infinite.
    pub t_max: &'a [f32],
    /// The triangle each segment starts on, or [`NO_PRIMITIVE`].
    pub leaves: &'a [u32],
    /// The triangle each segment ends on, or [`NO_PRIMITIVE`].
    pub reaches: &'a [u32],
}
