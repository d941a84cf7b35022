//! What a BSDF makes of its surface interactions: the last of three passes, one instance a kind.
//!
//! In the local frame of the shading normal, with `omega_o` above:
//!
//! * a direction drawn by the BSDF; the path goes on with `throughput *= f |cos| / pdf`;
//! * with next-event estimation, the light sample of the row, worth
//!   `throughput * f |cos| * L / p_l`, times the power heuristic's weight.
//!
//! A direction that lies on one side of the geometric surface and on the other of the shading normal's
//! plane carries nothing: light neither leaks through nor is reflected into the surface.
//!
//! Bytes: [`PATH`] a row, [`SHADOW`] an occlusion ray.

use super::align::Turn;
use super::{Cast, NextEvent, Out, Scattered};
use crate::bsdf::Bsdf;
use crate::cost::{Cost, columns, item};
use crate::hemisphere::Frame;
use crate::interpolate::terminator;
use crate::lanes::{Fx, LANES, Mask, as_mask, first, gather, load, load_u32, padded};
use crate::mis::power_heuristic;
use crate::queues::{
    Aligned, BOTH_SIDES, Drawn, DrawnMut, Listed, Lit, LitMut, PathsMut, ShadowsMut, Smooth,
    Surfaces, SurfacesMut,
};
use crate::tables::{Materials, Parameters};
use crate::vec3::Vec3x;

/// Bytes a row: surface, numbers, path and hit read; the scattered path written. The parameters of
/// the scene's few materials stay in the first cache and are not counted.
pub const PATH: Cost = Cost::new(
    4 + item::<SurfacesMut<'static>>()
        + columns::<DrawnMut<'static>>(&["direction"])
        + columns::<PathsMut<'static>>(&["throughput", "slot", "pixel", "sample", "bounces"]),
    item::<PathsMut<'static>>(),
);
/// Bytes an occlusion ray.
pub const SHADOW: Cost = Cost::new(item::<LitMut<'static>>(), item::<ShadowsMut<'static>>());

/// A kind of BSDF: how its parameters come out of the material tables.
pub trait Kind {
    /// The BSDF, a set of parameters a lane.
    type Bsdf: Bsdf;
    /// Whether nothing but its own sampling finds its directions: light is not sampled then.
    const DELTA: bool;
    /// Whether it reflects diffusely, so that the shadow's edge has to be softened where normals are
    /// interpolated (`interpolate::terminator`).
    const DIFFUSE: bool = false;
    /// Whether light passes through: what lies below is lit too.
    const PASSES: bool = false;
    /// Whether its parameters depend on the wavelength.
    const DISPERSES: bool = false;
    /// Whether it matters which way its surface lies (`align`).
    const ALIGNED: bool = false;
    /// Fetches the parameters, for surfaces seen from their front or their back.
    fn load(parameters: Parameters, front: Mask) -> Self::Bsdf;
}

/// Rows of surface interactions, all of one kind.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a, 'b> {
    /// The paths, row by row.
    pub listed: Listed<'a>,
    /// What they met.
    pub surfaces: Surfaces<'b>,
    /// The numbers that they use.
    pub drawn: Drawn<'b>,
    /// Light samples; unspecified where next-event estimation is not in use or the kind is a delta.
    pub lit: Lit<'b>,
    /// Where normals are interpolated.
    pub smooth: Option<Smooth<'b>>,
    /// Where surfaces are brushed along their texture coordinates; read by kinds that are.
    pub aligned: Option<Aligned<'b>>,
    /// Wavelengths, place by place of the paths; read by kinds that disperse.
    pub wavelengths: &'a [f32],
}

/// Scatters the rows behind the paths and occlusion rays that `out` already holds.
pub fn respond<K: Kind, N: NextEvent>(rows: Rows, materials: &Materials, out: &mut Out) {
    let Rows {
        listed,
        surfaces,
        drawn,
        lit,
        smooth,
        aligned,
        wavelengths,
    } = rows;
    let n = listed.len;
    for i in (0..padded(n)).step_by(LANES) {
        let (busy, at) = (first(n - i), load_u32(listed.index, i));
        let front = as_mask(load_u32(surfaces.front, i));
        let material = load_u32(surfaces.material, i);
        let bsdf = K::load(
            Parameters {
                materials,
                material,
                wavelength: if K::DISPERSES {
                    gather(wavelengths, at)
                } else {
                    Fx::ZERO
                },
            },
            front,
        );
        let throughput = Vec3x::gather_columns(listed.paths.throughput, at);
        let path = listed.paths.identity(at);
        let primitive = load_u32(surfaces.primitive, i);
        let normal = Vec3x::load(surfaces.normal, i);
        let shading = Vec3x::load(surfaces.shading, i);
        let frame = Frame::about(shading);
        let softened = |value: Vec3x, omega_i: Vec3x| match &smooth {
            Some(smooth) if K::DIFFUSE => {
                let coherence = load(smooth.coherence, i);
                value * terminator(shading, normal, omega_i, coherence)
            }
            _ => value,
        };
        let turn = match &aligned {
            Some(aligned) if K::ALIGNED => Some(Turn::load(aligned, i)),
            _ => None,
        };
        let to_local = |world: Vec3x| {
            let local = frame.to_local(world);
            turn.map_or(local, |turn| turn.into_turned(local))
        };
        let omega_o = Vec3x::load(surfaces.omega_o, i);
        let omega_o = turn.map_or(omega_o, |turn| turn.into_turned(omega_o));

        let [u, v, choice] = drawn.direction.map(|column| load(column, i));
        let sampled = bsdf.sample(omega_o, [u, v, choice]);
        let local = sampled.direction;
        let next = frame.to_world(turn.map_or(local, |turn| turn.out_of(local)));
        let side = normal.dot(next);
        let carried = sampled
            .weight
            .keep(sampled.valid & agree(side, sampled.direction.z));
        let carried = softened(carried, next);
        let clearance = load(surfaces.clearance, i);
        let origin = normal.scale_add(clearance.copysign(side), Vec3x::load(surfaces.point, i));
        let ray = Scattered {
            origin,
            direction: next,
            throughput: throughput.product(carried),
            pdf: sampled.pdf,
            leaves: primitive,
            marks: if K::PASSES { BOTH_SIDES } else { 0 },
        };
        out.scatter(i, &path, &ray);

        if N::LIGHTS && !K::DELTA {
            let direction = Vec3x::load(lit.direction, i);
            let omega_i = to_local(direction);
            let response = bsdf.evaluate(omega_o, omega_i);
            let weight = if N::WEIGHTED {
                power_heuristic(load(lit.pdf, i), response.pdf)
            } else {
                Fx::ONE
            };
            let radiance = throughput
                .product(softened(response.value, direction))
                .product(Vec3x::load(lit.radiance, i))
                * weight;
            let reached = load_u32(lit.primitive, i);
            let carries = busy
                & agree(normal.dot(direction), omega_i.z)
                & !as_mask(reached.simd_eq(primitive))
                & radiance.any_light();
            let ray = Cast {
                origin: Vec3x::load(lit.origin, i),
                segment: Vec3x::load(lit.segment, i),
                t_max: load(lit.t_max, i),
                leaves: primitive,
                reaches: reached,
                radiance,
            };
            out.cast(carries, &path, &ray);
        }
    }
    out.path_len += n;
}

/// Whether both cosines lie on the same side of 0.
#[inline(always)]
fn agree(geometric: Fx, shading: Fx) -> Mask {
    (geometric * shading).simd_gt(Fx::ZERO)
}
