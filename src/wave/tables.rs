//! From a compiled scene to the tables that kernels read.

use super::images::ImageTables;
use super::lights::LightTables;
use super::media::MediaTables;
use super::parameters::Parameters;
use crate::effects;
use crate::geometry::Geometry;
use crate::scene::{Mesh, Scene, Sphere};
use crate::settings::Settings;
use huygens_kernels::interpolate::Attributes;
use huygens_kernels::opacity::{Coordinates, Opacities};
use huygens_kernels::others::{Object, Others};
use huygens_kernels::tables::{Materials, SLOTS, Tables, Triangles};
use huygens_kernels::texture::Textures;

/// Material columns and light tables.
#[derive(Debug, Default)]
pub(crate) struct SceneTables<'a> {
    albedo: [Vec<f32>; 3],
    parameters: [Vec<f32>; SLOTS],
    emission: [Vec<f32>; 3],
    two_sided: Vec<u32>,
    pub(crate) lights: LightTables,
    objects: Vec<Object<'a>>,
    sphere_material: Vec<u32>,
    /// Empty where no sphere was turned.
    sphere_turns: Vec<[[f32; 3]; 3]>,
    /// Where materials read images.
    images: Option<ImageTables<'a>>,
    media: Option<MediaTables>,
}

impl<'a> SceneTables<'a> {
    /// The tables of `scene`; of `settings`, how lights are sampled and images read.
    pub(crate) fn new(scene: &'a Scene, settings: &Settings) -> Self {
        let mut tables = Self {
            lights: LightTables::new(scene, settings),
            images: ImageTables::new(scene, settings.texture_lod),
            media: effects::has_media(scene, settings).then(|| MediaTables::new(scene)),
            ..Self::default()
        };
        tables.others(scene);
        for m in &scene.materials {
            let albedo = m.albedo(&scene.materials);
            for c in 0..3 {
                tables.albedo[c].push(albedo[c]);
                tables.emission[c].push(m.emission.factor[c]);
            }
            for (column, value) in tables.parameters.iter_mut().zip(Parameters::of(m).slots) {
                column.push(value);
            }
            tables
                .two_sided
                .push(if m.two_sided { u32::MAX } else { 0 });
        }
        tables
    }

    /// What is no triangle of the world, for shading.
    fn others(&mut self, scene: &'a Scene) {
        let object = |o: &'a crate::scene::Object| Object {
            vertices: &o.mesh.vertices,
            indices: &o.mesh.indices,
            material: &o.mesh.material,
            attributes: attributes(&o.mesh),
        };
        self.objects = scene.objects.iter().map(object).collect();
        self.sphere_material = scene.spheres.iter().map(|s| s.material).collect();
        if scene.spheres.iter().any(|s| s.turn != Sphere::UPRIGHT) {
            self.sphere_turns = scene.spheres.iter().map(|s| s.turn).collect();
        }
    }

    fn view_of_others(&'a self, scene: &'a Scene, geometry: &'a Geometry) -> Option<Others<'a>> {
        if scene.spheres.is_empty() && scene.instances.is_empty() {
            return None;
        }
        let (instances, guide) = geometry.instances();
        Some(Others {
            first: scene.mesh.triangles() as u32,
            spheres: geometry.spheres(),
            sphere_material: &self.sphere_material,
            sphere_turns: &self.sphere_turns,
            sphere_selection: &self.lights.sphere_selection,
            instances,
            motions: geometry.motions(),
            guide: guide?,
            objects: &self.objects,
        })
    }

    /// What traversals ask, where some material is not wholly there.
    pub(crate) fn opacities(
        &'a self,
        scene: &'a Scene,
        geometry: &'a Geometry,
        seed: u32,
    ) -> Option<Opacities<'a>> {
        let coordinates = self.coordinates(scene, geometry);
        self.images.as_ref()?.opacities(coordinates, seed)
    }

    /// Where single hits are in texture coordinates.
    pub(crate) fn coordinates(
        &'a self,
        scene: &'a Scene,
        geometry: &'a Geometry,
    ) -> Coordinates<'a> {
        Coordinates {
            triangles: self.view(scene, geometry).triangles,
            attributes: attributes(&scene.mesh),
        }
    }

    /// What shares of mixtures read.
    pub(crate) fn amounts(&self) -> Option<(Textures<'_>, &[u32])> {
        self.images.as_ref().map(ImageTables::amounts)
    }

    fn view_of_attributes(&self, scene: &'a Scene) -> Option<Attributes<'a>> {
        let read = scene.has_normals() || self.images.is_some() || scene.is_brushed().is_some();
        read.then_some(attributes(&scene.mesh))
    }

    /// The view that kernels take.
    pub(crate) fn view(&'a self, scene: &'a Scene, geometry: &'a Geometry) -> Tables<'a> {
        let columns = |c: &'a [Vec<f32>; 3]| [&c[0][..], &c[1], &c[2]];
        Tables {
            triangles: Triangles {
                vertices: &scene.mesh.vertices,
                indices: &scene.mesh.indices,
                material: &scene.mesh.material,
                others: self.view_of_others(scene, geometry),
            },
            materials: Materials {
                albedo: columns(&self.albedo),
                parameters: self.parameters.each_ref().map(|column| &column[..]),
                emission: columns(&self.emission),
                two_sided: &self.two_sided,
                area_pdf: &self.lights.area_pdf,
            },
            lights: self.lights.view(scene),
            attributes: self.view_of_attributes(scene),
            images: self.images.as_ref().map(ImageTables::view),
            media: self.media.as_ref().map(MediaTables::view),
        }
    }
}

/// What a mesh's vertices carry.
pub(crate) fn attributes(mesh: &Mesh) -> Attributes<'_> {
    Attributes {
        normals: &mesh.normals,
        uvs: &mesh.uvs,
    }
}

/// Relative luminance of linear Rec. 709; never 0 for a colour that is not black.
pub(crate) fn luminance(c: [f32; 3]) -> f64 {
    0.2126 * f64::from(c[0]) + 0.7152 * f64::from(c[1]) + 0.0722 * f64::from(c[2])
}

/// Diagonal of the box around everything; 0 around nothing.
pub(crate) fn diagonal(scene: &Scene) -> f64 {
    let bounds = scene.bounds();
    bounds.map_or(0.0, |[low, high]| (high - low).length())
}

/// Area of a triangle.
pub(crate) fn area([a, b, c]: [[f32; 3]; 3]) -> f64 {
    let v = |p: [f32; 3]| glam::DVec3::from_array(p.map(f64::from));
    0.5 * (v(b) - v(a)).cross(v(c) - v(a)).length()
}

/// Vose's alias table for weights >= 0: (probability to keep entry `i`, what it stands for
/// otherwise). Empty for no weights.
pub(crate) fn alias_table(weights: &[f64]) -> (Vec<f32>, Vec<u32>) {
    let n = weights.len();
    let total: f64 = weights.iter().sum();
    let mut scaled: Vec<f64> = weights.iter().map(|w| w / total * n as f64).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| scaled[i] < 1.0);
    let mut keep = vec![1.0f32; n];
    let mut alias: Vec<u32> = (0..n as u32).collect();
    while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
        small.pop();
        keep[s] = scaled[s] as f32;
        alias[s] = l as u32;
        scaled[l] -= 1.0 - scaled[s];
        if scaled[l] < 1.0 {
            large.pop();
            small.push(l);
        }
    }
    // What is left is 1 up to rounding.
    (keep, alias)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_alias_table_gives_each_entry_its_weight() {
        for weights in [
            vec![1.0],
            vec![1.0, 3.0],
            vec![0.0, 5.0, 1e-9, 2.0, 2.0, 1e6],
        ] {
            let (keep, alias) = alias_table(&weights);
            let n = weights.len();
            let mut got = vec![0.0; n];
            for i in 0..n {
                got[i] += f64::from(keep[i]) / n as f64;
                got[alias[i] as usize] += (1.0 - f64::from(keep[i])) / n as f64;
            }
            let total: f64 = weights.iter().sum();
            for (w, g) in weights.iter().zip(got) {
                // Each of at most n entries rounds its probability to f32 once.
                assert!(
                    (w / total - g).abs() <= f64::from(f32::EPSILON),
                    "{weights:?}"
                );
            }
        }
    }
}
