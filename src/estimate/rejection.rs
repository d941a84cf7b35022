//! Rejection: draw from what can be drawn from, keep what falls under the density.

use super::points::uniform;
use super::{Density, Rng};

/// Draws from a density known only as a function, under a bound.
///
/// Draw `x` from the proposal `q`, accept it with probability `f(x) / (c q(x))`, where `c q >= f`
/// everywhere; what is accepted has density `f` over its integral, which nobody needs to know. Each
/// try succeeds with probability `(integral of f) / c`: the acceptance rate, and what rejection costs.
/// (J. von Neumann, "Various Techniques Used in Connection with Random Digits", 1951.)
///
/// It takes an unknown number of random numbers, so it fits no strata.
#[derive(Clone, Debug)]
pub struct Rejection<Q, F> {
    proposal: Q,
    target: F,
    bound: f64,
    tries: u64,
    accepted: u64,
    beyond: u64,
}

/// In a row, without one acceptance: then `target` is taken to be 0 everywhere.
const PATIENCE: u32 = 10_000_000;

impl<Q, F> Rejection<Q, F> {
    /// From `target`, which is not negative and nowhere more than `bound` times the pdf of
    /// `proposal`.
    ///
    /// # Panics
    /// Unless `bound` is positive and finite.
    #[must_use]
    pub fn new(proposal: Q, target: F, bound: f64) -> Self {
        assert!(bound > 0.0 && bound.is_finite(), "{bound} bounds nothing");
        Self {
            proposal,
            target,
            bound,
            tries: 0,
            accepted: 0,
            beyond: 0,
        }
    }

    /// Accepted points over tries so far: an estimate of `(integral of target) / bound`. None before
    /// the first try.
    #[must_use]
    pub fn acceptance_rate(&self) -> Option<f64> {
        (self.tries > 0).then(|| self.accepted as f64 / self.tries as f64)
    }

    /// Proposals drawn so far.
    #[must_use]
    pub fn tries(&self) -> u64 {
        self.tries
    }

    /// Proposals at which the target exceeded the bound. If it is not 0, the bound is wrong, and what
    /// was drawn is not distributed as asked.
    #[must_use]
    pub fn beyond(&self) -> u64 {
        self.beyond
    }

    /// The next point; none if ten million tries in a row failed.
    pub fn draw<const D: usize>(&mut self, rng: &mut impl Rng) -> Option<Q::Point>
    where
        Q: Density<D>,
        F: Fn(&Q::Point) -> f64,
    {
        for _ in 0..PATIENCE {
            self.tries += 1;
            let x = self.proposal.sample(std::array::from_fn(|_| uniform(rng)));
            let height = (self.target)(&x);
            let ceiling = self.bound * self.proposal.pdf(&x);
            self.beyond += u64::from(height > ceiling);
            // Strictly: where the target is 0, nothing is accepted.
            if uniform(rng) * ceiling < height {
                self.accepted += 1;
                return Some(x);
            }
        }
        None
    }
}
