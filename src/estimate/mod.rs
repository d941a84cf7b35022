//! Plain Monte Carlo: from `1/N sum f(X)` to stratified sampling of tabulated densities.
//!
//! An integral is an expectation. Draw `X` with density `p`, positive wherever `f` is not zero;
//! then
//!
//! ```text
//!     F_N = 1/N sum f(X_i) / p(X_i),    E[F_N] = integral of f,    V[F_N] = V[f(X)/p(X)] / N.
//! ```
//!
//! The error falls as `N^-1/2` in any number of dimensions; all the rest of the art is to make
//! `V[f/p]` small, or to place the points better than independently. The parts here answer one
//! question each, and any answer goes with any other:
//!
//! | question | answers |
//! |---|---|
//! | Where do the numbers in `[0, 1)` come from? | [`points`]: independent, jittered, Latin hypercube |
//! | Which density do they become? | a [`Density`]: [`UniformBox`], an analytic inverse ([`Inversion`], [`Power`], [`Lorentz`]), a table ([`Table`], [`Table2`]), directions ([`UniformSphere`], [`UniformHemisphere`], [`CosineHemisphere`]); or [`Rejection`] |
//! | What is the integral? | [`estimate`]; with two densities at once, [`estimate_mis`] |
//! | How far is it off? | [`Running`]: variance, standard error, confidence interval |
//!
//! # The integral of x^2 over 0..2, three times
//!
//! ```
//! use huygens::estimate::{Power, UniformBox, estimate, generator, points};
//! let square = |x: f64| x * x;
//! let mut rng = generator(&[1]);
//!
//! // With uniform points: p = 1/2.
//! let uniform = UniformBox::new([0.0], [2.0]);
//! let plain = estimate(points::independent(&mut rng, 1024), &uniform, |x| square(x[0]));
//! let [low, high] = plain.confidence_interval(0.999).unwrap();
//! assert!(low < 8.0 / 3.0 && 8.0 / 3.0 < high);
//!
//! // With p = x/2, which resembles the integrand: a quarter of the error.
//! let linear = Power::new(1.0, 2.0);
//! let better = estimate(points::independent(&mut rng, 1024), &linear, |x| square(*x));
//! assert!(better.standard_error() < plain.standard_error());
//!
//! // With one point in each of 1024 strata: the error falls as N^-3/2.
//! let strata = estimate(points::jittered(&mut rng, 1024), &uniform, |x| square(x[0]));
//! assert!((strata.mean() - 8.0 / 3.0).abs() < 1e-3);
//! ```
//!
//! `huygens accuracy integral` shows what each of these costs in time.

mod density;
mod integrate;
mod normal;
pub mod points;
mod rejection;
mod running;
mod sphere;
mod student;
mod table;

pub use density::{Density, Inversion, Lorentz, Power, UniformBox};
pub use integrate::{balance, contribution, estimate, estimate_mis, power};
pub use normal::{normal_quantile, sidak};
pub use points::{Generator, generator};
pub use rand_pcg::rand_core::Rng;
pub use rejection::Rejection;
pub use running::Running;
pub use sphere::{CosineHemisphere, UniformHemisphere, UniformSphere};
pub use student::student_quantile;
pub use table::{Table, Table2, TableError};
