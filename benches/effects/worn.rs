//! What surfaces wear instead of paint.

use huygens::scene::material::{
    Alpha, Cauchy, Channel, Dielectric, Principled, TexelFilter, TextureUse, Wrap,
};
use huygens::scene::{Bsdf, Medium, Scene, Textured};
use huygens_kernels::bsdf::fresnel::METALS;

fn wear(scene: &mut Scene, material: usize, bsdf: Bsdf) {
    scene.materials[material].bsdf = bsdf;
}

fn reflectance(scene: &Scene, material: usize) -> Textured<[f32; 3]> {
    match &scene.materials[material].bsdf {
        Bsdf::Diffuse { reflectance, .. } => *reflectance,
        _ => [0.5; 3].into(),
    }
}

/// The same paint, by the passes of all other kinds: one of both parts of a mixture is always drawn.
pub(crate) fn diffuse(scene: &mut Scene, material: usize) {
    let own = scene.materials[material].clone();
    let part = scene.materials.len() as u32;
    scene.materials.push(own);
    let bsdf = Bsdf::Mix {
        first: part,
        second: part,
        amount: 0.0.into(),
    };
    wear(scene, material, bsdf);
}

pub(crate) fn rough_diffuse(scene: &mut Scene, material: usize) {
    let bsdf = Bsdf::Diffuse {
        reflectance: reflectance(scene, material),
        roughness: 0.6,
    };
    wear(scene, material, bsdf);
}

fn conductor(scene: &mut Scene, material: usize, roughness: f32, anisotropy: f32) {
    let bsdf = Bsdf::Conductor {
        eta: METALS[3].eta,
        k: METALS[3].k,
        tint: reflectance(scene, material),
        roughness: roughness.into(),
        anisotropy,
    };
    wear(scene, material, bsdf);
}

pub(crate) fn mirror(scene: &mut Scene, material: usize) {
    conductor(scene, material, 0.0, 0.0);
}

pub(crate) fn metal(scene: &mut Scene, material: usize) {
    conductor(scene, material, 0.5, 0.0);
}

pub(crate) fn brushed(scene: &mut Scene, material: usize) {
    conductor(scene, material, 0.5, 0.8);
}

fn glass(scene: &mut Scene, material: usize, glass: Dielectric) {
    wear(scene, material, Bsdf::Dielectric(Box::new(glass)));
}

pub(crate) fn pane(scene: &mut Scene, material: usize) {
    let pane = Dielectric {
        thin: true,
        ..Dielectric::default()
    };
    glass(scene, material, pane);
}

pub(crate) fn frosted_pane(scene: &mut Scene, material: usize) {
    let pane = Dielectric {
        thin: true,
        roughness: 0.5.into(),
        ..Dielectric::default()
    };
    glass(scene, material, pane);
}

pub(crate) fn prism(scene: &mut Scene, material: usize) {
    let prism = Dielectric {
        dispersion: Some(Cauchy::from_abbe(1.5, 40.0)),
        ..Dielectric::default()
    };
    glass(scene, material, prism);
}

pub(crate) fn filled(scene: &mut Scene, material: usize) {
    scene.media.push(Medium {
        name: "milk".to_owned(),
        absorption: [0.0; 3],
        scattering: [1.0; 3],
        g: 0.0,
    });
    let jar = Dielectric {
        interior: Some(scene.media.len() as u32 - 1),
        ..Dielectric::default()
    };
    glass(scene, material, jar);
}

pub(crate) fn principled(scene: &mut Scene, material: usize) {
    let coated = Principled {
        base_color: reflectance(scene, material),
        clearcoat: 0.5.into(),
        ..Principled::default()
    };
    wear(scene, material, Bsdf::Principled(Box::new(coated)));
}

/// Half paint, half rough metal.
pub(crate) fn mix(scene: &mut Scene, material: usize) {
    let first = scene.materials.len();
    let paint = scene.materials[material].clone();
    scene.materials.extend([paint.clone(), paint]);
    metal(scene, first + 1);
    let bsdf = Bsdf::Mix {
        first: first as u32,
        second: first as u32 + 1,
        amount: 0.5.into(),
    };
    wear(scene, material, bsdf);
}

pub(crate) fn cut(scene: &mut Scene, material: usize) {
    scene.materials[material].alpha = Some(Alpha {
        opacity: 0.7.into(),
        cutoff: Some(0.5),
    });
}

pub(crate) fn image(scene: &mut Scene, material: usize) {
    let mut other = crate::shipped("textures");
    scene.textures.push(other.textures.swap_remove(0));
    let read = TextureUse {
        texture: scene.textures.len() as u32 - 1,
        channel: Channel::Colour,
        uv: TextureUse::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        filter: TexelFilter::Linear,
    };
    let bsdf = Bsdf::Diffuse {
        reflectance: Textured {
            factor: [1.0; 3],
            texture: Some(read),
        },
        roughness: 0.0,
    };
    wear(scene, material, bsdf);
}
