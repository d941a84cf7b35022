//! Panorama: every direction from one point, in equirectangular form. Longitude runs evenly across
//! the image, the view in its middle and rightwards to the right; latitude evenly down it, from
//! straight up to straight down. With `u` and `v` in `[0, 1]` across and down,
//!
//! ```text
//! direction = sin(pi v) (-sin(2 pi u) right - cos(2 pi u) forward) + cos(pi v) up
//! ```
//!
//! A filter reaches beyond the image's edges: across, that is the other edge's neighbourhood; above
//! and below, what lies beyond the pole. Both follow from the formula at any `u` and `v`.

use super::Projection;
use crate::lanes::Fx;
use crate::math::sin_cos_turn;
use crate::vec3::Vec3x;

/// A camera that looks all around, ready for pixels.
#[derive(Clone, Copy, Debug)]
pub struct Panorama {
    /// Where it stands.
    pub origin: [f32; 3],
    /// Direction of the image's middle, a unit vector.
    pub forward: [f32; 3],
    /// What lies a quarter of the image to the right of that, a unit vector.
    pub right: [f32; 3],
    /// Direction of the image's upper edge, a unit vector.
    pub up: [f32; 3],
    /// Turns a pixel: `1 / width` across, `1 / (2 height)` down.
    pub turns: [f32; 2],
}

/// What is left of `turns` without the whole ones, in `[0, 1]`.
#[inline(always)]
fn within_a_turn(turns: Fx) -> Fx {
    turns - turns.floor()
}

impl Projection for Panorama {
    #[inline(always)]
    fn ray(&self, x: Fx, y: Fx, _lens: [Fx; 2]) -> (Vec3x, Vec3x) {
        let turned = |at: Fx, by: f32| sin_cos_turn(within_a_turn(at * Fx::splat(by)));
        let (sin_u, cos_u) = turned(x, self.turns[0]);
        let (sin_v, cos_v) = turned(y, self.turns[1]);
        let direction = Vec3x::splat(self.right).scale_add(
            -(sin_v * sin_u),
            Vec3x::splat(self.forward).scale_add(-(sin_v * cos_u), Vec3x::splat(self.up) * cos_v),
        );
        // The polynomials' unit vectors are off by up to 3e-7; rays are unit vectors to rounding.
        (Vec3x::splat(self.origin), direction.normalized())
    }
}
