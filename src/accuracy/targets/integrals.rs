//! The estimators of each target.

use super::{Estimate, Method};
use crate::estimate::{
    CosineHemisphere, Density, Inversion, Lorentz, Power, Rejection, Rng, Running, Table,
    UniformBox, UniformHemisphere, UniformSphere, contribution, estimate, estimate_mis, generator,
    points,
};

/// Independent points through a density.
fn independent<const D: usize, P: Density<D> + 'static>(
    name: &str,
    what: &str,
    density: P,
    f: impl Fn(&P::Point) -> f64 + 'static,
) -> Method {
    Method::new(name, what, Some(-0.5), move |rng, n| {
        estimate(points::independent(rng, n), &density, &f)
    })
}

/// Jittered points through a density; `D` strata to a coordinate, as close to `n` cells as can be.
fn jittered<const D: usize, P: Density<D> + 'static>(
    what: &str,
    expected_slope: f64,
    density: P,
    f: impl Fn(&P::Point) -> f64 + 'static,
) -> Method {
    Method::new("jittered", what, Some(expected_slope), move |rng, n| {
        let strata = (n as f64).powf(1.0 / D as f64).round() as usize;
        estimate(points::jittered(rng, strata.max(1)), &density, &f)
    })
}

/// Latin hypercube points through a density.
fn latin<const D: usize, P: Density<D> + 'static>(
    what: &str,
    expected_slope: f64,
    density: P,
    f: impl Fn(&P::Point) -> f64 + 'static,
) -> Method {
    Method::new("latin", what, Some(expected_slope), move |rng, n| {
        estimate(points::latin(rng, n), &density, &f)
    })
}

pub(super) fn pi() -> Vec<Method> {
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

pub(super) fn integral() -> Vec<Method> {
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

pub(super) fn product() -> Vec<Method> {
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
        Method::new(
            "mis",
            "half the points from each factor, balance heuristic",
            Some(-0.5),
            move |rng, n| {
                // Both sets of points draw at once, each from a generator of its own.
                let other = &mut generator(&[rng.next_u64()]);
                let (half, rest) = (n / 2, n - n / 2);
                let a = (&first, points::independent(rng, half));
                let b = (&second, points::independent(other, rest));
                let parts = estimate_mis(a, b, |x| f(*x));
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
pub(super) fn peak_exact() -> f64 {
    let [c, w] = PEAK;
    let antiderivative = |t: f64| 0.5 * (w * w + t * t).ln() + c / w * (t / w).atan();
    antiderivative(1.0 - c) - antiderivative(-c)
}

pub(super) fn peak() -> Vec<Method> {
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
        Method::new(
            "rejection",
            "p = the peak without its slant, by rejection of uniform points",
            Some(-0.5),
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

pub(super) fn solid_box() -> Vec<Method> {
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

pub(super) fn hemisphere() -> Vec<Method> {
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
