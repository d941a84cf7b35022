//! What scenes may say that no kernel can render yet. Entries leave this list as kernels arrive: a
//! native scene that asks for one is refused, for a material of an MTL file a diffuse one stands in,
//! with a warning.

use super::compiled::Scene;
use super::import::Imported;
use super::material::{Bsdf, Material};

impl Scene {
    /// Why the scene cannot be rendered as it is meant, if so: what the first surface to blame asks
    /// for.
    #[must_use]
    pub fn unsupported(&self) -> Option<String> {
        let mut worn = vec![false; self.materials.len()];
        for &material in &self.mesh.material {
            worn[material as usize] = true;
        }
        let mut all = self.materials.iter().zip(worn);
        all.find_map(|(m, worn)| {
            let what = lacking(m).filter(|_| worn)?;
            Some(format!(
                "material `{}` has {what}, which cannot be rendered yet",
                m.name
            ))
        })
    }
}

fn lacking(material: &Material) -> Option<&'static str> {
    let kind = match &material.bsdf {
        Bsdf::Diffuse { reflectance, .. } => reflectance.texture.map(|_| "a textured `albedo`"),
        _ => None,
    };
    let emission = material.emission.texture.map(|_| "a textured `emission`");
    let alpha = material.alpha.map(|_| "`alpha`");
    let relief = material.normal_map.map(|_| "a normal or bump map");
    kind.or(emission).or(alpha).or(relief)
}

/// Puts diffuse surfaces in the place of what a file of geometry asks for and cannot be rendered yet.
pub(super) fn stand_in(imported: &mut Imported, file: &std::path::Path) {
    let mut replaced: Vec<(&'static str, Vec<String>)> = Vec::new();
    for (material, &matt) in imported.materials.iter_mut().zip(&imported.matt) {
        let Some(what) = lacking(material) else {
            continue;
        };
        match replaced.iter_mut().find(|(known, _)| *known == what) {
            Some((_, names)) => names.push(material.name.clone()),
            None => replaced.push((what, vec![material.name.clone()])),
        }
        let name = std::mem::take(&mut material.name);
        *material = Material::diffuse(name, matt, material.emission.factor);
    }
    for (what, names) in replaced {
        let more = match names.len() {
            1 => String::new(),
            n => format!(" and {} more", n - 1),
        };
        imported.warnings.push(format!(
            "{}: {what} cannot be rendered yet; taken as diffuse (material `{}`{more})",
            file.display(),
            names[0]
        ));
    }
    let mixed = |m: &Material| matches!(m.bsdf, Bsdf::Mix { .. });
    if !imported.materials.iter().any(mixed) {
        let worn = imported.materials.len() - std::mem::take(&mut imported.parts);
        imported.materials.truncate(worn);
    }
}
