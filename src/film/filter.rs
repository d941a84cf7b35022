//! Tables of the pixel filters for `huygens_kernels::filter::sample`.
//!
//! The table reaches pixels, so it must be the same on every machine: it is made in f64 of
//! additions, multiplications, divisions and square roots alone, which IEEE 754 rounds alike
//! everywhere and which Rust neither fuses nor reorders. The transcendental functions in it are
//! Taylor series of our own.

use crate::scene::Filter;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Intervals of a table.
pub const INTERVALS: usize = 1024;

/// The inverse distribution of `filter` over the square root of the tail, `INTERVALS + 1` knots
/// from the radius down to 0; the head of `huygens_kernels::filter` gives the definition.
///
/// Knots are the true values rounded to f32, so the mass between any two of them is the filter's.
/// Within a cell, linear interpolation in the root `w` is off by at most `h^2 / 8 max |x''|` pixels
/// (tested), `h = 1 / INTERVALS` and, for a density `p`, `x'' = -1 / p - w^2 p' / p^3`: 1.2e-7 for
/// the box, nothing for the tent, 1.4e-5 for the Gaussian. For Blackman-Harris it is 2.4e-3 in the
/// outermost cell, which holds a millionth of the mass, and falls quickly from there.
#[must_use]
pub fn table(filter: Filter) -> Vec<f32> {
    (0..=INTERVALS)
        .map(|k| position(filter, k as f64 / INTERVALS as f64) as f32)
        .collect()
}

/// The same, made once in the life of the process: it takes tens of milliseconds, and a study makes
/// hundreds of renders.
#[must_use]
pub fn shared_table(filter: Filter) -> &'static [f32] {
    static TABLES: [OnceLock<Vec<f32>>; 4] = [const { OnceLock::new() }; 4];
    TABLES[filter as usize].get_or_init(|| table(filter))
}

/// Half the filter's width, in pixels.
#[must_use]
pub fn radius(filter: Filter) -> f64 {
    match filter {
        Filter::Box => 0.5,
        Filter::Tent => 1.0,
        Filter::Gaussian => 1.5,
        Filter::BlackmanHarris => 1.65,
    }
}

/// The `x >= 0` beyond which, on both sides together, lies `root * root` of the filter's mass.
fn position(filter: Filter, root: f64) -> f64 {
    match filter {
        // In closed form, so that the box is an identity but for the table's interpolation.
        Filter::Box => 0.5 * (1.0 - root * root),
        Filter::Tent => 1.0 - root,
        Filter::Gaussian | Filter::BlackmanHarris => bisect(radius(filter), |x| {
            mass_within(filter, x) < 1.0 - root * root
        }),
    }
}

/// The share of the filter's mass in `-x ..= x`, for `0 <= x <= radius`.
fn mass_within(filter: Filter, x: f64) -> f64 {
    let r = radius(filter);
    match filter {
        Filter::Box => x / r,
        Filter::Tent => x * (2.0 - x),
        Filter::Gaussian => {
            // Standard deviation 1/2: exp(-2 x^2).
            let half = |x: f64| integral_of_gaussian(x * 2.0f64.sqrt());
            half(x) / half(r)
        }
        Filter::BlackmanHarris => blackman_harris_integral(x / r) / blackman_harris_integral(1.0),
    }
}

/// Integral of `exp(-t^2)` over `0..z`, as its Taylor series. For `z` up to 2.13 the terms stay
/// below 30, so what is lost to cancellation is below 1e-14.
fn integral_of_gaussian(z: f64) -> f64 {
    let mut power = z;
    let mut sum = z;
    for n in 1..64 {
        power *= -(z * z) / f64::from(n);
        sum += power / f64::from(2 * n + 1);
    }
    sum
}

/// Integral over `0..y` of the four-term Blackman-Harris window on `-1..1`: F. J. Harris, "On the
/// Use of Windows for Harmonic Analysis with the Discrete Fourier Transform", Proc. IEEE 66(1),
/// 1978, with 92 dB coefficients. Centred, so the cosines of odd order change their sign.
fn blackman_harris_integral(y: f64) -> f64 {
    // Sine and cosine of pi y, from the half turn nearer by: both series see at most pi / 2.
    let sin = sine(PI * y.min(1.0 - y));
    let cos = sine(PI * (0.5 - y));
    let sin2 = 2.0 * sin * cos;
    let sin3 = sin * (3.0 - 4.0 * sin * sin);
    0.35875 * y + 0.48829 / PI * sin + 0.14128 / (2.0 * PI) * sin2 + 0.01168 / (3.0 * PI) * sin3
}

/// Taylor series of the sine, for `|x| <= pi / 2`: the first term left out is below 1e-20.
fn sine(x: f64) -> f64 {
    let mut term = x;
    let mut sum = x;
    for n in 1..12 {
        let m = f64::from(2 * n);
        term *= -(x * x) / (m * (m + 1.0));
        sum += term;
    }
    sum
}

/// Where in `0..=end` `below` turns from true to false, to the last bit of f64.
fn bisect(end: f64, below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, end);
    if below(high) {
        return high;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests;
