//! Lights that are not the same all over: what images and opacities say of the points that
//! next-event estimation drew.
//!
//! Lights are sampled as if each triangle shone evenly with its material's emission. Where that is only
//! what texels are multiplied with, what the occlusion rays carry is corrected by a pass of its own,
//! in scenes that call for it; so that no kernel that samples lights knows of images. The point is
//! where the ray ends: its barycentric weights are those of the point's projection onto the triangle,
//! off by a few roundings of its coordinates over the triangle's size. Of a sphere, it is the direction in
//! which the point lies from the centre.
//!
//! The whole image is read, whatever the distance, here and where paths find the light
//! (`emission`): both see the same light, at the same pdf. A point that is not wholly there shines by
//! the share that is, which is the chance that a ray finds it.
//!
//! Cost: [`VARIED`].

use crate::cost::{Cost, columns};
use crate::images::{Images, Read};
use crate::lanes::{Fx, LANES, Mask, Ux, as_bits, as_mask, load, load_u32, padded};
use crate::queues::ShadowsMut;
use crate::sphere_light;
use crate::surface::{Corners, TRIANGLE_BYTES};
use crate::tables::{Tables, Triangles};
use crate::vec3::Vec3x;

/// Bytes an occlusion ray: where it ends, the triangle there with its coordinates, four texels, and
/// what it carries.
pub const VARIED: Cost = Cost::new(
    columns::<ShadowsMut<'static>>(&["origin", "direction", "t_max", "reaches", "radiance"])
        + TRIANGLE_BYTES
        + 24
        + 48
        + 16,
    columns::<ShadowsMut<'static>>(&["radiance"]),
)
.operations(150);

/// Multiplies the radiance of the first `n` occlusion rays by what varies the light that they reach.
///
/// # Panics
/// If the tables have no images.
pub fn vary(n: usize, shadows: &mut ShadowsMut, tables: &Tables) {
    let images = tables.images.as_ref().expect("a scene of varied lights");
    let triangles = &tables.triangles;
    let count = Ux::splat(triangles.indices.len() as u32);
    let others = triangles.others.as_ref();
    let others = others.filter(|others| !others.spheres.is_empty());
    for i in (0..padded(n)).step_by(LANES) {
        let reaches = load_u32(shadows.reaches, i);
        let flat = as_mask(reaches.simd_lt(count));
        let round = others.map_or(Fx::ZERO, |others| others.are_spheres(reaches));
        let own = flat | round;
        if own.none() {
            continue;
        }
        // Lanes that reach nothing borrow what some lane reaches.
        let some =
            Ux::splat(reaches.as_array()[own.to_bitmask().trailing_zeros() as usize % LANES]);
        let light = as_bits(own).select(reaches, some);
        let material = Ux::new(light.to_array().map(|p| triangles.material_of(p)));
        if !images.vary_emission(material).any() {
            continue;
        }
        let at = |columns: &[&mut [f32]; 3]| Vec3x::load([columns[0], columns[1], columns[2]], i);
        let t = load(shadows.t_max, i);
        let point = at(&shadows.direction).scale_add(t, at(&shadows.origin));
        let (mut u, mut v) = (Fx::ZERO, Fx::ZERO);
        if let Some(triangle) = sphere_light::triangles_only(light, !flat) {
            (u, v) = weights(triangles, triangle, point);
        }
        if let Some(others) = others.filter(|_| round.any()) {
            let [x, y] = others.normal_towards(light, point);
            u = round.select(x, u);
            v = round.select(y, v);
        }
        let share = emission(tables, images, light, material, own, u, v);
        let opacity = images.opacity_at(tables, light, material, u, v);
        let share = share * opacity;
        let radiance = at(&shadows.radiance);
        let varied = Vec3x::select(own, radiance.product(share), radiance);
        varied.store(&mut shadows.radiance, i);
    }
}

/// What the emission of `material` is multiplied with at points of triangles.
#[inline]
#[must_use]
pub fn emission(
    tables: &Tables,
    images: &Images,
    primitive: Ux,
    material: Ux,
    busy: Mask,
    u: Fx,
    v: Fx,
) -> Vec3x {
    let which = images.emission_of(material, busy);
    let read = Read::at(tables, primitive, (u, v), Fx::ZERO, None);
    let uv = read.map_or([Fx::ZERO; 2], |read| read.point.uv);
    images.textures.sample(which, uv, Fx::ZERO)
}

/// Barycentric weights of the second and third vertex, in 0..=1, of points near triangles.
#[inline(always)]
fn weights(triangles: &Triangles, primitive: Ux, point: Vec3x) -> (Fx, Fx) {
    let corners = Corners::gather(triangles, primitive);
    let scale = corners.scale();
    let (e1, e2) = (corners.e1 * scale, corners.e2 * scale);
    let from = (point - corners.v0) * scale;
    let normal = e1.cross(e2);
    let by_area = Fx::ONE / normal.dot(normal);
    let within = |x: Fx| (x * by_area).fast_max(Fx::ZERO).fast_min(Fx::ONE);
    (
        within(normal.dot(from.cross(e2))),
        within(normal.dot(e1.cross(from))),
    )
}
