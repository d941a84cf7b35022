//! One sample of the light around each surface interaction: the second of three passes.
//!
//! What arrives and how probable it is does not depend on the surface's BSDF; so this pass is compiled
//! once, and what it writes is what [`super::respond`] multiplies.
//!
//! Bytes: [`LIGHT_UP`].

use crate::cost::{Cost, columns, item};
use crate::lanes::{Fx, LANES, Ux, as_mask, load, padded, store, store_u32};
use crate::light::sample_light;
use crate::queues::{Drawn, DrawnMut, LitMut, Surfaces, SurfacesMut};
use crate::surface::{self, Anchor};
use crate::tables::Tables;
use crate::vec3::Vec3x;

/// Bytes a row: surface, numbers, the light's entry (12), triangle and material (20) read; the
/// sample written.
pub const LIGHT_UP: Cost = Cost::new(
    columns::<SurfacesMut<'static>>(&["point", "clearance", "normal"])
        + columns::<DrawnMut<'static>>(&["select", "keep", "u", "v"])
        + 12
        + surface::TRIANGLE_BYTES
        + 20,
    item::<LitMut<'static>>(),
)
.operations(130);

/// Samples a light for each of the first `n` rows, on both sides of surfaces that light `passes`
/// through. At least one light must exist.
pub fn light_up(
    n: usize,
    surfaces: Surfaces,
    drawn: Drawn,
    tables: &Tables,
    passes: bool,
    mut lit: LitMut,
) {
    let both_sides = as_mask(Ux::splat(if passes { !0 } else { 0 }));
    for i in (0..padded(n)).step_by(LANES) {
        let normal = Vec3x::load(surfaces.normal, i);
        let point = Vec3x::load(surfaces.point, i);
        let anchor = Anchor {
            point,
            normal,
            clearance: load(surfaces.clearance, i),
            both_sides,
        };
        let u = [drawn.select, drawn.keep, drawn.u, drawn.v].map(|column| load(column, i));
        let light = sample_light(tables, &anchor, u);
        light.origin.store(&mut lit.origin, i);
        light.segment.store(&mut lit.segment, i);
        store(lit.t_max, i, light.t_max);
        store_u32(lit.primitive, i, light.primitive);
        light.direction.store(&mut lit.direction, i);
        let worth = (light.radiance * (Fx::ONE / light.pdf)).keep(light.valid);
        worth.store(&mut lit.radiance, i);
        let found_by_none_else = Fx::splat(f32::INFINITY);
        store(
            lit.pdf,
            i,
            light.delta.select(found_by_none_else, light.pdf),
        );
    }
}
