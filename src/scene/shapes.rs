//! Shapes of a scene file to triangles in world space.

use super::builder::{Builder, Placed};
use super::compiled::Material;
use super::description::{Cuboid, InlineMesh, Rectangle, Shape};
use super::error::{SceneError, io_message};
use super::import::{Imported, mtl, obj};
use super::toml::{SceneFile, suggest};
use super::transform::vector;
use super::triangulate::triangulate;
use glam::{DAffine3, DVec3};
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use toml::Spanned;

/// Shapes on their way into a scene's tables.
pub(super) struct Shapes<'a> {
    pub(super) file: &'a SceneFile,
    pub(super) builder: Builder,
    pub(super) materials: Vec<Material>,
    pub(super) warnings: Vec<String>,
    /// Materials that the scene file names.
    named: HashMap<String, u32>,
    /// Files loaded so far, with the table index of each of their materials once one is in use.
    loaded: HashMap<PathBuf, (Rc<Imported>, Vec<Option<u32>>)>,
    /// Material of inline shapes that name none.
    grey: Option<u32>,
}

impl<'a> Shapes<'a> {
    /// Begins with the materials that the scene file names.
    pub(super) fn new(file: &'a SceneFile, materials: Vec<Material>) -> Self {
        let named = materials
            .iter()
            .enumerate()
            .map(|(i, m)| (m.name.clone(), i as u32))
            .collect();
        Self {
            file,
            builder: Builder::default(),
            materials,
            warnings: Vec::new(),
            named,
            loaded: HashMap::new(),
            grey: None,
        }
    }

    /// Adds one shape.
    pub(super) fn add(&mut self, shape: &Spanned<Shape>) -> Result<(), SceneError> {
        let (span, shape) = (shape.span(), shape.get_ref());
        let transform = match &shape.transform {
            Some(t) => t
                .get_ref()
                .compile()
                .map_err(|e| self.file.error(t.span(), e))?,
            None => DAffine3::IDENTITY,
        };
        match (&shape.obj, &shape.rectangle, &shape.cuboid, &shape.mesh) {
            (Some(obj), None, None, None) => self.add_obj(obj, shape, span, transform),
            (None, Some(rectangle), None, None) => {
                let corners = rectangle_corners(rectangle);
                self.add_inline(shape, span, transform, &corners, &[[0, 1, 2], [0, 2, 3]])
            }
            (None, None, Some(cuboid), None) => {
                let (corners, triangles) = self.cuboid(cuboid)?;
                self.add_inline(shape, span, transform, &corners, &triangles)
            }
            (None, None, None, Some(mesh)) => {
                let (corners, triangles) = self.inline_mesh(mesh)?;
                self.add_inline(shape, span, transform, &corners, &triangles)
            }
            _ => {
                let message = "expected exactly one of `obj`, `rectangle`, `box` or `mesh`";
                Err(self.file.error(span, message))
            }
        }
    }

    fn add_inline(
        &mut self,
        shape: &Shape,
        span: Range<usize>,
        transform: DAffine3,
        corners: &[DVec3],
        triangles: &[[u32; 3]],
    ) -> Result<(), SceneError> {
        if let Some((name, _)) = shape.materials.first_key_value() {
            let message = "`materials` renames those of an `obj`, expected `material`";
            return Err(self.file.error(name.span(), message));
        }
        let material = match &shape.material {
            Some(name) => self.lookup(name)?,
            None => *self.grey.get_or_insert_with(|| {
                self.materials.push(mtl::grey("default"));
                self.materials.len() as u32 - 1
            }),
        };
        let placed = Placed {
            vertices: corners.iter().copied(),
            triangles,
            transform,
        };
        self.builder
            .append(placed, |_| material)
            .map_err(|e| self.file.error(span, e))
    }

    fn add_obj(
        &mut self,
        obj: &Spanned<String>,
        shape: &Shape,
        span: Range<usize>,
        transform: DAffine3,
    ) -> Result<(), SceneError> {
        let folder = self.file.path.parent().unwrap_or(Path::new(""));
        let path = folder.join(obj.get_ref());
        let (imported, mut used) = match self.loaded.remove(&path) {
            Some(known) => known,
            None => {
                // A file that is not there is the scene file's mistake; one that is wrong is not.
                if let Err(e) = std::fs::File::open(&path) {
                    let message = format!("{}: {}", path.display(), io_message(&e));
                    return Err(self.file.error(obj.span(), message));
                }
                let mut imported = obj::load(&path)?;
                self.warnings.append(&mut imported.warnings);
                let used = vec![None; imported.materials.len()];
                (Rc::new(imported), used)
            }
        };
        let whole = shape.material.as_ref().map(|name| self.lookup(name));
        let whole = whole.transpose()?;
        let mut replaced = HashMap::new();
        for (own, by) in &shape.materials {
            let names = || imported.materials.iter().map(|m| m.name.as_str());
            if !names().any(|name| name == own.get_ref()) {
                let names: Vec<&str> = names().filter(|n| !n.is_empty()).collect();
                let message = format!(
                    "{} has no material `{}`, {}",
                    path.display(),
                    own.get_ref(),
                    suggest(own.get_ref(), &names)
                );
                return Err(self.file.error(own.span(), message));
            }
            replaced.insert(own.get_ref().as_str(), self.lookup(by)?);
        }
        let mut table = vec![0; imported.materials.len()];
        for &slot in &imported.material {
            let slot = slot as usize;
            let own = &imported.materials[slot];
            let replacement = replaced.get(own.name.as_str()).copied().or(whole);
            table[slot] = replacement.unwrap_or_else(|| {
                *used[slot].get_or_insert_with(|| {
                    self.materials.push(own.clone());
                    self.materials.len() as u32 - 1
                })
            });
        }
        let vertex = |v: &[f32; 3]| DVec3::from_array(v.map(f64::from));
        let placed = Placed {
            vertices: imported.vertices.iter().map(vertex),
            triangles: &imported.triangles,
            transform,
        };
        self.builder
            .append(placed, |i| table[imported.material[i] as usize])
            .map_err(|e| self.file.error(span, e))?;
        self.loaded.insert(path, (imported, used));
        Ok(())
    }

    /// Index of a material that the scene file names.
    fn lookup(&self, name: &Spanned<String>) -> Result<u32, SceneError> {
        self.named.get(name.get_ref()).copied().ok_or_else(|| {
            let mut names: Vec<&str> = self.named.keys().map(String::as_str).collect();
            names.sort_unstable();
            let hint = suggest(name.get_ref(), &names);
            let message = format!("no material `{}`, {hint}", name.get_ref());
            self.file.error(name.span(), message)
        })
    }

    fn cuboid(&self, cuboid: &Spanned<Cuboid>) -> Result<Triangles, SceneError> {
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
        let mut triangles = Vec::with_capacity(12);
        for [a, b, c, d] in quads {
            let (b, d) = if cuboid.inward { (d, b) } else { (b, d) };
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        Ok(((0..8).map(corner).collect(), triangles))
    }

    fn inline_mesh(&self, mesh: &Spanned<InlineMesh>) -> Result<Triangles, SceneError> {
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
        Ok((vertices, triangles))
    }
}

type Triangles = (Vec<DVec3>, Vec<[u32; 3]>);

/// Corners in order around the rectangle.
fn rectangle_corners(rectangle: &Rectangle) -> [DVec3; 4] {
    let corner = vector(rectangle.corner);
    let [a, b] = rectangle.edges.map(vector);
    [corner, corner + a, corner + a + b, corner + b]
}
