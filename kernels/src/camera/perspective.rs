//! Perspective: all rays leave one point. The direction is `forward + x right + y up`, normalised,
//! `x` and `y` running over the image plane at distance 1.

use super::Projection;
use crate::lanes::Fx;
use crate::vec3::Vec3x;

/// A pinhole camera, ready for pixels: a point at `(x, y)` pixels from the image's top left corner
/// lies in direction `corner + x right + y down`.
#[derive(Clone, Copy, Debug)]
pub struct Perspective {
    /// Centre of projection.
    pub origin: [f32; 3],
    /// Direction of the image's top left corner.
    pub corner: [f32; 3],
    /// One pixel to the right.
    pub right: [f32; 3],
    /// One pixel down.
    pub down: [f32; 3],
}

impl Perspective {
    /// The direction of `(x, y)`, of any length.
    #[inline(always)]
    pub(super) fn towards(&self, x: Fx, y: Fx) -> Vec3x {
        Vec3x::splat(self.right).scale_add(
            x,
            Vec3x::splat(self.down).scale_add(y, Vec3x::splat(self.corner)),
        )
    }
}

impl Projection for Perspective {
    #[inline(always)]
    fn ray(&self, x: Fx, y: Fx, _lens: [Fx; 2]) -> (Vec3x, Vec3x) {
        (Vec3x::splat(self.origin), self.towards(x, y).normalized())
    }
}
