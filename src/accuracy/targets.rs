//! Integrals whose value is known, and several ways to estimate each.

use super::study::Curve;
use crate::estimate::{
    CosineHemisphere, Density, Inversion, Lorentz, Power, Rejection, Running, Table, UniformBox,
    UniformHemisphere, UniformSphere, contribution, estimate, estimate_mis, points,
};
use clap::ValueEnum;
use rand_pcg::Pcg64;
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
    name: &'static str,
    what: &'static str,
    expected_slope: f64,
    pub(super) estimate: Estimator,
}

type Estimator = Box<dyn Fn(&mut Pcg64, usize) -> Estimate>;

/// One estimate.
pub(super) struct Estimate {
    pub(super) samples: usize,
    pub(super) value: f64,
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
    /// A curve with nothing on it yet.
    pub(super) fn curve(&self) -> Curve {
        Curve {
            name: self.name.into(),
            what: self.what.into(),
            points: Vec::new(),
            slope: None,
            slope_interval: None,
            expected_slope: Some(self.expected_slope),
        }
    }
}

fn method<E: Into<Estimate>>(
    name: &'static str,
    what: &'static str,
    expected_slope: f64,
    estimate: impl Fn(&mut Pcg64, usize) -> E + 'static,
) -> Method {
    Method {
        name,
        what,
        expected_slope,
        estimate: Box::new(move |rng, n| estimate(rng, n).into()),
    }
}

/// Independent points through a density.
fn independent<const D: usize, P: Density<D> + 'static>(
    name: &'static str,
    what: &'static str,
    density: P,
    f: impl Fn(&P::Point) -> f64 + 'static,
) -> Method {
    method(name, what, -0.5, move |rng, n| {
        estimate(points::independent(rng, n), &density, &f)
    })
}

/// Jittered points through a density; `D` strata to a coordinate, as close to `n` cells as can be.
fn jittered<const D: usize, P: Density<D> + 'static>(
    what: &'static str,
    expected_slope: f64,
    density: P,
    f: impl Fn(&P::Point) -> f64 + 'static,
) -> Method {
    method("jittered", what, expected_slope, move |rng, n| {
        let strata = (n as f64).powf(1.0 / D as f64).round() as usize;
        estimate(points::jittered(rng, strata.max(1)), &density, &f)
    })
}

/// Latin hypercube points through a density.
fn latin<const D: usize, P: Density<D> + 'static>(
    what: &'static str,
    expected_slope: f64,
    density: P,
    f: impl Fn(&P::Point) -> f64 + 'static,
) -> Method {
    method("latin", what, expected_slope, move |rng, n| {
        estimate(points::latin(rng, n), &density, &f)
    })
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
                pi(),
            ),
            Self::Integral => ("the integral of x^2 over 0..2", 8.0 / 3.0, integral()),
            Self::Product => (
                "the integral of 3 x^2 times 9 (1 - x)^8 over 0..1",
                // 27 B(3, 9).
                3.0 / 55.0,
                product(),
            ),
            Self::Peak => (
                "the integral of x / (0.05^2 + (x - 0.3)^2) over 0..1",
                peak_exact(),
                peak(),
            ),
            Self::Box => (
                "the integral of x^2 + y^2 + z^2 over a box of 1 by 2 by 3",
                // Volume times a third of the sum of the squared edges.
                28.0,
                solid_box(),
            ),
            Self::Hemisphere => (
                "the irradiance of a sky of radiance cos(theta)",
                TAU / 3.0,
                hemisphere(),
            ),
        };
        Problem {
            what: what.into(),
            exact,
            methods,
        }
    }
}

fn pi() -> Vec<Method> {
    let hit = |p: &[f64; 2]| {
        let [x, y] = p;
        4.0 * f64::from(u8::from(x * x + y * y < 1.0))
    };
    let square = UniformBox::<2>::unit();
    vec![
        independent("darts", "independent points, p = 1", square, hit),
        jittered(
            "one point in each cell of a square grid; only cells on the circle have variance",
            -0.75,
            square,
            hit,
        ),
        latin(
            "one point in each column and in each row",
            -0.5,
            square,
            hit,
        ),
    ]
}

fn integral() -> Vec<Method> {
    let uniform = UniformBox::new([0.0], [2.0]);
    vec![
        independent("uniform", "independent points, p = 1/2", uniform, |x| {
            x[0] * x[0]
        }),
        independent(
            "linear",
            "independent points, p = x/2 by inversion",
            Power::new(1.0, 2.0),
            |x| x * x,
        ),
        jittered("one point in each stratum, p = 1/2", -1.5, uniform, |x| {
            x[0] * x[0]
        }),
    ]
}

fn product() -> Vec<Method> {
    let first = Power::new(2.0, 1.0);
    let second = Inversion {
        inverse_cdf: |u: f64| 1.0 - (1.0 - u).powf(1.0 / 9.0),
        pdf: |x: f64| 9.0 * (1.0 - x).powi(8),
    };
    let f = |x: f64| 27.0 * x * x * (1.0 - x).powi(8);
    let uniform = UniformBox::new([0.0], [1.0]);
    vec![
        independent("uniform", "independent points, p = 1", uniform, move |x| {
            f(x[0])
        }),
        independent("first", "p = 3 x^2, the wide factor", first, move |x| f(*x)),
        independent(
            "second",
            "p = 9 (1 - x)^8, the narrow factor",
            second,
            move |x| f(*x),
        ),
        method(
            "mis",
            "half the points from each factor, balance heuristic",
            -0.5,
            move |rng, n| {
                let half: Vec<[f64; 1]> = points::independent(rng, n / 2).collect();
                let rest: Vec<[f64; 1]> = points::independent(rng, n - n / 2).collect();
                let (half, rest) = (half.into_iter(), rest.into_iter());
                let parts = estimate_mis((&first, half), (&second, rest), |x| f(*x));
                Estimate {
                    samples: n,
                    value: parts[0].mean() + parts[1].mean(),
                }
            },
        ),
        jittered(
            "one point in each stratum, p = 1",
            -1.5,
            uniform,
            move |x| f(x[0]),
        ),
    ]
}

/// Centre and half width of the peak.
const PEAK: [f64; 2] = [0.3, 0.05];

/// With `t = x - c`, `x / (w^2 + t^2)` is `t / (w^2 + t^2)`, the derivative of half a logarithm,
/// plus `c / (w^2 + t^2)`, that of an arc tangent.
fn peak_exact() -> f64 {
    let [c, w] = PEAK;
    let antiderivative = |t: f64| 0.5 * (w * w + t * t).ln() + c / w * (t / w).atan();
    antiderivative(1.0 - c) - antiderivative(-c)
}

fn peak() -> Vec<Method> {
    let [c, w] = PEAK;
    let f = move |x: f64| x / (w * w + (x - c) * (x - c));
    let uniform = UniformBox::new([0.0], [1.0]);
    let lorentz = Lorentz::new(c, w, 0.0, 1.0);
    let table = Table::of(0.0, 1.0, 32, f).expect("f is positive in the middle of each cell");
    vec![
        independent("uniform", "independent points, p = 1", uniform, move |x| {
            f(x[0])
        }),
        independent(
            "lorentz",
            "p = the peak without its slant, by analytic inversion",
            lorentz,
            move |x| f(*x),
        ),
        independent(
            "table",
            "p = the integrand in 32 cells, by inversion of the table",
            table,
            move |x| f(*x),
        ),
        method(
            "rejection",
            "p = the peak without its slant, by rejection of uniform points",
            -0.5,
            move |rng, n| {
                let shape = |x: &[f64; 1]| lorentz.pdf(&x[0]);
                let mut source = Rejection::new(uniform, shape, lorentz.pdf(&c));
                let drawn = (0..n).map_while(|_| source.draw(rng));
                let terms = drawn.map(|x| contribution(f(x[0]), lorentz.pdf(&x[0])));
                terms.collect::<Running>()
            },
        ),
        jittered(
            "one point in each stratum, p = 1",
            -1.5,
            uniform,
            move |x| f(x[0]),
        ),
    ]
}

fn solid_box() -> Vec<Method> {
    let uniform = UniformBox::new([0.0; 3], [1.0, 2.0, 3.0]);
    let f = |p: &[f64; 3]| p.iter().map(|x| x * x).sum();
    vec![
        independent("uniform", "independent points, p = 1/6", uniform, f),
        jittered("one point in each cell of a grid", -5.0 / 6.0, uniform, f),
        latin(
            "one point in each slab of each coordinate; the integrand is a sum over coordinates",
            -1.5,
            uniform,
            f,
        ),
    ]
}

fn hemisphere() -> Vec<Method> {
    // Radiance times cosine, 0 below the horizon.
    let f = |omega: &[f64; 3]| omega[2].max(0.0).powi(2);
    vec![
        independent(
            "sphere",
            "directions uniform on the sphere, p = 1/(4 pi)",
            UniformSphere,
            f,
        ),
        independent(
            "uniform",
            "directions uniform on the hemisphere, p = 1/(2 pi)",
            UniformHemisphere,
            f,
        ),
        independent("cosine", "p = cos(theta)/pi", CosineHemisphere, f),
        jittered(
            "as uniform, one direction in each cell of a square grid",
            -1.0,
            UniformHemisphere,
            f,
        ),
    ]
}
