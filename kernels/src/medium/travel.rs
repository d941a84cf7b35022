//! How far rays go: the distance to the next scattering event, drawn for the media that scatter.
//!
//! A channel `c` is drawn with the probability `p_c` of its share in the path's throughput, and a
//! distance `s` with the pdf `rate_c exp(-rate_c s)`. Whatever channel was drawn, all that could have
//! been count (the one-sample model with the balance heuristic, E. Veach and L. Guibas, "Optimally
//! Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995): throughput is multiplied by
//!
//! * `sigma_s exp(-sigma_t s) / sum_k p_k rate_k exp(-rate_k s)` where the ray is scattered at `s`,
//! * `exp(-sigma_t l) / sum_k p_k exp(-rate_k l)` where it stays in the medium for a length `l` and is
//!   not: of a medium that only absorbs, exactly what is left of its light.
//!
//! Domain: `u` in `[0, 1 - 2^-24]`, so no distance beyond an optical depth of 24 ln 2 is drawn; what is
//! missed is `2^-24` of the light.

use super::{IN_MEDIUM, Media, falloff};
use crate::cost::{Cost, columns, item};
use crate::lanes::{Fx, LANES, Mask, Ux, as_mask, first, gather, load, load_u32, padded, store};
use crate::lanes::{as_bits, store_u32};
use crate::queues::{MARKS, MediumsMut, PathHitsMut, PathsMut};
use crate::rays::NO_PRIMITIVE;
use crate::sampler::{Apart, Sampler, apart};
use crate::vec3::Vec3x;

/// A path: its ray, throughput, identity, medium and hit; throughput and hit written.
pub const TRAVEL: Cost = Cost::new(
    columns::<PathsMut<'static>>(&[
        "origin",
        "direction",
        "throughput",
        "pixel",
        "sample",
        "bounces",
    ]) + columns::<PathHitsMut<'static>>(&["primitive", "t"])
        + item::<MediumsMut<'static>>(),
    columns::<PathsMut<'static>>(&["throughput"])
        + columns::<PathHitsMut<'static>>(&["primitive", "t"]),
)
.operations(180);

/// Takes the first `n` paths through their media: weighs them, and puts [`IN_MEDIUM`] and the ray
/// parameter into the hits of those that are scattered before they get where they were going.
pub fn travel<S: Sampler>(
    n: usize,
    medium: &[u32],
    media: &Media,
    sampler: S,
    paths: &mut PathsMut,
    hits: &mut PathHitsMut,
) {
    for i in (0..padded(n)).step_by(LANES) {
        let busy = first(n - i);
        // What lies behind the last path is nobody's medium.
        let row = load_u32(medium, i) & as_bits(busy);
        let column = |c: &[f32]| load(c, i);
        let [x, y, z] = paths.origin.each_ref().map(|c| column(c));
        let origin = Vec3x::new(x, y, z);
        let [x, y, z] = paths.direction.each_ref().map(|c| column(c));
        let direction = Vec3x::new(x, y, z);
        let primitive = load_u32(hits.primitive, i);
        let leaves = as_mask(primitive.simd_eq(Ux::splat(NO_PRIMITIVE)));
        let way = leaves.select(Fx::splat(f32::INFINITY), load(hits.t, i));
        let reach = media.reach(row, origin, direction, way);

        let throughput = paths.throughput.each_ref().map(|c| column(c));
        let bounces = load_u32(paths.bounces, i) & Ux::splat(!MARKS);
        let (pixel, sample) = (load_u32(paths.pixel, i), load_u32(paths.sample, i));
        let [u, choice, ..] = sampler.draw4(pixel, sample, apart(bounces, Apart::Medium));
        let flight = Flight::draw(media, row, throughput, reach.length, u, choice);
        let there = busy & flight.scattered;
        let weight = Vec3x::select(there, flight.scatters, flight.passes);
        let [r, g, b] = throughput;
        let weighed = Vec3x::new(r, g, b).product(weight);
        weighed.store(&mut paths.throughput, i);
        let t = reach.enter + flight.distance;
        store(hits.t, i, there.select(t, load(hits.t, i)));
        let met = as_bits(there).select(Ux::splat(IN_MEDIUM), primitive);
        store_u32(hits.primitive, i, met);
    }
}

/// How far rays get.
struct Flight {
    /// The distance that was drawn.
    distance: Fx,
    /// Where it lies within the medium.
    scattered: Mask,
    /// What the throughput of scattered paths is multiplied with.
    scatters: Vec3x,
    /// And that of the others.
    passes: Vec3x,
}

impl Flight {
    #[inline(always)]
    fn draw(media: &Media, row: Ux, throughput: [Fx; 3], length: Fx, u: Fx, choice: Fx) -> Self {
        let size = throughput.map(|c| c.abs());
        let total = size[0] + size[1] + size[2];
        let alive = total.simd_gt(Fx::ZERO) & total.is_finite();
        let share = size.map(|c| alive.select(c / total, Fx::splat(1.0 / 3.0)));
        let rate = media.rate.map(|column| gather(column, row));
        // What is not red or green is blue: shares add up to 1 to rounding only. A channel without a
        // share is not drawn, even at the ends.
        let red = choice.simd_lt(share[0]);
        let green = choice.simd_lt(share[0] + share[1]) | share[2].simd_eq(Fx::ZERO);
        let rest = (green & share[1].simd_gt(Fx::ZERO)).select(rate[1], rate[2]);
        let rest_or_red = red | (share[1] + share[2]).simd_eq(Fx::ZERO);
        let drawn = rest_or_red.select(rate[0], rest);
        let depth = -(Fx::ONE - u).ln();
        let infinite = Fx::splat(f32::INFINITY);
        let distance = drawn.simd_gt(Fx::ZERO).select(depth / drawn, infinite);
        let scattered = alive & distance.simd_lt(length);

        let s = scattered.select(distance, Fx::ZERO);
        let (mut density, mut passed) = (Fx::ZERO, Fx::ZERO);
        for (share, rate) in share.into_iter().zip(rate) {
            density += share * rate * falloff(rate, s);
            passed += share * falloff(rate, length);
        }
        let [r, g, b] = media.scattering.map(|column| gather(column, row));
        let scatters = media.transmittance(row, s) * (Fx::ONE / density);
        let passes = media.transmittance(row, length) * (Fx::ONE / passed);
        Self {
            distance,
            scattered,
            scatters: scatters.product(Vec3x::new(r, g, b)),
            // Nothing is left where nothing can pass.
            passes: passes.keep(passed.simd_gt(Fx::ZERO)),
        }
    }
}
