//! The views that intersection kernels read and write: rays in, hits or occlusion out.
//!
//! All columns of a view have the same length, at least `padded(len)`.

use crate::cost::{Cost, columns, item};
use crate::lanes::{Fx, LANES, first, load};
use crate::queues::{OcclusionMut, PathHitsMut, PathsMut, ShadowsMut};
use crate::vec3::Columns;
use std::ops::Range;

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

impl<'a> Rays<'a> {
    /// Some of the rays; columns end with the last of them.
    ///
    /// # Panics
    /// If there are not so many.
    #[must_use]
    pub fn part(&self, range: Range<usize>) -> Self {
        Rays {
            len: range.len(),
            origin: self.origin.map(|column| &column[range.clone()]),
            direction: self.direction.map(|column| &column[range.clone()]),
            leaves: &self.leaves[range],
        }
    }
}

impl Hits<'_> {
    /// Some of the hits; columns end with the last of them.
    ///
    /// # Panics
    /// If there are not so many.
    #[must_use]
    pub fn part(&mut self, range: Range<usize>) -> Hits<'_> {
        Hits {
            primitive: &mut self.primitive[range.clone()],
            t: &mut self.t[range.clone()],
            u: &mut self.u[range.clone()],
            v: &mut self.v[range],
        }
    }
}

impl<'a> Segments<'a> {
    /// Some of the segments; columns end with the last of them.
    ///
    /// # Panics
    /// If there are not so many.
    #[must_use]
    pub fn part(&self, range: Range<usize>) -> Self {
        Segments {
            len: range.len(),
            origin: self.origin.map(|column| &column[range.clone()]),
            direction: self.direction.map(|column| &column[range.clone()]),
            t_max: &self.t_max[range.clone()],
            leaves: &self.leaves[range.clone()],
            reaches: &self.reaches[range],
        }
    }
}

/// Calls `found` with the place of each of the first `len` rays that nobody could trace: one with a
/// component that is not finite, or without a direction. Reads 24 bytes a ray.
///
/// # Panics
/// If a column is shorter than `padded(len)`.
#[inline]
pub fn untraceable(len: usize, origin: Columns, direction: Columns, mut found: impl FnMut(usize)) {
    for i in (0..len).step_by(LANES) {
        let [ox, oy, oz] = origin.map(|column| load(column, i));
        let [dx, dy, dz] = direction.map(|column| load(column, i));
        // A finite number times 0 is 0, any other is NaN, and so is a sum with a NaN in it.
        let components = [ox, oy, oz, dx, dy, dz];
        let zero = components
            .iter()
            .fold(Fx::ZERO, |sum, c| c.mul_add(Fx::ZERO, sum));
        let length = dx.abs().fast_max(dy.abs().fast_max(dz.abs()));
        let good = zero.simd_eq(Fx::ZERO) & length.simd_gt(Fx::ZERO);
        let mut bad = (!good & first(len - i)).to_bitmask();
        while bad != 0 {
            found(i + bad.trailing_zeros() as usize);
            bad &= bad - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_traced_is_found_in_every_lane_and_component() {
        let n = 2 * LANES + 3;
        let fine = || Vec::from([1.0f32; 3 * LANES]);
        for place in 0..n {
            for component in 0..6 {
                for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                    let mut columns: [Vec<f32>; 6] = std::array::from_fn(|_| fine());
                    columns[component][place] = bad;
                    let c = columns.each_ref().map(Vec::as_slice);
                    let mut seen = Vec::new();
                    untraceable(n, [c[0], c[1], c[2]], [c[3], c[4], c[5]], |i| seen.push(i));
                    assert_eq!(seen, [place]);
                }
            }
        }
    }

    #[test]
    fn no_direction_is_no_ray_but_the_smallest_one_is() {
        let origin = [f32::MAX; LANES];
        let (zero, minus) = ([0.0f32; LANES], [-0.0f32; LANES]);
        let mut tiny = zero;
        tiny[3] = f32::from_bits(1);
        let mut seen = Vec::new();
        let origin = [&origin[..]; 3];
        untraceable(5, origin, [&zero, &minus, &tiny], |i| seen.push(i));
        // What lies in the padding is nobody's ray.
        assert_eq!(seen, [0, 1, 2, 4]);
    }
}
