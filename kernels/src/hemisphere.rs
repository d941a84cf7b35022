//! Directions on the hemisphere about a normal, and their pdfs in solid angle.
//!
//! * uniform: `pdf = 1 / (2 pi)`; `cos_theta = u`, by inversion (Pharr, Jakob, Humphreys, *PBRT*
//!   4th ed., A.5.2).
//! * cosine: `pdf = cos_theta / pi`; a uniform point on the disk lifted to the hemisphere
//!   (Malley's method, ibid. A.5.3), the disk in polar form.
//!
//! Input: `u`, `v` in `[0, 1 - 2^-24]`. Output: unit vectors (to rounding) in the frame whose z
//! axis is the normal, with `z > 0`, so no pdf that is divided by is ever 0: uniform takes
//! `1 - u`, at least 2^-24, for the cosine; cosine takes `1 - u` under the root.

use crate::lanes::{Fx, Mask};
use crate::math::{INV_PI, sin_cos_turn};
use crate::vec3::Vec3x;

/// `1 / (2 pi)`.
pub const UNIFORM_PDF: f32 = 0.5 * INV_PI;

/// Uniform over the hemisphere about +z; pdf [`UNIFORM_PDF`].
#[inline(always)]
#[must_use]
pub fn sample_uniform(u: Fx, v: Fx) -> Vec3x {
    let z = Fx::ONE - u;
    // sin^2 = 1 - z^2 = (1 - z)(1 + z) = u (1 + z), without cancellation.
    let r = (u * (Fx::ONE + z)).sqrt();
    let (sin, cos) = sin_cos_turn(v);
    Vec3x::new(r * cos, r * sin, z)
}

/// As [`sample_uniform`], over the whole sphere where `both_sides`; pdf [`uniform_pdf`].
#[inline(always)]
#[must_use]
pub fn sample_sides(u: Fx, v: Fx, both_sides: Mask) -> Vec3x {
    let u = both_sides.select(u + u, u);
    let z = Fx::ONE - u;
    let r = (u * (Fx::ONE + z)).sqrt();
    let (sin, cos) = sin_cos_turn(v);
    Vec3x::new(r * cos, r * sin, z)
}

/// `1 / (4 pi)` where `both_sides`, else [`UNIFORM_PDF`].
#[inline(always)]
#[must_use]
pub fn uniform_pdf(both_sides: Mask) -> Fx {
    both_sides.select(Fx::splat(0.5 * UNIFORM_PDF), Fx::splat(UNIFORM_PDF))
}

/// Cosine-weighted over the hemisphere about +z; pdf [`cosine_pdf`] of the result's `z`.
#[inline(always)]
#[must_use]
pub fn sample_cosine(u: Fx, v: Fx) -> Vec3x {
    let r = u.sqrt();
    let (sin, cos) = sin_cos_turn(v);
    Vec3x::new(r * cos, r * sin, (Fx::ONE - u).sqrt())
}

/// `cos_theta / pi`, for `cos_theta >= 0`.
#[inline(always)]
#[must_use]
pub fn cosine_pdf(cos_theta: Fx) -> Fx {
    cos_theta * Fx::splat(INV_PI)
}

/// An orthonormal frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The x axis.
    pub tangent: Vec3x,
    /// The y axis.
    pub bitangent: Vec3x,
    /// The z axis.
    pub normal: Vec3x,
}

impl Frame {
    /// A frame whose z axis is the unit vector `n`.
    ///
    /// T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017: without a branch,
    /// and without the singularity at `n.z = -1`.
    #[inline(always)]
    #[must_use]
    pub fn about(n: Vec3x) -> Self {
        let sign = (n.z & Fx::splat(-0.0)) | Fx::ONE;
        let a = -Fx::ONE / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            tangent: Vec3x::new(
                (sign * n.x * n.x).mul_add(a, Fx::ONE),
                sign * b,
                -(sign * n.x),
            ),
            bitangent: Vec3x::new(b, (n.y * n.y).mul_add(a, sign), -n.y),
            normal: n,
        }
    }

    /// A vector of the frame in world space.
    #[inline(always)]
    #[must_use]
    pub fn to_world(&self, local: Vec3x) -> Vec3x {
        let bitangent = self.bitangent.scale_add(local.y, self.normal * local.z);
        self.tangent.scale_add(local.x, bitangent)
    }

    /// A vector of world space in the frame.
    #[inline(always)]
    #[must_use]
    pub fn to_local(&self, world: Vec3x) -> Vec3x {
        Vec3x::new(
            self.tangent.dot(world),
            self.bitangent.dot(world),
            self.normal.dot(world),
        )
    }
}

/// From the frame [`Frame::about`] the unit vector `n` to the world.
#[inline(always)]
#[must_use]
pub fn to_world(n: Vec3x, local: Vec3x) -> Vec3x {
    Frame::about(n).to_world(local)
}
