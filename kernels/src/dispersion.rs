//! Dispersion: the index of refraction at a wavelength, and what a single wavelength stands for in
//! red, green and blue.
//!
//! * Index: Cauchy's `n = a + b / lambda^2 + c / lambda^4`, from the index at the d line and Abbe's
//!   number `V = (n_d - 1) / (n_F - n_C)`, or from glTF's `dispersion = 20 / V`, with `c = 0`; or from
//!   Sellmeier's formula, which it follows from [`SHORTEST`] to [`LONGEST`].
//! * A path in RGB that meets a dispersive surface goes on with one wavelength, drawn with pdf
//!   `p(lambda)` over 380 to 730 nm. Its throughput is multiplied with `w(lambda) / p(lambda)`, where
//!   `w` are the matching functions of the sRGB primaries, each scaled to integral 1: so every channel
//!   sees its own mean over wavelengths, and what does not depend on them stays as it is. From there
//!   on the path keeps its wavelength, and is not weighed again.
//! * Matching functions: CIE 1931 in the fit of C. Wyman, P. Sloan, P. Shirley, "Simple Analytic
//!   Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013 (equation 4), by
//!   IEC 61966-2-1's matrix. They are negative in part: sRGB does not hold pure wavelengths. Means do.
//! * `p` is nearly proportional to `|w_r| + |w_g| + |w_b|`, with a floor: its inverse distribution
//!   function is linear between 129 wavelengths, and `p` is the reciprocal of that function's slope,
//!   exactly. No weight is above 5; the mean of their sizes is 1.42, and not 1, because of what is
//!   negative.
//!
//! Wavelengths are in nanometres.

use crate::lanes::{Fx, Ux, gather, to_f32, to_u32};
use crate::vec3::Vec3x;
use std::sync::LazyLock;

/// The shortest wavelength.
pub const SHORTEST: f32 = 380.0;
/// The longest wavelength.
pub const LONGEST: f32 = 730.0;

/// Fraunhofer's lines d, F and C.
const LINES: [f64; 3] = [587.56, 486.13, 656.27];

/// Cauchy's coefficients of a glass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cauchy {
    /// The index at infinite wavelength.
    pub a: f32,
    /// In square nanometres.
    pub b: f32,
    /// In nanometres to the fourth.
    pub c: f32,
}

impl Cauchy {
    /// From the index `n_d > 0` at 587.56 nm and Abbe's number `v > 0` (25 to 85 for real glasses; the
    /// smaller, the more dispersive). An infinite `v` does not disperse.
    #[must_use]
    pub fn from_abbe(n_d: f64, v: f64) -> Self {
        let [d, f, c] = LINES.map(|line| 1.0 / (line * line));
        let b = (n_d - 1.0) / (v * (f - c));
        Self {
            a: (n_d - b * d) as f32,
            b: b as f32,
            c: 0.0,
        }
    }

    /// The formula that has the index `n(lambda)` at three wavelengths, of which the inverse squares are
    /// Chebyshev's nodes over the spectrum: what it is off by in between is nearly as little as any of
    /// three terms can be.
    #[must_use]
    pub fn through(n: impl Fn(f64) -> f64) -> Self {
        let [low, high] = [LONGEST, SHORTEST].map(|l| f64::from(l).powi(-2));
        let outer = 0.75f64.sqrt();
        let node = |at: f64| 0.5 * ((low + high) + (high - low) * at);
        let [x0, x1, x2] = [-outer, 0.0, outer].map(node);
        let [n0, n1, n2] = [x0, x1, x2].map(|x| n(x.sqrt().recip()));
        // Newton's divided differences.
        let first = (n1 - n0) / (x1 - x0);
        let second = ((n2 - n1) / (x2 - x1) - first) / (x2 - x0);
        Self {
            a: (n0 - x0 * first + x0 * x1 * second) as f32,
            b: (first - (x0 + x1) * second) as f32,
            c: second as f32,
        }
    }

    /// The index at a wavelength, in f64.
    #[must_use]
    pub fn at(&self, nanometres: f64) -> f64 {
        let [a, b, c] = [self.a, self.b, self.c].map(f64::from);
        let x = nanometres.powi(-2);
        a + x * (b + x * c)
    }
}

/// `a + b / lambda^2 + c / lambda^4`, a glass a lane.
#[inline(always)]
#[must_use]
pub fn index_at([a, b, c]: [Fx; 3], wavelength: Fx) -> Fx {
    let inverse = Fx::ONE / wavelength;
    let x = inverse * inverse;
    // The third term is tiny in nanometres: first what it adds to the second.
    c.mul_add(x, b).mul_add(x, a)
}

/// A wavelength that was drawn.
#[derive(Clone, Copy, Debug)]
pub struct Wavelength {
    /// In `[SHORTEST, LONGEST]`.
    pub nanometres: Fx,
    /// `w(lambda) / p(lambda)`, red, green and blue; may be negative.
    pub weight: Vec3x,
}

/// Intervals of the inverse distribution function.
const STEPS: usize = 128;

/// The part of the mean of `p` that is spread evenly over all wavelengths: what bounds the weights in
/// the tails, where a piece of the function covers much of a steep slope.
const FLOOR: f64 = 0.25;

/// What drawing wavelengths takes; built at the first call, about a millisecond.
#[derive(Debug)]
pub struct Spectrum {
    /// Wavelengths at which the distribution function is `k / STEPS`.
    nodes: [f32; STEPS + 1],
    /// From XYZ to red, green and blue, each scaled to integral 1.
    to_rgb: [[f32; 3]; 3],
}

static SPECTRUM: LazyLock<Spectrum> = LazyLock::new(Spectrum::build);

/// IEC 61966-2-1: XYZ to linear sRGB.
const TO_RGB: [[f64; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];

/// A Gaussian with a width on either side of its mean.
#[inline(always)]
fn lobe(nanometres: Fx, scale: f32, mean: f32, below: f32, above: f32) -> Fx {
    let away = nanometres - Fx::splat(mean);
    let width = away
        .simd_lt(Fx::ZERO)
        .select(Fx::splat(below), Fx::splat(above));
    let t = away * width;
    (t * t * Fx::splat(-0.5)).exp() * Fx::splat(scale)
}

/// CIE 1931 at a wavelength.
#[inline(always)]
#[must_use]
pub fn xyz(nanometres: Fx) -> Vec3x {
    let at = |scale, mean, below, above| lobe(nanometres, scale, mean, below, above);
    Vec3x::new(
        at(1.056, 599.8, 0.0264, 0.0323) + at(0.362, 442.0, 0.0624, 0.0374)
            - at(0.065, 501.1, 0.0490, 0.0382),
        at(0.821, 568.8, 0.0213, 0.0247) + at(0.286, 530.9, 0.0613, 0.0322),
        at(1.217, 437.0, 0.0845, 0.0278) + at(0.681, 459.0, 0.0385, 0.0725),
    )
}

#[inline(always)]
fn matching(to_rgb: &[[f32; 3]; 3], nanometres: Fx) -> Vec3x {
    let xyz = xyz(nanometres);
    let row = |c: usize| xyz.dot(Vec3x::splat(to_rgb[c]));
    Vec3x::new(row(0), row(1), row(2))
}

impl Spectrum {
    /// The table; built at the first call.
    #[must_use]
    pub fn table() -> &'static Self {
        &SPECTRUM
    }

    /// A wavelength from `u` in `[0, 1 - 2^-24]`.
    #[inline(always)]
    #[must_use]
    pub fn sample(&self, u: Fx) -> Wavelength {
        let at = u * Fx::splat(STEPS as f32);
        let low = to_u32(at).min(Ux::splat(STEPS as u32 - 1));
        let from = gather(&self.nodes, low);
        let length = gather(&self.nodes, low + Ux::ONE) - from;
        let nanometres = (at - to_f32(low)).mul_add(length, from);
        // 1 / p is the slope.
        let over = length * Fx::splat(STEPS as f32);
        Wavelength {
            nanometres,
            weight: self.matching(nanometres) * over,
        }
    }

    /// `w(lambda)`: the matching functions of sRGB's primaries, each of integral 1 over the range, per
    /// nanometre.
    #[inline(always)]
    #[must_use]
    pub fn matching(&self, nanometres: Fx) -> Vec3x {
        matching(&self.to_rgb, nanometres)
    }

    fn build() -> Self {
        /// Points a nanometre.
        const FINE: usize = 8;
        let range = f64::from(LONGEST - SHORTEST);
        let points = range as usize * FINE;
        let at = |point: usize| f64::from(SHORTEST) + (point as f64 + 0.5) / FINE as f64;
        let mut table = Self {
            nodes: [LONGEST; STEPS + 1],
            to_rgb: TO_RGB.map(|row| row.map(|m| m as f32)),
        };
        let mut integrals = [0.0; 3];
        for point in 0..points {
            let w = matching(&table.to_rgb, Fx::splat(at(point) as f32)).lane(0);
            for (sum, w) in integrals.iter_mut().zip(w) {
                *sum += f64::from(w) / FINE as f64;
            }
        }
        for (row, integral) in table.to_rgb.iter_mut().zip(integrals) {
            *row = row.map(|m| (f64::from(m) / integral) as f32);
        }
        let scaled = table.to_rgb;
        let size = |point: usize| -> f64 {
            let w = matching(&scaled, Fx::splat(at(point) as f32)).lane(0);
            w.iter().map(|&w| f64::from(w.abs())).sum()
        };
        let plain: f64 = (0..points).map(size).sum();
        let floor = FLOOR * plain / points as f64;
        let total = plain * (1.0 + FLOOR);
        let (mut sum, mut node) = (0.0, 1);
        table.nodes[0] = SHORTEST;
        for point in 0..points {
            sum += size(point) + floor;
            while node < STEPS && sum >= total * node as f64 / STEPS as f64 {
                table.nodes[node] = at(point) as f32;
                node += 1;
            }
        }
        table
    }
}
