//! Shaders: the kinds of scattering that have a kernel of their own.

use crate::scene::{Bsdf, Material, Textured};
use huygens_kernels::bsdf::ALPHA_FLOOR;

/// What scatters at a surface: each has a kernel of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shader {
    /// Lambertian, flat and of one colour: one pass from hit to scattered path.
    Plain,
    /// Lambertian otherwise.
    Diffuse,
    /// Rough diffuse.
    RoughDiffuse,
    /// Polished metal.
    SmoothConductor,
    /// Rough metal.
    RoughConductor,
    /// Clear glass.
    SmoothDielectric,
    /// Frosted glass.
    RoughDielectric,
    /// Clear glass whose index depends on the wavelength.
    SmoothDispersive,
    /// Frosted glass whose index depends on the wavelength.
    RoughDispersive,
    /// The metallic-roughness model, where nothing passes.
    Principled,
    /// The same where light passes.
    PrincipledGlass,
    /// The same where its index depends on the wavelength.
    PrincipledDispersive,
    /// No surface: a medium that scatters.
    Medium,
    /// One of two others, at random.
    Mix,
}

impl Shader {
    /// All there are, in the order in which they run.
    pub const ALL: [Self; 14] = [
        Self::Plain,
        Self::Diffuse,
        Self::RoughDiffuse,
        Self::SmoothConductor,
        Self::RoughConductor,
        Self::SmoothDielectric,
        Self::RoughDielectric,
        Self::SmoothDispersive,
        Self::RoughDispersive,
        Self::Principled,
        Self::PrincipledGlass,
        Self::PrincipledDispersive,
        Self::Medium,
        Self::Mix,
    ];

    /// The effect's name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain diffuse",
            Self::Diffuse => "diffuse",
            Self::RoughDiffuse => "rough diffuse",
            Self::SmoothConductor => "smooth conductor",
            Self::RoughConductor => "rough conductor",
            Self::SmoothDielectric => "smooth dielectric",
            Self::RoughDielectric => "rough dielectric",
            Self::SmoothDispersive => "smooth dispersive dielectric",
            Self::RoughDispersive => "rough dispersive dielectric",
            Self::Principled => "principled",
            Self::PrincipledGlass => "principled glass",
            Self::PrincipledDispersive => "principled dispersive glass",
            Self::Medium => "scattering medium",
            Self::Mix => "mix",
        }
    }

    /// Its stage's name.
    #[must_use]
    pub fn stage(self) -> &'static str {
        match self {
            Self::Plain => "shade: surface",
            Self::Diffuse => "shade: diffuse",
            Self::RoughDiffuse => "shade: rough diffuse",
            Self::SmoothConductor => "shade: smooth conductor",
            Self::RoughConductor => "shade: rough conductor",
            Self::SmoothDielectric => "shade: smooth dielectric",
            Self::RoughDielectric => "shade: rough dielectric",
            Self::SmoothDispersive => "shade: smooth dispersive dielectric",
            Self::RoughDispersive => "shade: rough dispersive dielectric",
            Self::Principled => "shade: principled",
            Self::PrincipledGlass => "shade: principled glass",
            Self::PrincipledDispersive => "shade: principled dispersive glass",
            Self::Medium => "shade: medium",
            Self::Mix => "shade: mix",
        }
    }

    /// Whether it has rows of surface interactions between its passes.
    #[must_use]
    pub fn has_rows(self) -> bool {
        !matches!(self, Self::Plain | Self::Medium | Self::Mix)
    }

    /// Whether light can only be found by following its directions.
    #[must_use]
    pub fn is_delta(self) -> bool {
        matches!(
            self,
            Self::SmoothConductor | Self::SmoothDielectric | Self::SmoothDispersive
        )
    }

    /// Whether light passes through.
    #[must_use]
    pub fn passes(self) -> bool {
        matches!(
            self,
            Self::SmoothDielectric
                | Self::RoughDielectric
                | Self::SmoothDispersive
                | Self::RoughDispersive
                | Self::PrincipledGlass
                | Self::PrincipledDispersive
        )
    }

    /// Whether what it does depends on the wavelength.
    #[must_use]
    pub fn disperses(self) -> bool {
        matches!(
            self,
            Self::SmoothDispersive | Self::RoughDispersive | Self::PrincipledDispersive
        )
    }

    /// The shader of a material; `bent` if it cannot be plain: a surface that wears it has
    /// interpolated normals, or it is part of a mixture.
    pub(super) fn of(material: &Material, bent: bool) -> Self {
        match &material.bsdf {
            Bsdf::Diffuse { roughness, .. } if *roughness > 0.0 => Self::RoughDiffuse,
            Bsdf::Diffuse { reflectance, .. } => {
                if bent || material.normal_map.is_some() || reflectance.texture.is_some() {
                    Self::Diffuse
                } else {
                    Self::Plain
                }
            }
            Bsdf::Conductor { roughness, .. } if polished(roughness) => Self::SmoothConductor,
            Bsdf::Conductor { .. } => Self::RoughConductor,
            Bsdf::Dielectric(glass) => match (polished(&glass.roughness), glass.disperses()) {
                (true, false) => Self::SmoothDielectric,
                (false, false) => Self::RoughDielectric,
                (true, true) => Self::SmoothDispersive,
                (false, true) => Self::RoughDispersive,
            },
            Bsdf::Principled(p) if p.disperses() => Self::PrincipledDispersive,
            Bsdf::Principled(p) if p.passes() => Self::PrincipledGlass,
            Bsdf::Principled(_) => Self::Principled,
            Bsdf::Mix { .. } => Self::Mix,
        }
    }
}

/// Whether a roughness is none.
pub(crate) fn polished(roughness: &Textured<f32>) -> bool {
    roughness.texture.is_none() && roughness.factor * roughness.factor < ALPHA_FLOOR
}
