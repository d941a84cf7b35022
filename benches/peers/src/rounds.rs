//! Variants against each other: each round runs all of them over the same queue, so that whatever
//! else the machine is doing meets all alike, and ratios are taken within rounds.

use crate::clock::thread_seconds;
use crate::statistics::{Spread, median, spread};

/// One variant: its name and what it does with the queue.
pub(crate) type Variant<'a> = (&'static str, Box<dyn FnMut() + 'a>);

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
        variants.iter_mut().for_each(|(_, work)| work());
        let mut seconds: Vec<_> = variants.iter().map(|v| (v.0, Vec::new())).collect();
        for round in 0..rounds {
            for k in 0..variants.len() {
                let which = (round + k) % variants.len();
                seconds[which]
                    .1
                    .push(thread_seconds(&mut variants[which].1));
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
