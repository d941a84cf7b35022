//! What accuracy costs in time: studies of error against samples and seconds, and measures of the
//! difference of two images.
//!
//! A study runs each of several estimators over a ladder of samples, each doubled from the one
//! before, several times over with independent random numbers, and compares with the truth. What comes of it is a
//! [`Curve`] an estimator: error and seconds at each rung, and the slope that the error falls with.
//! `docs/accuracy.md` says what each number means and how it is laid out as JSON.
//!
//! ```
//! use huygens::accuracy::{Ladder, Target, study};
//! let ladder = Ladder { last: 1024, ..Ladder::default() };
//! let study = study(&Target::Integral.problem(), &ladder, || true);
//! for curve in &study.curves {
//!     println!("{}: N^{:.2}", curve.name, curve.slope.unwrap());
//! }
//! ```

mod difference;
mod false_colour;
mod fit;
mod flip;
pub mod report;
mod rounds;
pub mod scene;
mod study;
mod targets;

pub use difference::{
    Difference, DifferenceError, Largest, NoiseOf, Picture, TRIM, difference, pixel_errors,
};
pub use false_colour::{NO_NUMBER, false_colour};
pub use fit::{Fit, log_log};
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use rounds::{Ended, Goal, Rounds, render_rounds};
pub use study::{Curve, End, LEVEL, Ladder, Point, Rung, Study, study};
pub use targets::{Estimate, Method, Problem, Target};
