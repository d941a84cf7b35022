//! Independent uniform numbers: the hash of the counter (pixel, sample, block, seed) itself.

use super::{Sampler, pixel_name};
use crate::lanes::{Fx, Ux};
use crate::rng::{pcg4d, scatter, unit};

/// Independent uniform numbers.
#[derive(Clone, Copy, Debug)]
pub struct Independent {
    /// Two renders with different seeds are independent of each other.
    pub seed: u32,
}

impl Sampler for Independent {
    #[inline(always)]
    fn pixel(&self, x: Ux, y: Ux) -> Ux {
        pixel_name(x, y)
    }

    #[inline(always)]
    fn draw4(&self, pixel: Ux, sample: Ux, block: Ux) -> [Fx; 4] {
        pcg4d([pixel, sample, block, scatter(Ux::splat(self.seed))]).map(unit)
    }
}
