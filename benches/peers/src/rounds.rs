//! Variants against each other: each round runs all of them over the same queue, so that whatever
//! else the machine is doing meets all alike, and ratios are taken within rounds.
//!
//! A render asks one tracer about one tree all along. Here each turn would begin with caches full of
//! somebody else's tree, and the faster a tracer is, the larger a part of its turn that costs. So a turn
//! begins with rays of the same kind that are not timed; `--cold` leaves them out.

use crate::clock::thread_seconds;
use crate::statistics::{Spread, median, spread};

/// One variant.
pub(crate) struct Variant<'a> {
    pub(crate) name: &'static str,
    /// What a turn begins with, not timed.
    pub(crate) warm_up: Box<dyn FnMut() + 'a>,
    /// What it does with the queue.
    pub(crate) work: Box<dyn FnMut() + 'a>,
}

/// CPU seconds of each variant in each round.
#[derive(Clone, Debug)]
pub(crate) struct Timings {
    rays: usize,
    seconds: Vec<(&'static str, Vec<f64>)>,
}

impl Timings {
    /// Runs each variant once without looking at the clock, then `rounds` rounds, each beginning
    /// with another variant, so that none always runs in the wake of the same one.
    pub(crate) fn take(rays: usize, rounds: usize, mut variants: Vec<Variant>) -> Self {
        variants.iter_mut().for_each(|variant| (variant.work)());
        let mut seconds: Vec<_> = variants.iter().map(|v| (v.name, Vec::new())).collect();
        for round in 0..rounds {
            for k in 0..variants.len() {
                let which = (round + k) % variants.len();
                let variant = &mut variants[which];
                (variant.warm_up)();
                seconds[which].1.push(thread_seconds(&mut variant.work));
            }
        }
        Self { rays, seconds }
    }

    fn of(&self, name: &str) -> Option<&[f64]> {
        let found = self.seconds.iter().find(|(n, _)| *n == name);
        found.map(|(_, seconds)| &seconds[..])
    }

    /// Millions of rays a CPU second, median over rounds.
    pub(crate) fn rate(&self, name: &str) -> Option<f64> {
        let seconds = self.of(name)?;
        let rates: Vec<f64> = seconds.iter().map(|s| self.rays as f64 / s / 1e6).collect();
        Some(median(&rates))
    }

    /// How many times as fast as `other` `name` is.
    pub(crate) fn ratio(&self, name: &str, other: &str) -> Option<Spread> {
        let (ours, theirs) = (self.of(name)?, self.of(other)?);
        let ratios: Vec<f64> = ours.iter().zip(theirs).map(|(a, b)| b / a).collect();
        Some(spread(&ratios))
    }
}
