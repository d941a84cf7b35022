//! Effects: what a compiled scene calls for, and why.
//!
//! The wave is assembled from this: a stage, a queue or a kernel that no effect asks for is not
//! there.

use crate::scene::{Bsdf, LightKind, Material, Projection, Scene, Sky};
use crate::settings::{Integrator, LightSelection, Settings, Strategy};
use serde::Serialize;

/// One effect.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Effect {
    /// Its name.
    pub name: &'static str,
    /// What asks for it: a material, a light, the camera or a setting.
    pub reason: String,
}

/// What scatters at a surface: each has a kernel of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shader {
    /// Lambertian, flat and of one colour: one pass from hit to scattered path.
    Plain,
    /// Lambertian otherwise.
    Diffuse,
    /// Rough diffuse.
    RoughDiffuse,
}

impl Shader {
    /// All there are, in the order in which they run.
    pub const ALL: [Self; 3] = [Self::Plain, Self::Diffuse, Self::RoughDiffuse];

    /// The effect's name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain diffuse",
            Self::Diffuse => "diffuse",
            Self::RoughDiffuse => "rough diffuse",
        }
    }

    /// Whether light can only be found by following its directions.
    #[must_use]
    pub fn is_delta(self) -> bool {
        match self {
            Self::Plain | Self::Diffuse | Self::RoughDiffuse => false,
        }
    }

    /// Whether light passes through.
    #[must_use]
    pub fn passes(self) -> bool {
        match self {
            Self::Plain | Self::Diffuse | Self::RoughDiffuse => false,
        }
    }

    /// The shader of a material that is no mixture; `smooth` if a surface that wears it has
    /// interpolated normals.
    fn of(material: &Material, smooth: bool) -> Self {
        match &material.bsdf {
            Bsdf::Diffuse { roughness, .. } if *roughness > 0.0 => Self::RoughDiffuse,
            Bsdf::Diffuse { reflectance, .. } => {
                let bent = smooth || material.normal_map.is_some();
                if bent || reflectance.texture.is_some() {
                    Self::Diffuse
                } else {
                    Self::Plain
                }
            }
            _ => Self::Diffuse,
        }
    }
}

/// The effects that a scene calls for under some settings.
#[derive(Clone, Debug, Default)]
pub struct Effects {
    /// In the order of the wave's stages.
    pub list: Vec<Effect>,
    /// By material: what scatters there. Materials that no surface wears call for nothing and count as
    /// plain.
    pub shaders: Vec<Shader>,
    /// Whether rays that leave the scene can find light.
    pub beyond: bool,
    /// Whether there are lights that are no surfaces.
    pub lights: bool,
    /// Whether surfaces emit.
    pub emission: bool,
}

impl Effects {
    /// What `scene` calls for under `settings`.
    #[must_use]
    pub fn of(scene: &Scene, settings: &Settings) -> Self {
        let mut effects = Self::default();
        let transport = matches!(
            settings.integrator,
            Integrator::Path | Integrator::Direct | Integrator::Reference
        );
        effects.camera(scene);
        effects.light(scene);
        effects.surfaces(scene, transport);
        if transport && settings.roulette {
            effects.add("roulette", "setting `roulette`");
        }
        let samples_lights = matches!(settings.strategy, Strategy::Light | Strategy::Mis);
        let any = effects.beyond || effects.lights || effects.emission;
        let asked = (samples_lights && any).then(|| "setting `strategy`".to_owned());
        // Lights that no direction finds are sampled whatever the strategy.
        let delta = scene.lights.iter().find(|l| l.kind.is_delta());
        let asked = asked.or_else(|| delta.map(|l| format!("light `{}`", l.name)));
        if let Some(asked) = asked.filter(|_| transport) {
            effects.add("next-event estimation", asked);
            let (selection, reason) = light_selection(scene, settings);
            if selection == LightSelection::Tree {
                effects.add("light tree", reason);
            }
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

    fn light(&mut self, scene: &Scene) {
        if let Some(sky) = scene.sky.as_ref().filter(|sky| sky.shines()) {
            self.beyond = true;
            match sky {
                Sky::Gradient { .. } => self.add("sky", "the scene's `sky`"),
                Sky::Map(_) => self.add("environment map", "the scene's `sky`"),
            }
        }
        for light in &scene.lights {
            let (name, beyond) = match light.kind {
                LightKind::Point { spot: None, .. } => ("point lights", false),
                LightKind::Point { .. } => ("spots", false),
                LightKind::Distant { half_angle, .. } => match half_angle > 0.0 {
                    true => ("discs in the sky", true),
                    false => ("parallel light", false),
                },
            };
            self.beyond |= beyond;
            self.lights = true;
            if !self.list.iter().any(|effect| effect.name == name) {
                self.add(name, format!("light `{}`", light.name));
            }
        }
        let emits = |m: &&Material| m.emits();
        let worn = worn(scene);
        let mut emitting = scene.materials.iter().zip(&worn).filter(|(_, w)| **w);
        if let Some((m, _)) = emitting.find(|(m, _)| emits(m)) {
            self.emission = true;
            self.add("emissive triangles", material(m));
        }
    }

    fn surfaces(&mut self, scene: &Scene, transport: bool) {
        let worn = worn(scene);
        let smooth = smooth(scene);
        self.shaders = (0..scene.materials.len())
            .map(|i| match (transport, worn[i]) {
                (true, true) => Shader::of(&scene.materials[i], smooth[i]),
                _ => Shader::Plain,
            })
            .collect();
        for shader in Shader::ALL {
            let calls = |i: &usize| worn[*i] && self.shaders[*i] == shader;
            if let Some(i) = (0..worn.len()).find(calls) {
                let reason = material(&scene.materials[i]);
                self.add(shader.name(), reason);
            }
        }
        if let Some(i) = smooth.iter().position(|&s| s).filter(|_| transport) {
            self.add("shading normals", material(&scene.materials[i]));
        }
    }
}

/// The fewest lights at a finite distance for which a tree is worth its steps: see
/// docs/performance.md.
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

fn material(material: &Material) -> String {
    match material.name.as_str() {
        "" => "a material without a name".to_owned(),
        name => format!("material `{name}`"),
    }
}

/// By material: whether any surface wears it.
fn worn(scene: &Scene) -> Vec<bool> {
    let mut worn = vec![false; scene.materials.len()];
    for &m in &scene.mesh.material {
        worn[m as usize] = true;
    }
    worn
}

/// By material: whether a surface that wears it has interpolated normals.
fn smooth(scene: &Scene) -> Vec<bool> {
    let mesh = &scene.mesh;
    let mut smooth = vec![false; scene.materials.len()];
    for (triangle, &m) in mesh.indices.iter().zip(&mesh.material) {
        let has = |&v: &u32| {
            let normal = mesh.normals.get(v as usize);
            normal.is_some_and(|&n| n != crate::scene::Mesh::NO_NORMAL)
        };
        smooth[m as usize] |= triangle.iter().all(has);
    }
    smooth
}
