//! Samplers: what numbers a path draws, and how they are spread over a pixel's samples.
//!
//! A sampler is a pure function of (seed, pixel, sample, block of dimensions): a path carries no
//! state, and any lane, wave, thread or machine that asks the same gets the same.
//!
//! | sampler | a pixel's points in one block | cost |
//! |---|---|---|
//! | [`Independent`] | independent | one hash |
//! | [`Stratified`] | pairs of dimensions on a jittered grid of as many cells as samples | six permutations |
//! | [`Sobol`] | a scrambled four-dimensional Sobol sequence | five scramblings |
//! | [`BlueNoise`] | the same, and the pixels of a neighbourhood complete each other | six scramblings |
//!
//! In all of them different blocks are independent of each other (*padding*), and every single point
//! is uniform over the unit cube, so that every estimate is unbiased. What differs is the variance of
//! means over many samples, and how errors of neighbouring pixels are related.
//!
//! Input: lanes that hold no path may hold anything. Output: numbers in `[0, 1 - 2^-24]`.

mod blue_noise;
mod independent;
mod owen;
mod sobol;
mod stratified;

pub use blue_noise::BlueNoise;
pub use independent::Independent;
pub use sobol::{Sobol, sobol};
pub use stratified::Stratified;

use crate::lanes::{Fx, Ux};
use crate::rng::scatter;

/// A sequence of points: four dimensions a block, one point a (pixel, sample).
pub trait Sampler: Copy + Send + Sync {
    /// The word by which this sampler knows the pixel at `(x, y)`, both below 2^16. It is made once a
    /// path and travels with it.
    #[must_use]
    fn pixel(&self, x: Ux, y: Ux) -> Ux;

    /// Dimensions `4 * block .. 4 * block + 4` of the point of each lane's `(pixel, sample)`.
    ///
    /// Whoever needs fewer than four leaves the others unused: what only they need is not computed.
    #[must_use]
    fn draw4(&self, pixel: Ux, sample: Ux, block: Ux) -> [Fx; 4];
}

/// What a path vertex draws its numbers for: each gets a block of its own, so that no number is used
/// twice and none depends on what else a scene calls for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// Two for the next direction, one for roulette.
    Direction,
    /// Two to select a light, two for a point on it.
    Light,
}

/// The camera's block: two numbers for the pixel filter, two for the lens.
pub const CAMERA_BLOCK: u32 = 0;

/// The block of a path that has scattered `bounces` times so far (whatever its topmost bit).
#[inline(always)]
#[must_use]
pub fn block(bounces: Ux, what: Block) -> Ux {
    bounces + bounces + Ux::splat(1 + what as u32)
}

/// What a path draws its numbers for in scenes that call for it, apart from [`Block`]: the numbers of
/// a scene do not depend on what is not in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Apart {
    /// One for the wavelength.
    Wavelength,
    /// One for the moment that it lives at.
    Time,
    /// One for how far a ray goes in a medium, one for the channel that says so.
    Medium,
}

/// The first of the blocks of [`Apart`]: far beyond those of [`block`], and other than those in many
/// bits, low ones among them. Hashes of words that differ in the topmost bits alone are not
/// independent: numbers of a block with bit 31 set are correlated with those of the block without.
const FIRST_APART: u32 = 0xb529_7a4d;

/// The block of a path that has scattered `bounces` times so far, all marks left out.
#[inline(always)]
#[must_use]
pub fn apart(bounces: Ux, what: Apart) -> Ux {
    (bounces << 2) + Ux::splat(FIRST_APART + what as u32)
}

/// A pixel's name where only its identity counts: its coordinates, hashed.
#[inline(always)]
fn pixel_name(x: Ux, y: Ux) -> Ux {
    scatter((y << 16) | x)
}
