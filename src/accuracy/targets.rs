//! Integrals whose value is known, and several ways to estimate each.

mod integrals;

use super::study::Curve;
use crate::estimate::{Generator, Running};
use clap::ValueEnum;
use std::f64::consts::{PI, TAU};

/// A known integral, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// Pi, by darts thrown at a square: 4 times the share that lands in the quarter disk
    Pi,
    /// x^2 over 0..2, which is 8/3
    Integral,
    /// 3 x^2 times 9 (1 - x)^8 over 0..1, which is 3/55: two factors, each a density
    Product,
    /// A narrow peak, x / (w^2 + (x - c)^2) over 0..1: the density matters
    Peak,
    /// x^2 + y^2 + z^2 over a box of 1 by 2 by 3, which is 28
    Box,
    /// The irradiance of a sky of radiance cos(theta), which is 2 pi / 3: over directions
    Hemisphere,
}

/// An integral, what it is, and how to estimate it.
pub struct Problem {
    /// The integral in words.
    pub what: String,
    /// Its value.
    pub exact: f64,
    /// Estimators to compare.
    pub methods: Vec<Method>,
}

/// An estimator.
pub struct Method {
    name: String,
    what: String,
    expected_slope: Option<f64>,
    pub(super) estimate: Estimator,
}

type Estimator = Box<dyn Fn(&mut Generator, usize) -> Estimate>;

/// One estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Samples taken.
    pub samples: usize,
    /// What they say the integral is.
    pub value: f64,
}

impl From<Running> for Estimate {
    fn from(running: Running) -> Self {
        Self {
            samples: running.count() as usize,
            value: running.mean(),
        }
    }
}

impl Method {
    /// An estimator with a name and a line that says `what` it does; `estimate` takes about as many
    /// samples as it is told. `expected_slope` is the power of their number that its error is known
    /// to go with, if it is.
    pub fn new<E: Into<Estimate>>(
        name: &str,
        what: &str,
        expected_slope: Option<f64>,
        estimate: impl Fn(&mut Generator, usize) -> E + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            what: what.into(),
            expected_slope,
            estimate: Box::new(move |rng, n| estimate(rng, n).into()),
        }
    }

    /// A curve with nothing on it yet.
    pub(super) fn curve(&self) -> Curve {
        Curve::new(&self.name, &self.what, self.expected_slope)
    }
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Pi,
        Self::Integral,
        Self::Product,
        Self::Peak,
        Self::Box,
        Self::Hemisphere,
    ];

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pi => "pi",
            Self::Integral => "integral",
            Self::Product => "product",
            Self::Peak => "peak",
            Self::Box => "box",
            Self::Hemisphere => "hemisphere",
        }
    }

    /// The integral and its estimators.
    #[must_use]
    pub fn problem(self) -> Problem {
        let (what, exact, methods) = match self {
            Self::Pi => (
                "pi: 4 times the share of a square's darts that hit its quarter disk",
                PI,
                integrals::pi(),
            ),
            Self::Integral => (
                "the integral of x^2 over 0..2",
                8.0 / 3.0,
                integrals::integral(),
            ),
            Self::Product => (
                "the integral of 3 x^2 times 9 (1 - x)^8 over 0..1",
                // 27 B(3, 9).
                3.0 / 55.0,
                integrals::product(),
            ),
            Self::Peak => (
                "the integral of x / (0.05^2 + (x - 0.3)^2) over 0..1",
                integrals::peak_exact(),
                integrals::peak(),
            ),
            Self::Box => (
                "the integral of x^2 + y^2 + z^2 over a box of 1 by 2 by 3",
                // Volume times a third of the sum of the squared edges.
                28.0,
                integrals::solid_box(),
            ),
            Self::Hemisphere => (
                "the irradiance of a sky of radiance cos(theta)",
                TAU / 3.0,
                integrals::hemisphere(),
            ),
        };
        Problem {
            what: what.into(),
            exact,
            methods,
        }
    }
}
