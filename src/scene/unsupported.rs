//! What scenes may say that no kernel can render yet. Entries leave this list as kernels arrive: a
//! native scene that asks for one is refused; a material of an MTL file goes without it, with a
//! warning.

use super::compiled::Scene;
use super::import::Imported;
use super::material::{Bsdf, Material};
use crate::effects::polished;

impl Scene {
    /// Why the scene cannot be rendered as it is meant, if so: what the first surface to blame asks
    /// for.
    #[must_use]
    pub fn unsupported(&self) -> Option<String> {
        let mut all = self.materials.iter().zip(self.worn());
        all.find_map(|(m, worn)| {
            let what = lacking(m).filter(|_| worn)?;
            Some(format!(
                "material `{}` has {what}, which cannot be rendered yet",
                m.name
            ))
        })
    }

    /// Why the reference tracer would give another image than the wave, if so.
    #[must_use]
    pub fn beyond_reference(&self) -> Option<String> {
        let mut all = self.materials.iter().zip(self.worn());
        all.find_map(|(m, worn)| {
            let what = unknown(m).filter(|_| worn)?;
            let name = &m.name;
            Some(format!(
                "material `{name}` has {what}, which the reference tracer does not know"
            ))
        })
    }
}

/// What a material has that the reference tracer does not know.
fn unknown(material: &Material) -> Option<&'static str> {
    match &material.bsdf {
        Bsdf::Dielectric(glass) if glass.disperses() && !polished(&glass.roughness) => {
            Some("dispersion and roughness")
        }
        Bsdf::Dielectric(glass) if glass.interior.is_some() => Some("a medium inside"),
        Bsdf::Conductor { roughness, .. } if roughness.texture.is_some() => material
            .compensation
            .then_some("a metal's textured roughness, with compensation"),
        _ => None,
    }
}

/// What a material asks for and no kernel can do: an opacity, images.
fn lacking(material: &Material) -> Option<String> {
    let alpha = material.alpha.map(|_| "`alpha`".to_owned());
    alpha.or_else(|| {
        let mut copy = material.clone();
        let slots = copy.textures_mut();
        slots
            .first()
            .map(|slot| format!("a textured {}", slot.what()))
    })
}

/// Takes away what a file of geometry asks for and cannot be rendered yet.
pub(super) fn stand_in(imported: &mut Imported, file: &std::path::Path) {
    let mut removed: Vec<(String, Vec<String>)> = Vec::new();
    for material in &mut imported.materials {
        let mut lacks = Vec::new();
        if material.alpha.take().is_some() {
            lacks.push("opacity");
        }
        for mut slot in material.textures_mut() {
            lacks.push(slot.what());
            slot.remove();
        }
        for what in lacks {
            let name = material.name.clone();
            match removed.iter_mut().find(|(known, _)| known == what) {
                Some((_, names)) => names.push(name),
                None => removed.push((what.to_owned(), vec![name])),
            }
        }
    }
    for (what, names) in removed {
        let more = match names.len() {
            1 => String::new(),
            n => format!(" and {} more", n - 1),
        };
        imported.warnings.push(format!(
            "{}: images of {what} cannot be rendered yet; left out (material `{}`{more})",
            file.display(),
            names[0]
        ));
    }
}
