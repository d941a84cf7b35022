//! `huygens inspect`.

use crate::cli::failure::{Failure, warn};
use crate::cli::options::{self, SceneOptions};
use crate::cli::summary::plural;
use crate::cli::text::{bytes, out};
use huygens::film::Film;
use huygens::scene::{self, Filter, Mesh, Scene};
use miette::IntoDiagnostic;
use serde::Serialize;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

/// Show what a scene holds and what it needs, without rendering it
#[derive(Debug, clap::Args)]
#[command(args_override_self = true)]
pub(crate) struct Args {
    #[command(flatten)]
    scene: SceneOptions,

    /// Print JSON (see docs/stats.md)
    #[arg(long)]
    json: bool,
}

/// Runs `huygens inspect`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let scene = scene::load(path)
        .into_diagnostic()
        .map_err(Failure::Input)?;
    warn(&scene.warnings, args.scene.strict)?;
    let contents = Contents::of(&scene, path, &[]);
    if args.json {
        let json = serde_json::to_string_pretty(&contents).into_diagnostic();
        out(&(json.map_err(Failure::Other)? + "\n"));
    } else {
        out(&contents.to_text());
    }
    Ok(())
}

/// What a scene holds. The layout of its JSON is documented in docs/stats.md.
#[derive(Debug, Serialize)]
struct Contents {
    schema: u32,
    name: String,
    file: String,
    hash: String,
    triangles: usize,
    vertices: usize,
    area: f64,
    bounds: Bounds,
    image: ImageContents,
    camera: CameraContents,
    materials: Vec<MaterialContents>,
    lights: Vec<Light>,
    settings: String,
    memory: Vec<Table>,
    warnings: Vec<String>,
}

/// The box around all vertices; none without vertices.
#[derive(Debug, Serialize)]
struct Bounds {
    min: Option<[f32; 3]>,
    max: Option<[f32; 3]>,
}

#[derive(Debug, Serialize)]
struct ImageContents {
    width: u32,
    height: u32,
    filter: Filter,
}

#[derive(Debug, Serialize)]
struct CameraContents {
    origin: [f32; 3],
    forward: [f32; 3],
    up: [f32; 3],
    horizontal_degrees: f64,
    vertical_degrees: f64,
}

#[derive(Debug, Serialize)]
struct MaterialContents {
    name: String,
    triangles: usize,
    area: f64,
    albedo: [f32; 3],
    emission: [f32; 3],
    two_sided: bool,
}

#[derive(Debug, Serialize)]
struct Light {
    kind: &'static str,
    name: String,
    triangles: usize,
    radiance: [f32; 3],
    power: [f64; 3],
}

#[derive(Debug, Serialize)]
struct Table {
    table: &'static str,
    bytes: usize,
}

impl Contents {
    /// `tables` are those of the acceleration structure, with their bytes.
    fn of(scene: &Scene, file: &Path, tables: &[(&'static str, usize)]) -> Self {
        let materials = materials(scene);
        let degrees = |half: f32| 2.0 * f64::from(half).atan().to_degrees();
        let bounds = Bounds::of(&scene.mesh);
        Self {
            schema: 1,
            name: scene.name.clone(),
            file: file.display().to_string(),
            hash: blake3::Hash::from_bytes(scene.hash).to_hex().to_string(),
            triangles: scene.mesh.triangles(),
            vertices: scene.mesh.vertices.len(),
            area: materials.iter().map(|m| m.area).sum(),
            lights: lights(scene, &materials, &bounds),
            bounds,
            image: ImageContents {
                width: scene.film.width,
                height: scene.film.height,
                filter: scene.film.filter,
            },
            camera: CameraContents {
                origin: scene.camera.origin,
                forward: scene.camera.forward,
                up: scene.camera.up,
                horizontal_degrees: degrees(scene.camera.half_width),
                vertical_degrees: degrees(scene.camera.half_height),
            },
            materials,
            settings: options::as_options(scene),
            memory: memory(scene, tables),
            warnings: scene.warnings.clone(),
        }
    }

    fn to_text(&self) -> String {
        let mut text = format!("{} ({})\n", self.name, self.file);
        let mut line = |label: &str, what: String| {
            let _ = writeln!(text, "  {label:<10} {what}");
        };
        line(
            "geometry",
            format!(
                "{}, {}",
                plural(self.triangles as u64, "triangle"),
                vertices(self.vertices)
            ),
        );
        if let (Some(min), Some(max)) = (self.bounds.min, self.bounds.max) {
            line("bounds", format!("{} to {}", list(min), list(max)));
        }
        let c = &self.camera;
        line(
            "camera",
            format!(
                "at {}, towards {}, up {}, {:.2} x {:.2} degrees",
                list(c.origin),
                list(c.forward),
                list(c.up),
                c.horizontal_degrees,
                c.vertical_degrees
            ),
        );
        line("settings", self.settings.clone());
        for m in &self.materials {
            let what = plural(m.triangles as u64, "triangle");
            line(
                "material",
                format!("{}: albedo {}, {what}", m.name, list(m.albedo)),
            );
        }
        for l in &self.lights {
            let (radiance, power) = (list(l.radiance), list(l.power.map(|p| p as f32)));
            let what = match l.triangles {
                0 => String::new(),
                n => format!(", {}", plural(n as u64, "triangle")),
            };
            let name = &l.name;
            line(
                "light",
                format!("{name}: {radiance} W/m^2/sr, {power} W{what}"),
            );
        }
        if self.lights.is_empty() {
            line("light", "none".to_owned());
        }
        for t in &self.memory {
            line(
                "memory",
                format!("{:<20} {}", t.table, bytes(t.bytes as u64)),
            );
        }
        let all: usize = self.memory.iter().map(|t| t.bytes).sum();
        line("memory", format!("{:<20} {}", "in all", bytes(all as u64)));
        line("hash", self.hash.clone());
        text
    }
}

impl Bounds {
    fn of(mesh: &Mesh) -> Self {
        let reduce = |pick: fn(f32, f32) -> f32| {
            let combine = |a: [f32; 3], b: [f32; 3]| std::array::from_fn(|c| pick(a[c], b[c]));
            mesh.vertices.iter().copied().reduce(combine)
        };
        Self {
            min: reduce(f32::min),
            max: reduce(f32::max),
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
    let mut worn = vec![(0, 0.0); scene.materials.len()];
    for triangle in 0..scene.mesh.triangles() {
        let (count, all) = &mut worn[scene.mesh.material[triangle] as usize];
        *count += 1;
        *all += area(scene.mesh.corners(triangle));
    }
    let contents = |(m, (triangles, area)): (&scene::Material, (usize, f64))| MaterialContents {
        name: m.name.clone(),
        triangles,
        area,
        albedo: m.albedo,
        emission: m.emission,
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
    let emits = |m: &&MaterialContents| m.triangles > 0 && m.emission.iter().any(|&e| e > 0.0);
    let surface = |m: &MaterialContents| {
        let sides = if m.two_sided { 2.0 } else { 1.0 };
        Light {
            kind: "area",
            name: m.name.clone(),
            triangles: m.triangles,
            radiance: m.emission,
            power: m.emission.map(|l| PI * m.area * sides * f64::from(l)),
        }
    };
    let sky = scene.sky.map(|radiance| Light {
        kind: "sky",
        name: "sky".to_owned(),
        triangles: 0,
        radiance,
        // The sphere's surface times pi L: it is lit from all of each hemisphere above it.
        power: radiance.map(|l| 4.0 * PI * bounds.radius2() * PI * f64::from(l)),
    });
    materials
        .iter()
        .filter(emits)
        .map(surface)
        .chain(sky)
        .collect()
}

fn memory(scene: &Scene, tables: &[(&'static str, usize)]) -> Vec<Table> {
    let (mesh, film) = (&scene.mesh, &scene.film);
    let pixels = film.width as usize * film.height as usize;
    let table = |table, bytes| Table { table, bytes };
    let own = [
        table("vertices", size_of_val(mesh.vertices.as_slice())),
        table("vertex indices", size_of_val(mesh.indices.as_slice())),
        table("material indices", size_of_val(mesh.material.as_slice())),
        table("film", pixels * Film::BYTES_PER_PIXEL),
    ];
    let others = tables.iter().map(|&(name, bytes)| table(name, bytes));
    own.into_iter().chain(others).collect()
}

fn vertices(n: usize) -> String {
    match n {
        1 => "1 vertex".to_owned(),
        n => format!("{n} vertices"),
    }
}

fn list(v: [f32; 3]) -> String {
    format!("({}, {}, {})", v[0], v[1], v[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::stats::tests::{documented, paths, scene as empty};
    use huygens::scene::Material;
    use std::collections::BTreeSet;

    /// A 3-4-5 triangle that emits from both sides, under a sky.
    fn lit() -> Scene {
        let mut scene = empty();
        scene.mesh = Mesh {
            vertices: vec![[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
            indices: vec![[0, 1, 2]],
            material: vec![0],
        };
        scene.materials.push(Material {
            name: "lamp".into(),
            albedo: [0.5; 3],
            emission: [1.0, 2.0, 0.0],
            two_sided: true,
        });
        scene.sky = Some([1.0; 3]);
        scene
    }

    #[test]
    fn the_layout_is_the_documented_one() {
        let json =
            serde_json::to_value(Contents::of(&lit(), Path::new("a"), &[])).expect("serialised");
        let mut found = BTreeSet::new();
        paths(&json, "", &mut found);
        assert_eq!(found, documented("inspect --json"));
    }

    #[test]
    fn powers_are_those_of_lambertian_emitters_and_of_the_sky() {
        let contents = Contents::of(&lit(), Path::new("a"), &[]);
        // Area 6, both sides; the box's half diagonal squared is 6.25.
        assert_eq!(contents.lights[0].power, [12.0 * PI, 24.0 * PI, 0.0]);
        assert_eq!(contents.lights[1].power, [4.0 * PI * 6.25 * PI; 3]);
        assert_eq!(contents.area, 6.0);
    }

    #[test]
    fn an_empty_scene_has_no_bounds_and_no_light() {
        let contents = Contents::of(&empty(), Path::new("a"), &[]);
        assert_eq!((contents.bounds.min, contents.bounds.max), (None, None));
        assert!(contents.lights.is_empty());
        assert!(contents.to_text().contains("light      none\n"));
    }
}
