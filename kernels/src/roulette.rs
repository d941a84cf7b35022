//! Russian roulette: which paths go on.
//!
//! A path with throughput `T` survives with probability `q = min(g max(T), 0.99)` and then weighs
//! `T / q`, so that the expectation stays (J. Arvo, D. Kirk, "Particle Transport and Image
//! Synthesis", SIGGRAPH 1990). The gain `g`, 2 unless a render asks for another, keeps early bounces,
//! which carry most of the light: with 1 instead, an image of the same error took 1.2 times as long
//! (`docs/performance/wave.md`). The cap ends paths between perfectly white walls. Throughput that is 0 or
//! not finite never survives.
//!
//! The maximum depth is a rule of this stage too: a path that has scattered `limit` times may follow
//! its last ray to a light if that is of use, else it ends. A ray of infinite pdf always is: nothing
//! else finds what it finds.
//!
//! Cost: [`COST`] a path, and that of moving the survivors.

use crate::accumulate::report;
use crate::compact::Kept;
use crate::cost::{Cost, columns};
use crate::lanes::{
    Fx, LANES, Ux, as_bits, as_mask, first, gather, load, load_u32, padded, store_u32,
};
use crate::queues::{LAST_RAY, MARKS, PathsMut};
use crate::sampler::{Block, Sampler, block};
use crate::vec3::Vec3x;

/// A path.
pub const COST: Cost = Cost::new(
    columns::<PathsMut<'static>>(&["throughput", "pixel", "sample", "bounces"]),
    columns::<PathsMut<'static>>(&["throughput", "bounces"]),
)
.operations(12);

/// The rules of the stage.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Whether paths end at random.
    pub random: bool,
    /// Survival probability over throughput, positive, by the number of scattering events before the
    /// one that a path leaves; the last one also for all later. [`SURVIVAL_GAIN`] as a rule; where
    /// paths branch, times the branches so far, since each carries so much less.
    pub gain: [f32; GAINS],
    /// Scattering events after which a path ends.
    pub limit: u32,
    /// Whether only rays of infinite pdf go on: those of mirrors.
    pub mirrors_only: bool,
    /// Whether the ray after the last scattering event is of use whatever its pdf.
    pub last_ray: bool,
}

/// Scattering events that have a gain of their own.
pub const GAINS: usize = 8;
/// The usual survival probability over throughput.
pub const SURVIVAL_GAIN: f32 = 2.0;
/// The largest survival probability.
pub const SURVIVAL_CAP: f32 = 0.99;

/// Applies the rules to the first `n` paths: weighs the survivors, marks last rays, and pushes which
/// lanes of each vector survive to `kept` (which has room). `dropped` is called with the slot of each
/// path whose throughput is not finite.
///
/// `SIGNED` where throughput may be negative, as dispersion makes it: its size counts then.
pub fn roulette<S: Sampler, const SIGNED: bool>(
    n: usize,
    paths: &mut PathsMut,
    rules: Rules,
    sampler: S,
    kept: &mut Vec<Kept>,
    mut dropped: impl FnMut(u32),
) {
    let branching = rules.gain.iter().any(|g| *g != rules.gain[0]);
    for i in (0..padded(n)).step_by(LANES) {
        let throughput = Vec3x::new(
            load(paths.throughput[0], i),
            load(paths.throughput[1], i),
            load(paths.throughput[2], i),
        );
        let largest = if SIGNED {
            throughput.abs().max_component()
        } else {
            throughput.max_component()
        };
        let (busy, finite) = (first(n - i), throughput.is_finite());
        report(
            (busy & !finite).to_bitmask(),
            load_u32(paths.slot, i),
            &mut dropped,
        );
        let mut survives = busy & finite & largest.simd_gt(Fx::ZERO);
        let marked = load_u32(paths.bounces, i);
        let bounces = marked & Ux::splat(!MARKS);
        let limit = Ux::splat(rules.limit);
        // Not `>=`: a path marked before has ended by now.
        let last = as_mask(bounces.simd_eq(limit));
        let mark = as_bits(last) & Ux::splat(LAST_RAY);
        store_u32(paths.bounces, i, marked | mark);
        let alone = load(paths.pdf, i).simd_eq(Fx::splat(f32::INFINITY));
        if rules.mirrors_only {
            survives &= alone;
        }
        if !rules.last_ray {
            survives &= alone | as_mask(bounces.simd_lt(limit));
        }
        if rules.random {
            // The block of the vertex that was just left.
            let vertex = bounces - Ux::ONE;
            let pixel = load_u32(paths.pixel, i);
            let sample = load_u32(paths.sample, i);
            let [_, _, u, _] = sampler.draw4(pixel, sample, block(vertex, Block::Direction));
            let gain = if branching {
                gather(&rules.gain, vertex.min(Ux::splat(GAINS as u32 - 1)))
            } else {
                Fx::splat(rules.gain[0])
            };
            let wish = largest * gain;
            let q = wish.fast_min(Fx::splat(SURVIVAL_CAP));
            survives &= u.simd_lt(q);
            (throughput * (Fx::ONE / q)).store(&mut paths.throughput, i);
        }
        kept.push(Kept::new(survives));
    }
}
