//! The scene as kernels see it: slices of tables.

use crate::bare::called_for;
use crate::images::Images;
use crate::interpolate::Attributes;
use crate::lanes::{Fx, Ux, gather};
use crate::light::{Environment, Punctual, Tree};
use crate::medium::Media;
use crate::others::Others;
use crate::vec3::{Columns, Vec3x};

/// Most parameters that a kind of BSDF has.
pub const SLOTS: usize = 21;

/// All that shading reads. See each member for its lengths.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tables<'a> {
    /// Triangles.
    pub triangles: Triangles<'a>,
    /// Materials.
    pub materials: Materials<'a>,
    /// Lights.
    pub lights: Lights<'a>,
    /// What vertices carry besides, where some surfaces are interpolated or read images.
    pub attributes: Option<Attributes<'a>>,
    /// What materials read of images, where some do.
    pub images: Option<Images<'a>>,
    /// Media, where the scene has any.
    pub media: Option<Media<'a>>,
}

/// Triangle tables, world space.
#[derive(Clone, Copy, Debug, Default)]
pub struct Triangles<'a> {
    /// Vertex positions.
    pub vertices: &'a [[f32; 3]],
    /// Vertices of each triangle.
    pub indices: &'a [[u32; 3]],
    /// Material of each triangle.
    pub material: &'a [u32],
    /// Spheres and copies of objects, if there are any: their numbers come after the triangles'.
    pub others: Option<Others<'a>>,
}

impl Triangles<'_> {
    /// The material of what was hit, triangle or not.
    #[inline(always)]
    #[must_use]
    pub fn material_of(&self, primitive: u32) -> u32 {
        match (
            self.material.get(primitive as usize),
            called_for(self.others.as_ref()),
        ) {
            (Some(&material), _) => material,
            (None, Some(others)) => others.material_of(primitive),
            (None, None) => unreachable!("hits are numbered by triangles"),
        }
    }
}

/// Material tables, one element a material.
#[derive(Clone, Copy, Debug, Default)]
pub struct Materials<'a> {
    /// Diffuse reflectance; of other kinds, their colour in one word.
    pub albedo: Columns<'a>,
    /// The parameters of its BSDF, a column each; what they mean depends on the kind
    /// (`scatter::kinds`).
    pub parameters: [&'a [f32]; SLOTS],
    /// Emitted radiance.
    pub emission: Columns<'a>,
    /// All bits set if it emits from the back too, else 0.
    pub two_sided: &'a [u32],
    /// Pdf per unit area with which next-event estimation picks a point of this material: light
    /// selection by power makes it the same for all its triangles. 0: never picked.
    pub area_pdf: &'a [f32],
}

/// Light tables: emissive triangles and spheres, then lights of no area, then the sky if there is one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lights<'a> {
    /// Alias method: probability to keep entry `i`.
    pub keep: &'a [f32],
    /// Alias method: what entry `i` stands for otherwise.
    pub alias: &'a [u32],
    /// What light `i` is: a triangle or sphere by its number, or one of `light`'s marks.
    pub source: &'a [u32],
    /// Lights of no area.
    pub punctual: &'a [Punctual],
    /// Where a tree selects lights at a finite distance.
    pub tree: Option<Tree<'a>>,
    /// Pdf per unit area of points on each triangle; empty where that of its material holds or a tree
    /// says it.
    pub area_pdf: &'a [f32],
    /// The sky's map, if it has one.
    pub environment: Option<Environment<'a>>,
    /// Radiance of a sky without a map from straight above (+y); black if there is no sky.
    pub zenith: [f32; 3],
    /// Radiance of the sky from straight below.
    pub nadir: [f32; 3],
    /// Probability to select the sky.
    pub sky_selection: f32,
}

/// The BSDF parameters of a vector of surfaces.
#[derive(Clone, Copy, Debug)]
pub struct Parameters<'a> {
    /// The tables.
    pub materials: &'a Materials<'a>,
    /// The material in each lane.
    pub material: Ux,
    /// The wavelength in each lane, nanometres; for kinds that disperse.
    pub wavelength: Fx,
}

impl Parameters<'_> {
    /// The parameter of number `slot`.
    #[inline(always)]
    #[must_use]
    pub fn number(&self, slot: usize) -> Fx {
        gather(self.materials.parameters[slot], self.material)
    }

    /// The colour whose red is parameter `slot`, its green and blue the next two.
    #[inline(always)]
    #[must_use]
    pub fn colour(&self, slot: usize) -> Vec3x {
        Vec3x::new(
            self.number(slot),
            self.number(slot + 1),
            self.number(slot + 2),
        )
    }
}
