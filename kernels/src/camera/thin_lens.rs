//! Perspective through a thin lens: depth of field.
//!
//! R. Cook, T. Porter, L. Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984. All rays through one
//! point of the image meet where the pinhole's ray through it meets the plane of focus, which lies
//! `focus` before the lens. With `d` the pinhole's direction, whose component along the view is 1,
//! and `p` a point of the lens about its middle `o`, the ray starts at `o + p` and runs along
//! `focus d - p`, here divided by `focus`, so that far planes of focus do not overflow.
//!
//! Points are uniform over a round lens (pdf in area; every ray weighs 1: radiance is averaged over
//! the lens, so that an image is as bright as the pinhole's). A lens of radius 0 gives the pinhole's
//! rays exactly.

use super::{Perspective, Projection};
use crate::disk::sample_concentric;
use crate::lanes::Fx;
use crate::vec3::Vec3x;

/// A camera of a thin, round lens, ready for pixels.
#[derive(Clone, Copy, Debug)]
pub struct ThinLens {
    /// The camera whose pinhole is the lens's middle; its `corner` must have a component of 1 along
    /// the view, and `right` and `down` none.
    pub pinhole: Perspective,
    /// Two radii of the lens at right angles, across the view.
    pub radii: [[f32; 3]; 2],
    /// The same, divided by the distance of the plane of focus.
    pub slopes: [[f32; 3]; 2],
}

impl Projection for ThinLens {
    #[inline(always)]
    fn ray(&self, x: Fx, y: Fx, lens: [Fx; 2]) -> (Vec3x, Vec3x) {
        let [s, t] = sample_concentric(lens[0], lens[1]);
        let at = |[a, b]: [[f32; 3]; 2], from: Vec3x| {
            Vec3x::splat(a).scale_add(s, Vec3x::splat(b).scale_add(t, from))
        };
        let origin = at(self.radii, Vec3x::splat(self.pinhole.origin));
        let back = at(self.slopes, Vec3x::splat([0.0; 3]));
        let direction = self.pinhole.towards(x, y) - back;
        (origin, direction.normalized())
    }
}
