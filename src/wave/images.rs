//! From the images of a compiled scene to the tables by which kernels read them.

use super::camera;
use super::parameters::Parameters;
use crate::scene::material::{Alpha, NormalMap, Relief};
use crate::scene::{Bsdf, Material, Scene};
use crate::settings::TextureLod;
use huygens_kernels::images::{self, Cone, Images, SITES};
use huygens_kernels::opacity::{Coordinates, Opacities, Opacity};
use huygens_kernels::texture::{NO_TEXTURE, Texture, TextureUse, Textures};

/// What materials read of images.
#[derive(Debug)]
pub(crate) struct ImageTables<'a> {
    textures: Vec<Texture<'a>>,
    uses: Vec<TextureUse>,
    sites: [Vec<u32>; SITES],
    /// Empty where no material has a map.
    relief: Vec<images::Relief>,
    /// Of what is a colour in one word: see [`Material::albedo`].
    albedo: Vec<u32>,
    /// Of mixtures' shares.
    amount: Vec<u32>,
    /// Empty where no material has one for its emission.
    emission: Vec<u32>,
    /// Empty where all materials are wholly there.
    opacity: Vec<Opacity>,
    cone: Cone,
}

impl<'a> ImageTables<'a> {
    /// The tables of what surfaces of `scene` read, by material; none if they read nothing and are
    /// wholly there.
    pub(crate) fn new(scene: &'a Scene, lod: TextureLod) -> Option<Self> {
        let called_for = |m: &Material| m.alpha.is_some() || !m.textures().is_empty();
        if !scene.materials.iter().any(called_for) {
            return None;
        }
        let mut tables = Self {
            textures: scene.textures.iter().map(|t| t.view()).collect(),
            uses: Vec::new(),
            sites: [const { Vec::new() }; SITES],
            relief: Vec::new(),
            albedo: Vec::new(),
            amount: Vec::new(),
            emission: Vec::new(),
            opacity: Vec::new(),
            cone: match lod {
                TextureLod::Footprint => camera::cone(&scene.camera, &scene.film),
                TextureLod::Finest => Cone::NONE,
            },
        };
        for material in &scene.materials {
            let mut images = Parameters::of(material).images.into_iter();
            for k in 0..SITES {
                let index = tables.place(images.next().flatten());
                tables.sites[k].push(index);
            }
            let albedo = match &material.bsdf {
                Bsdf::Diffuse { reflectance, .. } => reflectance.texture,
                Bsdf::Conductor { tint, .. } => tint.texture,
                Bsdf::Dielectric(glass) => glass.transmission_tint.texture,
                Bsdf::Principled(p) => p.base_color.texture,
                Bsdf::Mix { .. } => None,
            };
            let index = tables.place(albedo);
            tables.albedo.push(index);
            let amount = match &material.bsdf {
                Bsdf::Mix { amount, .. } => amount.texture,
                _ => None,
            };
            let index = tables.place(amount);
            tables.amount.push(index);
        }
        if scene.materials.iter().any(|m| m.normal_map.is_some()) {
            for material in &scene.materials {
                let map = material.normal_map.as_ref();
                let row = map.map_or(images::Relief::NONE, |map| tables.relief(map));
                tables.relief.push(row);
            }
        }
        let lamp = |m: &Material| m.emits() && m.emission.texture.is_some();
        if scene.materials.iter().any(lamp) {
            for material in &scene.materials {
                let index = tables.place(material.emission.texture.filter(|_| material.emits()));
                tables.emission.push(index);
            }
        }
        if scene.materials.iter().any(|m| m.alpha.is_some()) {
            for material in &scene.materials {
                let alpha = material.alpha.as_ref();
                let row = alpha.map_or(Opacity::WHOLE, |alpha| tables.opacity(alpha));
                tables.opacity.push(row);
            }
        }
        Some(tables)
    }

    /// The index of a texture use: a new one.
    fn place(&mut self, texture: Option<TextureUse>) -> u32 {
        let Some(texture) = texture else {
            return NO_TEXTURE;
        };
        self.uses.push(texture);
        self.uses.len() as u32 - 1
    }

    fn relief(&mut self, map: &NormalMap) -> images::Relief {
        let [w, h] = self.textures[map.texture.texture as usize].levels[0].size;
        let [[a, b, _], [c, d, _]] = map.texture.uv.map(|row| row.map(f64::from));
        let texels = (f64::from(w) * f64::from(h) * (a * d - b * c).abs()).sqrt();
        images::Relief {
            texture: self.place(Some(map.texture)),
            heights: map.kind == Relief::Bump,
            strength: map.strength,
            texel: (1.0 / texels) as f32,
        }
    }

    fn opacity(&mut self, alpha: &Alpha) -> Opacity {
        Opacity {
            factor: alpha.opacity.factor,
            texture: self.place(alpha.opacity.texture),
            cutoff: alpha.cutoff.unwrap_or(f32::NAN),
        }
    }

    fn textures(&self) -> Textures<'_> {
        Textures {
            textures: &self.textures,
            uses: &self.uses,
        }
    }

    /// What shares of mixtures read: texture uses by material, or [`NO_TEXTURE`].
    pub(crate) fn amounts(&self) -> (Textures<'_>, &[u32]) {
        (self.textures(), &self.amount)
    }

    /// What traversals ask, where some material is not wholly there.
    pub(crate) fn opacities(
        &'a self,
        coordinates: Coordinates<'a>,
        seed: u32,
    ) -> Option<Opacities<'a>> {
        (!self.opacity.is_empty()).then(|| Opacities {
            of: &self.opacity,
            textures: self.textures(),
            coordinates,
            seed,
        })
    }

    /// The view that kernels take.
    pub(crate) fn view(&self) -> Images<'_> {
        Images {
            textures: self.textures(),
            sites: self.sites.each_ref().map(|column| &column[..]),
            relief: &self.relief,
            albedo: &self.albedo,
            emission: &self.emission,
            opacity: &self.opacity,
            cone: self.cone,
        }
    }
}
