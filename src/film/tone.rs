//! From linear radiance to what a screen shows: exposure, tone map, sRGB encoding, 8 bits.
//!
//! All of it is IEEE arithmetic in f64 in a fixed order, so a PNG is the same on every machine.

use std::sync::LazyLock;

/// How radiance is brought into the range of a screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ToneMap {
    /// Cut at 1.
    None,
    /// A film's curve: S. Hill's fit of the ACES reference and output transforms (in M. Pettineo and
    /// D. Neubelt's Baking Lab, 2016), with the exposure at which 18% grey stays 18% grey. Bright
    /// colours pale towards white as they do on film.
    Filmic,
}

/// Rec. 709 to the space of the fit, its saturation matrix included; rows sum to 1.
const TO_FIT: [[f64; 3]; 3] = [
    [0.59719, 0.35458, 0.04823],
    [0.07600, 0.90834, 0.01566],
    [0.02840, 0.13383, 0.83777],
];
/// And back.
const FROM_FIT: [[f64; 3]; 3] = [
    [1.60475, -0.53108, -0.07367],
    [-0.10208, 1.10813, -0.00605],
    [-0.00327, -0.07276, 1.07602],
];
/// The fit, `(x^2 + a x - b) / (c x^2 + d x + e)`.
const FIT: [f64; 5] = [
    0.024_578_6,
    0.000_090_537,
    0.983_729,
    0.432_951_0,
    0.238_081,
];
const GREY: f64 = 0.18;

/// What radiance is multiplied by before the fit, so that it maps grey to itself: the positive root
/// of `fit(x) = GREY`, over `GREY`.
static FIT_EXPOSURE: LazyLock<f64> = LazyLock::new(|| {
    let [a, b, c, d, e] = FIT;
    let (p, q, r) = (1.0 - GREY * c, a - GREY * d, -b - GREY * e);
    (-q + (q * q - 4.0 * p * r).sqrt()) / (2.0 * p) / GREY
});

/// The radiance at which the 8-bit code changes from `k` to `k + 1`, for `k` in `0..255`: the
/// radiance of code `k + 1/2`.
static THRESHOLDS: LazyLock<[f64; 255]> =
    LazyLock::new(|| std::array::from_fn(|k| from_srgb((k as f64 + 0.5) / 255.0)));

/// The pixel on screen, sRGB with 8 bits a channel, rounded to the nearest code. `scale` multiplies
/// the radiance first.
#[must_use]
pub fn display(radiance: [f32; 3], scale: f64, tone_map: ToneMap) -> [u8; 3] {
    let linear = radiance.map(|v| f64::from(v) * scale);
    let shown = match tone_map {
        ToneMap::None => linear,
        ToneMap::Filmic => filmic(linear),
    };
    shown.map(|v| THRESHOLDS.partition_point(|&t| t <= v) as u8)
}

/// `2^stops`.
#[must_use]
pub fn stops(stops: f32) -> f64 {
    let whole = stops.floor();
    let x = f64::from(stops - whole) * std::f64::consts::LN_2;
    // Taylor series of e^x on 0..ln 2: the first term left out is below 1e-18.
    let mut sum = 1.0;
    let mut term = 1.0;
    for n in 1..17 {
        term *= x / f64::from(n);
        sum += term;
    }
    let step = if whole < 0.0 { 0.5 } else { 2.0 };
    (0..whole.abs() as u32).fold(sum, |v, _| v * step)
}

/// The tone curve, for linear Rec. 709; the result may leave 0..=1 slightly.
fn filmic(rgb: [f64; 3]) -> [f64; 3] {
    // Radiance beyond 1e9 is white already; squared, the largest f32 must not become infinite.
    let scaled = rgb.map(|v| (v * *FIT_EXPOSURE).clamp(0.0, 1e9));
    multiply(FROM_FIT, multiply(TO_FIT, scaled).map(fit))
}

fn fit(x: f64) -> f64 {
    let [a, b, c, d, e] = FIT;
    (x * (x + a) - b) / (x * (c * x + d) + e)
}

fn multiply(m: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// The sRGB decoding of IEC 61966-2-1, for `0..=1`.
#[must_use]
pub fn from_srgb(code: f64) -> f64 {
    if code <= 0.04045 {
        return code / 12.92;
    }
    // x^2.4 = x^2 * fifth root of x^2.
    let x = (code + 0.055) / 1.055;
    let x2 = x * x;
    x2 * fifth_root(x2)
}

/// By Newton's method from above, where it converges without overshooting; 0 < y <= 1.
fn fifth_root(y: f64) -> f64 {
    let mut root = 1.0;
    loop {
        let r2: f64 = root * root;
        let next = (4.0 * root + y / (r2 * r2)) / 5.0;
        if next >= root {
            return root;
        }
        root = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oetf(v: f64) -> f64 {
        if v <= 0.003_130_8 {
            12.92 * v
        } else {
            1.055 * v.powf(1.0 / 2.4) - 0.055
        }
    }

    #[test]
    fn codes_are_the_srgb_curve_rounded() {
        for i in 0..=100_000u32 {
            let v = i as f32 / 100_000.0;
            let exact = oetf(f64::from(v)) * 255.0;
            // The standard's two branches of the curve do not quite meet: about 1e-7 at their seam.
            if ((exact - exact.floor()) - 0.5).abs() > 1e-6 {
                let code = display([v; 3], 1.0, ToneMap::None)[0];
                assert_eq!(f64::from(code), exact.round(), "at {v}");
            }
        }
    }

    #[test]
    fn codes_round_and_do_not_truncate() {
        // Every code comes back from the middle of its own range.
        for code in 0..=255u8 {
            let v = from_srgb(f64::from(code) / 255.0) as f32;
            assert_eq!(display([v; 3], 1.0, ToneMap::None), [code; 3]);
        }
    }

    #[test]
    fn out_of_range_radiance_is_black_or_white() {
        for tone_map in [ToneMap::None, ToneMap::Filmic] {
            let shown = |v| display([v; 3], 1.0, tone_map);
            assert_eq!(shown(0.0), [0; 3]);
            assert_eq!(shown(-5.0), [0; 3]);
            assert_eq!(shown(f32::MAX), [255; 3]);
            assert_eq!(shown(f32::INFINITY), [255; 3]);
        }
    }

    #[test]
    fn film_keeps_grey_and_rises_towards_white() {
        let grey = filmic([GREY; 3]);
        // The matrices are given to five digits.
        assert!(grey.iter().all(|v| (v - GREY).abs() < 1e-5 * 3.0));
        let curve: Vec<f64> = (0..2000)
            .map(|i| filmic([f64::from(i) * 0.01; 3])[1])
            .collect();
        assert!(curve.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn stops_double() {
        for s in [-8.0f32, -1.5, -1.0, -0.25, 0.0, 0.5, 1.0, 3.75, 20.0] {
            let expected = f64::from(s).exp2();
            // Sixteen terms and a product, each rounded once.
            assert!(
                (stops(s) / expected - 1.0).abs() < 32.0 * f64::EPSILON,
                "{s}"
            );
        }
        assert_eq!(stops(3.0), 8.0);
        assert_eq!(stops(-3.0), 0.125);
    }
}
