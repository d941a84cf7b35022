//! Mixtures: of two materials, each path that meets them meets one, with the probability of its share.
//! So a mixture needs no kernel, and costs nothing but the draw.

use crate::effects::{Effects, Shader};
use crate::scene::{Bsdf, Scene};
use huygens_kernels::lanes::Ux;
use huygens_kernels::queues::{MARKS, Paths};
use huygens_kernels::rng::{pcg4d, unit};

/// A mixture of two materials.
#[derive(Clone, Copy, Debug)]
struct Mixture {
    first: u32,
    second: u32,
    /// Share of the second.
    amount: f32,
}

/// The mixtures of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Mixtures {
    /// By material.
    of: Vec<Option<Mixture>>,
    seed: u32,
}

impl Mixtures {
    /// Those that the scene calls for; none if it calls for none.
    pub(crate) fn new(scene: &Scene, effects: &Effects, seed: u32) -> Option<Self> {
        let of = |m: &crate::scene::Material| match m.bsdf {
            Bsdf::Mix {
                first,
                second,
                amount,
            } => Some(Mixture {
                first,
                second,
                amount: amount.factor,
            }),
            _ => None,
        };
        effects.shaders.contains(&Shader::Mix).then(|| Self {
            of: scene.materials.iter().map(of).collect(),
            seed,
        })
    }

    /// What path `i` meets of `material`: the material itself if it is no mixture. A pure function of
    /// seed, pixel, sample and bounce, like all random numbers, but of no sampler: the draw is none of
    /// those that a low-discrepancy sequence spreads.
    pub(crate) fn draw(&self, paths: &Paths, i: usize, mut material: u32) -> u32 {
        let mut depth = 0;
        while let Some(mixture) = self.of[material as usize] {
            let bounce = paths.bounces[i] & !MARKS;
            // A stream apart from the samplers': their blocks do not reach so far.
            let block = !(bounce << 8 | depth);
            let name = [paths.pixel[i], paths.sample[i], block, self.seed];
            let u = unit(pcg4d(name.map(Ux::splat))[0]).as_array()[0];
            material = if u < mixture.amount {
                mixture.second
            } else {
                mixture.first
            };
            depth += 1;
        }
        material
    }
}
