//! Sheen: the sheen of cloth, A. Estevez, C. Kulla, "Production Friendly Microfacet Sheen BRDF",
//! 2017, as glTF's KHR_materials_sheen takes it up: facets distributed by
//! `D(h) = (2 + 1/alpha) sin(h)^(1/alpha) / (2 pi)`, `alpha = roughness^2`, and the visibility of
//! M. Ashikhmin, S. Premoze, "Distribution-based BRDFs", 2007, `1 / (4 (o.z + i.z - o.z i.z))`. No
//! Fresnel term.

use super::ggx::half_vector;
use crate::lanes::Fx;
use crate::math::INV_PI;
use crate::vec3::Vec3x;

/// The least roughness: below, the lobe is a line along the horizon.
pub const ROUGHNESS_FLOOR: f32 = 0.1;

/// `f i.z` of the lobe as published, for `o.z, i.z > 0` and a roughness in `[ROUGHNESS_FLOOR, 1]`.
/// Finite: `sin^2` is kept above the least number that has a logarithm, and the visibility's
/// denominator is at least `i.z`.
#[inline(always)]
pub(super) fn charlie(o: Vec3x, i: Vec3x, roughness: Fx) -> Fx {
    let h = half_vector(o, i);
    let sin2 = h.x.mul_add(h.x, h.y * h.y);
    let over = Fx::ONE / (roughness * roughness);
    let log = sin2.fast_clamp(Fx::splat(1e-30), Fx::ONE).ln();
    // Below e^-80 there is nothing to see, and the exponential stays in its domain.
    let power = (log * over * Fx::splat(0.5))
        .fast_max(Fx::splat(-80.0))
        .exp();
    let density = (over + Fx::splat(2.0)) * power * Fx::splat(0.5 * INV_PI);
    let visible = Fx::splat(4.0) * (o.z + i.z - o.z * i.z);
    density * i.z / visible
}
