//! Kinds of BSDF: where their parameters stand in the material tables.
//!
//! | kind | slots |
//! |---|---|
//! | [`Diffuse`] | 0-2 reflectance |
//! | [`RoughDiffuse`] | 0-2 reflectance, 3 roughness |
//! | [`SmoothConductor`], [`RoughConductor`] | 0-2 eta, 3-5 k, 6-8 tint, 9 roughness, 10 anisotropy, 11-13 mean reflectance |
//! | [`SmoothDielectric`], [`RoughDielectric`] | 0 index of refraction, 1 thin, 2-4 tint of reflection, 5-7 of transmission, 8 roughness, 9 compensated; where they disperse, 0 is Cauchy's `a`, 19 `b`, nm^2, and 20 `c`, nm^4 |
//! | [`Principled`] | 0-2 base colour, 3 metallic, 4 roughness, 5 index of refraction, 6 specular, 7-9 its colour, 10 transmission, 11 thin, 12 coat, 13 its roughness, 14-16 sheen, 17 its roughness, 18 compensated; where it disperses, 5, 19 and 20 as of glass |
//!
//! Compensated surfaces make up for what single scattering loses; a metal does not where its mean
//! reflectance is 0. A roughness is perceptual, as in glTF: the distribution's width alpha is its square, and at least
//! [`ALPHA_FLOOR`] where a kernel is for rough surfaces.

use super::respond::Kind;
use crate::bsdf::{
    self, ALPHA_FLOOR, Bsdf, Evaluated, ReflectionEnergy, Sampled, TransmissionEnergy,
};
use crate::dispersion::index_at;
use crate::lanes::{Fx, Mask};
use crate::tables::{Parameters, SLOTS};
use crate::vec3::Vec3x;

/// The slot of Cauchy's `b`, with that of `c` behind it: the last ones, behind whatever else glass has.
pub const CAUCHY_B: usize = SLOTS - 2;

/// Lambertian reflection that is not plain: its surface is interpolated or textured.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse;
/// Rough diffuse reflection.
#[derive(Clone, Copy, Debug)]
pub struct RoughDiffuse;
/// A polished metal.
#[derive(Clone, Copy, Debug)]
pub struct SmoothConductor;
/// A rough metal.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor;
/// Clear glass; `DISPERSIVE` if its index depends on the wavelength.
#[derive(Clone, Copy, Debug)]
pub struct SmoothDielectric<const DISPERSIVE: bool>;
/// Frosted glass; `DISPERSIVE` if its index depends on the wavelength.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric<const DISPERSIVE: bool>;
/// The metallic-roughness model; `GLASS` if some of its materials let light pass, `DISPERSIVE` if their
/// index depends on the wavelength.
#[derive(Clone, Copy, Debug)]
pub struct Principled<const GLASS: bool, const DISPERSIVE: bool>;

/// A BSDF times a colour.
#[derive(Clone, Copy, Debug)]
pub struct Tinted<B> {
    bsdf: B,
    tint: Vec3x,
}

impl<B: Bsdf> Bsdf for Tinted<B> {
    #[inline(always)]
    fn evaluate(&self, o: Vec3x, i: Vec3x) -> Evaluated {
        let Evaluated { value, pdf } = self.bsdf.evaluate(o, i);
        Evaluated {
            value: value.product(self.tint),
            pdf,
        }
    }

    #[inline(always)]
    fn sample(&self, o: Vec3x, u: [Fx; 3]) -> Sampled {
        let sampled = self.bsdf.sample(o, u);
        Sampled {
            weight: sampled.weight.product(self.tint),
            ..sampled
        }
    }
}

/// The width of a roughness.
#[inline(always)]
fn alpha(roughness: Fx) -> Fx {
    (roughness * roughness).fast_max(Fx::splat(ALPHA_FLOOR))
}

/// True where a flag's slot is not 0.
#[inline(always)]
fn flag(slot: Fx) -> Mask {
    slot.simd_gt(Fx::ZERO)
}

/// The index of the far side over that of the near one.
#[inline(always)]
fn relative_index(ior: Fx, front: Mask) -> Fx {
    front.select(ior, Fx::ONE / ior)
}

impl Kind for Diffuse {
    type Bsdf = bsdf::Lambert;
    const DELTA: bool = false;
    const DIFFUSE: bool = true;
    #[inline(always)]
    fn load(parameters: Parameters, _front: Mask) -> bsdf::Lambert {
        bsdf::Lambert {
            albedo: parameters.colour(0),
        }
    }
}

impl Kind for RoughDiffuse {
    type Bsdf = bsdf::RoughDiffuse;
    const DELTA: bool = false;
    const DIFFUSE: bool = true;
    #[inline(always)]
    fn load(parameters: Parameters, _front: Mask) -> bsdf::RoughDiffuse {
        bsdf::RoughDiffuse {
            albedo: parameters.colour(0),
            roughness: parameters.number(3),
        }
    }
}

impl Kind for SmoothConductor {
    type Bsdf = Tinted<bsdf::SmoothConductor>;
    const DELTA: bool = true;
    #[inline(always)]
    fn load(parameters: Parameters, _front: Mask) -> Self::Bsdf {
        Tinted {
            bsdf: bsdf::SmoothConductor {
                eta: parameters.colour(0),
                k: parameters.colour(3),
            },
            tint: parameters.colour(6),
        }
    }
}

impl Kind for RoughConductor {
    type Bsdf = Tinted<bsdf::RoughConductor<'static>>;
    const DELTA: bool = false;
    const ALIGNED: bool = true;
    #[inline(always)]
    fn load(parameters: Parameters, _front: Mask) -> Self::Bsdf {
        let roughness = parameters.number(9);
        let (width, anisotropy) = (roughness * roughness, parameters.number(10));
        let along = |factor: Fx| {
            let alpha = width * factor;
            alpha.fast_max(Fx::splat(ALPHA_FLOOR)).fast_min(Fx::ONE)
        };
        Tinted {
            bsdf: bsdf::RoughConductor {
                eta: parameters.colour(0),
                k: parameters.colour(3),
                mean: parameters.colour(11),
                alpha: [along(Fx::ONE + anisotropy), along(Fx::ONE - anisotropy)],
                energy: ReflectionEnergy::table(),
            },
            tint: parameters.colour(6),
        }
    }
}

/// The index of refraction, of which slot `at` has Cauchy's `a` where it depends on the wavelength.
#[inline(always)]
fn index<const DISPERSIVE: bool>(parameters: Parameters, at: usize) -> Fx {
    let ior = parameters.number(at);
    if DISPERSIVE {
        let [b, c] = [CAUCHY_B, CAUCHY_B + 1].map(|slot| parameters.number(slot));
        index_at([ior, b, c], parameters.wavelength)
    } else {
        ior
    }
}

#[inline(always)]
fn glass<const DISPERSIVE: bool>(parameters: Parameters, front: Mask) -> bsdf::SmoothDielectric {
    let (ior, thin) = (
        index::<DISPERSIVE>(parameters, 0),
        flag(parameters.number(1)),
    );
    bsdf::SmoothDielectric {
        eta: relative_index(ior, front | thin),
        thin,
        reflection: parameters.colour(2),
        transmission: parameters.colour(5),
    }
}

impl<const DISPERSIVE: bool> Kind for SmoothDielectric<DISPERSIVE> {
    type Bsdf = bsdf::SmoothDielectric;
    const DELTA: bool = true;
    const PASSES: bool = true;
    const DISPERSES: bool = DISPERSIVE;
    #[inline(always)]
    fn load(parameters: Parameters, front: Mask) -> Self::Bsdf {
        glass::<DISPERSIVE>(parameters, front)
    }
}

impl<const DISPERSIVE: bool> Kind for RoughDielectric<DISPERSIVE> {
    type Bsdf = bsdf::RoughDielectric<'static>;
    const DELTA: bool = false;
    const PASSES: bool = true;
    const DISPERSES: bool = DISPERSIVE;
    #[inline(always)]
    fn load(parameters: Parameters, front: Mask) -> Self::Bsdf {
        bsdf::RoughDielectric {
            surface: glass::<DISPERSIVE>(parameters, front),
            alpha: alpha(parameters.number(8)),
            energy: TransmissionEnergy::table(),
            compensated: flag(parameters.number(9)),
        }
    }
}

impl<const GLASS: bool, const DISPERSIVE: bool> Kind for Principled<GLASS, DISPERSIVE> {
    type Bsdf = bsdf::Principled;
    const DELTA: bool = false;
    const PASSES: bool = GLASS;
    const DISPERSES: bool = DISPERSIVE;
    #[inline(always)]
    fn load(parameters: Parameters, front: Mask) -> Self::Bsdf {
        let thin = flag(parameters.number(11));
        // What lets nothing pass is alike on both sides.
        let outside = if GLASS {
            front | thin | !flag(parameters.number(10))
        } else {
            Fx::ZERO.simd_eq(Fx::ZERO)
        };
        let floor = Fx::splat(bsdf::charlie::ROUGHNESS_FLOOR);
        bsdf::Principled {
            base: parameters.colour(0),
            metallic: parameters.number(3),
            alpha: alpha(parameters.number(4)),
            eta: relative_index(index::<DISPERSIVE>(parameters, 5), outside),
            specular: parameters.number(6),
            specular_color: parameters.colour(7),
            transmission: if GLASS {
                parameters.number(10)
            } else {
                Fx::ZERO
            },
            thin,
            coat: parameters.number(12),
            coat_alpha: alpha(parameters.number(13)),
            sheen: parameters.colour(14),
            sheen_roughness: parameters.number(17).fast_max(floor),
            compensated: flag(parameters.number(18)),
        }
    }
}
