//! Throughput, measured so that it can be compared: the standard scenes, how a run is timed, and what
//! may be said about two sets of runs.
//!
//! Times are processor times, which other work on the machine moves far less than wall-clock times, and
//! each run is flanked by a *yardstick*: a fixed piece of work of the same kind (vector arithmetic,
//! look-ups, branches) that no change of the renderer touches. A run's cost is its time over the
//! yardstick's, so that a machine that is slower today, or busy, is slower in both.

pub mod compare;
mod difference;
pub mod forest;
pub mod measure;
pub mod suite;
mod yardstick;

pub use yardstick::{memory_yardstick, yardstick};
