//! Files of geometry that a scene names.

pub(super) mod attributes;
pub(super) mod mtl;
mod obj;
pub(super) mod panorama;
mod piece;
mod ply;
mod statements;

use super::error::SceneError;
use super::material::Material;
use super::texture::Request;
use std::io::{self, Read};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Triangles of a file in its own space.
#[derive(Clone, Debug, Default)]
pub(super) struct Imported {
    /// Positions, all finite, each used by a triangle.
    pub(super) vertices: Vec<[f32; 3]>,
    /// Vertex indices, all valid, counter-clockwise seen from the front.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Codes of the vertices' normals, as [`super::compiled::Mesh::normals`]; all or none.
    pub(super) normals: Vec<u32>,
    /// Texture coordinates of the vertices, as [`super::compiled::Mesh::uvs`]; all or none.
    pub(super) uvs: Vec<[f32; 2]>,
    /// Index into `materials` of each triangle.
    pub(super) material: Vec<u32>,
    /// Materials by the file's own names.
    pub(super) materials: Vec<Material>,
    /// Textures that they read, by place; until `surfaces::bind_imported`.
    pub(super) textures: Vec<Request>,
    /// What had to be left out or guessed.
    pub(super) warnings: Vec<String>,
}

/// How much geometry there is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Vertices.
    pub vertices: u64,
    /// Triangles.
    pub triangles: u64,
    /// Spheres.
    pub spheres: u64,
    /// Instances.
    pub instances: u64,
    /// Bytes of textures with their mip levels.
    pub texture_bytes: u64,
}

impl std::ops::Add for Counts {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            vertices: self.vertices.saturating_add(other.vertices),
            triangles: self.triangles.saturating_add(other.triangles),
            spheres: self.spheres.saturating_add(other.spheres),
            instances: self.instances.saturating_add(other.instances),
            texture_bytes: self.texture_bytes.saturating_add(other.texture_bytes),
        }
    }
}

/// Kinds of files of geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Obj,
    Ply,
}

impl Format {
    /// The format of a file of geometry by its name.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        let is = |name: &str| extension.eq_ignore_ascii_case(name);
        if is("obj") {
            Some(Self::Obj)
        } else {
            is("ply").then_some(Self::Ply)
        }
    }

    /// Loads the file at `path`; `read` grows by the bytes read.
    pub(super) fn load(self, path: &Path, read: &AtomicU64) -> Result<Imported, SceneError> {
        match self {
            Self::Obj => obj::load(path, read),
            Self::Ply => ply::load(path, read),
        }
    }

    /// Counts what the file at `path` holds, without keeping any of it: exact for a file that is
    /// right. Textures that its materials read are listed, not counted.
    pub(super) fn count(self, path: &Path) -> Result<(Counts, Vec<Request>), SceneError> {
        match self {
            Self::Obj => obj::count(path),
            Self::Ply => Ok((ply::count(path)?, Vec::new())),
        }
    }
}

impl Imported {
    /// Textures that its materials still read.
    pub(super) fn wanted(&self) -> impl Iterator<Item = &Request> {
        let places = self.materials.iter().flat_map(Material::textures);
        places.map(|texture| &self.textures[texture as usize])
    }

    /// Leaves out vertices that no triangle uses: they would count in the scene's box.
    fn drop_unused_vertices(&mut self) {
        let mut used = vec![false; self.vertices.len()];
        for &vertex in self.triangles.as_flattened() {
            used[vertex as usize] = true;
        }
        if used.iter().all(|&used| used) {
            return;
        }
        let mut moved = Vec::with_capacity(used.len());
        let mut kept = 0;
        for &used in &used {
            moved.push(kept);
            kept += u32::from(used);
        }
        retain(&mut self.vertices, &used);
        retain(&mut self.normals, &used);
        retain(&mut self.uvs, &used);
        for vertex in self.triangles.as_flattened_mut() {
            *vertex = moved[*vertex as usize];
        }
    }
}

/// Keeps the elements that are marked.
fn retain<T>(table: &mut Vec<T>, marked: &[bool]) {
    let mut marks = marked.iter();
    table.retain(|_| marks.next() == Some(&true));
}

/// Counts the bytes that pass.
#[derive(Debug)]
struct Counted<'a, R> {
    reader: R,
    read: &'a AtomicU64,
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer)?;
        self.read.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}
