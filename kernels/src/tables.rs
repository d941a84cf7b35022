//! The scene as kernels see it: slices of tables.

use crate::light::{Environment, Punctual};
use crate::vec3::Columns;

/// All that shading reads. See each member for its lengths.
#[derive(Clone, Copy, Debug)]
pub struct Tables<'a> {
    /// Triangles.
    pub triangles: Triangles<'a>,
    /// Materials.
    pub materials: Materials<'a>,
    /// Lights.
    pub lights: Lights<'a>,
}

/// Triangle tables, world space.
#[derive(Clone, Copy, Debug)]
pub struct Triangles<'a> {
    /// Vertex positions.
    pub vertices: &'a [[f32; 3]],
    /// Vertices of each triangle.
    pub indices: &'a [[u32; 3]],
    /// Material of each triangle.
    pub material: &'a [u32],
}

/// Material tables, one element a material.
#[derive(Clone, Copy, Debug)]
pub struct Materials<'a> {
    /// Diffuse reflectance.
    pub albedo: Columns<'a>,
    /// Emitted radiance.
    pub emission: Columns<'a>,
    /// All bits set if it emits from the back too, else 0.
    pub two_sided: &'a [u32],
    /// Pdf per unit area with which next-event estimation picks a point of this material: light
    /// selection by power makes it the same for all its triangles. 0: never picked.
    pub area_pdf: &'a [f32],
}

/// Light tables: emissive triangles, then lights of no area, then the sky if there is one.
#[derive(Clone, Copy, Debug)]
pub struct Lights<'a> {
    /// Alias method: probability to keep entry `i`.
    pub keep: &'a [f32],
    /// Alias method: what entry `i` stands for otherwise.
    pub alias: &'a [u32],
    /// What light `i` is: a triangle by its index, or one of `light`'s marks.
    pub source: &'a [u32],
    /// Lights of no area.
    pub punctual: &'a [Punctual],
    /// The sky's map, if it has one.
    pub environment: Option<Environment<'a>>,
    /// Radiance of a sky without a map from straight above (+y); black if there is no sky.
    pub zenith: [f32; 3],
    /// Radiance of the sky from straight below.
    pub nadir: [f32; 3],
    /// Probability to select the sky.
    pub sky_selection: f32,
}
