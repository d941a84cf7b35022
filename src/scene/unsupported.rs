//! What scenes may say that no kernel can render yet. Entries leave this list as kernels arrive; a
//! scene that asks for one is refused.

use super::compiled::Scene;
use super::material::{Bsdf, Material};
use crate::effects::{Effects, polished};

impl Scene {
    /// Why the scene cannot be rendered as it is meant, if so: what the first surface to blame asks
    /// for.
    #[must_use]
    pub fn unsupported(&self) -> Option<String> {
        if let Some(effect) = Effects::of(self, &self.settings).left_out() {
            return Some(format!(
                "calls for `{}` ({}), which this build leaves out: it has the feature `bare`",
                effect.name, effect.reason
            ));
        }
        self.spheres.iter().find_map(|sphere| {
            let m = &self.materials[sphere.material as usize];
            let what = if m.alpha.is_some() {
                "`alpha`"
            } else {
                m.emission_varies().then_some("an image of `emission`")?
            };
            Some(format!(
                "material `{}` has {what} and is worn by a sphere, which cannot be rendered yet",
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
    let again = material.disperses() && material.compensation;
    match &material.bsdf {
        // Albedos by quadrature, for every sample's wavelength anew.
        Bsdf::Dielectric(glass) if !polished(&glass.roughness) => {
            again.then_some("dispersion and roughness, with compensation")
        }
        Bsdf::Principled(_) => again.then_some("dispersion, with compensation"),
        Bsdf::Conductor { roughness, .. } if roughness.texture.is_some() => material
            .compensation
            .then_some("a metal's textured roughness, with compensation"),
        _ => None,
    }
}
