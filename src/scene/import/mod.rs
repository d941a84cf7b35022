//! Files of geometry that a scene names.

pub(super) mod mtl;
pub(super) mod obj;
mod scan;

use super::compiled::Material;

/// Triangles of a file in its own space.
#[derive(Debug, Default)]
pub(super) struct Imported {
    /// Positions, all finite.
    pub(super) vertices: Vec<[f32; 3]>,
    /// Vertex indices, all valid, counter-clockwise seen from the front.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Index into `materials` of each triangle.
    pub(super) material: Vec<u32>,
    /// Materials by the file's own names.
    pub(super) materials: Vec<Material>,
    /// What had to be left out or guessed.
    pub(super) warnings: Vec<String>,
}
