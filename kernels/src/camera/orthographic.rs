//! Orthographic: all rays are parallel and start on the plane of the camera. The size of an image
//! does not depend on the distance.

use super::Projection;
use crate::lanes::Fx;
use crate::vec3::Vec3x;

/// A camera of parallel rays, ready for pixels: the ray at `(x, y)` pixels from the image's top left
/// corner starts at `corner + x right + y down`.
#[derive(Clone, Copy, Debug)]
pub struct Orthographic {
    /// The image's top left corner in the world.
    pub corner: [f32; 3],
    /// One pixel to the right, in scene units.
    pub right: [f32; 3],
    /// One pixel down, in scene units.
    pub down: [f32; 3],
    /// Direction of all rays, a unit vector.
    pub forward: [f32; 3],
}

impl Projection for Orthographic {
    #[inline(always)]
    fn ray(&self, x: Fx, y: Fx, _lens: [Fx; 2]) -> (Vec3x, Vec3x) {
        let origin = Vec3x::splat(self.right).scale_add(
            x,
            Vec3x::splat(self.down).scale_add(y, Vec3x::splat(self.corner)),
        );
        (origin, Vec3x::splat(self.forward))
    }
}
