//! Statistics of Monte Carlo estimates: running moments, confidence intervals, and the levels of
//! significance to hold them against.

mod normal;
mod running;

pub use normal::{normal_quantile, sidak};
pub use running::Running;
