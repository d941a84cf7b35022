//! Metals, polished and rough.
//!
//! * [`SmoothConductor`]: the mirror, with Fresnel's reflectance.
//! * [`RoughConductor`]: GGX facets with visible-normal sampling ([`super::ggx`]), and the light that
//!   leaves after more than one facet, by C. Kulla, A. Conty, "Revisiting Physically Based Shading at
//!   Imageworks", SIGGRAPH 2017 course: `f_ms = F_ms (1 - E(o)) (1 - E(i)) / (pi (1 - E_avg))`, with
//!   `F_ms = F_avg^2 E_avg / (1 - F_avg (1 - E_avg))`. Reciprocal. `E` is tabulated
//!   ([`super::ReflectionEnergy`]).
//!
//! A direction is drawn by a visible normal with probability `E(o)`. The rest goes to the light that
//! has met more facets, which for narrow lobes lies along the horizon alone, so that cosine-weighted
//! directions would find it rarely and with weights of `1 / alpha^2`: half of its draws are
//! cosine-weighted, half have `z = w v / (1 + w - v)` for a uniform `v`, with `w` the geometric mean of
//! the widths, whose pdf is `w (1 + w) / (2 pi (z + w)^2)`. No weight is above 12. The pdf is that of
//! the mixture. Draws are not valid where a facet reflects below the horizon.
//!
//! Lanes whose two widths differ take `E` from [`super::AnisotropicEnergy`]. A perfect mirror keeps
//! 0.99 and more of its light where they do not, 0.98 and more where they do; none gains.
//!
//! Domain: `eta >= 0`, `k >= 0`, widths in `[ALPHA_FLOOR, 1]`.

use super::energy::{AnisotropicEnergy, ReflectionEnergy};
use super::fresnel::conductor_rgb;
use super::ggx::{Ggx, half_vector, reflect};
use super::{Bsdf, DELTA_PDF, Evaluated, Sampled};
use crate::hemisphere::{UNIFORM_PDF, cosine_pdf, sample_cosine};
use crate::lanes::Fx;
use crate::math::sin_cos_turn;
use crate::vec3::Vec3x;

/// A polished metal.
#[derive(Clone, Copy, Debug)]
pub struct SmoothConductor {
    /// Real part of the relative index of refraction.
    pub eta: Vec3x,
    /// Imaginary part.
    pub k: Vec3x,
}

/// A rough metal.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor<'a> {
    /// Real part of the relative index of refraction.
    pub eta: Vec3x,
    /// Imaginary part.
    pub k: Vec3x,
    /// Fresnel's reflectance averaged over the hemisphere: [`super::fresnel::conductor_mean`].
    pub mean: Vec3x,
    /// Width of the distribution of facets along x and y.
    pub alpha: [Fx; 2],
    /// What single scattering keeps.
    pub energy: &'a ReflectionEnergy,
}

impl Bsdf for SmoothConductor {
    #[inline(always)]
    fn evaluate(&self, _o: Vec3x, _i: Vec3x) -> Evaluated {
        Evaluated::nothing()
    }

    #[inline(always)]
    fn sample(&self, o: Vec3x, _u: [Fx; 3]) -> Sampled {
        let i = Vec3x::new(-o.x, -o.y, o.z);
        let weight = conductor_rgb(o.z, self.eta, self.k);
        Sampled::new(i, weight, Fx::splat(DELTA_PDF), o.z.simd_gt(Fx::ZERO))
    }
}

impl Bsdf for RoughConductor<'_> {
    #[inline(always)]
    fn evaluate(&self, o: Vec3x, i: Vec3x) -> Evaluated {
        let lost = self.lost(o);
        self.through(o, i, half_vector(o, i), lost)
            .keep(i.z.simd_gt(Fx::ZERO))
    }

    #[inline(always)]
    fn sample(&self, o: Vec3x, u: [Fx; 3]) -> Sampled {
        let lost = self.lost(o);
        let again = u[2].simd_lt(lost);
        let even = u[2].simd_lt(lost * Fx::splat(0.5));
        let normal = Ggx { alpha: self.alpha }.sample_normal(o, u[0], u[1]);
        let width = self.width();
        let low = with_cosine(width * u[0] / (width + (Fx::ONE - u[0])), u[1]);
        let far = Vec3x::select(even, sample_cosine(u[0], u[1]), low);
        let i = Vec3x::select(again, far, reflect(o, normal));
        let normal = Vec3x::select(again, half_vector(o, i), normal);
        let Evaluated { value, pdf } = self.through(o, i, normal, lost);
        let valid = i.z.simd_gt(Fx::ZERO) & o.dot(normal).simd_gt(Fx::ZERO);
        Sampled::new(i, value * (Fx::ONE / pdf), pdf, valid)
    }
}

impl RoughConductor<'_> {
    /// The geometric mean of the widths.
    #[inline(always)]
    fn width(&self) -> Fx {
        (self.alpha[0] * self.alpha[1]).sqrt()
    }

    /// `1 - E(w)`.
    #[inline(always)]
    fn lost(&self, w: Vec3x) -> Fx {
        self.by_kind(
            |width| self.energy.lost(w.z, width),
            |widths| AnisotropicEnergy::table().lost(w, widths),
        )
    }

    /// `1 - E_avg`.
    #[inline(always)]
    fn lost_mean(&self) -> Fx {
        self.by_kind(
            |width| self.energy.mean_lost(width),
            |widths| AnisotropicEnergy::table().mean_lost(widths),
        )
    }

    /// By the first function where the widths are the same, by the second where they differ; which is
    /// not called where no lane needs it.
    #[inline(always)]
    fn by_kind(&self, same: impl Fn(Fx) -> Fx, differ: impl Fn([Fx; 2]) -> Fx) -> Fx {
        let [x, y] = self.alpha;
        let isotropic = x.simd_eq(y);
        if isotropic.all() {
            same(x)
        } else {
            isotropic.select(same(x), differ(self.alpha))
        }
    }

    /// Value and pdf, given the half vector and `1 - E(o)`; `i.z > 0`.
    #[inline(always)]
    fn through(&self, o: Vec3x, i: Vec3x, h: Vec3x, lost: Fx) -> Evaluated {
        let once = Ggx { alpha: self.alpha }.reflection(o, i, h);
        let fresnel = conductor_rgb(o.dot(h), self.eta, self.k);

        let lost_mean = self.lost_mean();
        let kept_mean = Fx::ONE - lost_mean;
        let shape = lost * self.lost(i) / lost_mean * cosine_pdf(i.z);
        let shape = lost_mean.simd_gt(Fx::ZERO) & shape;
        let again = |mean: Fx| mean * mean * kept_mean / mean.mul_neg_add(lost_mean, Fx::ONE);
        let again = Vec3x::new(again(self.mean.x), again(self.mean.y), again(self.mean.z));
        let width = self.width();
        let from = i.z + width;
        let low = width * (width + Fx::ONE) * Fx::splat(UNIFORM_PDF) / (from * from);
        let far = (cosine_pdf(i.z) + low) * Fx::splat(0.5);
        Evaluated {
            value: fresnel * once.value + again * shape,
            pdf: lost.mul_add(far - once.pdf, once.pdf),
        }
    }
}

/// The direction of cosine `z` to the normal, and of that azimuth in turns.
#[inline(always)]
fn with_cosine(z: Fx, turn: Fx) -> Vec3x {
    let r = ((Fx::ONE - z) * (Fx::ONE + z)).sqrt();
    let (sin, cos) = sin_cos_turn(turn);
    Vec3x::new(r * cos, r * sin, z)
}
