//! What scenes may say that no kernel can render yet. Entries leave this list as kernels arrive.

use super::compiled::Scene;
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
        Bsdf::Conductor { .. } => Some("kind `conductor`"),
        Bsdf::Dielectric(_) => Some("kind `dielectric`"),
        Bsdf::Principled(_) => Some("kind `principled`"),
        Bsdf::Mix { .. } => Some("kind `mix`"),
    };
    let emission = material.emission.texture.map(|_| "a textured `emission`");
    let alpha = material.alpha.map(|_| "`alpha`");
    let relief = material.normal_map.map(|_| "a normal or bump map");
    kind.or(emission).or(alpha).or(relief)
}
