//! Shapes of a scene file to triangles in world space.

use super::builder::{Builder, Placed};
use super::description::{Ball, Cuboid, InlineMesh, Rectangle, Shape};
use super::error::SceneError;
use super::import::{Imported, mtl};
use super::load::GeometryFile;
use super::material::{Bsdf, Material};
use super::placed::Sphere;
use super::toml::{SceneFile, suggest};
use super::transform::{Transform, vector};
use super::triangulate::triangulate;
use super::values::Finite;
use glam::{DAffine3, DMat3, DVec3};
use std::collections::HashMap;
use std::ops::Range;
use toml::Spanned;

/// Shapes on their way into a scene's tables.
pub(super) struct Shapes<'a> {
    pub(super) file: &'a SceneFile,
    pub(super) builder: Builder,
    pub(super) spheres: Vec<Sphere>,
    pub(super) materials: Vec<Material>,
    pub(super) warnings: Vec<String>,
    /// Materials that the scene file names.
    named: HashMap<String, u32>,
    files: &'a [GeometryFile],
    loaded: Vec<Loaded>,
    /// Material of inline shapes that name none.
    grey: Option<u32>,
}

/// What one of the scene's files holds, until the last shape that names it has been added.
struct Loaded {
    imported: Imported,
    /// Shapes still to come that name it.
    uses: usize,
    /// The table index of each of its materials that is in use.
    used: Vec<Option<u32>>,
}

impl<'a> Shapes<'a> {
    /// Begins with the materials that the scene file names, and with what its files hold; without
    /// that, shapes can be checked but not added.
    pub(super) fn new(
        file: &'a SceneFile,
        materials: &[Material],
        files: &'a [GeometryFile],
        imported: Vec<Imported>,
    ) -> Self {
        let named = materials
            .iter()
            .enumerate()
            .map(|(i, m)| (m.name.clone(), i as u32))
            .collect();
        let loaded = |(imported, file): (Imported, &GeometryFile)| Loaded {
            uses: file.uses,
            used: vec![None; imported.materials.len()],
            imported,
        };
        Self {
            file,
            builder: Builder::default(),
            spheres: Vec::new(),
            materials: materials.to_vec(),
            warnings: Vec::new(),
            named,
            files,
            loaded: imported.into_iter().zip(files).map(loaded).collect(),
            grey: None,
        }
    }

    /// What can be told to be wrong before the geometry is there.
    pub(super) fn check(&self, shape: &Spanned<Shape>) -> Result<(), SceneError> {
        let (span, shape) = (shape.span(), shape.get_ref());
        self.transform(shape)?;
        let kinds = [
            shape.obj.is_some(),
            shape.ply.is_some(),
            shape.rectangle.is_some(),
            shape.cuboid.is_some(),
            shape.mesh.is_some(),
            shape.sphere.is_some(),
        ];
        if kinds.into_iter().filter(|&given| given).count() != 1 {
            let message =
                "expected exactly one of `obj`, `ply`, `rectangle`, `box`, `mesh` or `sphere`";
            return Err(self.file.error(span, message));
        }
        if let (None, Some((name, _))) = (&shape.obj, shape.materials.first_key_value()) {
            let message = "`materials` renames those of an `obj`, expected `material`";
            return Err(self.file.error(name.span(), message));
        }
        let names = shape.material.iter().chain(shape.materials.values());
        names
            .map(|name| self.lookup(name))
            .collect::<Result<Vec<_>, _>>()?;
        Ok(())
    }

    /// Adds one shape that has been checked.
    pub(super) fn add(&mut self, shape: &Spanned<Shape>) -> Result<(), SceneError> {
        let (span, shape) = (shape.span(), shape.get_ref());
        let transform = self.transform(shape)?;
        let textured = shape.material.as_ref().is_some_and(|name| {
            let material = self.named.get(name.get_ref());
            material.is_some_and(|&m| self.materials[m as usize].reads_textures(&self.materials))
        });
        let drawn = if let Some(rectangle) = &shape.rectangle {
            let [a, b] = rectangle.edges.map(vector);
            if a.cross(b) == DVec3::ZERO {
                let message = "a rectangle without area, expected edges in two directions";
                return Err(self.file.error(span, message));
            }
            Drawn::rectangle(rectangle, textured)
        } else if let Some(cuboid) = &shape.cuboid {
            self.cuboid(cuboid, textured)?
        } else if let Some(mesh) = &shape.mesh {
            self.inline_mesh(mesh)?
        } else if let Some(ball) = &shape.sphere {
            let sphere = sphere(ball, &transform, self.worn(shape)?);
            self.spheres
                .push(sphere.map_err(|e| self.file.error(span, e))?);
            return Ok(());
        } else {
            return self.add_file(shape, span, transform);
        };
        self.add_inline(shape, span, transform, &drawn)
    }

    fn transform(&self, shape: &Shape) -> Result<DAffine3, SceneError> {
        self.placement(shape.transform.as_ref())
    }

    /// The map that a transformation means; none leaves everything where it is.
    pub(super) fn placement(
        &self,
        transform: Option<&Spanned<Transform>>,
    ) -> Result<DAffine3, SceneError> {
        match transform {
            Some(t) => t
                .get_ref()
                .compile()
                .map_err(|e| self.file.error(t.span(), e)),
            None => Ok(DAffine3::IDENTITY),
        }
    }

    /// The material of a shape that is written in the scene file itself.
    fn worn(&mut self, shape: &Shape) -> Result<u32, SceneError> {
        match &shape.material {
            Some(name) => self.lookup(name),
            None => Ok(*self.grey.get_or_insert_with(|| {
                self.materials.push(mtl::grey("default"));
                self.materials.len() as u32 - 1
            })),
        }
    }

    fn add_inline(
        &mut self,
        shape: &Shape,
        span: Range<usize>,
        transform: DAffine3,
        drawn: &Drawn,
    ) -> Result<(), SceneError> {
        let material = self.worn(shape)?;
        let placed = Placed {
            vertices: &drawn.vertices,
            normals: &drawn.normals,
            uvs: &drawn.uvs,
            triangles: &drawn.triangles,
            transform,
            material,
        };
        self.builder
            .append(&placed)
            .map_err(|e| self.file.error(span, e))
    }

    fn add_file(
        &mut self,
        shape: &Shape,
        span: Range<usize>,
        transform: DAffine3,
    ) -> Result<(), SceneError> {
        let named = shape.file();
        let place = named.and_then(|(name, format)| {
            let path = self.file.beside(name.get_ref());
            let is = |f: &GeometryFile| f.path == path && f.format == format;
            self.files.iter().position(is)
        });
        let Some(place) = place else {
            unreachable!("files are loaded before their shapes are added");
        };
        let whole = shape.material.as_ref().map(|name| self.lookup(name));
        let whole = whole.transpose()?;
        let own = &self.loaded[place].imported.materials;
        let mut replaced = HashMap::new();
        for (name, by) in &shape.materials {
            if !own.iter().any(|m| m.name == *name.get_ref()) {
                let names = own.iter().map(|m| m.name.as_str());
                let names: Vec<&str> = names.filter(|n| !n.is_empty()).collect();
                let message = format!(
                    "{} has no material `{}`, {}",
                    self.files[place].path.display(),
                    name.get_ref(),
                    suggest(name.get_ref(), &names)
                );
                return Err(self.file.error(name.span(), message));
            }
            replaced.insert(name.get_ref().as_str(), self.lookup(by)?);
        }
        let Loaded {
            imported,
            uses,
            used,
        } = &mut self.loaded[place];
        self.warnings.append(&mut imported.warnings);
        // Every material of a file is worn by some triangle of it, or part of one that is.
        let before = self.materials.len();
        let table: Vec<u32> = imported
            .materials
            .iter()
            .zip(used)
            .map(|(own, used)| {
                let replacement = replaced.get(own.name.as_str()).copied().or(whole);
                replacement.unwrap_or_else(|| {
                    *used.get_or_insert_with(|| {
                        self.materials.push(own.clone());
                        self.materials.len() as u32 - 1
                    })
                })
            })
            .collect();
        for material in &mut self.materials[before..] {
            if let Bsdf::Mix { first, second, .. } = &mut material.bsdf {
                *first = table[*first as usize];
                *second = table[*second as usize];
            }
        }
        *uses -= 1;
        let mut geometry = if *uses == 0 {
            Imported {
                materials: Vec::new(),
                ..std::mem::take(imported)
            }
        } else {
            imported.clone()
        };
        for material in &mut geometry.material {
            *material = table[*material as usize];
        }
        self.builder
            .append_file(geometry, transform)
            .map_err(|e| self.file.error(span, e))
    }

    /// Index of a material that the scene file names.
    pub(super) fn lookup(&self, name: &Spanned<String>) -> Result<u32, SceneError> {
        self.named.get(name.get_ref()).copied().ok_or_else(|| {
            let mut names: Vec<&str> = self.named.keys().map(String::as_str).collect();
            names.sort_unstable();
            let hint = suggest(name.get_ref(), &names);
            let message = format!("no material `{}`, {hint}", name.get_ref());
            self.file.error(name.span(), message)
        })
    }

    fn cuboid(&self, cuboid: &Spanned<Cuboid>, textured: bool) -> Result<Drawn, SceneError> {
        let (span, cuboid) = (cuboid.span(), cuboid.get_ref());
        let (low, high) = (vector(cuboid.min), vector(cuboid.max));
        if !low.cmplt(high).all() {
            let message = "expected every coordinate of `min` below that of `max`";
            return Err(self.file.error(span, message));
        }
        // Bit i of a corner's number says whether it lies at `max` along axis i.
        let corner = |i: u32| {
            let at = |axis: u32| i >> axis & 1 == 1;
            DVec3::select(glam::BVec3::new(at(0), at(1), at(2)), high, low)
        };
        let quads: [[u32; 4]; 6] = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let mut drawn = Drawn::default();
        if !textured {
            drawn.vertices = (0..8).map(corner).collect();
        }
        for (face, [a, b, c, d]) in (0..).zip(quads) {
            let [a, b, c, d] = if textured {
                // Each face has the whole image, seen from its front.
                drawn.vertices.extend([a, b, c, d].map(corner));
                drawn.uvs.extend(SQUARE);
                [0, 1, 2, 3].map(|i| 4 * face + i)
            } else {
                [a, b, c, d]
            };
            let (b, d) = if cuboid.inward { (d, b) } else { (b, d) };
            drawn.triangles.extend([[a, b, c], [a, c, d]]);
        }
        Ok(drawn)
    }

    fn inline_mesh(&self, mesh: &Spanned<InlineMesh>) -> Result<Drawn, SceneError> {
        let (span, mesh) = (mesh.span(), mesh.get_ref());
        let vertices: Vec<DVec3> = mesh.vertices.iter().map(|&v| vector(v)).collect();
        if mesh.faces.is_empty() {
            return Err(self.file.error(span, "has no faces, expected at least one"));
        }
        let mut triangles = Vec::new();
        let mut cut = Vec::new();
        for face in &mesh.faces {
            let indices = face.get_ref();
            if indices.len() < 3 {
                let message = format!("a face has {} corners, expected 3 or more", indices.len());
                return Err(self.file.error(face.span(), message));
            }
            if let Some(bad) = indices.iter().find(|i| i.0 as usize >= vertices.len()) {
                let message = format!(
                    "a face has vertex index {}, expected one of the {} vertices, from 0",
                    bad.0,
                    vertices.len()
                );
                return Err(self.file.error(face.span(), message));
            }
            let corners: Vec<DVec3> = indices.iter().map(|i| vertices[i.0 as usize]).collect();
            cut.clear();
            triangulate(&corners, &mut cut);
            triangles.extend(cut.iter().map(|t| t.map(|i| indices[i as usize].0)));
        }
        let count = vertices.len();
        let whole = |what: &str, found: usize, span: Range<usize>| {
            let message =
                format!("has {found} {what}, expected one for each of its {count} vertices");
            (found == count)
                .then_some(())
                .ok_or_else(|| self.file.error(span, message))
        };
        let (mut normals, mut uvs) = (Vec::new(), Vec::new());
        if let Some(said) = &mesh.normals {
            whole("normals", said.get_ref().len(), said.span())?;
            normals = said.get_ref().iter().map(|&n| vector(n)).collect();
        }
        if let Some(said) = &mesh.uvs {
            whole("uvs", said.get_ref().len(), said.span())?;
            let uv = |uv: &[Finite; 2]| uv.map(|x| x.0 as f32);
            uvs = said.get_ref().iter().map(uv).collect();
        }
        Ok(Drawn {
            vertices,
            triangles,
            normals,
            uvs,
        })
    }
}

/// Texture coordinates around a square.
const SQUARE: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// A shape that the scene file itself describes.
#[derive(Default)]
struct Drawn {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    uvs: Vec<[f32; 2]>,
}

impl Drawn {
    /// Its (u, v) run along the first and the second edge.
    fn rectangle(rectangle: &Rectangle, textured: bool) -> Self {
        let corner = vector(rectangle.corner);
        let [a, b] = rectangle.edges.map(vector);
        Self {
            vertices: vec![corner, corner + a, corner + a + b, corner + b],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            uvs: if textured {
                SQUARE.to_vec()
            } else {
                Vec::new()
            },
            ..Self::default()
        }
    }
}

/// A sphere in the world. Its transformation must leave it one: the columns are then of one length
/// and at right angles, to the roundings of the few products that may have made them.
fn sphere(ball: &Ball, transform: &DAffine3, material: u32) -> Result<Sphere, &'static str> {
    let columns = transform.matrix3;
    let square = columns.transpose() * columns;
    let scale = (square.x_axis.x + square.y_axis.y + square.z_axis.z) / 3.0;
    let off = square - DMat3::from_diagonal(DVec3::splat(scale));
    let largest = off
        .to_cols_array()
        .into_iter()
        .fold(0.0, |m: f64, c| m.max(c.abs()));
    // A matrix may have been written with the digits of f32.
    if largest > 16.0 * f64::from(f32::EPSILON) * scale {
        return Err("a sphere can be scaled, but not differently along different axes");
    }
    let centre = transform.transform_point3(vector(ball.center));
    let sphere = Sphere {
        centre: centre.as_vec3().to_array(),
        radius: (ball.radius.0 * scale.sqrt()) as f32,
        material,
        // The inverse of what is orthogonal but for a scale: its columns are the rows here.
        turn: (columns * scale.sqrt().recip())
            .to_cols_array_2d()
            .map(|column| column.map(|c| c as f32)),
    };
    let [x, y, z] = sphere.centre;
    let fits = [x, y, z, sphere.radius].into_iter().all(f32::is_finite);
    if fits && sphere.radius > 0.0 {
        Ok(sphere)
    } else {
        Err("the sphere lies beyond the range of 32-bit floats")
    }
}
