//! Renders that end by their error, or by the clock: in rounds of a few samples.
//!
//! *Estimate.* Every round has random numbers of its own, so that the means of a pixel's rounds are
//! independent whatever the sampler, and their scatter says how far their mean is off:
//!
//! ```text
//! m = sum n_r m_r / N,    V[m] ~ sum n_r (m_r - m)^2 / ((R - 1) N),    N = sum n_r
//! ```
//!
//! over `R` rounds of `n_r` samples. That is unbiased where a round's variance goes as `1 / n_r`, as
//! with independent samples. Where larger rounds are better than that, it is too large, on the safe
//! side, by what the first, small rounds still weigh.
//!
//! An error is relative to the true brightness `b`, by `1 / (b^2 + floor)`. A pixel that one very bright
//! path has met is noisy by its estimate, and bright by the same path: to divide by the square of its own
//! mean would hide the noise where there is most. `m^2 - V[m]`, whose expectation is `b^2`, takes out what
//! the noise adds.
//!
//! *Allocation.* Blocks of pixels go on or stop together. With `V_b` the variance of block `b` after one
//! sample, summed over pixels and relative as an error is, and `c_b` its pixels, the sum of `V_b / N_b`
//! falls soonest with `N_b` in proportion to `sqrt(V_b / c_b)` (J. Neyman, 1934); blocks that have that
//! many already wait.
//!
//! *Bias.* Whether a block goes on depends on what was seen in it, so its mean is not quite unbiased: a
//! block that happens to look calm stops sooner. The decision rests on some thousand values of which
//! one pixel's are three, which is why the bias of a pixel is a small part of its standard error. A
//! test measures it. What no sample has met (a caustic through a keyhole) no estimate knows of.

use super::difference::floor;
use crate::estimate::{Rng, generator};
use crate::film::{Film, Image, Tile};
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::wave::{self, Control, RenderStats};

/// Edge of a block in pixels, whatever the tiles of other renders.
const BLOCK: u32 = 32;
/// Rounds that every block gets before anything is decided, and their samples.
const FIRST: (u32, u32) = (8, 4);
/// Samples of later rounds.
const LATER: u32 = 16;
/// Names the seeds of rounds among all seeds.
const TAG: u64 = 0x726f_756e;

/// When a render ends, besides by its [`Control`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The relative error to reach: the root of the mean of relMSE over all pixels (`docs/accuracy.md`).
    pub error: Option<f64>,
    /// The most samples of a pixel, at least 1.
    pub spp: u32,
}

/// A render in rounds.
#[derive(Clone, Debug)]
pub struct Rounds {
    /// The image. Its variance is that of the rounds, right whatever the sampler; infinite below two.
    pub image: Image,
    /// What the renders did, all together.
    pub stats: RenderStats,
    /// The relative error by estimate; infinite if nothing is known of it.
    pub error: f64,
    /// How it ended.
    pub ended: Ended,
}

/// How a render in rounds ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The error was reached.
    Error,
    /// At the most samples.
    Samples,
    /// It was stopped, or its time was over.
    Stopped,
}

/// Weighted mean of rounds, and their squared deviations from it.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    value: f64,
    squares: f64,
}

/// One block's pixels.
struct Block {
    tile: Tile,
    pixels: Vec<[Mean; 3]>,
    rounds: u32,
    samples: u32,
}

impl Block {
    fn new(tile: Tile) -> Self {
        Self {
            tile,
            pixels: vec![[Mean::default(); 3]; tile.pixels() as usize],
            rounds: 0,
            samples: 0,
        }
    }

    fn add(&mut self, means: &[[f64; 3]], samples: u32) {
        self.rounds += 1;
        self.samples += samples;
        let (weight, all) = (f64::from(samples), f64::from(self.samples));
        for (pixel, mean) in self.pixels.iter_mut().zip(means) {
            for (m, value) in pixel.iter_mut().zip(mean) {
                let before = value - m.value;
                m.value += before * (weight / all);
                m.squares += weight * before * (value - m.value);
            }
        }
    }

    /// The variance of one sample, by the scatter of the rounds.
    fn of_sample(&self, mean: &Mean) -> f64 {
        if self.rounds < 2 {
            return f64::INFINITY;
        }
        mean.squares / f64::from(self.rounds - 1)
    }

    /// The relative variance of one sample, summed over pixels and channels.
    fn relative(&self, floor: f64) -> f64 {
        let all = self.pixels.as_flattened().iter();
        let samples = f64::from(self.samples.max(1));
        let relative = |m: &Mean| {
            let variance = self.of_sample(m);
            // Of the square of a mean, its variance is no brightness.
            let square = m.value * m.value - variance / samples;
            variance / (square.max(0.0) + floor)
        };
        all.map(relative).sum()
    }
}

/// Renders `scene` in rounds until `goal` is reached, or `control` stops it; rounds that are cut count
/// for the blocks that they were done in. The number of samples and the seed of `settings` are those
/// of the goal and of the rounds. Without an error to reach, all blocks go on to the end.
///
/// The image is a function of scene, settings and goal, unless it was stopped.
#[must_use]
pub fn render_rounds(
    scene: &Scene,
    geometry: &Geometry,
    settings: &Settings,
    goal: Goal,
    control: &Control,
) -> Rounds {
    let (width, height) = (scene.film.width, scene.film.height);
    let all = Film::new(width, height, BLOCK);
    let mut blocks: Vec<Block> = all.tiles().iter().copied().map(Block::new).collect();
    let mut stats = RenderStats::default();
    let mut ended = Ended::Samples;
    for round in 0.. {
        let size = if round < FIRST.0 { FIRST.1 } else { LATER };
        let chosen = match goal.error {
            Some(error) if round >= FIRST.0 => wanted(&blocks, error),
            _ => vec![true; blocks.len()],
        };
        if !chosen.contains(&true) {
            ended = Ended::Error;
            break;
        }
        // At the ceiling, a last round of what is left.
        let rest = |b: &Block| goal.spp.saturating_sub(b.samples).min(size);
        let samples = blocks.iter().zip(&chosen).filter(|(_, c)| **c);
        let Some(samples) = samples.map(|(b, _)| rest(b)).filter(|&n| n > 0).min() else {
            break;
        };
        let going: Vec<usize> = (0..blocks.len())
            .filter(|&i| chosen[i] && rest(&blocks[i]) > 0)
            .collect();
        let tiles = going.iter().map(|&i| blocks[i].tile).collect();
        let film = Film::of_tiles(width, height, tiles);
        let seed = [u64::from(settings.seed), TAG, u64::from(round)];
        let settings = Settings {
            seed: generator(&seed).next_u32(),
            spp: samples,
            ..settings.clone()
        };
        stats.follow(wave::render(scene, geometry, &settings, &film, control));
        for (tile, &i) in going.iter().enumerate() {
            if let Some(means) = film.means(tile, samples) {
                blocks[i].add(&means, samples);
            }
        }
        if stats.stopped {
            ended = Ended::Stopped;
            break;
        }
    }
    Rounds {
        image: develop(width, height, &blocks),
        stats,
        error: error(&blocks),
        ended,
    }
}

/// What is added to the squares of values, so that black ones can be divided by.
fn floor_of(blocks: &[Block]) -> f64 {
    let values = blocks.iter().flat_map(|b| b.pixels.as_flattened());
    let (sum, n) = values.fold((0.0, 0u64), |(sum, n), m| (sum + m.value.abs(), n + 1));
    floor(sum / n as f64)
}

/// Pixels and channels.
fn values(blocks: &[Block]) -> f64 {
    let pixels: u64 = blocks.iter().map(|b| u64::from(b.tile.pixels())).sum();
    3.0 * pixels as f64
}

fn error(blocks: &[Block]) -> f64 {
    let floor = floor_of(blocks);
    if floor <= 0.0 {
        // Black as far as is known.
        return if blocks.iter().all(|b| b.rounds > 1) {
            0.0
        } else {
            f64::INFINITY
        };
    }
    let noise = blocks
        .iter()
        .map(|b| b.relative(floor) / f64::from(b.samples.max(1)));
    (noise.sum::<f64>() / values(blocks)).sqrt()
}

/// The blocks that shall go on.
fn wanted(blocks: &[Block], error: f64) -> Vec<bool> {
    let floor = floor_of(blocks);
    if floor <= 0.0 {
        return vec![false; blocks.len()];
    }
    let variance: Vec<f64> = blocks.iter().map(|b| b.relative(floor)).collect();
    let had: Vec<f64> = blocks.iter().map(|b| f64::from(b.samples)).collect();
    let share: Vec<f64> = blocks
        .iter()
        .zip(&variance)
        .map(|(b, v)| (v / f64::from(b.tile.pixels())).sqrt())
        .collect();
    let goal = error * error * values(blocks);
    let left = |scale: f64| -> f64 {
        let each = variance.iter().zip(&had).zip(&share);
        each.map(|((v, n), s)| v / n.max(scale * s)).sum()
    };
    if left(0.0) <= goal {
        return vec![false; blocks.len()];
    }
    // The scale at which the goal is met lies between these; halving finds it to the last bits.
    let (mut low, mut high) = (0.0, 1.0);
    while left(high) > goal && high < 1e300 {
        (low, high) = (high, 4.0 * high);
    }
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if left(middle) > goal {
            low = middle;
        } else {
            high = middle;
        }
    }
    share.iter().zip(&had).map(|(s, n)| high * s > *n).collect()
}

fn develop(width: u32, height: u32, blocks: &[Block]) -> Image {
    let pixels = width as usize * height as usize;
    let mut image = Image {
        width,
        height,
        mean: vec![[0.0; 3]; pixels],
        variance: vec![[f32::INFINITY; 3]; pixels],
        samples: vec![0; pixels],
    };
    for block in blocks {
        for (at, pixel) in block.pixels.iter().enumerate() {
            let (x, y) = (at as u32 % block.tile.width, at as u32 / block.tile.width);
            let i = (block.tile.y + y) as usize * width as usize + (block.tile.x + x) as usize;
            let n = f64::from(block.samples.max(1));
            image.mean[i] = pixel.map(|m| m.value as f32);
            image.variance[i] = pixel.map(|m| (block.of_sample(&m) / n) as f32);
            image.samples[i] = block.samples;
        }
    }
    image
}

#[cfg(test)]
mod tests;
