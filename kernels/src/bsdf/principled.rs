//! The metallic-roughness model of glTF 2.0 with its extensions for transmission, index of
//! refraction, specular, clearcoat and sheen (Khronos, *glTF 2.0 Specification*, appendix B, and the
//! KHR_materials_ pages).
//!
//! From outside in, all for light from `o`:
//!
//! * clearcoat: GGX facets of index 1.5 (`f0 = 0.04`), weight `coat`; what lies below is multiplied
//!   with `1 - coat E_c(o)`;
//! * sheen ([`super::charlie`]), coloured; what lies below with `1 - max(sheen) E_s(o)`;
//! * a mix by `metallic` of metal and dielectric, the latter a mix by `transmission` of glass and an
//!   opaque base under a specular layer:
//!   * metal: facets with Schlick's Fresnel from `f0 = base` to 1, times `1 + base (1 - E) / E` for
//!     what single scattering loses (Turquin, 2019);
//!   * specular layer: facets with `f0 = specular min(F0(eta) specular_color, 1)` and
//!     `f90 = specular`; below it a Lambertian base, times `1 - max R(o)`, `R` being the layer's
//!     albedo. glTF's own `1 - F(o.h)` there may give more than it receives at grazing;
//!   * glass: [`RoughDielectric`], tinted by `base` in passing and by
//!     `min(specular specular_color, 1)` in reflection; thin, or a boundary of `eta`.
//!
//! Albedos are tabulated ([`super::ReflectionEnergy`] and its like) from above, so that a furnace
//! never gains; a white material keeps 0.98 and more of its light, 0.99 and more but for grazing
//! light on polished layers, where the table of Schlick's term is least exact. Scaling by what `o` alone says is what the field's tools do and is not reciprocal;
//! the coat's and the sheen's lobes themselves are.
//!
//! One lobe is drawn in proportion to its albedo; the pdf is that of the mixture. Draws are not
//! valid where a facet sends light to the wrong side. Where the light comes from within
//! (`eta < 1`, not thin) there is neither coat nor sheen, and only glass knows of total reflection.
//!
//! Domain: colours and weights in `[0, 1]`, widths in `[ALPHA_FLOOR, 1]`, roughness of sheen in
//! `[charlie::ROUGHNESS_FLOOR, 1]`, `eta > 0`.

use super::charlie::charlie;
use super::dielectric::{RoughDielectric, SmoothDielectric};
use super::energy::{ReflectionEnergy, SchlickEnergy, SheenEnergy, TransmissionEnergy};
use super::fresnel::schlick;
use super::ggx::{Ggx, half_vector, reflect};
use super::{Bsdf, DELTA_PDF, Evaluated, Sampled};
use crate::hemisphere::{UNIFORM_PDF, cosine_pdf, sample_cosine, sample_uniform};
use crate::lanes::{Fx, Mask};
use crate::vec3::Vec3x;

/// A material as glTF describes it. `alpha` is the square of a glTF roughness.
#[derive(Clone, Copy, Debug)]
pub struct Principled {
    /// Base colour.
    pub base: Vec3x,
    /// 0: dielectric, 1: metal.
    pub metallic: Fx,
    /// Width of the distribution of facets.
    pub alpha: Fx,
    /// Index of the far side over that of the near side (1.5 where the file says nothing and the
    /// light comes from outside).
    pub eta: Fx,
    /// Strength of a dielectric's reflection.
    pub specular: Fx,
    /// Its colour at normal incidence.
    pub specular_color: Vec3x,
    /// The part of a dielectric that is glass.
    pub transmission: Fx,
    /// Where glass is a thin wall.
    pub thin: Mask,
    /// Strength of the clearcoat.
    pub coat: Fx,
    /// Width of its facets.
    pub coat_alpha: Fx,
    /// Colour of the sheen.
    pub sheen: Vec3x,
    /// Its roughness.
    pub sheen_roughness: Fx,
    /// Where metal and glass make up for what single scattering loses.
    pub compensated: Mask,
}

/// `f0` of the clearcoat.
const COAT_F0: f32 = 0.04;

/// What a direction `o` makes of the material: how strong each lobe is, and how likely it is drawn.
struct Lobes {
    /// Strength of coat and sheen, 0 from within.
    coat: Fx,
    sheen: Vec3x,
    /// The metal's Fresnel is `metal + (boost - metal) s`.
    metal: Vec3x,
    boost: Vec3x,
    /// The specular layer's is `f0 + (f90 - f0) s`.
    f0: Vec3x,
    f90: Fx,
    /// Albedo of the opaque base.
    diffuse: Vec3x,
    /// Strength of glass.
    glass: Fx,
    /// Probabilities of base, facets, coat, sheen; glass has the rest.
    chance: [Fx; 5],
}

impl Principled {
    /// The glass.
    #[inline(always)]
    fn glass(&self) -> RoughDielectric<'static> {
        let tint = self.specular_color * self.specular;
        let one = Fx::ONE;
        RoughDielectric {
            surface: SmoothDielectric {
                eta: self.eta,
                thin: self.thin,
                reflection: Vec3x::new(
                    tint.x.fast_min(one),
                    tint.y.fast_min(one),
                    tint.z.fast_min(one),
                ),
                transmission: self.base,
            },
            alpha: self.alpha,
            energy: TransmissionEnergy::table(),
            compensated: self.compensated,
        }
    }

    /// Where light comes from within.
    #[inline(always)]
    fn inside(&self) -> Mask {
        self.eta.simd_lt(Fx::ONE) & !self.thin
    }

    fn lobes(&self, o: Vec3x) -> Lobes {
        let one = Fx::ONE;
        let white = Vec3x::splat([1.0; 3]);
        let outside = !self.inside();
        let (coat, sheen) = (outside & self.coat, self.sheen.keep(outside));

        let (reflection, schlick) = (ReflectionEnergy::table(), SchlickEnergy::table());
        let coat_kept = one - reflection.lost(o.z, self.coat_alpha);
        let coat_steep = schlick.albedo(o.z, self.coat_alpha);
        let coat_albedo = coat * layer(Fx::splat(COAT_F0), one, coat_kept, coat_steep);
        let under_coat = one - coat_albedo;
        let sheen_albedo = SheenEnergy::table().albedo(o.z, self.sheen_roughness);
        let under = under_coat * (one - sheen.max_component() * sheen_albedo);

        let lost = reflection.lost(o.z, self.alpha);
        let kept = one - lost;
        let steep = schlick.albedo(o.z, self.alpha).fast_min(kept);
        let dielectric = under * (one - self.metallic);
        let opaque = dielectric * (one - self.transmission);
        let again = self.compensated & (lost / kept);
        let boost = self.base.scale_add(again, white) * (under * self.metallic);
        let metal = boost.product(self.base);
        let amplitude = (self.eta - one) / (self.eta + one);
        let normal = self.specular_color * (amplitude * amplitude);
        let normal = Vec3x::new(
            normal.x.fast_min(one),
            normal.y.fast_min(one),
            normal.z.fast_min(one),
        );
        let normal = normal * self.specular;
        let reflected = layer(normal.max_component(), self.specular, kept, steep);
        let diffuse = self.base * (opaque * (one - reflected).fast_max(Fx::ZERO));

        // In proportion to the mean of the three colours.
        let third = Fx::splat(1.0 / 3.0);
        let mean = |c: Vec3x| (c.x + c.y + c.z) * third;
        let facets = layer(mean(metal), mean(boost), kept, steep)
            + opaque * layer(mean(normal), self.specular, kept, steep);
        let glass = dielectric * self.transmission;
        let shares = [
            mean(diffuse),
            facets,
            coat_albedo,
            mean(sheen) * under_coat * sheen_albedo,
            glass * (mean(self.base) + one) * Fx::splat(0.5),
        ];
        let total = shares[0] + shares[1] + shares[2] + shares[3] + shares[4];
        let some = total.simd_gt(Fx::ZERO);
        let mut chance = shares.map(|share| some & (share / total));
        // Something is drawn of a black material too.
        chance[0] = some.select(chance[0], one);
        Lobes {
            coat,
            sheen: sheen * under_coat,
            metal,
            boost,
            f0: normal * opaque,
            f90: self.specular * opaque,
            diffuse,
            glass,
            chance,
        }
    }

    /// Value and pdf of the mixture.
    fn mixture(&self, lobes: &Lobes, o: Vec3x, i: Vec3x) -> Evaluated {
        let up = i.z.simd_gt(Fx::ZERO);
        let h = half_vector(o, i);
        let cos = o.dot(h);
        let term = schlick(cos);
        let once = Ggx::isotropic(self.alpha).reflection(o, i, h);
        let cosine = cosine_pdf(i.z);
        let channel = |metal: Fx, boost: Fx, f0: Fx, diffuse: Fx| {
            let fresnel = term.mul_add(boost + lobes.f90 - metal - f0, metal + f0);
            fresnel.mul_add(once.value, diffuse * cosine)
        };
        let mut value = Vec3x::new(
            channel(lobes.metal.x, lobes.boost.x, lobes.f0.x, lobes.diffuse.x),
            channel(lobes.metal.y, lobes.boost.y, lobes.f0.y, lobes.diffuse.y),
            channel(lobes.metal.z, lobes.boost.z, lobes.f0.z, lobes.diffuse.z),
        );
        let [base, facets, coat, sheen, glass] = lobes.chance;
        let mut pdf = base * cosine + facets * once.pdf;
        if lobes.coat.simd_gt(Fx::ZERO).any() {
            let above = Ggx::isotropic(self.coat_alpha).reflection(o, i, h);
            let fresnel = term.mul_add(Fx::splat(1.0 - COAT_F0), Fx::splat(COAT_F0));
            let above_value = lobes.coat * fresnel * above.value;
            value += Vec3x::new(above_value, above_value, above_value);
            pdf += coat * above.pdf;
        }
        if sheen.simd_gt(Fx::ZERO).any() {
            let scale = SheenEnergy::table().scale(self.sheen_roughness);
            value += lobes.sheen * (charlie(o, i, self.sheen_roughness) * scale);
            pdf += sheen * Fx::splat(UNIFORM_PDF);
        }
        let mut all = Evaluated { value, pdf }.keep(up);
        if glass.simd_gt(Fx::ZERO).any() {
            let through = self.glass().evaluate(o, i);
            all.value += through.value * lobes.glass;
            all.pdf += through.pdf * glass;
        }
        all
    }
}

/// Albedo of facets with Schlick's Fresnel.
#[inline(always)]
fn layer(f0: Fx, f90: Fx, kept: Fx, steep: Fx) -> Fx {
    steep.mul_add(f90 - f0, f0 * kept)
}

impl Bsdf for Principled {
    #[inline(always)]
    fn evaluate(&self, o: Vec3x, i: Vec3x) -> Evaluated {
        self.mixture(&self.lobes(o), o, i)
    }

    #[inline(always)]
    fn sample(&self, o: Vec3x, u: [Fx; 3]) -> Sampled {
        let lobes = self.lobes(o);
        let [base, facets, coat, sheen, glass] = lobes.chance;
        let below_coat = base + facets;
        let below_sheen = below_coat + coat;
        let below_glass = below_sheen + sheen;
        let coated = u[2].simd_ge(below_coat);
        let width = coated.select(self.coat_alpha, self.alpha);
        let normal = Ggx::isotropic(width).sample_normal(o, u[0], u[1]);
        let i = Vec3x::select(
            u[2].simd_lt(base),
            sample_cosine(u[0], u[1]),
            reflect(o, normal),
        );
        let clothed = u[2].simd_ge(below_sheen);
        let mut i = Vec3x::select(clothed, sample_uniform(u[0], u[1]), i);
        let mut valid = i.z.simd_gt(Fx::ZERO);
        let through = u[2].simd_ge(below_glass) & glass.simd_gt(Fx::ZERO);
        if !through.any() {
            let Evaluated { value, pdf } = self.mixture(&lobes, o, i);
            let valid = valid & pdf.simd_gt(Fx::ZERO);
            return Sampled::new(i, value * (Fx::ONE / pdf), pdf, valid);
        }

        let most = Fx::splat(1.0 - f32::EPSILON * 0.5);
        let rest = ((u[2] - below_glass) / glass).fast_clamp(Fx::ZERO, most);
        let drawn = self.glass().sample(o, [u[0], u[1], rest]);
        i = Vec3x::select(through, drawn.direction, i);
        valid = through.select(drawn.valid, valid);
        let Evaluated { value, pdf } = self.mixture(&lobes, o, i);
        let delta = through & drawn.pdf.simd_eq(Fx::splat(DELTA_PDF));
        let weight = Vec3x::select(
            delta,
            drawn.weight * (lobes.glass / glass),
            value * (Fx::ONE / pdf),
        );
        let pdf = delta.select(drawn.pdf, pdf);
        Sampled::new(i, weight, pdf, valid & pdf.simd_gt(Fx::ZERO))
    }
}
