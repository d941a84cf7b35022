//! Next-event estimation: a light, a point on it, and what one sample of it is worth.
//!
//! *Selection* by power through an alias table (A. J. Walker 1977; M. D. Vose, "A Linear Algorithm
//! for Generating Random Numbers with a Given Distribution", 1991): entry `i = floor(u0 n)` is kept
//! where `u1 < keep[i]`, else replaced by `alias[i]`.
//!
//! Where there are many lights, all that are at a finite distance stand for one entry of that table, and
//! a tree chooses among them (`tree`).
//!
//! *Point*: uniform over the triangle, `(u, v) = (1 - sqrt(u2), u3 sqrt(u2))` (G. Turk, "Generating
//! Random Points in Triangles", *Graphics Gems*, 1990). Pdf in area measure: `selection / area`; by
//! power, `selection = area * w / W`, so it is `w / W` whatever the triangle.
//!
//! *Measure*: at distance `r`, seen under `cos_l` at the light, a pdf per area is a pdf per solid
//! angle times `r^2 / cos_l`; see [`area_to_solid_angle`]. The two functions of that pdf that
//! next-event estimation and emission need are therefore one and the same.
//!
//! *Sky*: uniform over the hemisphere of the surface, `selection / (2 pi)` in solid angle; over the
//! whole sphere, `selection / (4 pi)`, where light passes through the surface.
//!
//! *Delta lights* have no pdf in solid angle: [`LightSample::delta`] marks them, and what stands for
//! the pdf is the probability of their selection. No path finds them.

mod environment;
mod punctual;
mod tree;
mod varied;

pub use environment::{Environment, UNITS};
pub use punctual::Punctual;
pub use tree::{LEAF, NO_LIGHT, Node, Tree};
pub use varied::{VARIED, emission as varied_emission, vary};

use crate::bare::{COMPLETE, called_for};
use crate::hemisphere::{sample_sides, to_world, uniform_pdf};
use crate::lanes::{Fx, LANES, Mask, Ux, as_bits, as_mask, gather, gather_u32, to_f32, to_u32};
use crate::mis::power_heuristic;
use crate::others::Others;
use crate::queues::{BOTH_SIDES, Paths};
use crate::rays::NO_PRIMITIVE;
use crate::sphere_light;
use crate::surface::{Anchor, Corners, Surface, spawn};
use crate::tables::{Lights, Tables};
use crate::vec3::Vec3x;

/// A pdf per unit area at a point seen under `cos_l > 0` at squared distance `r2`, as a pdf per
/// unit solid angle.
#[inline(always)]
#[must_use]
pub fn area_to_solid_angle(area_pdf: Fx, r2: Fx, cos_l: Fx) -> Fx {
    area_pdf * r2 / cos_l
}

/// Radiance of a sky without a map from unit `direction`: `nadir + (zenith - nadir) (1 + y) / 2`.
#[inline(always)]
#[must_use]
pub fn gradient(lights: &Lights, direction: Vec3x) -> Vec3x {
    let half = Fx::splat(0.5);
    let height = direction.y.mul_add(half, half);
    let nadir = Vec3x::splat(lights.nadir);
    (Vec3x::splat(lights.zenith) - nadir).scale_add(height, nadir)
}

/// In `Lights::source`: what a light is, if it is no triangle: the sky, or `PUNCTUAL | k` for light
/// `k` of `Lights::punctual`.
pub const PUNCTUAL: u32 = 1 << 31;
/// See [`PUNCTUAL`].
pub const SKY: u32 = u32::MAX;
/// See [`PUNCTUAL`]: some light of the tree.
pub const TREE: u32 = u32::MAX - 1;

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// The bit mask of all lanes.
const ALL: u32 = (1 << LANES) - 1;

/// The light that `u0` and `u1` select, both in `[0, 1)`; with it, what is left of either: numbers
/// in `[0, 1)` that do not depend on the light.
#[inline(always)]
#[must_use]
pub fn select_light(keep: &[f32], alias: &[u32], u0: Fx, u1: Fx) -> (Ux, [Fx; 2]) {
    let n = keep.len() as u32;
    let place = u0 * to_f32(Ux::splat(n));
    // u0 n can round up to n.
    let entry = to_u32(place).min(Ux::splat(n - 1));
    let below_one = Fx::splat(BELOW_ONE);
    let fraction = (place - to_f32(entry)).fast_min(below_one);
    let keep = gather(keep, entry);
    let kept = u1.simd_lt(keep);
    let light = as_bits(kept).select(entry, gather_u32(alias, entry));
    let rest = kept.select(u1 / keep, (u1 - keep) / (Fx::ONE - keep));
    (light, [fraction, rest.fast_min(below_one)])
}

/// One sample of the light around each of `LANES` surfaces.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Where the occlusion ray starts: off the surface, on the light's side if light passes through.
    pub origin: Vec3x,
    /// From `origin` to the light: the whole way for triangles (`t_max` 1), a unit
    /// vector for the sky (`t_max` infinite).
    pub segment: Vec3x,
    /// Ray parameter of the light along `segment`.
    pub t_max: Fx,
    /// Triangle sampled, or `NO_PRIMITIVE`.
    pub primitive: Ux,
    /// Unit vector to the light.
    pub direction: Vec3x,
    /// Radiance emitted towards the surface.
    pub radiance: Vec3x,
    /// Pdf of `direction` in solid angle, selection included; of delta lights, the probability of
    /// selection. Positive and finite where `valid`.
    pub pdf: Fx,
    /// Where the light is one that only this sample can find.
    pub delta: Mask,
    /// Where the sample can carry light at all.
    pub valid: Mask,
}

impl LightSample {
    /// The weight of the sample where the surface would have scattered into its direction with pdf
    /// `scattered`, in solid angle.
    #[inline(always)]
    #[must_use]
    pub fn weight(&self, scattered: Fx) -> Fx {
        let shared = power_heuristic(self.pdf, scattered);
        self.delta.select(Fx::ONE, shared)
    }
}

/// Rays that found light, and the surfaces that they left.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// Where the rays started.
    pub origin: Vec3x,
    /// Their unit directions.
    pub direction: Vec3x,
    /// The triangles that they left, or `NO_PRIMITIVE`.
    pub leaves: Ux,
    /// Where light from both sides counted there.
    pub both_sides: Mask,
}

impl Departure {
    /// That of the paths at places `at` of their queue.
    #[inline(always)]
    #[must_use]
    pub fn of(paths: &Paths, at: Ux) -> Self {
        let marks = gather_u32(paths.bounces, at);
        Self {
            origin: Vec3x::gather_columns(paths.origin, at),
            direction: Vec3x::gather_columns(paths.direction, at),
            leaves: gather_u32(paths.leaves, at),
            both_sides: as_mask((marks & Ux::splat(BOTH_SIDES)).simd_eq(Ux::splat(BOTH_SIDES))),
        }
    }
}

/// The pdf in solid angle, selection included, with which [`sample_light`] would have found what
/// rays found on `surface`, at distance `t`.
#[inline(always)]
#[must_use]
pub fn surface_pdf(tables: &Tables, from: &Departure, surface: &Surface, t: Fx) -> Fx {
    let (primitive, material, cos_l) = (surface.primitive, surface.material, surface.cos_o);
    let Some(others) = spheres(tables) else {
        return triangle_pdf(tables, from, primitive, material, t, cos_l);
    };
    let spheres = others.are_spheres(primitive);
    let on_sphere = sphere_light::pdf(others, from, primitive);
    match sphere_light::triangles_only(primitive, spheres) {
        None => on_sphere,
        Some(triangles) => {
            let on_triangle = triangle_pdf(tables, from, triangles, material, t, cos_l);
            spheres.select(on_sphere, on_triangle)
        }
    }
}

/// The same for triangles `primitive` of `material`, under `cos_l` at the light.
#[inline(always)]
fn triangle_pdf(
    tables: &Tables,
    from: &Departure,
    primitive: Ux,
    material: Ux,
    t: Fx,
    cos_l: Fx,
) -> Fx {
    let area_pdf = match &tables.lights.tree {
        Some(tree) => tree.probability(from.origin, primitive) * tree.inverse_area_of(primitive),
        None => area_pdf_of(tables, primitive, material),
    };
    area_to_solid_angle(area_pdf, t * t, cos_l)
}

/// Pdf per unit area of points on triangles, where no tree selects them.
#[inline(always)]
fn area_pdf_of(tables: &Tables, primitive: Ux, material: Ux) -> Fx {
    match tables.lights.area_pdf {
        [] => gather(tables.materials.area_pdf, material),
        by_triangle => gather(by_triangle, primitive),
    }
}

/// What rays that left the scene find: calls `found` with the radiance of each light there, and the
/// pdf in solid angle, selection included, with which [`sample_light`] would have drawn it.
#[inline(always)]
pub fn beyond(tables: &Tables, from: &Departure, mut found: impl FnMut(Vec3x, Fx)) {
    let lights = &tables.lights;
    let (radiance, pdf) = match called_for(lights.environment.as_ref()) {
        Some(map) => map.look_up(from.direction),
        None => (
            gradient(lights, from.direction),
            uniform_pdf(from.both_sides),
        ),
    };
    found(radiance, pdf * Fx::splat(lights.sky_selection));
    if COMPLETE {
        punctual::discs(lights.punctual, from, found);
    }
}

/// Samples a light for the surfaces `anchor`. At least one light must exist. A sample may lie below
/// the surface; that no light passes there is for the BSDF to say.
#[inline(always)]
#[must_use]
pub fn sample_light(tables: &Tables, anchor: &Anchor, u: [Fx; 4]) -> LightSample {
    let lights = &tables.lights;
    let (light, [fraction, spare]) = select_light(lights.keep, lights.alias, u[0], u[1]);
    let mut source = gather_u32(lights.source, light);
    let mut picked = None;
    if let Some(tree) = &lights.tree {
        let in_tree = as_mask(source.simd_eq(Ux::splat(TREE)));
        if in_tree.any() {
            let (light, probability) = tree.sample(anchor.point, fraction, spare);
            source = as_bits(in_tree).select(gather_u32(tree.source, light), source);
            let area_pdf = probability * gather(tree.inverse_area, light);
            picked = Some((in_tree, probability, area_pdf));
        }
    }
    let on_surface = as_mask(source.simd_lt(Ux::splat(PUNCTUAL)));
    let surfaces = on_surface.to_bitmask();
    let is_sky = as_mask(source.simd_eq(Ux::splat(SKY)));
    let sky = is_sky.to_bitmask();
    let mut sample = None;
    if sky != 0 {
        sample = Some(sample_sky(tables, anchor, u[2], u[3], spare));
    }
    // Lanes of other kinds borrow some light of a kind, so that every look-up is in range.
    if COMPLETE && sky | surfaces != ALL {
        let own = !(is_sky | on_surface);
        let k = as_bits(own) & source & Ux::splat(!PUNCTUAL);
        let mut drawn = punctual::sample(lights.punctual, anchor, k, u[2], u[3]);
        if let Some((in_tree, probability, _)) = picked {
            // Points and spots: lights of no extent, whose pdf is their probability.
            drawn.pdf = in_tree.select(probability, drawn.pdf);
            drawn.valid &= drawn.pdf.simd_gt(Fx::ZERO);
        }
        sample = Some(merge(own, drawn, sample));
    }
    if surfaces != 0 {
        let some = source.as_array()[surfaces.trailing_zeros() as usize % LANES];
        let primitive = as_bits(on_surface).select(source, Ux::splat(some));
        let area_pdf = picked.map(|(_, _, area_pdf)| area_pdf);
        let drawn = sample_surface(tables, anchor, primitive, area_pdf, u[2], u[3]);
        sample = Some(match surfaces {
            ALL => drawn,
            _ => merge(on_surface, drawn, sample),
        });
    }
    sample.expect("each lane's light is of some kind")
}

/// `a` where `mask` is true, else `b`, if there is one.
#[inline(always)]
fn merge(mask: Mask, a: LightSample, b: Option<LightSample>) -> LightSample {
    let Some(b) = b else { return a };
    LightSample {
        origin: Vec3x::select(mask, a.origin, b.origin),
        segment: Vec3x::select(mask, a.segment, b.segment),
        t_max: mask.select(a.t_max, b.t_max),
        primitive: as_bits(mask).select(a.primitive, b.primitive),
        direction: Vec3x::select(mask, a.direction, b.direction),
        radiance: Vec3x::select(mask, a.radiance, b.radiance),
        pdf: mask.select(a.pdf, b.pdf),
        delta: mask.select(a.delta, b.delta),
        valid: mask.select(a.valid, b.valid),
    }
}

/// What knows the spheres, if there are any.
#[inline(always)]
fn spheres<'a>(tables: &'a Tables) -> Option<&'a Others<'a>> {
    let others = tables.triangles.others.as_ref();
    called_for(others).filter(|others| !others.spheres.is_empty())
}

/// A point on an emissive triangle or sphere.
#[inline(always)]
fn sample_surface(
    tables: &Tables,
    anchor: &Anchor,
    primitive: Ux,
    area_pdf: Option<Fx>,
    u: Fx,
    v: Fx,
) -> LightSample {
    let Some(others) = spheres(tables) else {
        return sample_triangle(tables, anchor, primitive, area_pdf, u, v);
    };
    let spheres = others.are_spheres(primitive);
    let Some(triangles) = sphere_light::triangles_only(primitive, spheres) else {
        return sphere_light::sample(tables, others, anchor, primitive, u, v);
    };
    let on_triangle = sample_triangle(tables, anchor, triangles, area_pdf, u, v);
    if spheres.to_bitmask() == 0 {
        return on_triangle;
    }
    let on_sphere = sphere_light::sample(tables, others, anchor, primitive, u, v);
    merge(spheres, on_sphere, Some(on_triangle))
}

#[inline(always)]
fn sample_triangle(
    tables: &Tables,
    anchor: &Anchor,
    primitive: Ux,
    area_pdf: Option<Fx>,
    u: Fx,
    v: Fx,
) -> LightSample {
    let corners = Corners::gather(&tables.triangles, primitive);
    let root = u.sqrt();
    let (p, s) = corners.point(Fx::ONE - root, v * root);
    let front_normal = corners.unit_normal();
    let origin = anchor.start(p - anchor.point);
    // The side that faces the surface, decided from the point itself; the segment ends just above
    // it.
    let towards = p - origin;
    let front = front_normal.dot(towards).simd_lt(Fx::ZERO);
    let normal = Vec3x::select(front, front_normal, -front_normal);
    let segment = spawn(p, s, normal) - origin;
    let r2 = segment.dot(segment);
    let direction = segment * (Fx::ONE / r2.sqrt());
    let cos_l = -normal.dot(direction);
    let material = gather_u32(tables.triangles.material, primitive);
    let materials = &tables.materials;
    let emits = front | as_mask(gather_u32(materials.two_sided, material));
    let area_pdf = area_pdf.unwrap_or_else(|| area_pdf_of(tables, primitive, material));
    let pdf = area_to_solid_angle(area_pdf, r2, cos_l);
    let valid = emits & cos_l.simd_gt(Fx::ZERO) & pdf.simd_gt(Fx::ZERO) & pdf.is_finite();
    LightSample {
        origin,
        segment,
        t_max: Fx::ONE,
        primitive,
        direction,
        radiance: Vec3x::gather_columns(materials.emission, material),
        pdf,
        delta: Fx::ZERO,
        valid,
    }
}

#[inline(always)]
fn sample_sky(tables: &Tables, anchor: &Anchor, u: Fx, v: Fx, spare: Fx) -> LightSample {
    let lights = &tables.lights;
    let (direction, radiance, pdf) = match called_for(lights.environment.as_ref()) {
        Some(map) => map.sample(u, v, spare),
        None => {
            let local = sample_sides(u, v, anchor.both_sides);
            let direction = to_world(anchor.normal, local);
            let radiance = gradient(lights, direction);
            (direction, radiance, uniform_pdf(anchor.both_sides))
        }
    };
    let pdf = pdf * Fx::splat(lights.sky_selection);
    let above = anchor.both_sides | anchor.normal.dot(direction).simd_gt(Fx::ZERO);
    LightSample {
        origin: anchor.start(direction),
        segment: direction,
        t_max: Fx::splat(f32::INFINITY),
        primitive: Ux::splat(NO_PRIMITIVE),
        direction,
        radiance,
        pdf,
        delta: Fx::ZERO,
        valid: above & pdf.simd_gt(Fx::ZERO),
    }
}
