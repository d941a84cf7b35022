//! Metals, polished and rough.
//!
//! * [`SmoothConductor`]: the mirror, with Fresnel's reflectance.
//! * [`RoughConductor`]: GGX facets with visible-normal sampling ([`super::ggx`]), and the light that
//!   leaves after more than one facet, by C. Kulla, A. Conty, "Revisiting Physically Based Shading at
//!   Imageworks", SIGGRAPH 2017 course: `f_ms = F_ms (1 - E(o)) (1 - E(i)) / (pi (1 - E_avg))`, with
//!   `F_ms = F_avg^2 E_avg / (1 - F_avg (1 - E_avg))`. Reciprocal. `E` is tabulated
//!   ([`super::ReflectionEnergy`]) for isotropic facets.
//!
//! A direction is drawn cosine-weighted with probability `1 - E(o)`, else by a visible normal; the
//! pdf is that of the mixture. Draws are not valid where a facet reflects below the horizon.
//!
//! Anisotropic facets lose more than isotropic ones of any one width tell: `E` is then taken as the
//! larger of those of the lesser width and of the geometric mean, so that nothing is gained, and at
//! widths 1 and 0.1 a third stays lost (widths 0.5 and 0.2: 6%, at normal incidence).
//!
//! Domain: `eta >= 0`, `k >= 0`, widths in `[ALPHA_FLOOR, 1]`.

use super::energy::ReflectionEnergy;
use super::fresnel::conductor_rgb;
use super::ggx::{Ggx, half_vector, reflect};
use super::{Bsdf, DELTA_PDF, Evaluated, Sampled};
use crate::hemisphere::{cosine_pdf, sample_cosine};
use crate::lanes::Fx;
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
        let normal = Ggx { alpha: self.alpha }.sample_normal(o, u[0], u[1]);
        let far = sample_cosine(u[0], u[1]);
        let i = Vec3x::select(again, far, reflect(o, normal));
        let normal = Vec3x::select(again, half_vector(o, i), normal);
        let Evaluated { value, pdf } = self.through(o, i, normal, lost);
        let valid = i.z.simd_gt(Fx::ZERO) & o.dot(normal).simd_gt(Fx::ZERO);
        Sampled::new(i, value * (Fx::ONE / pdf), pdf, valid)
    }
}

impl RoughConductor<'_> {
    /// `1 - E(w)`.
    #[inline(always)]
    fn lost(&self, w: Vec3x) -> Fx {
        let [x, y] = self.alpha;
        let mean = self.energy.lost(w.z, (x * y).sqrt());
        if x.simd_eq(y).all() {
            mean
        } else {
            mean.fast_min(self.energy.lost(w.z, x.fast_min(y)))
        }
    }

    /// Value and pdf, given the half vector and `1 - E(o)`; `i.z > 0`.
    #[inline(always)]
    fn through(&self, o: Vec3x, i: Vec3x, h: Vec3x, lost: Fx) -> Evaluated {
        let once = Ggx { alpha: self.alpha }.reflection(o, i, h);
        let fresnel = conductor_rgb(o.dot(h), self.eta, self.k);

        let [x, y] = self.alpha;
        let lost_mean = self.energy.mean_lost((x * y).sqrt());
        let kept_mean = Fx::ONE - lost_mean;
        let shape = lost * self.lost(i) / lost_mean * cosine_pdf(i.z);
        let shape = lost_mean.simd_gt(Fx::ZERO) & shape;
        let again = |mean: Fx| mean * mean * kept_mean / mean.mul_neg_add(lost_mean, Fx::ONE);
        let again = Vec3x::new(again(self.mean.x), again(self.mean.y), again(self.mean.z));
        Evaluated {
            value: fresnel * once.value + again * shape,
            pdf: lost.mul_add(cosine_pdf(i.z) - once.pdf, once.pdf),
        }
    }
}
