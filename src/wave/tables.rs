//! From a compiled scene to the tables that kernels read.

use crate::scene::{Bsdf, Material, Mesh, Scene, Sky};
use huygens_kernels::rays::NO_PRIMITIVE;
use huygens_kernels::tables::{Lights, Materials, SLOTS, Tables, Triangles};

/// Material and light columns, and what selects a light.
#[derive(Debug, Default)]
pub(crate) struct SceneTables {
    albedo: [Vec<f32>; 3],
    parameters: [Vec<f32>; SLOTS],
    emission: [Vec<f32>; 3],
    two_sided: Vec<u32>,
    area_pdf: Vec<f32>,
    keep: Vec<f32>,
    alias: Vec<u32>,
    primitive: Vec<u32>,
    sky_selection: f32,
}

impl SceneTables {
    /// The tables of `scene`. Lights are selected by power: `pi * area * sides * luminance` of a
    /// triangle, `4 pi^2 r^2 * mean luminance` of the sky over a scene of bounding radius `r` (the
    /// flux through that sphere; *PBRT* 4th ed., 12.5).
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut tables = Self::default();
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
        let exitance: Vec<f64> = scene
            .materials
            .iter()
            .map(|m| {
                luminance(m.emission.factor) * std::f64::consts::PI * (1.0 + f64::from(m.two_sided))
            })
            .collect();
        let mut powers = Vec::new();
        for (i, &m) in scene.mesh.material.iter().enumerate() {
            if exitance[m as usize] > 0.0 {
                tables.primitive.push(i as u32);
                powers.push(exitance[m as usize] * area(scene.mesh.corners(i)));
            }
        }
        if let Some(sky) = scene.sky.filter(Sky::shines) {
            tables.primitive.push(NO_PRIMITIVE);
            let r = 0.5 * diagonal(&scene.mesh);
            let power = 4.0 * std::f64::consts::PI.powi(2) * r * r * luminance(sky.mean());
            // Without geometry there is nothing to light and r is 0.
            powers.push(power.max(f64::MIN_POSITIVE));
        }
        let total: f64 = powers.iter().sum();
        tables.area_pdf = exitance.iter().map(|&e| ratio(e, total)).collect();
        if tables.primitive.last() == Some(&NO_PRIMITIVE) {
            tables.sky_selection = ratio(powers[powers.len() - 1], total);
        }
        (tables.keep, tables.alias) = alias_table(&powers);
        tables
    }

    /// Whether next-event estimation has anything to sample.
    pub(crate) fn has_lights(&self) -> bool {
        !self.primitive.is_empty()
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
                area_pdf: &self.area_pdf,
            },
            lights: Lights {
                keep: &self.keep,
                alias: &self.alias,
                primitive: &self.primitive,
                zenith: scene.sky.map_or([0.0; 3], |sky| sky.zenith),
                nadir: scene.sky.map_or([0.0; 3], |sky| sky.nadir),
                sky_selection: self.sky_selection,
            },
        }
    }
}

/// The parameters of a material's BSDF, in the slots where its kernel looks for them
/// (`huygens_kernels::scatter::kinds`).
fn parameters(material: &Material) -> [f32; SLOTS] {
    let mut slots = [0.0; SLOTS];
    if let Bsdf::Diffuse {
        reflectance,
        roughness,
    } = &material.bsdf
    {
        slots[..3].copy_from_slice(&reflectance.factor);
        slots[3] = *roughness;
    }
    slots
}

/// `a / total`, 0 where there is no total.
fn ratio(a: f64, total: f64) -> f32 {
    if total > 0.0 { (a / total) as f32 } else { 0.0 }
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
