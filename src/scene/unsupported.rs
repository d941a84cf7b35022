//! What scenes may say that no kernel can render yet. Entries leave this list as kernels arrive; a
//! scene that asks for one is refused.

use super::compiled::Scene;
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
        lacking.or_else(|| self.lacking_on_others())
    }

    /// What spheres and copies of objects cannot wear.
    fn lacking_on_others(&self) -> Option<String> {
        let spheres = self.spheres.iter().map(|s| s.material);
        let copies = self.instances.iter().flat_map(|i| {
            let own = &self.objects[i.object as usize].mesh.material;
            let own = own.iter().filter(|_| i.material.is_none());
            i.material.iter().chain(own)
        });
        let lacks = |m: &Material| m.alpha.is_some() || m.reads_textures(&self.materials);
        let mut placed = spheres.chain(copies.copied());
        let found = placed.find(|&m| lacks(&self.materials[m as usize]))?;
        Some(format!(
            "material `{}` has images or `alpha` and is worn by a sphere or an instance, which \
             cannot be rendered yet",
            self.materials[found as usize].name
        ))
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
        Bsdf::Dielectric(glass) if glass.abbe.is_some() => Some("an Abbe number"),
        Bsdf::Dielectric(glass) if glass.interior.is_some() => Some("a medium inside"),
        Bsdf::Conductor { roughness, .. } if roughness.texture.is_some() => material
            .compensation
            .then_some("a metal's textured roughness, with compensation"),
        _ => None,
    }
}

/// What a material asks for and no kernel can do: some images.
fn lacking(material: &Material) -> Option<String> {
    let mut copy = material.clone();
    let slots = copy.textures_mut();
    let slot = slots.iter().find(|slot| is_lacking(slot.what()));
    slot.map(|slot| format!("a textured {}", slot.what()))
}

fn is_lacking(slot: &str) -> bool {
    slot == "amount"
}
