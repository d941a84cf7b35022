//! A description becomes the tables that kernels read.

use super::builder::Builder;
use super::camera;
use super::compiled::{FilmSpec, Mesh, Scene};
use super::description::{self, Description};
use super::error::SceneError;
use super::hash;
use super::import::Imported;
use super::import::panorama::Pixels;
use super::light::Sky;
use super::lights;
use super::load::GeometryFile;
use super::material::Material;
use super::media;
use super::motion::{self, Motion};
use super::placed::Placed;
use super::shapes::Shapes;
use super::surfaces::{Surfaces, bind};
use super::texture::Store;
use super::toml::SceneFile;
use super::values::{NonNegative, OneOrThree};
use crate::settings::{Integrator, Settings};
use glam::DAffine3;
use std::path::Path;

/// What can be told to be wrong before the geometry is there, shapes apart.
pub(super) fn check(file: &SceneFile, said: &Description) -> Result<(), SceneError> {
    lights::check(file, said)?;
    media::media(file, said)?;
    media::fog(file, said)?;
    match &said.camera {
        Some(camera) => {
            let film = film(Some(&said.film));
            motion::compile(file, camera.get_ref().motion.as_ref())?;
            camera::compile(camera.get_ref(), camera.span(), film, file).map(|_| ())
        }
        None => Ok(()),
    }
}

/// Compiles a native scene, whose files hold what `imported` says.
pub(super) fn native(
    file: &SceneFile,
    said: &Description,
    files: &[GeometryFile],
    imported: Vec<Imported>,
    surfaces: Surfaces,
    mut store: Store,
    map: Option<Pixels>,
) -> Result<Scene, SceneError> {
    let path = &file.path;
    let film = film(Some(&said.film));
    let Surfaces {
        mut materials,
        wanted,
        mut warnings,
    } = surfaces;
    bind(file, &mut materials, &wanted, &mut store, &mut warnings)?;
    let mut shapes = Shapes::new(file, &materials, files, imported);
    shapes.warnings = warnings;
    for shape in &said.shapes {
        shapes.add(shape)?;
    }
    let (objects, instances) = shapes.instances(said)?;
    let placed = Placed {
        mesh: &shapes.builder.mesh,
        spheres: &shapes.spheres,
        objects: &objects,
        instances: &instances,
    };
    let camera = match &said.camera {
        Some(camera) => camera::compile(camera.get_ref(), camera.span(), film, file)?,
        None => camera::framing(&placed, film).ok_or_else(|| too_large(path))?,
    };
    let (sky, sun) = lights::sky(file, said, map)?;
    let mut lights = lights::lights(file, said, &mut shapes.warnings)?;
    lights.extend(sun);
    Ok(finish(Scene {
        name: said.name.clone().unwrap_or_else(|| stem(path)),
        hash: [0; 32],
        camera,
        camera_motion: camera_motion(file, said)?,
        film,
        sky,
        lights,
        media: media::media(file, said)?,
        fog: media::fog(file, said)?,
        settings: settings(&said.settings),
        materials: shapes.materials,
        textures: store.finish(),
        warnings: with_dropped(shapes.warnings, &shapes.builder),
        mesh: shapes.builder.mesh,
        spheres: shapes.spheres,
        objects,
        instances,
    }))
}

/// The sky over a bare file without light. Darker from below: under a constant sky a white model
/// would have the sky's own colour everywhere and be invisible before it.
const SOFT_SKY: Sky = Sky::Gradient {
    zenith: [1.5; 3],
    nadir: [0.3; 3],
};

/// Compiles a bare file of geometry: a camera that frames it, and a soft sky if it brings no light.
pub(super) fn bare(
    path: &Path,
    imported: Vec<Imported>,
    store: Store,
) -> Result<Scene, SceneError> {
    let mut builder = Builder::default();
    let (mut materials, mut warnings) = (Vec::new(), Vec::new());
    for mut imported in imported {
        materials.append(&mut imported.materials);
        warnings.append(&mut imported.warnings);
        builder
            .append_file(imported, DAffine3::IDENTITY)
            .map_err(|e| SceneError::file(path, e))?;
    }
    let film = film(None);
    let placed = Placed::triangles(&builder.mesh);
    let camera = camera::framing(&placed, film).ok_or_else(|| too_large(path))?;
    let mut scene = Scene {
        name: stem(path),
        hash: [0; 32],
        camera,
        camera_motion: None,
        film,
        sky: None,
        lights: Vec::new(),
        media: Vec::new(),
        fog: None,
        settings: Settings::default(),
        materials,
        textures: store.finish(),
        warnings: with_dropped(warnings, &builder),
        mesh: builder.mesh,
        spheres: Vec::new(),
        objects: Vec::new(),
        instances: Vec::new(),
    };
    if !emits(&scene) {
        scene.sky = Some(SOFT_SKY);
    }
    Ok(finish(scene))
}

/// How the camera moves.
fn camera_motion(file: &SceneFile, said: &Description) -> Result<Option<Motion>, SceneError> {
    let camera = said.camera.as_ref().map(|c| c.get_ref());
    motion::compile(file, camera.and_then(|c| c.motion.as_ref()))
}

/// What both kinds of scene end with: the hash, and warnings about the whole.
fn finish(mut scene: Scene) -> Scene {
    scene.mesh.vertices.shrink_to_fit();
    scene.mesh.indices.shrink_to_fit();
    scene.mesh.material.shrink_to_fit();
    scene.mesh.normals.shrink_to_fit();
    scene.mesh.uvs.shrink_to_fit();
    if scene.is_empty() {
        let message = "no shapes: the camera sees nothing but the sky";
        scene.warnings.push(message.to_owned());
    }
    scene.warnings.extend(without_coordinates(&scene));
    let needs_light = scene.settings.integrator.is_transport();
    let sky_shines = scene.sky.as_ref().is_some_and(Sky::shines);
    if needs_light && !sky_shines && scene.lights.is_empty() && !emits(&scene) {
        let message = "no light: neither a sky nor a surface emits, so the image will be black";
        scene.warnings.push(message.to_owned());
    }
    scene.hash = hash::of(&scene);
    scene
}

/// Warnings about materials that read images where there are no texture coordinates.
fn without_coordinates(scene: &Scene) -> Vec<String> {
    let reads = |m: &Material| m.reads_textures(&scene.materials);
    let reads: Vec<bool> = scene.materials.iter().map(reads).collect();
    if !reads.contains(&true) {
        return Vec::new();
    }
    let mut without = vec![0; scene.materials.len()];
    let mut count = |mesh: &Mesh, worn: Option<u32>| {
        let lacks = |&v: &u32| mesh.uvs.get(v as usize).is_none_or(|uv| uv[0].is_nan());
        for (triangle, &own) in mesh.indices.iter().zip(&mesh.material) {
            let material = worn.unwrap_or(own) as usize;
            without[material] += usize::from(reads[material] && triangle.iter().any(lacks));
        }
    };
    count(&scene.mesh, None);
    // However many copies there are of one look.
    let mut looks = std::collections::BTreeSet::new();
    for copy in &scene.instances {
        if looks.insert((copy.object, copy.material)) {
            count(&scene.objects[copy.object as usize].mesh, copy.material);
        }
    }
    let named = scene.materials.iter().zip(without).filter(|(_, n)| *n > 0);
    let line = |(m, n): (&Material, usize)| {
        let has = if n == 1 { "has" } else { "have" };
        format!(
            "material `{}` has images, but {n} of the triangles that wear it {has} no texture \
             coordinates; the image's corner is taken",
            m.name
        )
    };
    named.map(line).collect()
}

/// Whether any triangle or sphere shines.
fn emits(scene: &Scene) -> bool {
    let shines: Vec<bool> = scene.materials.iter().map(Material::emits).collect();
    let spheres = scene.spheres.iter().map(|s| s.material);
    let mut worn = scene.mesh.material.iter().copied().chain(spheres);
    worn.any(|m| shines[m as usize])
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

/// The film that a scene file asks for, or the default.
pub(super) fn film(said: Option<&description::Film>) -> FilmSpec {
    let default = description::Film::default();
    let said = said.unwrap_or(&default);
    FilmSpec {
        width: said.width.0,
        height: said.height.0,
        filter: said.filter,
    }
}

fn settings(said: &description::Settings) -> Settings {
    let default = Settings::default();
    let roulette = said.roulette.unwrap_or(default.roulette.into());
    // One ray a pixel, as on the command line.
    let spp = match said.integrator {
        Some(Integrator::Whitted) => 1,
        _ => default.spp,
    };
    Settings {
        integrator: said.integrator.unwrap_or(default.integrator),
        strategy: said.strategy.unwrap_or(default.strategy),
        light_selection: said.light_selection.unwrap_or(default.light_selection),
        sampler: said.sampler.unwrap_or(default.sampler),
        spp: said.spp.map_or(spp, |n| n.0),
        max_depth: said.max_depth.map(|n| n.0).or(default.max_depth),
        roulette: roulette.on,
        survival: roulette.survival,
        split: said.split.as_ref().map_or(default.split, |s| s.0.clone()),
        seed: said.seed.map_or(default.seed, |n| n.0),
        texture_lod: said.texture_lod.unwrap_or(default.texture_lod),
        ao_distance: said.ao_distance.map(|d| d.0 as f32).or(default.ao_distance),
        bvh: said.bvh.unwrap_or(default.bvh),
        ..default
    }
}

pub(super) fn radiance(colour: OneOrThree<NonNegative>) -> [f32; 3] {
    colour.0.map(|c| c.0 as f32)
}
