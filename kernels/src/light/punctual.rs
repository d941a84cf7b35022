//! Lights of no area: points, spots and distant ones, which may subtend a disc.
//!
//! *Point*: at squared distance `r^2` a radiant intensity `I` (W/sr) gives an irradiance of
//! `I / r^2` on a surface that faces it.
//!
//! *Spot*: a point whose intensity falls from `I` to 0 between two cones about its axis, by the
//! smooth step `t^2 (3 - 2 t)` of `t = (cos - edge) slope`, clamped to 0..1.
//!
//! *Distant*: parallel light of irradiance `E` on a surface that faces it; or, for a disc of half
//! angle `a`, the radiance `L = E / (pi sin^2(a))` from every direction of the disc, drawn with pdf
//! `1 / (2 pi (1 - cos(a)))`: `1 - cos = u (1 - cos(a))`, without cancellation however small the
//! disc. What a path finds of the disc is `discs`' business.
//!
//! A delta light's `LightSample::radiance` is an irradiance, and its pdf the probability of its
//! selection, so that `f cos L / pdf` is right for it too. Bytes a sample: 60.

use super::{Departure, LightSample};
use crate::hemisphere::to_world;
use crate::lanes::{Fx, LANES, Mask, Ux};
use crate::math::sin_cos_turn;
use crate::rays::NO_PRIMITIVE;
use crate::surface::Anchor;
use crate::vec3::Vec3x;

/// A light of no area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Punctual {
    /// Position of a point or spot; of a distant light, the unit vector towards it.
    pub place: [f32; 3],
    /// Intensity (W/sr) of a point or spot at most; irradiance (W/m^2) of a distant delta light;
    /// radiance (W/m^2/sr) of a disc.
    pub value: [f32; 3],
    /// Probability of its selection.
    pub selection: f32,
    /// Whether it is distant.
    pub distant: bool,
    /// Unit axis of a spot, along its light; of no meaning for others.
    pub axis: [f32; 3],
    /// Cosine on the cone outside which a spot is dark; below -1 for a point.
    pub edge: f32,
    /// One over the difference of the two cones' cosines, finite; 1 for a point.
    pub slope: f32,
    /// `1 - cos(a)` of a disc of half angle `a`; 0 for a delta light.
    pub extent: f32,
    /// Pdf per solid angle of a disc's directions; 1 for a delta light.
    pub density: f32,
}

/// The `of` of each lane's light.
#[inline(always)]
fn each<T>(lights: &[Punctual], k: [u32; LANES], of: impl Fn(&Punctual) -> T) -> [T; LANES] {
    k.map(|k| of(&lights[k as usize]))
}

#[inline(always)]
fn scalar(lights: &[Punctual], k: [u32; LANES], of: impl Fn(&Punctual) -> f32) -> Fx {
    Fx::new(each(lights, k, of))
}

#[inline(always)]
fn vector(lights: &[Punctual], k: [u32; LANES], of: impl Fn(&Punctual) -> [f32; 3]) -> Vec3x {
    let of = &of;
    let axis = |c: usize| scalar(lights, k, move |l| of(l)[c]);
    Vec3x::new(axis(0), axis(1), axis(2))
}

/// Samples light `k` of `lights` in each lane.
#[inline(always)]
pub(super) fn sample(lights: &[Punctual], anchor: &Anchor, k: Ux, u: Fx, v: Fx) -> LightSample {
    let k = k.to_array();
    let place = vector(lights, k, |l| l.place);
    let value = vector(lights, k, |l| l.value);
    let selection = scalar(lights, k, |l| l.selection);
    let extent = scalar(lights, k, |l| l.extent);
    let distant: Mask = bytemuck::cast(each(lights, k, |l| if l.distant { u32::MAX } else { 0 }));

    let cap = u * extent;
    let radius = (cap * (Fx::splat(2.0) - cap)).sqrt();
    let (sin, cos) = sin_cos_turn(v);
    let local = Vec3x::new(radius * cos, radius * sin, Fx::ONE - cap);
    let away = to_world(place, local);

    let towards = Vec3x::select(distant, away, place - anchor.point);
    let origin = anchor.start(towards);
    let segment = Vec3x::select(distant, away, place - origin);
    let r2 = segment.dot(segment);
    let direction = Vec3x::select(distant, away, segment * (Fx::ONE / r2.sqrt()));

    let edge = scalar(lights, k, |l| l.edge);
    let slope = scalar(lights, k, |l| l.slope);
    let cos = -vector(lights, k, |l| l.axis).dot(direction);
    let t = ((cos - edge) * slope).fast_max(Fx::ZERO).fast_min(Fx::ONE);
    let smooth = t * t * (Fx::splat(3.0) - (t + t));
    let share = distant.select(Fx::ONE, smooth / r2);
    let density = scalar(lights, k, |l| l.density);
    let above = anchor.both_sides | anchor.normal.dot(direction).simd_gt(Fx::ZERO);
    LightSample {
        origin,
        segment,
        t_max: distant.select(Fx::splat(f32::INFINITY), Fx::ONE),
        primitive: Ux::splat(NO_PRIMITIVE),
        direction,
        radiance: value * share,
        pdf: selection * density,
        delta: extent.simd_eq(Fx::ZERO),
        valid: above & share.simd_gt(Fx::ZERO) & share.is_finite(),
    }
}

/// What rays that left the scene find of the discs among `lights`: calls `found` with each disc's
/// radiance (0 off it) and the pdf with which [`sample`] draws directions in it, selection included.
#[inline(always)]
pub(super) fn discs(lights: &[Punctual], from: &Departure, mut found: impl FnMut(Vec3x, Fx)) {
    for light in lights.iter().filter(|l| l.extent > 0.0) {
        // The cosine of a small disc's edge says little: squares of chords, 2 (1 - cos), do.
        let chord = from.direction - Vec3x::splat(light.place);
        let inside = chord.dot(chord).simd_lt(Fx::splat(2.0 * light.extent));
        let pdf = Fx::splat(light.selection * light.density);
        found(Vec3x::splat(light.value).keep(inside), pdf);
    }
}
