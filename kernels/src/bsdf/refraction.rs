//! Refraction by a facet: B. Walter et al., "Microfacet Models for Refraction through Rough
//! Surfaces", EGSR 2007, section 4.2.
//!
//! With `eta` the index of the far side over that of the near side, the facet's normal is along
//! `o + eta i`, whose length is `|c - q|`, where `c = o.m` and `q = eta |i.m|`; and
//! `d omega_m / d omega_i = eta^2 |i.m| / (c - q)^2`.

use crate::lanes::{Fx, Mask};
use crate::vec3::Vec3x;

/// A pair of directions and the facet that refracts one into the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refraction {
    /// The facet's normal, with `z >= 0`.
    pub(super) normal: Vec3x,
    /// Where light goes.
    pub(super) direction: Vec3x,
    /// Whether the facet's front is met and left by its back.
    pub(super) possible: Mask,
    /// `|i.m|`.
    far: Fx,
    /// `(c - q)^2`.
    square: Fx,
}

impl Refraction {
    /// The facet that sends light from `o` to `i`, `i.z < 0`.
    #[inline(always)]
    pub(super) fn between(o: Vec3x, i: Vec3x, eta: Fx) -> Self {
        let along = i.scale_add(eta, o);
        let square = along.dot(along);
        let sound = square.simd_ge(Fx::splat(f32::MIN_POSITIVE));
        let sign = (along.z & Fx::splat(-0.0)) | Fx::ONE;
        let normal = along * (sign / square.sqrt());
        let far = -i.dot(normal);
        let zero = Fx::ZERO;
        Self {
            normal,
            direction: i,
            possible: sound & o.dot(normal).simd_gt(zero) & far.simd_gt(zero),
            far,
            square,
        }
    }

    /// Where the facet of normal `m` sends light from `o`; `q` from Fresnel's equations.
    #[inline(always)]
    pub(super) fn by(o: Vec3x, m: Vec3x, q: Fx, eta: Fx) -> Self {
        let cos = o.dot(m);
        let over = Fx::ONE / eta;
        // c - q without cancellation.
        let length = (eta - Fx::ONE) * (eta + Fx::ONE) / (cos + q);
        Self {
            normal: m,
            direction: m.scale_add(cos - q, -o) * over,
            possible: cos.simd_gt(Fx::ZERO) & q.simd_gt(Fx::ZERO),
            far: q * over,
            square: length * length,
        }
    }

    /// `d omega_m / d omega_i`. Not finite for `eta = 1`.
    #[inline(always)]
    pub(super) fn jacobian(&self, eta: Fx) -> Fx {
        eta * eta * self.far / self.square
    }
}
