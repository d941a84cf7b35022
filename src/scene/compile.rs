//! A description becomes the tables that kernels read.

use super::builder::{Builder, Placed};
use super::camera;
use super::compiled::{FilmSpec, Material, Scene};
use super::description::{self, Description};
use super::error::SceneError;
use super::hash;
use super::import::obj;
use super::shapes::Shapes;
use super::toml::SceneFile;
use super::values::{NonNegative, OneOrThree, Unit};
use crate::settings::{Integrator, Settings};
use glam::{DAffine3, DVec3};
use std::path::Path;

/// Compiles a native scene file.
pub(super) fn native(path: &Path) -> Result<Scene, SceneError> {
    let file = SceneFile::read(path)?;
    let said = file.parse()?;
    let film = film(&said.film);
    let mut shapes = Shapes::new(&file, materials(&said));
    for shape in &said.shapes {
        shapes.add(shape)?;
    }
    let mesh = &shapes.builder.mesh;
    let camera = match &said.camera {
        Some(camera) => camera::compile(camera.get_ref(), camera.span(), film, &file)?,
        None => camera::framing(mesh, film).ok_or_else(|| too_large(path))?,
    };
    let sky = said.sky.as_ref().map(|sky| radiance(sky.radiance));
    Ok(finish(Scene {
        name: said.name.clone().unwrap_or_else(|| stem(path)),
        hash: [0; 32],
        camera,
        film,
        sky,
        settings: settings(&said.settings),
        materials: shapes.materials,
        warnings: with_dropped(shapes.warnings, &shapes.builder),
        mesh: shapes.builder.mesh,
    }))
}

/// Compiles a bare OBJ file: a camera that frames it, and a soft sky if it brings no light.
pub(super) fn bare_obj(path: &Path) -> Result<Scene, SceneError> {
    let imported = obj::load(path)?;
    let mut builder = Builder::default();
    let vertex = |v: &[f32; 3]| DVec3::from_array(v.map(f64::from));
    let placed = Placed {
        vertices: imported.vertices.iter().map(vertex),
        triangles: &imported.triangles,
        transform: DAffine3::IDENTITY,
    };
    builder
        .append(placed, |i| imported.material[i])
        .map_err(|e| SceneError::file(path, e))?;
    let film = film(&description::Film::default());
    let camera = camera::framing(&builder.mesh, film).ok_or_else(|| too_large(path))?;
    let mut scene = Scene {
        name: stem(path),
        hash: [0; 32],
        camera,
        film,
        sky: None,
        settings: Settings::default(),
        materials: imported.materials,
        warnings: with_dropped(imported.warnings, &builder),
        mesh: builder.mesh,
    };
    if !emits(&scene) {
        scene.sky = Some([1.0; 3]);
    }
    Ok(finish(scene))
}

/// What both kinds of scene end with: the hash, and warnings about the whole.
fn finish(mut scene: Scene) -> Scene {
    if scene.mesh.indices.is_empty() {
        let message = "no shapes: the camera sees nothing but the sky";
        scene.warnings.push(message.to_owned());
    }
    let needs_light = matches!(
        scene.settings.integrator,
        Integrator::Path | Integrator::Direct | Integrator::Reference
    );
    let sky_shines = scene.sky.is_some_and(|sky| sky.iter().any(|&c| c > 0.0));
    if needs_light && !sky_shines && !emits(&scene) {
        let message = "no light: neither a sky nor a surface emits, so the image will be black";
        scene.warnings.push(message.to_owned());
    }
    scene.hash = hash::of(&scene);
    scene
}

/// Whether any triangle shines.
fn emits(scene: &Scene) -> bool {
    let shines: Vec<bool> = scene.materials.iter().map(Material::emits).collect();
    scene.mesh.material.iter().any(|&m| shines[m as usize])
}

fn with_dropped(mut warnings: Vec<String>, builder: &Builder) -> Vec<String> {
    if builder.dropped > 0 {
        warnings.push(format!(
            "triangles of zero area: {} left out",
            builder.dropped
        ));
    }
    warnings
}

fn too_large(path: &Path) -> SceneError {
    SceneError::file(path, "is too large to place a camera in 32-bit floats")
}

fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or(path.as_os_str());
    stem.to_string_lossy().into_owned()
}

fn film(said: &description::Film) -> FilmSpec {
    FilmSpec {
        width: said.width.0,
        height: said.height.0,
        filter: said.filter,
    }
}

fn settings(said: &description::Settings) -> Settings {
    let default = Settings::default();
    Settings {
        integrator: said.integrator.unwrap_or(default.integrator),
        strategy: said.strategy.unwrap_or(default.strategy),
        spp: said.spp.map_or(default.spp, |n| n.0),
        max_depth: said.max_depth.map(|n| n.0).or(default.max_depth),
        roulette: said.roulette.unwrap_or(default.roulette),
        seed: said.seed.map_or(default.seed, |n| n.0),
        ao_distance: said.ao_distance.map(|d| d.0 as f32).or(default.ao_distance),
        bvh: said.bvh.unwrap_or(default.bvh),
        ..default
    }
}

fn materials(said: &Description) -> Vec<Material> {
    let material = |(name, m): (&String, &description::Material)| Material {
        name: name.clone(),
        albedo: reflectance(m.albedo),
        emission: radiance(m.emission),
        two_sided: m.two_sided,
    };
    said.materials.iter().map(material).collect()
}

fn reflectance(colour: OneOrThree<Unit>) -> [f32; 3] {
    colour.0.map(|c| c.0 as f32)
}

fn radiance(colour: OneOrThree<NonNegative>) -> [f32; 3] {
    colour.0.map(|c| c.0 as f32)
}
