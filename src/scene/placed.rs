//! What a scene holds besides the triangles of its world: spheres, and copies of objects.

use super::compiled::{Mesh, Scene};
use super::material::{Bsdf, Material};
use super::motion::Motion;
use crate::effects::polished;
use glam::{DAffine3, DMat3, DVec3};

/// A sphere in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, finite.
    pub centre: [f32; 3],
    /// Radius, positive and finite.
    pub radius: f32,
    /// Material index.
    pub material: u32,
}

impl Sphere {
    /// Its surface's area.
    #[must_use]
    pub fn area(&self) -> f64 {
        4.0 * std::f64::consts::PI * f64::from(self.radius).powi(2)
    }
}

/// Triangles that instances copy, in a space of their own. Their materials emit nothing.
#[derive(Clone, Debug, Default)]
pub struct Object {
    /// Its name in the scene file.
    pub name: String,
    /// At least one triangle.
    pub mesh: Mesh,
}

/// A copy of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index of the object.
    pub object: u32,
    /// Where it stands when the shutter opens.
    pub placement: Placement,
    /// The material that all of it wears instead of the object's own; emits nothing.
    pub material: Option<u32>,
    /// How it moves from there while the shutter is open, if it does: it turns about its origin.
    pub motion: Option<Motion>,
}

/// An affine map from an object's space to the world's, as rays see it: through its inverse, rounded
/// to f32.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Rows of the inverse of the linear part.
    pub to_object: [[f32; 3]; 3],
    /// Rows of the linear part: the inverse of that, rounded.
    pub to_world: [[f32; 3]; 3],
    /// Where the object's origin lies.
    pub origin: [f32; 3],
}

/// Larger entries of either matrix are refused: distances along a ray must not overflow in either
/// space.
const LARGEST: f32 = (1u64 << 60) as f32;

impl Placement {
    /// The nearest to `map` that rays can see.
    ///
    /// # Errors
    /// If it is too large, too small or too flat: an entry of the linear part or of its inverse is
    /// beyond 2^60, or the place beyond the range of f32.
    pub fn new(map: &DAffine3) -> Result<Self, String> {
        let to_object = rows(&map.matrix3.inverse());
        let to_world = rows(&matrix(to_object).inverse());
        let origin = map.translation.as_vec3().to_array();
        let entries = [to_object, to_world];
        let entries = entries.as_flattened().as_flattened();
        let fits = |c: &f32| c.abs() <= LARGEST;
        if !entries.iter().all(fits) || !origin.iter().all(|c| c.is_finite()) {
            return Err(format!(
                "an instance is scaled by {:.3e}, expected less than 2^60 and more than 2^-60, and \
                 a place within the range of 32-bit floats",
                map.matrix3.determinant().abs().cbrt()
            ));
        }
        Ok(Self {
            to_object,
            to_world,
            origin,
        })
    }

    /// The map in f64: exactly where rays meet the object.
    #[must_use]
    pub fn map(&self) -> DAffine3 {
        let origin = DVec3::from_array(self.origin.map(f64::from));
        DAffine3::from_mat3_translation(matrix(self.to_object).inverse(), origin)
    }
}

fn rows(m: &DMat3) -> [[f32; 3]; 3] {
    m.transpose()
        .to_cols_array_2d()
        .map(|row| row.map(|c| c as f32))
}

fn matrix(rows: [[f32; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(&rows.map(|row| row.map(f64::from))).transpose()
}

/// What stands in the world.
pub(super) struct Placed<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) spheres: &'a [Sphere],
    pub(super) objects: &'a [Object],
    pub(super) instances: &'a [Instance],
}

impl<'a> Placed<'a> {
    pub(super) fn triangles(mesh: &'a Mesh) -> Self {
        Self {
            mesh,
            spheres: &[],
            objects: &[],
            instances: &[],
        }
    }

    /// Points whose hull holds everything: corners of triangles, and those of boxes around spheres
    /// and copies.
    pub(super) fn points(&self) -> impl Iterator<Item = DVec3> {
        let vertex = |&v: &u32| vector(self.mesh.vertices[v as usize]);
        let triangles = self.mesh.indices.iter().flatten().map(vertex);
        let spheres = self.spheres.iter().flat_map(|s| {
            let (centre, radius) = (vector(s.centre), DVec3::splat(s.radius.into()));
            corners([centre - radius, centre + radius])
        });
        let boxes: Vec<[DVec3; 2]> = self.objects.iter().map(|o| hull(&o.mesh)).collect();
        let copies = self.instances.iter().flat_map(move |i| {
            let map = i.placement.map();
            corners(boxes[i.object as usize]).map(move |p| map.transform_point3(p))
        });
        triangles.chain(spheres).chain(copies)
    }
}

impl Scene {
    /// Whether any triangle, of the world or of an object, may be smooth.
    #[must_use]
    pub fn has_normals(&self) -> bool {
        let objects = self.objects.iter().map(|o| &o.mesh);
        let mut meshes = objects.chain([&self.mesh]);
        meshes.any(|mesh| !mesh.normals.is_empty())
    }

    /// Lowest and highest corner of a box around everything, if there is anything: around triangles
    /// and spheres as tight as can be, around copies of objects up to their objects' boxes.
    #[must_use]
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let placed = Placed {
            mesh: &self.mesh,
            spheres: &self.spheres,
            objects: &self.objects,
            instances: &self.instances,
        };
        let both = placed.points().map(|p| [p, p]);
        both.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Whether there is nothing to hit.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mesh.indices.is_empty() && self.spheres.is_empty() && self.instances.is_empty()
    }

    /// Triangles, those of copies counted as often as they are there.
    #[must_use]
    pub fn placed_triangles(&self) -> u64 {
        let of = |i: &Instance| self.objects[i.object as usize].mesh.triangles() as u64;
        self.mesh.triangles() as u64 + self.instances.iter().map(of).sum::<u64>()
    }

    /// Triangles in memory: those of objects counted once.
    #[must_use]
    pub fn stored_triangles(&self) -> usize {
        let objects = self.objects.iter().map(|o| o.mesh.triangles());
        self.mesh.triangles() + objects.sum::<usize>()
    }

    /// A worn metal whose highlights are longer one way, if there is one and texture coordinates may say
    /// which way that is.
    #[must_use]
    pub fn is_brushed(&self) -> Option<&Material> {
        let objects = self.objects.iter().map(|o| &o.mesh);
        let mut meshes = objects.chain([&self.mesh]);
        if self.spheres.is_empty() && meshes.all(|mesh| mesh.uvs.is_empty()) {
            return None;
        }
        let brushed = |m: &Material| match &m.bsdf {
            Bsdf::Conductor {
                roughness,
                anisotropy,
                ..
            } => *anisotropy != 0.0 && !polished(roughness),
            _ => false,
        };
        let mut all = self.materials.iter().zip(self.worn());
        all.find(|(m, worn)| *worn && brushed(m)).map(|(m, _)| m)
    }

    /// By material, whether any surface wears it, or a mixture of which it is part.
    #[must_use]
    pub fn worn(&self) -> Vec<bool> {
        let mut worn = vec![false; self.materials.len()];
        for &m in &self.mesh.material {
            worn[m as usize] = true;
        }
        for sphere in &self.spheres {
            worn[sphere.material as usize] = true;
        }
        let mut own = vec![false; self.objects.len()];
        for instance in &self.instances {
            match instance.material {
                Some(m) => worn[m as usize] = true,
                None => own[instance.object as usize] = true,
            }
        }
        for (object, _) in self.objects.iter().zip(own).filter(|(_, own)| *own) {
            for &m in &object.mesh.material {
                worn[m as usize] = true;
            }
        }
        let mut mixtures: Vec<usize> = (0..worn.len()).filter(|&m| worn[m]).collect();
        while let Some(m) = mixtures.pop() {
            for part in self.materials[m].parts() {
                if !std::mem::replace(&mut worn[part as usize], true) {
                    mixtures.push(part as usize);
                }
            }
        }
        worn
    }
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// The box around the triangles of a mesh.
fn hull(mesh: &Mesh) -> [DVec3; 2] {
    let vertices = mesh.indices.iter().flatten();
    let points = vertices.map(|&v| vector(mesh.vertices[v as usize]));
    let both = points.map(|p| [p, p]);
    both.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
        .unwrap_or_default()
}

fn corners([low, high]: [DVec3; 2]) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |bits| {
        let at = |axis: u32| bits >> axis & 1 == 1;
        DVec3::select(glam::BVec3::new(at(0), at(1), at(2)), high, low)
    })
}
