//! Sampling: which sampler a render draws its numbers from.
//!
//! The kernels that draw are generic over the sampler, and a stage picks their instance each time it
//! runs: a branch for some thousand paths. Only those kernels are compiled once a sampler; the loop,
//! traversal and all else are compiled once.

use crate::settings::{self, Settings};
use huygens_kernels::sampler::{BlueNoise, Independent, Sobol, Stratified};

/// The sampler of a render.
#[derive(Clone, Copy, Debug)]
pub(crate) enum AnySampler {
    Independent(Independent),
    Stratified(Stratified),
    Sobol(Sobol),
    BlueNoise(BlueNoise),
}

impl AnySampler {
    pub(crate) fn new(settings: &Settings) -> Self {
        // Branches go on as samples of their own.
        let branches = settings.split.iter().product::<u32>();
        let (seed, spp) = (settings.seed, settings.spp.saturating_mul(branches));
        match settings.sampler {
            settings::Sampler::Independent => Self::Independent(Independent { seed }),
            settings::Sampler::Stratified => Self::Stratified(Stratified::new(seed, spp)),
            settings::Sampler::Sobol => Self::Sobol(Sobol { seed }),
            settings::Sampler::BlueNoise => Self::BlueNoise(BlueNoise::new(seed, spp)),
        }
    }
}

/// `with_sampler!(any, sampler => expression)`: the expression with `sampler` as what it is.
macro_rules! with_sampler {
    ($any:expr, $sampler:ident => $run:expr) => {
        match $any {
            $crate::wave::sampling::AnySampler::Independent($sampler) => $run,
            $crate::wave::sampling::AnySampler::Stratified($sampler) => $run,
            $crate::wave::sampling::AnySampler::Sobol($sampler) => $run,
            $crate::wave::sampling::AnySampler::BlueNoise($sampler) => $run,
        }
    };
}
pub(super) use with_sampler;
