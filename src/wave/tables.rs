//! From a compiled scene to the tables that kernels read.

use super::lights::LightTables;
use super::parameters::parameters;
use crate::scene::{Mesh, Scene};
use crate::settings::Settings;
use huygens_kernels::interpolate::Attributes;
use huygens_kernels::tables::{Materials, SLOTS, Tables, Triangles};

/// Material columns and light tables.
#[derive(Debug, Default)]
pub(crate) struct SceneTables {
    albedo: [Vec<f32>; 3],
    parameters: [Vec<f32>; SLOTS],
    emission: [Vec<f32>; 3],
    two_sided: Vec<u32>,
    pub(crate) lights: LightTables,
}

impl SceneTables {
    /// The tables of `scene`; of `settings`, how lights are sampled.
    pub(crate) fn new(scene: &Scene, settings: &Settings) -> Self {
        let mut tables = Self {
            lights: LightTables::new(scene, settings),
            ..Self::default()
        };
        for m in &scene.materials {
            let albedo = m.albedo(&scene.materials);
            for c in 0..3 {
                tables.albedo[c].push(albedo[c]);
                tables.emission[c].push(m.emission.factor[c]);
            }
            for (column, value) in tables.parameters.iter_mut().zip(parameters(m)) {
                column.push(value);
            }
            tables
                .two_sided
                .push(if m.two_sided { u32::MAX } else { 0 });
        }
        tables
    }

    /// The view that kernels take.
    pub(crate) fn view<'a>(&'a self, scene: &'a Scene) -> Tables<'a> {
        let columns = |c: &'a [Vec<f32>; 3]| [&c[0][..], &c[1], &c[2]];
        Tables {
            triangles: Triangles {
                vertices: &scene.mesh.vertices,
                indices: &scene.mesh.indices,
                material: &scene.mesh.material,
            },
            materials: Materials {
                albedo: columns(&self.albedo),
                parameters: self.parameters.each_ref().map(|column| &column[..]),
                emission: columns(&self.emission),
                two_sided: &self.two_sided,
                area_pdf: &self.lights.area_pdf,
            },
            lights: self.lights.view(scene),
            attributes: (!scene.mesh.normals.is_empty()).then(|| Attributes {
                normals: &scene.mesh.normals,
                uvs: &scene.mesh.uvs,
            }),
        }
    }
}

/// Relative luminance of linear Rec. 709; never 0 for a colour that is not black.
pub(crate) fn luminance(c: [f32; 3]) -> f64 {
    0.2126 * f64::from(c[0]) + 0.7152 * f64::from(c[1]) + 0.0722 * f64::from(c[2])
}

/// Diagonal of the box around the vertices; 0 without any.
pub(crate) fn diagonal(mesh: &Mesh) -> f64 {
    let mut vertices = mesh
        .vertices
        .iter()
        .map(|v| glam::DVec3::from_array(v.map(f64::from)));
    let Some(first) = vertices.next() else {
        return 0.0;
    };
    let (lo, hi) = vertices.fold((first, first), |(lo, hi), v| (lo.min(v), hi.max(v)));
    (hi - lo).length()
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
