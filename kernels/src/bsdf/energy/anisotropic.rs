//! What facets lose that are wider along one axis: `1 - E(o)` of reflection, and its mean.
//!
//! Four coordinates: the greater width `a` as elsewhere; the root of the lesser over it; the width
//! `w` across which `o` looks, `w^2 = (ax^2 o.x^2 + ay^2 o.y^2) / (o.x^2 + o.y^2)`, as
//! `sqrt((w - least) / (a - least))`; and the cosine, as elsewhere with `w` for alpha.
//!
//! With what the mean is off by between entries, a perfect mirror comes out between 0.9903 and 1.0054
//! (against the same quadrature, on a grid between the entries); `E` is raised by [`MARGIN`], so that a
//! furnace never gains.

use super::{Between, across, alpha_of, coordinate, cosine_at};
use crate::bsdf::ggx::{ALPHA_FLOOR, Ggx, reflect};
use crate::lanes::{Fx, LANES, Ux, gather, iota, to_f32};
use crate::vec3::Vec3x;
use std::sync::LazyLock;

/// Entries along the cosine.
const COSINES: usize = 16;
/// Entries along the width that `o` looks across.
const TURNS: usize = 6;
/// Entries along the ratio of the widths.
const RATIOS: usize = 8;
/// Entries along the greater width.
const WIDTHS: usize = 16;
/// Entries of a pair of widths.
const PAIR: usize = COSINES * TURNS;
/// Points along each side of the unit square for an entry.
const FINE: usize = 24;
/// What `E` is raised by: no less than what interpolation and quadrature may lack.
const MARGIN: f64 = 6e-3;

/// What anisotropic facets lose.
#[derive(Debug)]
pub struct AnisotropicEnergy {
    lost: [f32; WIDTHS * RATIOS * PAIR],
    mean_lost: [f32; WIDTHS * RATIOS],
}

static ANISOTROPIC: LazyLock<AnisotropicEnergy> = LazyLock::new(AnisotropicEnergy::build);

/// Where a pair of widths lies in the table.
struct Pair {
    width: Between,
    ratio: Between,
}

impl Pair {
    #[inline(always)]
    fn new(most: Fx, least: Fx) -> Self {
        Self {
            width: Between::new(across(most), WIDTHS),
            ratio: Between::new((least / most).sqrt(), RATIOS),
        }
    }

    /// Of the four pairs around, each as `take` has it from its number.
    #[inline(always)]
    fn mix(&self, take: impl Fn(Ux) -> Fx) -> Fx {
        let first = self.width.low * Ux::splat(RATIOS as u32) + self.ratio.low;
        let at = |offset: usize| take(first + Ux::splat(offset as u32));
        self.width.mix(
            self.ratio.mix(at(0), at(1)),
            self.ratio.mix(at(RATIOS), at(RATIOS + 1)),
        )
    }
}

impl AnisotropicEnergy {
    /// The table; built at the first call.
    #[must_use]
    pub fn table() -> &'static Self {
        &ANISOTROPIC
    }

    /// `1 - E(w)` for facets of widths `alpha`.
    #[inline(always)]
    #[must_use]
    pub fn lost(&self, w: Vec3x, alpha: [Fx; 2]) -> Fx {
        let (x, y) = (w.x * alpha[0], w.y * alpha[1]);
        let flat = w.x.mul_add(w.x, w.y * w.y);
        let [most, least] = [alpha[0].fast_max(alpha[1]), alpha[0].fast_min(alpha[1])];
        // Straight down there is no azimuth, and E does not depend on it.
        let seen = (x.mul_add(x, y * y) / flat).sqrt();
        let seen = flat
            .simd_gt(Fx::splat(f32::MIN_POSITIVE))
            .select(seen, most);
        let seen = seen.fast_clamp(least, most);
        let span = (seen - least) / (most - least);
        let span = most.simd_gt(least).select(span, Fx::ONE);
        let turn = Between::new(span.sqrt(), TURNS);
        let cos = Between::new(coordinate(w.z, seen), COSINES);
        let inner = turn.low * Ux::splat(COSINES as u32) + cos.low;
        let lost = Pair::new(most, least).mix(|pair| {
            let first = pair * Ux::splat(PAIR as u32) + inner;
            let take = |offset: usize| gather(&self.lost, first + Ux::splat(offset as u32));
            turn.mix(
                cos.mix(take(0), take(1)),
                cos.mix(take(COSINES), take(COSINES + 1)),
            )
        });
        lost.fast_clamp(Fx::ZERO, Fx::ONE)
    }

    /// `1 - E_avg`.
    #[inline(always)]
    #[must_use]
    pub fn mean_lost(&self, alpha: [Fx; 2]) -> Fx {
        let [most, least] = [alpha[0].fast_max(alpha[1]), alpha[0].fast_min(alpha[1])];
        Pair::new(most, least).mix(|pair| gather(&self.mean_lost, pair))
    }

    fn build() -> Self {
        let mut table = Self {
            lost: [0.0; WIDTHS * RATIOS * PAIR],
            mean_lost: [0.0; WIDTHS * RATIOS],
        };
        for pair in 0..WIDTHS * RATIOS {
            let [most, least] = widths(pair);
            for entry in 0..PAIR {
                let t = (entry % COSINES) as f64 / (COSINES - 1) as f64;
                let span = (entry / COSINES) as f64 / (TURNS - 1) as f64;
                let seen = least + (most - least) * span * span;
                let cos = cosine_at(t, seen).max(1e-7);
                // seen^2 = most^2 cos^2 + least^2 sin^2 of the azimuth.
                let square = most * most - least * least;
                let azimuth = if square > 0.0 {
                    ((seen * seen - least * least) / square).clamp(0.0, 1.0)
                } else {
                    1.0
                };
                let kept = reflected([most, least], cos, azimuth);
                table.lost[pair * PAIR + entry] = (1.0 - kept - MARGIN) as f32;
            }
        }
        for pair in 0..WIDTHS * RATIOS {
            table.mean_lost[pair] = table.mean_of(widths(pair)) as f32;
        }
        table
    }

    /// The mean of the interpolated function, weighed by the cosine, over a quarter of the hemisphere:
    /// by the midpoint rule in the root of the cosine and in the azimuth.
    fn mean_of(&self, alpha: [f64; 2]) -> f64 {
        const STEPS: usize = 64;
        let alpha = alpha.map(|a| Fx::splat(a as f32));
        let mut sum = 0.0;
        for turn in 0..STEPS {
            let angle = std::f64::consts::FRAC_PI_2 * (turn as f64 + 0.5) / STEPS as f64;
            let (y, x) = (angle.sin() as f32, angle.cos() as f32);
            for first in (0..STEPS).step_by(LANES) {
                let root = (to_f32(iota(first as u32)) + Fx::splat(0.5)) / Fx::splat(STEPS as f32);
                let z = root * root;
                let r = ((Fx::ONE - z) * (Fx::ONE + z)).sqrt();
                let w = Vec3x::new(r * Fx::splat(x), r * Fx::splat(y), z);
                let part = self.lost(w, alpha) * z * root * Fx::splat(4.0);
                sum += f64::from(part.reduce_add());
            }
        }
        sum / (STEPS * STEPS) as f64
    }
}

/// Greater and lesser width of a pair.
fn widths(pair: usize) -> [f64; 2] {
    let most = alpha_of(pair / RATIOS, WIDTHS);
    let ratio = ((pair % RATIOS) as f64 / (RATIOS - 1) as f64).powi(2);
    [most, (most * ratio).max(f64::from(ALPHA_FLOOR))]
}

/// `E` for light from a cosine and an azimuth, given as the square of its cosine.
fn reflected(alpha: [f64; 2], cos: f64, azimuth: f64) -> f64 {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    let (x, y) = (sin * azimuth.sqrt(), sin * (1.0 - azimuth).sqrt());
    let o = Vec3x::splat([x as f32, y as f32, cos as f32]);
    let facets = Ggx {
        alpha: alpha.map(|a| Fx::splat(a as f32)),
    };
    // All around: nothing is even here.
    let half = |shift: f32| {
        super::over_unit_square(FINE, |u, v| {
            let i = reflect(o, facets.sample_normal(o, u + Fx::splat(shift), v));
            i.z.simd_gt(Fx::ZERO) & facets.shadowing(o, i)
        })
    };
    0.5 * (half(0.0) + half(0.5))
}
