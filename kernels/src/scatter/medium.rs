//! Scattering in a medium: a direction of its phase function, and next-event estimation.
//!
//! What a scattering event keeps of the throughput is accounted for where its distance is drawn
//! (`medium::travel`); the phase function is drawn exactly (`phase`), so a direction weighs 1. With
//! next-event estimation, one light sample is worth `throughput * p(omega_o, omega_i) * L / p_l`, times the
//! power heuristic's weight; what the medium takes from it on its way is for `medium::attenuate`.
//!
//! There is no surface: light comes from all around, and rays start at the point itself.
//!
//! Bytes: [`PATH`] a path, [`SHADOW`] an occlusion ray.

use super::{Cast, NextEvent, Out, Scattered, draw};
use crate::cost::{Cost, columns, item};
use crate::lanes::{Fx, Ux, as_mask, gather, gather_u32};
use crate::light::sample_light;
use crate::medium::Media;
use crate::phase::HenyeyGreenstein;
use crate::queues::{BOTH_SIDES, Listed, PathHitsMut, PathsMut, ShadowsMut};
use crate::rays::NO_PRIMITIVE;
use crate::sampler::{Block, Sampler};
use crate::surface::{self, Anchor};
use crate::tables::Tables;
use crate::vec3::Vec3x;

/// A path: its place, ray, throughput, identity and distance read; the path written.
pub const PATH: Cost = Cost::new(
    8 + columns::<PathsMut<'static>>(&[
        "origin",
        "direction",
        "throughput",
        "slot",
        "pixel",
        "sample",
        "bounces",
    ]) + columns::<PathHitsMut<'static>>(&["t"]),
    item::<PathsMut<'static>>(),
)
.operations(110);
/// An occlusion ray: the light's entry (12), triangle and material (20) read; the ray written.
pub const SHADOW: Cost = Cost::new(
    12 + surface::TRIANGLE_BYTES + 20,
    item::<ShadowsMut<'static>>(),
)
.operations(150);

/// Scatters the listed paths, which were scattered in media, behind the paths and occlusion rays that
/// `out` already holds.
pub fn scatter<N: NextEvent, S: Sampler>(
    listed: Listed,
    medium: &[u32],
    media: &Media,
    tables: &Tables,
    sampler: S,
    out: &mut Out,
) {
    for (i, at, busy) in listed.vectors() {
        let direction = Vec3x::gather_columns(listed.paths.direction, at);
        let origin = Vec3x::gather_columns(listed.paths.origin, at);
        let point = direction.scale_add(gather(listed.hits.t, at), origin);
        let throughput = Vec3x::gather_columns(listed.paths.throughput, at);
        let phase = HenyeyGreenstein {
            g: gather(media.g, gather_u32(medium, at)),
        };
        let path = listed.paths.identity(at);
        let back = -direction;

        let [u, v, ..] = draw(sampler, &path, Block::Direction);
        let (next, pdf) = phase.sample(back, [u, v]);
        let ray = Scattered {
            origin: point,
            direction: next,
            throughput,
            pdf,
            leaves: Ux::splat(NO_PRIMITIVE),
            marks: BOTH_SIDES,
        };
        out.scatter(i, &path, &ray);

        if N::LIGHTS {
            let u = draw(sampler, &path, Block::Light);
            let anchor = Anchor {
                point,
                normal: back,
                clearance: Fx::ZERO,
                both_sides: as_mask(Ux::splat(!0)),
            };
            let light = sample_light(tables, &anchor, u);
            let value = phase.pdf(back, light.direction);
            let weight = if N::WEIGHTED {
                light.weight(value)
            } else {
                Fx::ONE
            };
            let factor = value * weight / light.pdf;
            let radiance = throughput.product(light.radiance) * factor;
            let carries = busy & light.valid & radiance.any_light();
            let ray = Cast {
                origin: light.origin,
                segment: light.segment,
                t_max: light.t_max,
                leaves: Ux::splat(NO_PRIMITIVE),
                reaches: light.primitive,
                radiance,
            };
            out.cast(carries, &path, &ray);
        }
    }
    out.path_len += listed.len;
}
