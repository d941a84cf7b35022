//! Media, what is filled with them, and lights in them.

use huygens::scene::material::Dielectric;
use huygens::scene::{Bsdf, Fog, Light, LightKind, Medium, Scene};

pub(crate) fn medium(absorption: [f32; 3], scattering: [f32; 3], g: f32) -> Medium {
    Medium {
        name: "medium".into(),
        absorption,
        scattering,
        g,
    }
}

pub(crate) fn fill(scene: &mut Scene, medium: Medium, bounds: Option<[[f32; 3]; 2]>) {
    scene.media = vec![medium];
    scene.fog = Some(Fog { medium: 0, bounds });
}

pub(crate) fn glass(ior: f32, roughness: f32, interior: Option<u32>) -> Bsdf {
    Bsdf::Dielectric(Box::new(Dielectric {
        ior,
        roughness: roughness.into(),
        interior,
        ..Dielectric::default()
    }))
}

pub(crate) fn light(kind: LightKind) -> Light {
    let name = "test".to_owned();
    Light { name, kind }
}
