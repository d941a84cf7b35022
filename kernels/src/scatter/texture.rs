//! Images at surface interactions: a pass between [`super::interact`] and [`super::respond`], only for
//! lists of which some material reads one.
//!
//! Parameters are fetched for each row, those that an image varies multiplied by its value there, and
//! written as the columns of a material table with a material a row, of which each row wears its own:
//! so the kernels of BSDFs know nothing of images. Normal and bump maps bend the
//! shading normal that `interact` left, by its rules, and leave `queues::Smooth` as it is.
//!
//! Cost: [`TEXTURE`].

use crate::cost::{Cost, columns, item};
use crate::hemisphere::Frame;
use crate::images::{Images, Read, Site, facing};
use crate::lanes::{
    Fx, LANES, Ux, as_mask, gather, gather_u32, iota, load_u32, padded, store, store_u32,
};
use crate::queues::{Listed, PathHitsMut, PathsMut, SurfacesMut, TexturedMut};
use crate::surface;
use crate::tables::Tables;
use crate::texture::NO_TEXTURE;
use crate::vec3::Vec3x;

/// Bytes a path: its place, direction, pdf, hit, surface and triangle with coordinates read, and one
/// image, eight texels of four bytes; a row of parameters written.
pub const TEXTURE: Cost = Cost::new(
    4 + columns::<PathsMut<'static>>(&["direction", "pdf"])
        + item::<PathHitsMut<'static>>()
        + columns::<SurfacesMut<'static>>(&["normal", "front", "primitive", "material"])
        + surface::TRIANGLE_BYTES
        + 24
        + 48
        + 32,
    item::<TexturedMut<'static>>(),
)
.operations(2 * surface::OPERATIONS + 120);

/// What a list's kind of BSDF has in the material tables.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// How many parameters.
    pub slots: usize,
    /// Those that images may vary; their places here are those in `Images::sites`.
    pub sites: Vec<Site>,
}

/// Textures the listed paths' surfaces, row by row of the list.
///
/// # Panics
/// If the tables have no images.
pub fn texture(
    listed: Listed,
    tables: &Tables,
    layout: &Layout,
    mut surfaces: SurfacesMut,
    mut textured: TexturedMut,
) {
    let images = tables.images.as_ref().expect("a scene with images");
    let n = listed.len;
    for i in (0..padded(n)).step_by(LANES) {
        let at = load_u32(listed.index, i);
        let material = load_u32(surfaces.material, i);
        let (t, pdf) = (gather(listed.hits.t, at), gather(listed.paths.pdf, at));
        let (u, v) = (gather(listed.hits.u, at), gather(listed.hits.v, at));
        let primitive = load_u32(surfaces.primitive, i);
        let read = Read::at(
            tables,
            primitive,
            (u, v),
            images.cone.width(t, pdf),
            listed.times(at),
        );
        parameters(
            tables,
            images,
            layout,
            read.as_ref(),
            material,
            i,
            &mut textured,
        );
        if let Some(read) = read.filter(|_| !images.relief.is_empty()) {
            let direction = Vec3x::gather_columns(listed.paths.direction, at);
            bend(images, &read, material, direction, i, &mut surfaces);
        }
        store_u32(textured.row, i, iota(i as u32));
    }
}

/// Writes the parameters of a vector of rows.
#[inline(always)]
fn parameters(
    tables: &Tables,
    images: &Images,
    layout: &Layout,
    read: Option<&Read>,
    material: Ux,
    i: usize,
    textured: &mut TexturedMut,
) {
    let table = &tables.materials.parameters;
    for slot in 0..layout.slots {
        store(textured.parameters[slot], i, gather(table[slot], material));
    }
    for (site, column) in layout.sites.iter().zip(images.sites) {
        let which = gather_u32(column, material);
        if as_mask(which.simd_eq(Ux::splat(NO_TEXTURE))).all() {
            continue;
        }
        let (uv, width) = read.map_or(([Fx::ZERO; 2], Fx::ZERO), |r| (r.point.uv, r.width));
        let value = images.textures.sample(which, uv, width);
        let parts = [value.x, value.y, value.z];
        for (k, value) in parts.into_iter().enumerate().take(site.parts()) {
            let factor = gather(table[site.slot + k], material);
            store(textured.parameters[site.slot + k], i, factor * value);
        }
    }
}

/// Bends the shading normals of a vector of rows.
#[inline(always)]
fn bend(
    images: &Images,
    read: &Read,
    material: Ux,
    direction: Vec3x,
    i: usize,
    surfaces: &mut SurfacesMut,
) {
    let (bent, some) = read.bent(images, material);
    if some.none() {
        return;
    }
    let front = as_mask(load_u32(surfaces.front, i));
    let at = |columns: &[&mut [f32]; 3]| Vec3x::load([columns[0], columns[1], columns[2]], i);
    let (normal, before) = (at(&surfaces.normal), at(&surfaces.shading));
    let towards = facing(bent, front, normal, -direction);
    let shading = Vec3x::select(some, towards, before);
    shading.store(&mut surfaces.shading, i);
    let omega_o = Frame::about(shading).to_local(-direction);
    omega_o.store(&mut surfaces.omega_o, i);
}

impl Site {
    /// Columns that it takes.
    #[inline(always)]
    fn parts(self) -> usize {
        if self.colour { 3 } else { 1 }
    }
}
