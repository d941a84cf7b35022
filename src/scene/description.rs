//! What a native scene file says, key by key. `docs/scene-format.md` describes every key to users;
//! a key that is not declared here is an error.

use super::compiled::Filter;
use super::import::{Counts, Format};
use super::surfaces::Material;
use super::transform::{Rotation, Transform};
use super::values::{
    Angle, Count, FieldOfView, Finite, MeanCosine, Natural, NonNegative, OneOrThree, Pixels,
    Positive, Radius, Turbidity, Unit,
};
use super::ways::{Roulette, Split};
use crate::settings::{Integrator, LightSelection, Preset, Sampler, Strategy, TextureLod};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// A whole scene file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[serde(expecting = "a scene")]
pub(super) struct Description {
    pub(super) name: Option<String>,
    pub(super) camera: Option<Spanned<Camera>>,
    pub(super) film: Film,
    pub(super) settings: Settings,
    pub(super) sky: Option<Spanned<Sky>>,
    pub(super) lights: Vec<Spanned<Light>>,
    pub(super) media: BTreeMap<String, Spanned<Medium>>,
    pub(super) fog: Option<Spanned<Fog>>,
    pub(super) materials: BTreeMap<String, Spanned<Material>>,
    pub(super) shapes: Vec<Spanned<Shape>>,
    pub(super) objects: BTreeMap<String, Object>,
    pub(super) instances: Vec<Spanned<Instance>>,
}

impl Description {
    /// The shapes of the world, then those of objects.
    pub(super) fn all_shapes(&self) -> impl Iterator<Item = &Spanned<Shape>> {
        let in_objects = self.objects.values().flat_map(|object| &object.shapes);
        self.shapes.iter().chain(in_objects)
    }
}

/// `[media.NAME]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[serde(expecting = "a table such as { scattering = 0.1 }")]
pub(super) struct Medium {
    pub(super) absorption: Option<OneOrThree<NonNegative>>,
    pub(super) scattering: Option<OneOrThree<NonNegative>>,
    pub(super) g: Option<MeanCosine>,
}

/// `[fog]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table such as { medium = \"mist\" }")]
pub(super) struct Fog {
    pub(super) medium: Spanned<String>,
    #[serde(default)]
    pub(super) within: Option<Spanned<Extents>>,
}

/// An axis-aligned box.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `min` and `max`")]
pub(super) struct Extents {
    pub(super) min: [Finite; 3],
    pub(super) max: [Finite; 3],
}

/// `[objects.NAME]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `shapes`")]
pub(super) struct Object {
    pub(super) shapes: Vec<Spanned<Shape>>,
}

/// `[[instances]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table such as { object = \"tree\" }")]
pub(super) struct Instance {
    pub(super) object: Spanned<String>,
    pub(super) material: Option<Spanned<String>>,
    pub(super) transform: Option<Spanned<Transform>>,
    pub(super) scatter: Option<Scatter>,
    pub(super) motion: Option<Spanned<Motion>>,
}

/// What moves while the shutter is open.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[serde(expecting = "a table such as { translate = [1, 0, 0] }")]
pub(super) struct Motion {
    pub(super) translate: Option<[Finite; 3]>,
    pub(super) rotate: Option<Spanned<Rotation>>,
}

impl Instance {
    /// How many copies it stands for.
    pub(super) fn copies(&self) -> u32 {
        self.scatter.as_ref().map_or(1, |s| s.count.0)
    }
}

/// Many copies over a parallelogram: a corner of it and the two edges from there.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `count`, `corner` and `edges`")]
pub(super) struct Scatter {
    pub(super) count: Count,
    #[serde(default)]
    pub(super) seed: Natural,
    pub(super) corner: [Finite; 3],
    pub(super) edges: [[Finite; 3]; 2],
    pub(super) scale: Option<[Positive; 2]>,
}

/// `[camera]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default, rename_all = "snake_case")]
#[serde(expecting = "a table such as { origin = [0, 0, 5], target = [0, 0, 0] }")]
pub(super) struct Camera {
    pub(super) origin: Option<Spanned<[Finite; 3]>>,
    pub(super) target: Option<Spanned<[Finite; 3]>>,
    pub(super) up: Option<Spanned<[Finite; 3]>>,
    pub(super) matrix: Option<Spanned<[[Finite; 4]; 4]>>,
    pub(super) kind: CameraKind,
    pub(super) fov: Option<Spanned<FieldOfView>>,
    pub(super) fov_axis: Option<Spanned<FovAxis>>,
    pub(super) aperture: Option<Spanned<Radius>>,
    pub(super) focus: Option<Spanned<Positive>>,
    pub(super) focus_at: Option<Spanned<[Finite; 3]>>,
    pub(super) width: Option<Spanned<Positive>>,
    pub(super) motion: Option<Spanned<Motion>>,
}

/// How a camera projects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum CameraKind {
    #[default]
    Perspective,
    Orthographic,
    Panorama,
}

/// Which extent of the image the field of view spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum FovAxis {
    #[default]
    X,
    Y,
    Smaller,
}

/// `[film]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[serde(expecting = "a table such as { width = 640, height = 480 }")]
pub(super) struct Film {
    pub(super) width: Pixels,
    pub(super) height: Pixels,
    pub(super) filter: Filter,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            width: Pixels(1280),
            height: Pixels(720),
            filter: Filter::Gaussian,
        }
    }
}

/// `[settings]`: what is given replaces the default of [`crate::settings::Settings`].
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[serde(expecting = "a table such as { spp = 64 }")]
pub(super) struct Settings {
    pub(super) integrator: Option<Integrator>,
    pub(super) strategy: Option<Strategy>,
    pub(super) light_selection: Option<LightSelection>,
    pub(super) sampler: Option<Sampler>,
    pub(super) spp: Option<Count>,
    pub(super) max_depth: Option<Natural>,
    pub(super) roulette: Option<Roulette>,
    pub(super) split: Option<Split>,
    pub(super) seed: Option<Natural>,
    pub(super) texture_lod: Option<TextureLod>,
    pub(super) ao_distance: Option<Positive>,
    pub(super) bvh: Option<Preset>,
}

/// `[sky]`: one of `radiance`, `map` and `sun`, which `lights` checks.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[serde(expecting = "a table such as { radiance = 1 }")]
pub(super) struct Sky {
    pub(super) radiance: Option<OneOrThree<NonNegative>>,
    pub(super) nadir: Option<Spanned<OneOrThree<NonNegative>>>,
    pub(super) map: Option<Spanned<String>>,
    pub(super) scale: Option<Spanned<OneOrThree<NonNegative>>>,
    pub(super) rotate: Option<Spanned<Finite>>,
    pub(super) up: Option<Spanned<[Finite; 3]>>,
    pub(super) sun: Option<Spanned<[Finite; 3]>>,
    pub(super) turbidity: Option<Spanned<Turbidity>>,
    pub(super) ground: Option<Spanned<OneOrThree<Unit>>>,
    pub(super) disc: Option<Spanned<bool>>,
}

/// `[[lights]]`: exactly one of the first three, and of the last four, which `lights` checks.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[serde(expecting = "a table such as { point = { position = [0, 2, 0] }, power = 60 }")]
pub(super) struct Light {
    pub(super) point: Option<Point>,
    pub(super) spot: Option<Spot>,
    pub(super) sun: Option<Sun>,
    pub(super) name: Option<String>,
    pub(super) power: Option<Spanned<OneOrThree<NonNegative>>>,
    pub(super) intensity: Option<Spanned<OneOrThree<NonNegative>>>,
    pub(super) irradiance: Option<Spanned<OneOrThree<NonNegative>>>,
    pub(super) radiance: Option<Spanned<OneOrThree<NonNegative>>>,
}

/// Light from a point.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `position`")]
pub(super) struct Point {
    pub(super) position: [Finite; 3],
}

/// Light from a point within a cone.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `position`, `target` and `angle`")]
pub(super) struct Spot {
    pub(super) position: [Finite; 3],
    pub(super) target: Spanned<[Finite; 3]>,
    pub(super) angle: FieldOfView,
    #[serde(default)]
    pub(super) blend: Option<Unit>,
}

/// Light from very far away.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `from` and `angle`")]
pub(super) struct Sun {
    pub(super) from: Spanned<[Finite; 3]>,
    #[serde(default)]
    pub(super) angle: Option<Angle>,
}

/// `[[shapes]]`: exactly one of the first six, which `shapes` checks.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[serde(expecting = "a table such as { obj = \"file.obj\" }")]
pub(super) struct Shape {
    pub(super) obj: Option<Spanned<String>>,
    pub(super) ply: Option<Spanned<String>>,
    pub(super) rectangle: Option<Rectangle>,
    #[serde(rename = "box")]
    pub(super) cuboid: Option<Spanned<Cuboid>>,
    pub(super) mesh: Option<Spanned<InlineMesh>>,
    pub(super) sphere: Option<Ball>,
    pub(super) material: Option<Spanned<String>>,
    pub(super) materials: BTreeMap<Spanned<String>, Spanned<String>>,
    pub(super) transform: Option<Spanned<Transform>>,
}

impl Shape {
    /// The file that holds its geometry, if one does.
    pub(super) fn file(&self) -> Option<(&Spanned<String>, Format)> {
        let obj = self.obj.as_ref().map(|name| (name, Format::Obj));
        obj.or(self.ply.as_ref().map(|name| (name, Format::Ply)))
    }

    /// What is written in the scene file itself.
    pub(super) fn counts(&self) -> Counts {
        let (vertices, triangles) = match (&self.rectangle, &self.cuboid, &self.mesh) {
            (Some(_), ..) => (4, 2),
            (_, Some(_), _) => (8, 12),
            (.., Some(mesh)) => {
                let mesh = mesh.get_ref();
                let corners = |face: &Spanned<Vec<Natural>>| face.get_ref().len() as u64;
                let triangles = mesh.faces.iter().map(|f| corners(f).saturating_sub(2));
                (mesh.vertices.len() as u64, triangles.sum())
            }
            _ => (0, 0),
        };
        Counts {
            vertices,
            triangles,
            spheres: u64::from(self.sphere.is_some()),
            ..Counts::default()
        }
    }
}

/// A sphere; its front is outside.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `center` and `radius`")]
pub(super) struct Ball {
    pub(super) center: [Finite; 3],
    pub(super) radius: Positive,
}

/// A parallelogram: a corner and the two edges from it. Its front is where they turn
/// counter-clockwise from the first to the second.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `corner` and `edges`")]
pub(super) struct Rectangle {
    pub(super) corner: [Finite; 3],
    pub(super) edges: [[Finite; 3]; 2],
}

/// An axis-aligned box whose fronts face outwards, or inwards.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `min` and `max`")]
pub(super) struct Cuboid {
    pub(super) min: [Finite; 3],
    pub(super) max: [Finite; 3],
    #[serde(default)]
    pub(super) inward: bool,
}

/// Polygons over shared vertices, indices from 0, counter-clockwise seen from the front.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table of `vertices` and `faces`")]
pub(super) struct InlineMesh {
    pub(super) vertices: Vec<[Finite; 3]>,
    pub(super) faces: Vec<Spanned<Vec<Natural>>>,
    #[serde(default)]
    pub(super) normals: Option<Spanned<Vec<[Finite; 3]>>>,
    #[serde(default)]
    pub(super) uvs: Option<Spanned<Vec<[Finite; 2]>>>,
}
