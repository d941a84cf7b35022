//! Glass and its like, polished and rough, as a boundary or as a thin wall.
//!
//! With `eta` the index of the far side over that of the near side (the side of `o`):
//!
//! * [`SmoothDielectric`]: mirror and refraction, one of them drawn by Fresnel's reflectance `R`. What
//!   passes is divided by `eta^2`, radiance being what a path carries. At `eta = 1` nothing is
//!   reflected and everything goes straight on, to the bit.
//! * [`RoughDielectric`]: B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces",
//!   EGSR 2007, over GGX facets drawn by visible normals; `R` is that of the facet. Draws are not
//!   valid where a facet sends light to the wrong side.
//! * Where `thin`, the far side is a second boundary right behind, after which the medium is that of
//!   the near side again: `R' = R + T^2 R / (1 - R^2) = 2R / (1 + R)` reflected and the rest passed
//!   without a bend. A rough thin wall passes light as it reflects it, mirrored to the far side (as
//!   glTF's KHR_materials_transmission has it).
//!
//! Light that leaves a rough boundary after more than one facet is made up for by dividing by the
//! albedo `E(o)` of all that single scattering reflects and passes (E. Turquin, "Practical multiple
//! scattering compensation for microfacet models", 2019): nothing is absorbed, so that a furnace
//! comes out even. This is not reciprocal: `f(o, i) E(o)` is.
//!
//! Refraction by facets moves a direction by about `b = |eta - 1| / max(eta, 1)` times their slope.
//! Where `b alpha` is below [`ALPHA_FLOOR`] that lobe is too narrow to be evaluated in f32: it is
//! drawn as it is, but as a delta lobe, which light sampling does not find. Where `b` is below 0.05
//! (`E` is too steep to be tabulated there), light passes as through a polished surface, down to
//! `eta = 1`, where all of it goes straight on; what is reflected, `R` being that of the polished
//! surface, is spread and made up for as off a metal.
//!
//! A furnace keeps 0.99 and more for `eta > 1`, 0.98 and more for `eta < 1`, where the edge of total
//! reflection is what the table of `E` follows least well.
//!
//! Domain: `eta > 0`, tints in `[0, 1]`, widths in `[ALPHA_FLOOR, 1]`.

use super::energy::TransmissionEnergy;
use super::fresnel::{Dielectric, dielectric};
use super::ggx::{ALPHA_FLOOR, Ggx, half_vector, reflect};
use super::refraction::Refraction;
use super::{Bsdf, DELTA_PDF, Evaluated, Sampled};
use crate::lanes::{Fx, Mask};
use crate::vec3::Vec3x;

/// The least `|eta - 1| / max(eta, 1)` for which what passes a rough boundary is evaluated.
const INDEX_FLOOR: f32 = 0.05;

/// A polished boundary of two dielectrics, or a thin pane.
#[derive(Clone, Copy, Debug)]
pub struct SmoothDielectric {
    /// Index of the far side over that of the near side.
    pub eta: Fx,
    /// Where the surface is a thin wall.
    pub thin: Mask,
    /// What reflections are multiplied with; 1 is physical.
    pub reflection: Vec3x,
    /// What passes is multiplied with; 1 is physical.
    pub transmission: Vec3x,
}

/// A rough boundary of two dielectrics, or a thin pane of frosted glass.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric<'a> {
    /// Polished, it would be this.
    pub surface: SmoothDielectric,
    /// Width of the distribution of facets.
    pub alpha: Fx,
    /// What single scattering keeps.
    pub energy: &'a TransmissionEnergy,
    /// Where the rest is made up for.
    pub compensated: Mask,
}

impl SmoothDielectric {
    /// Fresnel's equations at a cosine, for both boundaries of a thin wall.
    #[inline(always)]
    fn boundary(&self, cos: Fx) -> Dielectric {
        let once = dielectric(cos, self.eta);
        let r = once.reflectance;
        Dielectric {
            reflectance: self.thin.select((r + r) / (Fx::ONE + r), r),
            ..once
        }
    }

    /// What radiance is multiplied with in passing: `1 / eta^2`, and 1 for a thin wall.
    #[inline(always)]
    fn compression(&self) -> Fx {
        self.thin.select(Fx::ONE, Fx::ONE / (self.eta * self.eta))
    }

    /// Where light from `o` goes when it passes a polished surface.
    #[inline(always)]
    fn straight(&self, o: Vec3x, q: Fx) -> Vec3x {
        let bent = Vec3x::new(-o.x, -o.y, -q) * (Fx::ONE / self.eta);
        Vec3x::select(self.thin, -o, bent)
    }
}

impl Bsdf for SmoothDielectric {
    #[inline(always)]
    fn evaluate(&self, _o: Vec3x, _i: Vec3x) -> Evaluated {
        Evaluated::nothing()
    }

    #[inline(always)]
    fn sample(&self, o: Vec3x, u: [Fx; 3]) -> Sampled {
        let boundary = self.boundary(o.z);
        let mirrored = u[2].simd_lt(boundary.reflectance);
        let up = Vec3x::new(-o.x, -o.y, o.z);
        let i = Vec3x::select(mirrored, up, self.straight(o, boundary.q));
        let weight = Vec3x::select(
            mirrored,
            self.reflection,
            self.transmission * self.compression(),
        );
        Sampled::new(i, weight, Fx::splat(DELTA_PDF), i.z.simd_ne(Fx::ZERO))
    }
}

impl RoughDielectric<'_> {
    /// `|eta - 1|`, seen from the denser side: the same for light that comes back.
    #[inline(always)]
    fn bend(&self) -> Fx {
        let eta = self.surface.eta;
        (eta - Fx::ONE).abs() / eta.fast_max(Fx::ONE)
    }

    /// Where the index is so close to 1 that light passes as if the surface were polished.
    #[inline(always)]
    fn matched(&self) -> Mask {
        self.bend().simd_lt(Fx::splat(INDEX_FLOOR)) & !self.surface.thin
    }

    /// Where the lobe that passes is not evaluated.
    #[inline(always)]
    fn unspread(&self) -> Mask {
        let narrow = (self.bend() * self.alpha).simd_lt(Fx::splat(ALPHA_FLOOR));
        self.matched() | (narrow & !self.surface.thin)
    }

    /// `E(o)`.
    #[inline(always)]
    fn kept(&self, o: Vec3x) -> Fx {
        let one_way = Fx::ONE - self.energy.reflection.lost(o.z, self.alpha);
        let boundary = self.energy.albedo(o.z, self.alpha, self.surface.eta);
        let kept = (self.surface.thin | self.matched()).select(one_way, boundary);
        self.compensated.select(kept, Fx::ONE)
    }

    /// Fresnel's equations for a facet of normal `m`.
    #[inline(always)]
    fn boundary(&self, o: Vec3x, m: Vec3x) -> Dielectric {
        self.surface.boundary(self.matched().select(o.z, o.dot(m)))
    }

    /// The part of a facet's light that passes, or that is reflected.
    #[inline(always)]
    fn part(&self, reflectance: Fx, passed: Mask) -> Fx {
        passed.select(Fx::ONE - reflectance, reflectance)
    }

    #[inline(always)]
    fn tint(&self, passed: Mask) -> Vec3x {
        Vec3x::select(passed, self.surface.transmission, self.surface.reflection)
    }
}

impl Bsdf for RoughDielectric<'_> {
    #[inline(always)]
    fn evaluate(&self, o: Vec3x, i: Vec3x) -> Evaluated {
        let eta = self.surface.eta;
        let passed = i.z.simd_lt(Fx::ZERO);
        let bent = passed & !self.surface.thin;
        let mirrored = Vec3x::new(i.x, i.y, i.z.abs());
        let bend = Refraction::between(o, i, eta);
        let m = Vec3x::select(bent, bend.normal, half_vector(o, mirrored));
        let part = self.part(self.boundary(o, m).reflectance, passed);

        let facets = Ggx::isotropic(self.alpha);
        let once = facets.reflection(o, mirrored, m);
        let spread = facets.visible(o, m) * bend.jacobian(eta);
        let through = facets.shadowing(o, i) * self.surface.compression();
        let pdf = part * bent.select(spread, once.pdf);
        let value = part * bent.select(spread * through, once.value);
        let met = bent.select(bend.possible & !self.unspread(), i.z.simd_ne(Fx::ZERO));
        Evaluated {
            value: self.tint(passed) * (value / self.kept(o)),
            pdf,
        }
        .keep(met)
    }

    #[inline(always)]
    fn sample(&self, o: Vec3x, u: [Fx; 3]) -> Sampled {
        let eta = self.surface.eta;
        let facets = Ggx::isotropic(self.alpha);
        let m = facets.sample_normal(o, u[0], u[1]);
        let boundary = self.boundary(o, m);
        let passed = u[2].simd_ge(boundary.reflectance);
        let bent = passed & !self.surface.thin;

        let up = reflect(o, m);
        let mirrored = Vec3x::new(up.x, up.y, passed.select(-up.z, up.z));
        let bend = Refraction::by(o, m, boundary.q, eta);
        let i = Vec3x::select(bent, bend.direction, mirrored);
        let matched = bent & self.matched();
        let i = Vec3x::select(matched, self.surface.straight(o, boundary.q), i);

        let once = facets.reflection(o, up, m);
        let spread = facets.visible(o, m) * bend.jacobian(eta);
        let pdf = self.part(boundary.reflectance, passed) * bent.select(spread, once.pdf);
        let unspread = bent & self.unspread();
        let pdf = unspread.select(Fx::splat(DELTA_PDF), pdf);
        let through = facets.shadowing(o, i) * self.surface.compression();
        let weight = bent.select(through, once.value / once.pdf);
        let weight = weight / self.kept(o);
        let weight = matched.select(self.surface.compression(), weight);

        let sided = passed.select(i.z.simd_lt(Fx::ZERO), i.z.simd_gt(Fx::ZERO));
        let met = o.dot(m).simd_gt(Fx::ZERO) & pdf.simd_gt(Fx::ZERO);
        let met = met & (bend.possible | matched | !bent);
        Sampled::new(i, self.tint(passed) * weight, pdf, sided & met)
    }
}
