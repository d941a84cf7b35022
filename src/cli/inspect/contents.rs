//! What a scene holds, in numbers.

use super::camera::CameraContents;
use crate::cli::options;
use huygens::film::Film;
use huygens::scene::{self, Filter, Mesh, Scene, Texture};
use huygens::wave::Plan;
use serde::Serialize;
use std::f64::consts::PI;
use std::path::Path;

/// What a scene holds. The layout of its JSON is documented in docs/stats.md.
#[derive(Debug, Serialize)]
pub(crate) struct Contents {
    pub(super) schema: u32,
    pub(super) name: String,
    pub(super) file: String,
    pub(super) hash: String,
    pub(super) triangles: usize,
    pub(super) vertices: usize,
    pub(super) spheres: usize,
    pub(super) instances: usize,
    /// Those of instances counted as often as they are there.
    pub(super) placed_triangles: u64,
    pub(super) area: f64,
    pub(super) bounds: Bounds,
    pub(super) image: ImageContents,
    pub(super) camera: CameraContents,
    pub(super) materials: Vec<MaterialContents>,
    pub(super) lights: Vec<Light>,
    pub(super) settings: String,
    /// Effects, stages and queues.
    #[serde(flatten)]
    pub(super) plan: Plan,
    pub(super) memory: Vec<Table>,
    /// Of all tables but the film and textures.
    pub(super) bytes_per_triangle: Option<f64>,
    pub(super) warnings: Vec<String>,
}

/// The box around all vertices; none without vertices.
#[derive(Debug, Serialize)]
pub(super) struct Bounds {
    pub(super) min: Option<[f32; 3]>,
    pub(super) max: Option<[f32; 3]>,
}

#[derive(Debug, Serialize)]
pub(super) struct ImageContents {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) filter: Filter,
}

#[derive(Debug, Serialize)]
pub(super) struct MaterialContents {
    pub(super) name: String,
    pub(super) triangles: usize,
    pub(super) spheres: usize,
    pub(super) area: f64,
    pub(super) albedo: [f32; 3],
    pub(super) emission: [f32; 3],
    pub(super) two_sided: bool,
}

#[derive(Debug, Serialize)]
pub(super) struct Light {
    pub(super) kind: &'static str,
    pub(super) name: String,
    pub(super) triangles: usize,
    pub(super) spheres: usize,
    pub(super) radiance: [f32; 3],
    pub(super) power: [f64; 3],
}

#[derive(Debug, Serialize)]
pub(super) struct Table {
    pub(super) table: &'static str,
    pub(super) bytes: usize,
    /// None for what does not grow with the geometry.
    pub(super) bytes_per_triangle: Option<f64>,
}

impl Contents {
    /// `tables` are those of the acceleration structure, with their bytes.
    pub(crate) fn of(
        scene: &Scene,
        file: &Path,
        tables: &[(&'static str, usize)],
        plan: Plan,
    ) -> Self {
        let materials = materials(scene);
        let bounds = Bounds::of(scene);
        let memory = memory(scene, tables);
        let triangles = scene.stored_triangles();
        let objects = scene.objects.iter().map(|o| o.mesh.vertices.len());
        let geometry = memory.iter().filter(|t| grows(t.table));
        Self {
            schema: 1,
            name: scene.name.clone(),
            file: file.display().to_string(),
            hash: blake3::Hash::from_bytes(scene.hash).to_hex().to_string(),
            triangles,
            vertices: scene.mesh.vertices.len() + objects.sum::<usize>(),
            spheres: scene.spheres.len(),
            instances: scene.instances.len(),
            placed_triangles: scene.placed_triangles(),
            area: materials.iter().map(|m| m.area).sum(),
            lights: lights(scene, &materials, &bounds),
            bounds,
            image: ImageContents {
                width: scene.film.width,
                height: scene.film.height,
                filter: scene.film.filter,
            },
            camera: CameraContents::of(&scene.camera),
            materials,
            settings: options::as_options(scene),
            plan,
            bytes_per_triangle: each(geometry.map(|t| t.bytes).sum(), triangles),
            memory,
            warnings: scene.warnings.clone(),
        }
    }
}

impl Bounds {
    fn of(scene: &Scene) -> Self {
        let corner = |k: usize| scene.bounds().map(|b| b[k].as_vec3().to_array());
        Self {
            min: corner(0),
            max: corner(1),
        }
    }

    /// Square of the radius of the sphere around the box.
    fn radius2(&self) -> f64 {
        let (Some(min), Some(max)) = (self.min, self.max) else {
            return 0.0;
        };
        let half = |c: usize| 0.5 * (f64::from(max[c]) - f64::from(min[c]));
        (0..3).map(|c| half(c) * half(c)).sum()
    }
}

fn materials(scene: &Scene) -> Vec<MaterialContents> {
    let mut worn = vec![(0, 0, 0.0); scene.materials.len()];
    for triangle in 0..scene.mesh.triangles() {
        let (count, _, all) = &mut worn[scene.mesh.material[triangle] as usize];
        *count += 1;
        *all += area(scene.mesh.corners(triangle));
    }
    for &material in scene.objects.iter().flat_map(|o| &o.mesh.material) {
        worn[material as usize].0 += 1;
    }
    for sphere in &scene.spheres {
        let (_, count, all) = &mut worn[sphere.material as usize];
        *count += 1;
        *all += sphere.area();
    }
    type Worn = (usize, usize, f64);
    let contents = |(m, (triangles, spheres, area)): (&scene::Material, Worn)| MaterialContents {
        name: m.name.clone(),
        triangles,
        spheres,
        area,
        albedo: m.albedo(&scene.materials),
        emission: m.emission.mean(&scene.textures),
        two_sided: m.two_sided,
    };
    scene.materials.iter().zip(worn).map(contents).collect()
}

/// Area of a triangle: half the length of the vector product of two sides.
fn area(corners: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| p.map(f64::from));
    let side = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (u, v) = (side(b), side(c));
    let cross = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
    let (x, y, z) = (cross(1, 2), cross(2, 0), cross(0, 1));
    0.5 * (x * x + y * y + z * z).sqrt()
}

fn lights(scene: &Scene, materials: &[MaterialContents], bounds: &Bounds) -> Vec<Light> {
    let shines = |m: &MaterialContents| m.emission.iter().any(|&e| e > 0.0);
    let emits = |m: &&MaterialContents| m.triangles + m.spheres > 0 && shines(m);
    let surface = |m: &MaterialContents| {
        let sides = if m.two_sided { 2.0 } else { 1.0 };
        Light {
            kind: "area",
            name: m.name.clone(),
            triangles: m.triangles,
            spheres: m.spheres,
            radiance: m.emission,
            power: m.emission.map(|l| PI * m.area * sides * f64::from(l)),
        }
    };
    let punctual = scene.lights.iter().map(|light| Light {
        kind: match light.kind {
            scene::LightKind::Point { spot: None, .. } => "point",
            scene::LightKind::Point { .. } => "spot",
            scene::LightKind::Distant { .. } => "sun",
        },
        name: light.name.clone(),
        triangles: 0,
        spheres: 0,
        radiance: match light.kind.extent() {
            0.0 => [0.0; 3],
            _ => light.kind.radiance().map(|l| l as f32),
        },
        power: light
            .kind
            .colour()
            .map(|c| f64::from(c) * light.kind.power_factor(bounds.radius2().sqrt())),
    });
    let sky = scene.sky.as_ref().map(|sky| Light {
        kind: match sky {
            scene::Sky::Gradient { .. } => "sky",
            scene::Sky::Map(_) => "map",
        },
        name: "sky".to_owned(),
        triangles: 0,
        spheres: 0,
        radiance: sky.mean(),
        // The sphere's surface times pi L, L the mean: all of it is lit from all sides together.
        power: sky
            .mean()
            .map(|l| 4.0 * PI * bounds.radius2() * PI * f64::from(l)),
    });
    materials
        .iter()
        .filter(emits)
        .map(surface)
        .chain(punctual)
        .chain(sky)
        .collect()
}

/// Tables whose size does not depend on the geometry.
const FILM: &str = "film";
const TEXTURES: &str = "textures";

fn grows(table: &str) -> bool {
    table != FILM && table != TEXTURES
}

/// Bytes for each of the triangles, if there are any.
fn each(bytes: usize, triangles: usize) -> Option<f64> {
    (triangles > 0).then(|| bytes as f64 / triangles as f64)
}

fn memory(scene: &Scene, tables: &[(&'static str, usize)]) -> Vec<Table> {
    let (mesh, film) = (&scene.mesh, &scene.film);
    let pixels = film.width as usize * film.height as usize;
    let table = |table, bytes| Table {
        table,
        bytes,
        bytes_per_triangle: each(bytes, scene.stored_triangles()).filter(|_| grows(table)),
    };
    let own = [
        table("vertices", size_of_val(mesh.vertices.as_slice())),
        table("vertex indices", size_of_val(mesh.indices.as_slice())),
        table("material indices", size_of_val(mesh.material.as_slice())),
        table(FILM, pixels * Film::BYTES_PER_PIXEL),
    ];
    let textures = scene.textures.iter().map(Texture::bytes).sum();
    let asked = [
        table("normals", size_of_val(mesh.normals.as_slice())),
        table("texture coordinates", size_of_val(mesh.uvs.as_slice())),
        table(TEXTURES, textures),
    ];
    let asked = asked.into_iter().filter(|t| t.bytes > 0);
    let objects = || scene.objects.iter().map(|o| &o.mesh);
    let of = |bytes: fn(&Mesh) -> usize| objects().map(bytes).sum::<usize>();
    let placed = [
        table("object vertices", of(|m| size_of_val(&m.vertices[..]))),
        table("object indices", of(|m| size_of_val(&m.indices[..]))),
        table("object materials", of(|m| size_of_val(&m.material[..]))),
        table("instances", size_of_val(&scene.instances[..])),
        table("spheres", size_of_val(&scene.spheres[..])),
    ];
    let placed = placed.into_iter().filter(|t| t.bytes > 0);
    let others = tables.iter().map(|&(name, bytes)| table(name, bytes));
    own.into_iter()
        .chain(asked)
        .chain(placed)
        .chain(others)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::stats::tests::{documented, paths, scene as empty};
    use huygens::geometry::Geometry;
    use huygens::scene::{Material, Sky};
    use std::collections::BTreeSet;

    fn plan(scene: &Scene) -> Plan {
        huygens::wave::plan(scene, &Geometry::build(&scene.mesh), &scene.settings)
    }

    /// A 3-4-5 triangle that emits from both sides, under a sky.
    fn lit() -> Scene {
        let mut scene = empty();
        scene.mesh = Mesh {
            vertices: vec![[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
            indices: vec![[0, 1, 2]],
            material: vec![0],
            ..Mesh::default()
        };
        scene.materials.push(Material {
            two_sided: true,
            ..Material::diffuse("lamp", [0.5; 3], [1.0, 2.0, 0.0])
        });
        scene.sky = Some(Sky::constant([1.0; 3]));
        scene
    }

    #[test]
    fn the_layout_is_the_documented_one() {
        let json = serde_json::to_value(Contents::of(&lit(), Path::new("a"), &[], plan(&lit())))
            .expect("serialised");
        let mut found = BTreeSet::new();
        paths(&json, "", &mut found);
        assert_eq!(found, documented("inspect --json"));
    }

    #[test]
    fn powers_are_those_of_lambertian_emitters_and_of_the_sky() {
        let contents = Contents::of(&lit(), Path::new("a"), &[], plan(&lit()));
        // Area 6, both sides; the box's half diagonal squared is 6.25.
        assert_eq!(contents.lights[0].power, [12.0 * PI, 24.0 * PI, 0.0]);
        assert_eq!(contents.lights[1].power, [4.0 * PI * 6.25 * PI; 3]);
        assert_eq!(contents.area, 6.0);
    }

    #[test]
    fn an_empty_scene_has_no_bounds_and_no_light() {
        let contents = Contents::of(&empty(), Path::new("a"), &[], plan(&empty()));
        assert_eq!((contents.bounds.min, contents.bounds.max), (None, None));
        assert!(contents.lights.is_empty());
        assert!(contents.to_text().contains("light      none\n"));
    }
}
