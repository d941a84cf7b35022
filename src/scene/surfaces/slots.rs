//! The places where a material reads textures.

use crate::scene::material::{Bsdf, Material, NormalMap, TextureUse, Textured};
use crate::scene::texture::Texture;

/// One of them.
pub(in crate::scene) enum Slot<'a> {
    /// A number or colour: its name, its largest factor, whether it has to stay within 1.
    Value(&'a mut Option<TextureUse>, &'static str, f32, bool),
    /// A normal or bump map.
    Relief(&'a mut Option<NormalMap>),
}

/// What a texture holds that a material cannot have.
pub(in crate::scene) enum Problem {
    Negative(f32),
    AboveOne(f32),
}

impl Slot<'_> {
    /// Index of the texture.
    pub(in crate::scene) fn texture(&self) -> u32 {
        let texture = match self {
            Slot::Value(texture, ..) => texture.as_ref().map(|t| t.texture),
            Slot::Relief(map) => map.as_ref().map(|m| m.texture.texture),
        };
        texture.expect("slots hold textures")
    }

    /// Sets the index of the texture.
    pub(in crate::scene) fn set(&mut self, index: u32) {
        match self {
            Slot::Value(Some(texture), ..) => texture.texture = index,
            Slot::Relief(Some(map)) => map.texture.texture = index,
            _ => {}
        }
    }

    /// Takes the texture away; its factor stays.
    pub(in crate::scene) fn remove(&mut self) {
        match self {
            Slot::Value(texture, ..) => **texture = None,
            Slot::Relief(map) => **map = None,
        }
    }

    /// The name of what the texture varies.
    pub(in crate::scene) fn what(&self) -> &'static str {
        match self {
            Slot::Value(_, what, ..) => what,
            Slot::Relief(_) => "relief",
        }
    }

    /// What `texture` holds that does not go here.
    pub(in crate::scene) fn problem(&self, texture: &Texture) -> Option<Problem> {
        let Slot::Value(_, _, factor, within_one) = self else {
            return None;
        };
        let [low, high] = texture.range;
        if low < 0.0 {
            Some(Problem::Negative(low))
        } else if *within_one && high * factor > 1.0 {
            Some(Problem::AboveOne(high))
        } else {
            None
        }
    }
}

/// The largest number of a factor.
trait Largest {
    fn largest(&self) -> f32;
}

impl Largest for f32 {
    fn largest(&self) -> f32 {
        *self
    }
}

impl Largest for [f32; 3] {
    fn largest(&self) -> f32 {
        self.iter().fold(0.0, |a, &b| a.max(b))
    }
}

fn value<'a, T: Largest>(
    all: &mut Vec<Slot<'a>>,
    what: &'static str,
    value: &'a mut Textured<T>,
    within_one: bool,
) {
    let largest = value.factor.largest();
    if value.texture.is_some() {
        all.push(Slot::Value(&mut value.texture, what, largest, within_one));
    }
}

impl Material {
    /// Whether it, or a part of it, reads textures. `materials` are those of the scene.
    pub(in crate::scene) fn reads_textures(&self, materials: &[Self]) -> bool {
        let part = |i: u32| materials[i as usize].reads_textures(materials);
        !self.textures().is_empty()
            || matches!(self.bsdf, Bsdf::Mix { first, second, .. } if part(first) || part(second))
    }

    /// The textures that it reads, by index.
    pub(crate) fn textures(&self) -> Vec<u32> {
        let mut copy = self.clone();
        let slots = copy.textures_mut();
        slots.iter().map(Slot::texture).collect()
    }

    /// Whether images vary what it does with light.
    #[must_use]
    pub(crate) fn is_varied(&self) -> bool {
        let mut slots = Vec::new();
        let mut bsdf = self.bsdf.clone();
        bsdf.textures_mut(&mut slots);
        let mixture = matches!(self.bsdf, Bsdf::Mix { .. });
        self.normal_map.is_some() || (!mixture && !slots.is_empty())
    }

    /// The places where it reads a texture.
    pub(in crate::scene) fn textures_mut(&mut self) -> Vec<Slot<'_>> {
        let mut all = Vec::new();
        self.bsdf.textures_mut(&mut all);
        value(&mut all, "emission", &mut self.emission, false);
        if let Some(alpha) = &mut self.alpha {
            value(&mut all, "opacity", &mut alpha.opacity, true);
        }
        if self.normal_map.is_some() {
            all.push(Slot::Relief(&mut self.normal_map));
        }
        all
    }
}

impl Bsdf {
    fn textures_mut<'a>(&'a mut self, all: &mut Vec<Slot<'a>>) {
        match self {
            Bsdf::Diffuse { reflectance, .. } => value(all, "albedo", reflectance, true),
            Bsdf::Conductor {
                tint, roughness, ..
            } => {
                value(all, "tint", tint, true);
                value(all, "roughness", roughness, true);
            }
            Bsdf::Dielectric(d) => {
                value(all, "roughness", &mut d.roughness, true);
                value(all, "reflection tint", &mut d.reflection_tint, true);
                value(all, "transmission tint", &mut d.transmission_tint, true);
            }
            Bsdf::Principled(p) => {
                value(all, "base colour", &mut p.base_color, true);
                value(all, "metallic", &mut p.metallic, true);
                value(all, "roughness", &mut p.roughness, true);
                value(all, "specular", &mut p.specular, true);
                value(all, "specular colour", &mut p.specular_color, false);
                value(all, "transmission", &mut p.transmission, true);
                value(all, "clear coat", &mut p.clearcoat, true);
                value(
                    all,
                    "clear coat's roughness",
                    &mut p.clearcoat_roughness,
                    true,
                );
                value(all, "sheen", &mut p.sheen_color, true);
                value(all, "sheen's roughness", &mut p.sheen_roughness, true);
            }
            Bsdf::Mix { amount, .. } => value(all, "amount", amount, true),
        }
    }
}
