//! From what a scene file says of its materials to those of the compiled scene. Textures are checked
//! as far as their headers tell; in [`TextureUse::texture`] stands their place in
//! [`Surfaces::wanted`] until they are loaded.

use super::glass;
use super::images::{Images, Wanted};
use super::said::{self, Kind};
use crate::scene::error::SceneError;
use crate::scene::material::{Alpha, Bsdf, Dielectric, Material, NormalMap, Principled, Relief};
use crate::scene::toml::{SceneFile, suggest};
use huygens_kernels::bsdf::fresnel::METALS;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;

/// Names of [`METALS`] in scene files, in their order.
const METAL_NAMES: [&str; 5] = ["gold", "silver", "copper", "aluminium", "iron"];

/// Reflectance of what no file describes.
const GREY: [f32; 3] = [0.5; 3];

/// The materials that a scene file names, in the order of their names.
#[derive(Debug, Default)]
pub(in crate::scene) struct Surfaces {
    pub(in crate::scene) materials: Vec<Material>,
    /// Textures that they read.
    pub(in crate::scene) wanted: Vec<Wanted>,
    /// What was out of range and could be limited.
    pub(in crate::scene) warnings: Vec<String>,
}

/// Compiles the materials of a scene file, whose media have these names.
///
/// # Errors
/// Keys that the kind has no use for, values that no surface has, unknown names, textures that are
/// not there.
pub(in crate::scene) fn compile(
    file: &SceneFile,
    said: &BTreeMap<String, Spanned<said::Material>>,
    media: &[&str],
) -> Result<Surfaces, SceneError> {
    let names: Vec<&str> = said.keys().map(String::as_str).collect();
    let mut images = Images::new(file);
    let mut materials = Vec::new();
    for (name, said) in said {
        let mut compiler = Compiler {
            file,
            names: &names,
            media,
            images: &mut images,
            span: said.span(),
        };
        materials.push(compiler.material(name, said.get_ref())?);
    }
    for (at, said) in said.values().enumerate() {
        if holds_itself(&materials, at, at, 0) {
            let message = "the mixture holds itself, expected other materials";
            return Err(file.error(said.span(), message));
        }
    }
    Ok(Surfaces {
        materials,
        wanted: images.wanted,
        warnings: images.warnings,
    })
}

/// Whether `sought` is a part of the mixture `at`, however deep.
fn holds_itself(materials: &[Material], sought: usize, at: usize, depth: usize) -> bool {
    match materials[at].bsdf {
        // A chain longer than there are materials goes round somewhere.
        Bsdf::Mix { first, second, .. } => [first, second].into_iter().any(|part| {
            part as usize == sought
                || depth >= materials.len()
                || holds_itself(materials, sought, part as usize, depth + 1)
        }),
        _ => false,
    }
}

struct Compiler<'a, 'f> {
    file: &'f SceneFile,
    names: &'a [&'a str],
    /// Names of media.
    media: &'a [&'a str],
    images: &'a mut Images<'f>,
    /// Of the material.
    span: Range<usize>,
}

impl Compiler<'_, '_> {
    fn material(&mut self, name: &str, m: &said::Material) -> Result<Material, SceneError> {
        let kind = m.kind.as_ref().map_or(Kind::Diffuse, |k| *k.get_ref());
        nothing_needless(self.file, m, kind)?;
        let bsdf = match kind {
            Kind::Diffuse => Bsdf::Diffuse {
                reflectance: self.images.value(&m.albedo, GREY)?,
                roughness: self.plain_roughness(m)?,
            },
            Kind::Conductor => self.conductor(m)?,
            Kind::Dielectric => Bsdf::Dielectric(Box::new(self.dielectric(m)?)),
            Kind::Principled => Bsdf::Principled(Box::new(self.principled(m)?)),
            Kind::Mix => self.mix(m)?,
        };
        let mut emission = self.images.value(&m.emission, [0.0; 3])?;
        if let Some(strength) = &m.emission_strength {
            let Some(said) = &m.emission else {
                let message = "multiplies `emission`, which is not there";
                return Err(self.file.error(strength.span(), message));
            };
            emission.factor = emission.factor.map(|c| c * strength.get_ref().0 as f32);
            if emission.factor.iter().any(|c| !c.is_finite()) {
                let message = "with its strength is beyond 32-bit floats";
                return Err(self.file.error(said.span(), message));
            }
        }
        Ok(Material {
            name: name.to_owned(),
            bsdf,
            emission,
            two_sided: m.two_sided,
            alpha: self.alpha(m)?,
            normal_map: self.relief(m)?,
            compensation: m.compensation.as_ref().is_none_or(|x| *x.get_ref()),
        })
    }

    fn alpha(&mut self, m: &said::Material) -> Result<Option<Alpha>, SceneError> {
        let cutoff = m.alpha_cutoff.as_ref();
        if m.alpha.is_none() {
            let message = "cuts `alpha`, which is not there";
            return match cutoff {
                Some(cutoff) => Err(self.file.error(cutoff.span(), message)),
                None => Ok(None),
            };
        }
        Ok(Some(Alpha {
            opacity: self.images.opacity(&m.alpha)?,
            cutoff: cutoff.map(|c| c.get_ref().0 as f32),
        }))
    }

    fn relief(&mut self, m: &said::Material) -> Result<Option<NormalMap>, SceneError> {
        let (image, kind) = match (&m.normal_map, &m.bump_map) {
            (None, None) => return Ok(None),
            (Some(image), None) => (image, Relief::Normals),
            (None, Some(image)) => (image, Relief::Bump),
            (Some(_), Some(bump)) => {
                let message = "found both `normal_map` and `bump_map`, expected one";
                return Err(self.file.error(bump.span(), message));
            }
        };
        let strength = image.get_ref().strength.as_ref();
        Ok(Some(NormalMap {
            texture: self.images.relief(image.get_ref(), kind)?,
            kind,
            strength: strength.map_or(1.0, |s| s.get_ref().0 as f32),
        }))
    }

    /// The roughness of a diffuse surface, which no texture varies.
    fn plain_roughness(&mut self, m: &said::Material) -> Result<f32, SceneError> {
        let value = self.images.roughness(&m.roughness, 0.0)?;
        match (&m.roughness, value.texture) {
            (Some(said), Some(_)) => {
                let message = "of a diffuse surface: found an image, expected a number";
                Err(self.file.error(said.span(), message))
            }
            _ => Ok(value.factor),
        }
    }

    fn conductor(&mut self, m: &said::Material) -> Result<Bsdf, SceneError> {
        let (eta, k) = match (&m.metal, &m.eta, &m.k) {
            (Some(metal), None, None) => {
                let found = METAL_NAMES.iter().position(|n| n == metal.get_ref());
                let Some(found) = found else {
                    let hint = suggest(metal.get_ref(), &METAL_NAMES);
                    let message = format!("no metal `{}`, {hint}", metal.get_ref());
                    return Err(self.file.error(metal.span(), message));
                };
                (METALS[found].eta, METALS[found].k)
            }
            (None, Some(eta), Some(k)) => (
                numbers(eta.get_ref().0.map(|c| c.0)),
                numbers(k.get_ref().0.map(|c| c.0)),
            ),
            _ => {
                let message = "a conductor needs either `metal` or `eta` and `k`";
                return Err(self.file.error(self.span.clone(), message));
            }
        };
        let anisotropy = match &m.anisotropy {
            Some(said) => self.images.limited(said, -1.0, 1.0),
            None => 0.0,
        };
        Ok(Bsdf::Conductor {
            eta,
            k,
            tint: self.images.value(&m.tint, [1.0; 3])?,
            roughness: self.images.roughness(&m.roughness, 0.0)?,
            anisotropy,
        })
    }

    fn dielectric(&mut self, m: &said::Material) -> Result<Dielectric, SceneError> {
        let (ior, dispersion) = glass::index(self.file, m, Dielectric::default().ior)?;
        let [interior, exterior] = glass::beside(self.file, self.media, m)?;
        Ok(Dielectric {
            ior,
            roughness: self.images.roughness(&m.roughness, 0.0)?,
            thin: m.thin.as_ref().is_some_and(|x| *x.get_ref()),
            reflection_tint: self.images.value(&m.reflection_tint, [1.0; 3])?,
            transmission_tint: self.images.value(&m.transmission_tint, [1.0; 3])?,
            dispersion,
            interior,
            exterior,
        })
    }

    fn principled(&mut self, m: &said::Material) -> Result<Principled, SceneError> {
        let default = Principled::default();
        let (ior, dispersion) = glass::index(self.file, m, default.ior)?;
        let [interior, exterior] = glass::beside(self.file, self.media, m)?;
        let images = &mut *self.images;
        let principled = Principled {
            base_color: images.value(&m.base_color, default.base_color.factor)?,
            metallic: images.value(&m.metallic, 0.0)?,
            roughness: images.roughness(&m.roughness, default.roughness.factor)?,
            ior,
            specular: images.value(&m.specular, 1.0)?,
            specular_color: images.value(&m.specular_color, [1.0; 3])?,
            transmission: images.value(&m.transmission, 0.0)?,
            thin: m.thin.as_ref().is_some_and(|x| *x.get_ref()),
            dispersion,
            interior,
            exterior,
            clearcoat: images.value(&m.clearcoat, 0.0)?,
            clearcoat_roughness: images.roughness(&m.clearcoat_roughness, 0.0)?,
            sheen_color: images.value(&m.sheen_color, [0.0; 3])?,
            sheen_roughness: images.roughness(&m.sheen_roughness, 0.0)?,
        };
        glass::fits(self.file, m, &principled)?;
        Ok(principled)
    }

    fn mix(&mut self, m: &said::Material) -> Result<Bsdf, SceneError> {
        let Some(parts) = &m.materials else {
            let message = "a mixture needs `materials`, the names of two";
            return Err(self.file.error(self.span.clone(), message));
        };
        let lookup = |name: &Spanned<String>| {
            let found = self.names.iter().position(|n| n == name.get_ref());
            found.map(|i| i as u32).ok_or_else(|| {
                let hint = suggest(name.get_ref(), self.names);
                let message = format!("no material `{}`, {hint}", name.get_ref());
                self.file.error(name.span(), message)
            })
        };
        let [first, second] = parts.get_ref();
        let (first, second) = (lookup(first)?, lookup(second)?);
        Ok(Bsdf::Mix {
            first,
            second,
            amount: self.images.value(&m.amount, 0.5)?,
        })
    }
}

impl Kind {
    fn word(self) -> &'static str {
        match self {
            Self::Diffuse => "diffuse",
            Self::Conductor => "conductor",
            Self::Dielectric => "dielectric",
            Self::Principled => "principled",
            Self::Mix => "mix",
        }
    }
}

fn numbers(x: [f64; 3]) -> [f32; 3] {
    x.map(|c| c as f32)
}

/// An error about the first key that a material of this kind has no use for.
fn nothing_needless(file: &SceneFile, m: &said::Material, kind: Kind) -> Result<(), SceneError> {
    use Kind::{Conductor, Dielectric, Diffuse, Mix, Principled};
    macro_rules! keys {
        ($($key:ident: $kinds:expr),* $(,)?) => {
            [$((stringify!($key), m.$key.as_ref().map(Spanned::span), &$kinds as &[Kind])),*]
        };
    }
    let keys = keys! {
        normal_map: [Diffuse, Conductor, Dielectric, Principled],
        bump_map: [Diffuse, Conductor, Dielectric, Principled],
        albedo: [Diffuse],
        roughness: [Diffuse, Conductor, Dielectric, Principled],
        metal: [Conductor],
        eta: [Conductor],
        k: [Conductor],
        tint: [Conductor],
        anisotropy: [Conductor],
        ior: [Dielectric, Principled],
        thin: [Dielectric, Principled],
        reflection_tint: [Dielectric],
        transmission_tint: [Dielectric],
        abbe: [Dielectric, Principled],
        cauchy: [Dielectric, Principled],
        sellmeier: [Dielectric, Principled],
        interior: [Dielectric, Principled],
        exterior: [Dielectric, Principled],
        base_color: [Principled],
        metallic: [Principled],
        specular: [Principled],
        specular_color: [Principled],
        transmission: [Principled],
        clearcoat: [Principled],
        clearcoat_roughness: [Principled],
        sheen_color: [Principled],
        sheen_roughness: [Principled],
        compensation: [Conductor, Dielectric, Principled],
        materials: [Mix],
        amount: [Mix],
    };
    for (key, span, kinds) in keys {
        if let (Some(span), false) = (span, kinds.contains(&kind)) {
            let of: Vec<String> = kinds.iter().map(|k| format!("`{}`", k.word())).collect();
            let message = format!(
                "`{key}` is for materials of kind {}, this one is `{}`",
                of.join(", "),
                kind.word()
            );
            return Err(file.error(span, message));
        }
    }
    Ok(())
}
