//! Materials as a compiled scene holds them: what a surface does with light, in the units of the
//! scene format (`docs/scene-format.md`), with references to textures by index.

use super::texture::Texture;
pub use huygens_kernels::dispersion::Cauchy;
pub use huygens_kernels::texture::{Channel, TexelFilter, TextureUse, Wrap};

/// A number or colour that may vary over a surface: `factor` times the texel, component by
/// component; `factor` alone without a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Textured<T> {
    /// The value without a texture, or what its texels are multiplied with.
    pub factor: T,
    /// What varies it.
    pub texture: Option<TextureUse>,
}

impl<T> Textured<T> {
    /// The same everywhere.
    pub const fn constant(factor: T) -> Self {
        Self {
            factor,
            texture: None,
        }
    }
}

impl Textured<[f32; 3]> {
    /// The mean over the whole image, of which `textures` are the scene's.
    #[must_use]
    pub fn mean(&self, textures: &[Texture]) -> [f32; 3] {
        let texture = self.texture.map(|read| &textures[read.texture as usize]);
        let mean = texture.map_or([1.0; 3], Texture::mean);
        std::array::from_fn(|c| self.factor[c] * mean[c])
    }
}

impl<T> From<T> for Textured<T> {
    fn from(factor: T) -> Self {
        Self::constant(factor)
    }
}

/// A surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the scene file or MTL.
    pub name: String,
    /// What it does with light that meets it.
    pub bsdf: Bsdf,
    /// Emitted radiance, W/m^2/sr, each channel finite and >= 0; black: no light.
    pub emission: Textured<[f32; 3]>,
    /// Whether it emits from the back too.
    pub two_sided: bool,
    /// Where it is not there, or not wholly.
    pub alpha: Option<Alpha>,
    /// What bends its shading normal.
    pub normal_map: Option<NormalMap>,
    /// Whether its facets make up for the light that they lose by scattering it once only: of metals,
    /// rough glass and the principled surface.
    pub compensation: bool,
}

/// How much of a surface is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alpha {
    /// Opacity, 0..=1: the share of light that meets the surface; the rest goes on as if it were not
    /// there.
    pub opacity: Textured<f32>,
    /// Makes a mask of it, in 0..=1: the surface is wholly there where its opacity is at least that, and
    /// elsewhere not at all.
    pub cutoff: Option<f32>,
}

/// A shading normal that varies over the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// The texture.
    pub texture: TextureUse,
    /// What its texels are.
    pub kind: Relief,
    /// Normals: what x and y are multiplied with before the normal is made of unit length. Bump:
    /// scene units of height that a texel of 1 stands for.
    pub strength: f32,
}

/// What the texels of a [`NormalMap`] are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relief {
    /// Normals in the frame of u, v and the surface's normal, each component from -1 to 1 stored as
    /// 0 to 1; +y is the direction of rising v (as glTF and OpenGL, not as DirectX).
    Normals,
    /// Heights.
    Bump,
}

/// Scattering at a surface. All kinds but [`Bsdf::Dielectric`] and the transmissive part of
/// [`Bsdf::Principled`] are alike on both sides.
///
/// A `roughness` is perceptual, as in glTF: the microfacet distribution's alpha is its square.
#[derive(Clone, Debug, PartialEq)]
pub enum Bsdf {
    /// Rough diffuse reflection; Lambertian at roughness 0.
    Diffuse {
        /// Share of light that is reflected, each channel in 0..=1.
        reflectance: Textured<[f32; 3]>,
        /// In 0..=1. Here it is the model's own, not squared.
        roughness: f32,
    },
    /// A metal.
    Conductor {
        /// Real part of the index of refraction, > 0.
        eta: [f32; 3],
        /// Its imaginary part, the absorption, >= 0.
        k: [f32; 3],
        /// What the Fresnel reflectance is multiplied with, each channel in 0..=1.
        tint: Textured<[f32; 3]>,
        /// In 0..=1.
        roughness: Textured<f32>,
        /// In -1..=1: alpha is `roughness^2 * (1 + anisotropy)` along u, `* (1 - anisotropy)` along
        /// v (C. Kulla, A. Conty, "Revisiting Physically Based Shading at Imageworks", 2017).
        anisotropy: f32,
    },
    /// Glass, water: reflects and refracts. The outside is the side of the front.
    Dielectric(Box<Dielectric>),
    /// The glTF 2.0 metallic-roughness model with its extensions.
    Principled(Box<Principled>),
    /// A share of light meets one material, the rest another.
    Mix {
        /// Material index of which `1 - amount` is taken.
        first: u32,
        /// Material index of which `amount` is taken.
        second: u32,
        /// In 0..=1.
        amount: Textured<f32>,
    },
}

/// See [`Bsdf::Dielectric`].
#[derive(Clone, Debug, PartialEq)]
pub struct Dielectric {
    /// Index of refraction of the inside over that of the outside, > 0; at the d line (587.56 nm) where
    /// it varies.
    pub ior: f32,
    /// In 0..=1.
    pub roughness: Textured<f32>,
    /// Whether it is a pane without thickness: what enters leaves at once, in its old direction.
    pub thin: bool,
    /// What reflected light is multiplied with, each channel in 0..=1.
    pub reflection_tint: Textured<[f32; 3]>,
    /// What transmitted light is multiplied with at each passage, each channel in 0..=1.
    pub transmission_tint: Textured<[f32; 3]>,
    /// How the index varies over the spectrum. None: not at all.
    pub dispersion: Option<Cauchy>,
    /// Index of the medium inside.
    pub interior: Option<u32>,
    /// Index of the medium outside, of glass that lies in other glass. None: what is outside of all.
    pub exterior: Option<u32>,
}

/// See [`Bsdf::Principled`]. The members are those of glTF 2.0 and the extensions KHR_materials_ior,
/// specular, transmission, clearcoat and sheen; emissive strength is part of
/// [`Material::emission`].
#[derive(Clone, Debug, PartialEq)]
pub struct Principled {
    /// Diffuse reflectance of the dielectric, reflectance at normal incidence of the metal; 0..=1.
    pub base_color: Textured<[f32; 3]>,
    /// 0: dielectric, 1: metal.
    pub metallic: Textured<f32>,
    /// In 0..=1.
    pub roughness: Textured<f32>,
    /// Index of refraction of the dielectric, >= 1.
    pub ior: f32,
    /// Strength of the dielectric's reflection, 0..=1.
    pub specular: Textured<f32>,
    /// Colour of the dielectric's reflection at normal incidence, >= 0.
    pub specular_color: Textured<[f32; 3]>,
    /// Share of light that is refracted instead of scattered diffusely, 0..=1.
    pub transmission: Textured<f32>,
    /// Whether what is refracted leaves at once, as through a pane.
    pub thin: bool,
    /// How the index varies over the spectrum, where light passes. None: not at all.
    pub dispersion: Option<Cauchy>,
    /// Index of the medium inside, where light passes.
    pub interior: Option<u32>,
    /// As [`Dielectric::exterior`], where light passes.
    pub exterior: Option<u32>,
    /// Strength of the clear coat, 0..=1.
    pub clearcoat: Textured<f32>,
    /// Its roughness, 0..=1.
    pub clearcoat_roughness: Textured<f32>,
    /// Colour of the sheen, 0..=1.
    pub sheen_color: Textured<[f32; 3]>,
    /// Its roughness, 0..=1.
    pub sheen_roughness: Textured<f32>,
}

impl Default for Principled {
    /// glTF's defaults, but for a roughness of 0.5 and no metal.
    fn default() -> Self {
        Self {
            base_color: [1.0; 3].into(),
            metallic: 0.0.into(),
            roughness: 0.5.into(),
            ior: 1.5,
            specular: 1.0.into(),
            specular_color: [1.0; 3].into(),
            transmission: 0.0.into(),
            thin: false,
            dispersion: None,
            interior: None,
            exterior: None,
            clearcoat: 0.0.into(),
            clearcoat_roughness: 0.0.into(),
            sheen_color: [0.0; 3].into(),
            sheen_roughness: 0.0.into(),
        }
    }
}

impl Default for Dielectric {
    /// Clear, smooth glass.
    fn default() -> Self {
        Self {
            ior: 1.5,
            roughness: 0.0.into(),
            thin: false,
            reflection_tint: [1.0; 3].into(),
            transmission_tint: [1.0; 3].into(),
            dispersion: None,
            interior: None,
            exterior: None,
        }
    }
}

impl Dielectric {
    /// Whether its index varies over the spectrum, and matters: what passes a pane is not bent, so
    /// there is nothing to tell wavelengths apart by but a trace in what is reflected.
    #[must_use]
    pub fn disperses(&self) -> bool {
        self.dispersion.is_some() && !self.thin
    }
}

impl Principled {
    /// Whether light passes.
    #[must_use]
    pub fn passes(&self) -> bool {
        let metal = self.metallic.texture.is_none() && self.metallic.factor >= 1.0;
        self.transmission.factor > 0.0 && !metal
    }

    /// As [`Dielectric::disperses`].
    #[must_use]
    pub fn disperses(&self) -> bool {
        self.dispersion.is_some() && !self.thin && self.passes()
    }
}

impl Material {
    /// A Lambertian surface that emits `emission` to its front.
    pub fn diffuse(name: impl Into<String>, reflectance: [f32; 3], emission: [f32; 3]) -> Self {
        Self {
            name: name.into(),
            bsdf: Bsdf::Diffuse {
                reflectance: reflectance.into(),
                roughness: 0.0,
            },
            emission: emission.into(),
            two_sided: false,
            alpha: None,
            normal_map: None,
            compensation: true,
        }
    }

    /// Index of the medium behind its surfaces, where light comes there at all.
    #[must_use]
    pub fn interior(&self) -> Option<u32> {
        match &self.bsdf {
            Bsdf::Dielectric(glass) => glass.interior,
            Bsdf::Principled(p) => p.interior.filter(|_| p.passes()),
            _ => None,
        }
    }

    /// Index of the medium before its surfaces, where it is not what lies outside of all glass.
    #[must_use]
    pub fn exterior(&self) -> Option<u32> {
        match &self.bsdf {
            Bsdf::Dielectric(glass) => glass.exterior,
            Bsdf::Principled(p) => p.exterior.filter(|_| p.passes()),
            _ => None,
        }
    }

    /// Whether its index of refraction varies over the spectrum, and matters.
    #[must_use]
    pub fn disperses(&self) -> bool {
        match &self.bsdf {
            Bsdf::Dielectric(glass) => glass.disperses(),
            Bsdf::Principled(p) => p.disperses(),
            _ => false,
        }
    }

    /// The materials that it is a mixture of.
    pub fn parts(&self) -> impl Iterator<Item = u32> {
        let parts = match self.bsdf {
            Bsdf::Mix { first, second, .. } => Some([first, second]),
            _ => None,
        };
        parts.into_iter().flatten()
    }

    /// Whether it emits at all.
    #[must_use]
    pub fn emits(&self) -> bool {
        self.emission.factor.iter().any(|&c| c > 0.0)
    }

    /// Whether what it emits is not the same all over: by an image, or because not all of it is there.
    #[must_use]
    pub fn emission_varies(&self) -> bool {
        self.emits() && (self.emission.texture.is_some() || self.alpha.is_some())
    }

    /// Its colour in one word, textures apart: the diffuse reflectance; of a metal, what it reflects
    /// at normal incidence; of glass, the tint of what passes. `materials` are those of the scene.
    #[must_use]
    pub fn albedo(&self, materials: &[Self]) -> [f32; 3] {
        match &self.bsdf {
            Bsdf::Diffuse { reflectance, .. } => reflectance.factor,
            Bsdf::Conductor { eta, k, tint, .. } => std::array::from_fn(|c| {
                let (n, k2) = (eta[c], k[c] * k[c]);
                let (below, above) = (n - 1.0, n + 1.0);
                tint.factor[c] * (below * below + k2) / (above * above + k2)
            }),
            Bsdf::Dielectric(glass) => glass.transmission_tint.factor,
            Bsdf::Principled(p) => p.base_color.factor,
            Bsdf::Mix {
                first,
                second,
                amount,
            } => {
                // No mixture holds itself: the recursion ends.
                let [a, b] = [first, second].map(|&i| materials[i as usize].albedo(materials));
                std::array::from_fn(|c| a[c] + amount.factor * (b[c] - a[c]))
            }
        }
    }
}
