//! Effects: what a compiled scene calls for, and why.
//!
//! The wave is assembled from this: a stage, a queue or a kernel that no effect asks for is not
//! there.

mod shader;

pub use shader::Shader;
pub(crate) use shader::polished;

use crate::scene::{Light, Material, Mesh, Projection, Scene, Sky};
use crate::settings::{Integrator, LightSelection, Settings, Strategy};
use huygens_kernels::bare::COMPLETE;
use serde::Serialize;

/// One effect.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Effect {
    /// Its name.
    pub name: &'static str,
    /// What asks for it: a material, a light, the camera or a setting.
    pub reason: String,
}

/// The effects that a scene calls for under some settings.
#[derive(Clone, Debug, Default)]
pub struct Effects {
    /// In the order of the wave's stages.
    pub list: Vec<Effect>,
    /// By material: what scatters there. Materials that no surface wears call for nothing and count as
    /// plain.
    pub shaders: Vec<Shader>,
    /// Shaders of which some material reads images.
    pub textured: Vec<Shader>,
    /// Whether some surfaces are not wholly there.
    pub opacity: bool,
    /// The shader of which some surfaces are brushed along their texture coordinates.
    pub aligned: Option<Shader>,
    /// Whether surfaces emit that do not emit the same all over.
    pub varying_emission: bool,
    /// Whether normal or bump maps bend shading normals.
    pub relief: bool,
    /// Whether light comes from all around, or from discs at no distance.
    pub sky: bool,
    /// Whether surfaces emit.
    pub emission: bool,
    /// Whether surfaces disperse light: paths carry a wavelength.
    pub dispersion: bool,
    /// Whether anything moves while the shutter is open: paths live at a moment.
    pub motion: bool,
    /// Whether there are media: rays lose light on their way.
    pub media: bool,
    /// Whether any of them scatters.
    pub scattering_media: bool,
}

impl Effects {
    /// What `scene` calls for under `settings`.
    #[must_use]
    pub fn of(scene: &Scene, settings: &Settings) -> Self {
        let mut effects = Self::default();
        let transport = settings.integrator.is_transport();
        effects.camera(scene);
        if let Some(reason) = scene.moves() {
            effects.motion = true;
            effects.add("motion", reason);
        }
        if let Some(sphere) = scene.spheres.first() {
            let worn = &scene.materials[sphere.material as usize];
            effects.add("spheres", material(worn));
        }
        if let Some(instance) = scene.instances.first() {
            let object = &scene.objects[instance.object as usize];
            effects.add("instances", format!("object `{}`", object.name));
        }
        let worn = scene.worn();
        effects.opacity(scene, &worn);
        effects.light(scene, &worn);
        effects.surfaces(scene, &worn, transport);
        if transport {
            effects.media(scene);
        }
        if transport && settings.roulette {
            effects.add("roulette", "setting `roulette`");
        }
        let strategy = matches!(settings.strategy, Strategy::Light | Strategy::Mis);
        let samples_lights = strategy || settings.integrator == Integrator::Whitted;
        let (selection, reason) = light_selection(scene, settings);
        if transport
            && samples_lights
            && (effects.sky || effects.emission || !scene.lights.is_empty())
        {
            effects.add("next-event estimation", "setting `strategy`");
            if selection == LightSelection::Tree {
                effects.add("light tree", reason);
            }
        } else if let Some(light) = scene.lights.iter().find(|l| l.kind.is_delta())
            && transport
        {
            effects.add("next-event estimation", light_of(light));
        }
        effects
    }

    fn add(&mut self, name: &'static str, reason: impl Into<String>) {
        self.list.push(Effect {
            name,
            reason: reason.into(),
        });
    }

    fn camera(&mut self, scene: &Scene) {
        if let Projection::Perspective {
            lens: Some(lens), ..
        } = scene.camera.projection
        {
            self.add(
                "depth of field",
                format!("the camera's lens of radius {}", lens.radius),
            );
        }
    }

    fn light(&mut self, scene: &Scene, worn: &[bool]) {
        if let Some(sky) = scene.sky.as_ref().filter(|sky| sky.shines()) {
            self.sky = true;
            let name = match sky {
                Sky::Gradient { .. } => "sky",
                Sky::Map(_) => "environment map",
            };
            self.add(name, "the scene's `sky`");
        }
        let (delta, discs): (Vec<_>, Vec<_>) = scene.lights.iter().partition(|l| l.kind.is_delta());
        if let Some(disc) = discs.first() {
            self.sky = true;
            self.add("discs in the sky", light_of(disc));
        }
        if let Some(delta) = delta.first() {
            self.add("delta lights", light_of(delta));
        }
        let emits = |m: &&Material| m.emits();
        let mut emitting = scene.materials.iter().zip(worn).filter(|(_, w)| **w);
        if let Some((m, _)) = emitting.find(|(m, _)| emits(m)) {
            self.emission = true;
            self.add("emissive triangles", material(m));
        }
        let mut emitting = scene
            .materials
            .iter()
            .zip(worn)
            .filter(|(m, w)| **w && emits(m));
        if let Some((m, _)) = emitting.find(|(m, _)| m.emission_varies()) {
            self.varying_emission = true;
            self.add("varying emission", material(m));
        }
    }

    fn media(&mut self, scene: &Scene) {
        let mut all = scene.media_in_use();
        if let Some((_, reason)) = all.next() {
            self.media = true;
            self.add("media", reason);
        }
        let mut all = scene.media_in_use();
        if let Some((medium, reason)) = all.find(|(m, _)| m.scatters()) {
            self.scattering_media = true;
            let name = Shader::Medium.name();
            self.add(name, format!("medium `{}`, of {reason}", medium.name));
        }
    }

    fn surfaces(&mut self, scene: &Scene, worn: &[bool], transport: bool) {
        let smooth = smooth(scene);
        let mixed = mixed(scene, worn);
        self.shaders = (0..scene.materials.len())
            .map(|i| match (transport, worn[i]) {
                (true, true) => Shader::of(&scene.materials[i], smooth[i] || mixed[i]),
                _ => Shader::Plain,
            })
            .collect();
        for shader in Shader::ALL {
            let calls = |i: &usize| worn[*i] && self.shaders[*i] == shader;
            if let Some(i) = (0..worn.len()).find(calls) {
                let reason = material(&scene.materials[i]);
                self.add(shader.name(), reason);
                if shader.disperses() && !self.dispersion {
                    self.dispersion = true;
                    self.add("dispersion", material(&scene.materials[i]));
                }
            }
        }
        if transport {
            self.images(scene, worn);
        }
        if let Some(brushed) = scene.is_brushed().filter(|_| transport) {
            self.aligned = Some(Shader::RoughConductor);
            self.add("anisotropy along u", material(brushed));
        }
        if let Some(i) = smooth.iter().position(|&s| s).filter(|_| transport) {
            self.add("shading normals", material(&scene.materials[i]));
        }
    }
}

/// The effects of images at surfaces.
impl Effects {
    fn opacity(&mut self, scene: &Scene, worn: &[bool]) {
        let partial = |m: &Material| m.alpha.map(|alpha| alpha.cutoff.is_none());
        for (name, wanted) in [("alpha masks", false), ("partial opacity", true)] {
            let mut all = scene.materials.iter().zip(worn);
            if let Some((m, _)) = all.find(|(m, worn)| **worn && partial(m) == Some(wanted)) {
                self.opacity = true;
                self.add(name, material(m));
            }
        }
    }

    fn images(&mut self, scene: &Scene, worn: &[bool]) {
        let all = || scene.materials.iter().zip(worn).zip(&self.shaders);
        let varied = all().filter(|((m, worn), _)| **worn && m.is_varied());
        let textured: Vec<Shader> = varied.clone().map(|(_, &shader)| shader).collect();
        let first = varied.map(|((m, _), _)| m).next();
        let bent = all().find(|((m, worn), _)| **worn && m.normal_map.is_some());
        let bent = bent.map(|((m, _), _)| m);
        if let Some(m) = first {
            self.add("textures", material(m));
        }
        if let Some(m) = bent {
            self.relief = true;
            self.add("normal maps", material(m));
        }
        self.textured = textured;
    }
}

/// All that there is in a build with the feature `bare`.
const BARE: [&str; 6] = [
    "sky",
    "emissive triangles",
    "plain diffuse",
    "roulette",
    "next-event estimation",
    "light tree",
];

impl Effects {
    /// The first effect that this build leaves out (see [`huygens_kernels::bare`]), if there is one.
    #[must_use]
    pub fn left_out(&self) -> Option<&Effect> {
        let missing = |effect: &&Effect| !COMPLETE && !BARE.contains(&effect.name);
        self.list.iter().find(missing)
    }
}

/// Whether a render has to do with media.
pub(crate) fn has_media(scene: &Scene, settings: &Settings) -> bool {
    settings.integrator.is_transport() && scene.media_in_use().next().is_some()
}

/// The fewest lights at a finite distance for which a tree is taken to be worth its steps: set by
/// judgement, see docs/performance/samplers.md.
const MANY_LIGHTS: usize = 16;

/// How a render chooses among lights, `auto` resolved, and why.
#[must_use]
pub fn light_selection(scene: &Scene, settings: &Settings) -> (LightSelection, String) {
    let emits: Vec<bool> = scene.materials.iter().map(Material::emits).collect();
    let triangles = scene.mesh.material.iter().filter(|&&m| emits[m as usize]);
    let sampled = match settings.strategy {
        Strategy::Light | Strategy::Mis => triangles.count(),
        // Only what directions do not find.
        Strategy::Uniform | Strategy::Cosine => 0,
    };
    let points = scene.lights.iter();
    let near = sampled + points.filter(|l| l.kind.is_near()).count();
    match settings.light_selection {
        LightSelection::Auto if near >= MANY_LIGHTS => (
            LightSelection::Tree,
            format!("{near} lights at a finite distance"),
        ),
        LightSelection::Auto => (
            LightSelection::Power,
            format!("fewer than {MANY_LIGHTS} lights at a finite distance"),
        ),
        LightSelection::Tree if near == 0 => (
            LightSelection::Power,
            "no light at a finite distance".to_owned(),
        ),
        asked => (asked, "setting `light_selection`".to_owned()),
    }
}

fn light_of(light: &Light) -> String {
    format!("light `{}`", light.name)
}

fn material(material: &Material) -> String {
    match material.name.as_str() {
        "" => "a material without a name".to_owned(),
        name => format!("material `{name}`"),
    }
}

/// By material: whether it is part of a mixture that any surface wears.
fn mixed(scene: &Scene, worn: &[bool]) -> Vec<bool> {
    let mut mixed = vec![false; worn.len()];
    for (m, _) in scene.materials.iter().zip(worn).filter(|(_, worn)| **worn) {
        for part in m.parts() {
            mixed[part as usize] = true;
        }
    }
    mixed
}

/// By material: whether a surface that wears it has interpolated normals.
fn smooth(scene: &Scene) -> Vec<bool> {
    let mut smooth = vec![false; scene.materials.len()];
    mark_smooth(&scene.mesh, None, &mut smooth);
    let mut known = std::collections::HashSet::new();
    for instance in &scene.instances {
        if known.insert((instance.object, instance.material)) {
            let mesh = &scene.objects[instance.object as usize].mesh;
            mark_smooth(mesh, instance.material, &mut smooth);
        }
    }
    smooth
}

/// Marks the materials of a mesh's smooth triangles, or the one that all of it wears.
fn mark_smooth(mesh: &Mesh, worn: Option<u32>, smooth: &mut [bool]) {
    for (triangle, &m) in mesh.indices.iter().zip(&mesh.material) {
        let has = |&v: &u32| {
            let normal = mesh.normals.get(v as usize);
            normal.is_some_and(|&n| n != Mesh::NO_NORMAL)
        };
        smooth[worn.unwrap_or(m) as usize] |= triangle.iter().all(has);
    }
}
