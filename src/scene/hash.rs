//! The identity of a scene: two files of one hash give one image for equal settings.

use super::compiled::{Extent, Filter, Projection, Scene};
use super::light::{LightKind, Sky};
use super::material::{Bsdf, Material, Textured};
use super::placed::Sphere;

/// BLAKE3 of the tables that the image depends on, in a fixed order, each with its length. Names,
/// warnings and settings have no part in it.
pub(super) fn of(scene: &Scene) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    let mut table = |bytes: &[u8]| {
        hasher.update(&(bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    };
    table(b"huygens scene 1");
    let c = &scene.camera;
    table(bytemuck::cast_slice(&[c.origin, c.forward, c.right, c.up]));
    // Kinds are told apart by the lengths of their first tables: 8, 16, 12 and 15 bytes.
    let halves = |e: Extent| [e.half_width, e.half_height];
    match c.projection {
        Projection::Perspective { extent, lens: None } => {
            table(bytemuck::cast_slice(&halves(extent)));
        }
        Projection::Perspective {
            extent,
            lens: Some(lens),
        } => table(bytemuck::cast_slice(&[
            halves(extent),
            [lens.radius, lens.focus],
        ])),
        Projection::Orthographic { extent } => {
            table(b"orthographic");
            table(bytemuck::cast_slice(&halves(extent)));
        }
        Projection::Panorama => table(b"equirectangular"),
    }
    if let Some(motion) = &scene.camera_motion {
        table(format!("{motion:?}").as_bytes());
    }
    let filter = match scene.film.filter {
        Filter::Box => 0,
        Filter::Tent => 1,
        Filter::Gaussian => 2,
        Filter::BlackmanHarris => 3u32,
    };
    table(bytemuck::cast_slice(&[
        scene.film.width,
        scene.film.height,
        filter,
    ]));
    table(bytemuck::cast_slice(&scene.mesh.vertices));
    table(bytemuck::cast_slice(&scene.mesh.indices));
    table(bytemuck::cast_slice(&scene.mesh.material));
    if !scene.mesh.normals.is_empty() || !scene.mesh.uvs.is_empty() {
        table(b"attributes");
        table(bytemuck::cast_slice(&scene.mesh.normals));
        table(bytemuck::cast_slice(&scene.mesh.uvs));
    }
    if !scene.spheres.is_empty() || !scene.instances.is_empty() {
        table(b"placed");
        for s in &scene.spheres {
            let [x, y, z] = s.centre;
            table(bytemuck::cast_slice(&[x, y, z, s.radius]));
            table(&s.material.to_le_bytes());
            if s.turn != Sphere::UPRIGHT {
                table(bytemuck::cast_slice(&s.turn));
            }
        }
        for object in &scene.objects {
            let mesh = &object.mesh;
            table(bytemuck::cast_slice(&mesh.vertices));
            table(bytemuck::cast_slice(&mesh.indices));
            table(bytemuck::cast_slice(&mesh.material));
            table(bytemuck::cast_slice(&mesh.normals));
            table(bytemuck::cast_slice(&mesh.uvs));
        }
        for instance in &scene.instances {
            table(bytemuck::cast_slice(&instance.placement.to_object));
            table(bytemuck::cast_slice(&instance.placement.origin));
            let worn = instance.material.map_or(0, |m| u64::from(m) + 1);
            table(bytemuck::cast_slice(&[u64::from(instance.object), worn]));
            if let Some(motion) = &instance.motion {
                table(format!("{motion:?}").as_bytes());
            }
        }
    }
    for material in &scene.materials {
        match plain(material) {
            Some(colours) => table(bytemuck::cast_slice(&colours)),
            // By this way no member is forgotten; numbers are written so that they read back alike.
            None => {
                let unnamed = Material {
                    name: String::new(),
                    ..material.clone()
                };
                table(format!("{unnamed:?}").as_bytes());
            }
        }
        table(&[u8::from(material.two_sided)]);
    }
    for texture in &scene.textures {
        let how = (texture.format, texture.srgb, &texture.levels);
        table(format!("{how:?}").as_bytes());
        table(bytemuck::cast_slice(&texture.words));
    }
    match &scene.sky {
        None => table(&[]),
        Some(Sky::Gradient { zenith, nadir }) => table(bytemuck::cast_slice(&[*zenith, *nadir])),
        Some(Sky::Map(map)) => {
            table(bytemuck::cast_slice(&[map.width, map.height]));
            table(bytemuck::cast_slice(&map.frame));
            table(bytemuck::cast_slice(&map.texels));
        }
    }
    if scene.fog.is_some() || !scene.media.is_empty() {
        table(b"media");
        for m in &scene.media {
            table(bytemuck::cast_slice(&[m.absorption, m.scattering]));
            table(&m.g.to_le_bytes());
        }
        table(format!("{:?}", scene.fog).as_bytes());
    }
    for light in &scene.lights {
        match light.kind {
            LightKind::Point {
                position,
                intensity,
                spot,
            } => {
                table(bytemuck::cast_slice(&[position, intensity]));
                if let Some(spot) = spot {
                    table(bytemuck::cast_slice(&spot.axis));
                    table(bytemuck::cast_slice(&[spot.dark, spot.full]));
                }
            }
            LightKind::Distant {
                from,
                irradiance,
                half_angle,
            } => {
                table(b"distant");
                table(bytemuck::cast_slice(&[from, irradiance]));
                table(&half_angle.to_le_bytes());
            }
        }
    }
    *hasher.finalize().as_bytes()
}

/// Reflectance and emission of a Lambertian material without textures.
fn plain(material: &Material) -> Option<[[f32; 3]; 2]> {
    match (&material.bsdf, material.emission) {
        (
            &Bsdf::Diffuse {
                reflectance:
                    Textured {
                        factor: reflectance,
                        texture: None,
                    },
                roughness: 0.0,
            },
            Textured {
                factor: emission,
                texture: None,
            },
        ) if material.alpha.is_none() && material.normal_map.is_none() => {
            Some([reflectance, emission])
        }
        _ => None,
    }
}
