//! What takes an effect away from a scene.

use huygens::scene::{Bsdf, Projection, Scene, Sky, Textured};
use huygens::settings::LightSelection;

/// No glass disperses: its index is that at the d line.
pub(crate) fn one_index(scene: &mut Scene) {
    for material in &mut scene.materials {
        if let Bsdf::Dielectric(glass) = &mut material.bsdf {
            glass.dispersion = None;
        }
    }
}

pub(crate) fn pinhole(scene: &mut Scene) {
    if let Projection::Perspective { lens, .. } = &mut scene.camera.projection {
        *lens = None;
    }
}

pub(crate) fn no_fog(scene: &mut Scene) {
    scene.fog = None;
}

pub(crate) fn clear_air(scene: &mut Scene) {
    no_fog(scene);
    for material in &mut scene.materials {
        if let Bsdf::Dielectric(glass) = &mut material.bsdf {
            glass.interior = None;
        }
    }
}

/// All stands where it is half-way.
pub(crate) fn freeze(scene: &mut Scene) {
    *scene = scene.frozen(0.5);
}

/// Colours and numbers are the means of their images.
pub(crate) fn paint(scene: &mut Scene) {
    let textures = std::mem::take(&mut scene.textures);
    let colour = |value: &mut Textured<[f32; 3]>| *value = value.mean(&textures).into();
    let number = |value: &mut Textured<f32>| {
        let mean = value
            .texture
            .map(|read| textures[read.texture as usize].mean());
        *value = (value.factor * mean.map_or(1.0, |mean| mean[0])).into();
    };
    for material in &mut scene.materials {
        match &mut material.bsdf {
            Bsdf::Diffuse { reflectance, .. } => colour(reflectance),
            Bsdf::Principled(p) => {
                colour(&mut p.base_color);
                number(&mut p.roughness);
            }
            _ => {}
        }
    }
    scene.textures = textures;
}

pub(crate) fn flatten(scene: &mut Scene) {
    scene.materials.iter_mut().for_each(|m| m.normal_map = None);
}

pub(crate) fn whole(scene: &mut Scene) {
    scene.materials.iter_mut().for_each(|m| m.alpha = None);
}

/// Lamps shine with the means of their images.
pub(crate) fn even_lamps(scene: &mut Scene) {
    for material in &mut scene.materials {
        material.emission = material.emission.mean(&scene.textures).into();
    }
}

pub(crate) fn scatter_once(scene: &mut Scene) {
    for material in &mut scene.materials {
        material.compensation = false;
    }
}

pub(crate) fn even_sky(scene: &mut Scene) {
    if let Some(sky) = &mut scene.sky {
        let mean = sky.mean();
        *sky = Sky::Gradient {
            zenith: mean,
            nadir: mean,
        };
    }
}

/// No normals are interpolated.
pub(crate) fn facets(scene: &mut Scene) {
    let objects = scene.objects.iter_mut().map(|object| &mut object.mesh);
    objects
        .chain([&mut scene.mesh])
        .for_each(|mesh| mesh.normals.clear());
}

pub(crate) fn by_power(scene: &mut Scene) {
    scene.settings.light_selection = LightSelection::Power;
}

pub(crate) fn uniformly(scene: &mut Scene) {
    scene.settings.light_selection = LightSelection::Uniform;
}
