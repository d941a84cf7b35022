//! A ray against the eight boxes of a node, never missing a box that the ray or its rounded
//! triangle test could enter.
//!
//! Slabs: the ray is between planes `b0` and `b1` of an axis for `t` between `(b0 - o) / d` and
//! `(b1 - o) / d`; the box is hit if the three intervals and `[0, limit]` meet (T. Kay, J. Kajiya,
//! 1986). Subtracting first, rather than `fma(b, 1/d, -o/d)`, costs six more operations a node and
//! keeps every error relative to the distance, however far from the world's origin the scene lies.
//!
//! **Bound** (after T. Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013). Let `u = 2^-24`. The
//! near value is rounded three times (`b - o`, `1 / d`, the product), the far value four times
//! (the least of the three is scaled by `1 + PAD`): for a point of the box at ray parameter `t > 0` the
//! near value is at most `t (1 + u)^3` and the far value at least `t (1 + PAD) (1 - u)^4`. The
//! triangle test (`triangle.rs`) is exact for a triangle whose vertices' distances from the
//! origin along each axis are off by a factor of at most `1 + 5u`: subtraction, shear, product and
//! the rounded direction; and its distance is rounded by `13u` at most. So a triangle that the test
//! accepts has `t` within the slabs to `(3 + 4 + 5 + 13) u = 25u`; `PAD = 32u = 2^-19` covers that, and second-order terms, with the
//! next power of two. This holds while `t`, and the way
//! along each axis where it is not 0, stay above the smallest normal number: below it the triangle
//! test loses digits that this test does not.
//!
//! **Zero components.** `1 / ±0` is an infinity of the same sign. A plane strictly to one side
//! then gives the infinity that keeps or ends the interval, as it must; a plane that contains
//! the origin gives `0 * inf = NaN`, and the order of the operands of `fast_max` and `fast_min`
//! drops a NaN on x86, which keeps the interval. Elsewhere the NaN survives, and the last comparison is
//! written so that it counts as a hit: a wider answer, never a missed one. Components whose
//! reciprocal overflows (below 2^-128 of the largest one) act as zeros.
//!
//! Input: finite origins, directions as [`crate::triangle::Shear::new`] normalises them. Reads 192
//! bytes of the node; writes nothing.

use crate::bvh::Node;
use crate::lanes::{Fx, Mask};

/// By what share the far side of a box, and the current closest distance, are moved away.
pub const PAD: f32 = 1.0 / 524_288.0;

/// What the box test needs of a ray.
#[derive(Clone, Copy, Debug, Default)]
pub struct Slabs {
    origin: [f32; 3],
    /// Reciprocal direction.
    inverse: [f32; 3],
    /// Which plane of each axis the ray meets first: 0 the lower, 1 the upper.
    near: [u32; 3],
}

impl Slabs {
    /// Prepares a ray. The direction may have components of either zero, but not be zero.
    #[inline(always)]
    #[must_use]
    pub fn new(origin: [f32; 3], direction: [f32; 3]) -> Self {
        let inverse = direction.map(|d| 1.0 / d);
        Self {
            origin,
            inverse,
            // The sign of the bit, not of the number: -0 belongs with the negatives.
            near: direction.map(|d| d.to_bits() >> 31),
        }
    }

    /// Which boxes meet the ray at `0 ..= limit`, and where it enters them.
    ///
    /// `limit` is the distance beyond which nothing is wanted, already times `1 + PAD`.
    #[inline(always)]
    #[must_use]
    pub fn test(&self, node: &Node, limit: f32) -> (Mask, Fx) {
        let plane = |axis: usize, side: u32| {
            let plane = node.planes[2 * axis + (side & 1) as usize];
            (plane - Fx::splat(self.origin[axis])) * Fx::splat(self.inverse[axis])
        };
        let near = |axis: usize| plane(axis, self.near[axis]);
        let far = |axis: usize| plane(axis, self.near[axis] ^ 1);
        // What may be NaN stands first.
        let enter = near(0).fast_max(near(1).fast_max(near(2).fast_max(Fx::ZERO)));
        let never = Fx::splat(f32::INFINITY);
        let leave = far(0).fast_min(far(1).fast_min(far(2).fast_min(never)));
        let leave = (leave * Fx::splat(1.0 + PAD)).fast_min(Fx::splat(limit));
        (!enter.simd_gt(leave), enter)
    }
}
