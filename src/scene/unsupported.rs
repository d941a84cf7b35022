//! What scenes may say that no kernel can render yet. Entries leave this list as kernels arrive: a
//! native scene that asks for one is refused; a material of an MTL file goes without it, with a
//! warning.

use super::compiled::Scene;
use super::import::Imported;
use super::material::{Bsdf, Material};

impl Scene {
    /// Why the scene cannot be rendered as it is meant, if so: what the first surface to blame asks
    /// for.
    #[must_use]
    pub fn unsupported(&self) -> Option<String> {
        let mut all = self.materials.iter().zip(self.worn());
        let lacking = all.find_map(|(m, worn)| {
            let what = lacking(m).filter(|_| worn)?;
            Some(format!(
                "material `{}` has {what}, which cannot be rendered yet",
                m.name
            ))
        });
        lacking.or_else(|| {
            let spheres = self.spheres.iter().map(|s| s.material);
            let copies = self.instances.iter().flat_map(|i| {
                let own = &self.objects[i.object as usize].mesh.material;
                i.material
                    .iter()
                    .chain(own.iter().filter(|_| i.material.is_none()))
            });
            let mut placed = spheres.chain(copies.copied());
            let varied =
                placed.find(|&m| self.materials[m as usize].reads_textures(&self.materials))?;
            Some(format!(
                "material `{}` has images or `alpha` and is worn by a sphere or an instance, which cannot be \
                 rendered yet",
                self.materials[varied as usize].name
            ))
        })
    }

    /// Why the reference tracer would give another image than the wave, if so: it knows Lambertian
    /// surfaces alone.
    #[must_use]
    pub fn beyond_reference(&self) -> Option<String> {
        let matt = |m: &Material| matches!(m.bsdf, Bsdf::Diffuse { roughness: 0.0, .. });
        let mut all = self.materials.iter().zip(self.worn());
        let (Material { name, .. }, _) = all.find(|(m, worn)| *worn && !matt(m))?;
        Some(format!(
            "material `{name}` is not Lambertian, and the reference tracer knows no other surfaces"
        ))
    }
}

/// What a material asks for and no kernel can do: an opacity of what emits, some images.
fn lacking(material: &Material) -> Option<String> {
    let alpha = material.alpha.filter(|_| material.emits());
    let alpha = alpha.map(|_| "`alpha` and `emission`".to_owned());
    alpha.or_else(|| {
        let mut copy = material.clone();
        let slots = copy.textures_mut();
        let slot = slots.iter().find(|slot| is_lacking(slot.what()));
        slot.map(|slot| format!("a textured {}", slot.what()))
    })
}

fn is_lacking(slot: &str) -> bool {
    matches!(slot, "emission" | "amount")
}

/// Takes away what a file of geometry asks for and cannot be rendered yet.
pub(super) fn stand_in(imported: &mut Imported, file: &std::path::Path) {
    let mut removed: Vec<(String, Vec<String>)> = Vec::new();
    for material in &mut imported.materials {
        let mut lacks = Vec::new();
        if material.emits() && material.alpha.take().is_some() {
            lacks.push("opacity of what emits");
        }
        for mut slot in material.textures_mut() {
            if !is_lacking(slot.what()) {
                continue;
            }
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
            "{}: {what} cannot be rendered yet; left out (material `{}`{more})",
            file.display(),
            names[0]
        ));
    }
}
