//! What every family has to pass.

use crate::common::{CORNERS, SIGNIFICANCE, Source, Suite};
use crate::twin;
use huygens_kernels::bsdf::{Bsdf, DELTA_PDF};
use huygens_kernels::lanes::{Fx, LANES};
use huygens_kernels::vec3::Vec3x;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::f64::consts::TAU;

/// Half a unit in the last place of 1: one rounding.
pub(crate) const ROUNDING: f64 = 1.0 / 16_777_216.0;

/// Cosines of `o`: grazing, between, and straight down.
pub(crate) const COSINES: [f64; 6] = [1e-3, 0.05, 0.3, 0.6, 0.9, 1.0];

/// The unit vector with that cosine to z and that azimuth.
pub(crate) fn direction(cos: f64, azimuth: f64) -> [f64; 3] {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    [sin * azimuth.cos(), sin * azimuth.sin(), cos]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn splat(v: [f64; 3]) -> Vec3x {
    Vec3x::splat(v.map(|c| c as f32))
}

/// `LANES` directions, one a lane.
pub(crate) fn lanes_of(directions: [[f64; 3]; LANES]) -> Vec3x {
    let column = |c: usize| Fx::new(std::array::from_fn(|l| directions[l][c] as f32));
    Vec3x::new(column(0), column(1), column(2))
}

/// A map of directions onto the unit square, on which cells are laid.
#[derive(Clone, Copy)]
pub(crate) enum Map {
    /// Cells of equal area on the sphere; the horizon is the boundary of two rings.
    Even,
    /// By the facet that sends light there from `o`: `r / (1 + r)` for its slope over its width, and
    /// the azimuth, so that cells are as narrow as the lobe, and the density of visible normals stays
    /// finite at large slopes. `eta` is that of a refraction, 0 for a reflection.
    Facets {
        o: [f64; 3],
        alpha: [f64; 2],
        eta: f64,
    },
}

impl Map {
    /// By reflecting facets.
    pub(crate) fn reflecting(o: [f64; 3], alpha: [f32; 2]) -> Self {
        let alpha = alpha.map(f64::from);
        Self::Facets { o, alpha, eta: 0.0 }
    }

    fn map(self, w: [f64; 3]) -> [f64; 2] {
        let [q, y, x] = match self {
            Self::Even => [0.5 * (1.0 - w[2]), w[1], w[0]],
            Self::Facets { o, alpha, eta } => {
                let i = if eta == 0.0 { w } else { w.map(|c| c * eta) };
                let h: [f64; 3] = std::array::from_fn(|c| o[c] + i[c]);
                let [x, y] = [0, 1].map(|c| h[c] / (h[2] * alpha[c]));
                let r = x.hypot(y);
                [1.0 - 1.0 / (1.0 + r), y, x]
            }
        };
        [q, (y.atan2(x) / TAU).rem_euclid(1.0)]
    }

    /// The direction of a point of the square, and the solid angle of a unit of its area there; none
    /// where no facet sends light that way.
    fn unmap(self, [q, turn]: [f64; 2]) -> Option<([f64; 3], f64)> {
        let (y, x) = (turn * TAU).sin_cos();
        match self {
            Self::Even => {
                let cos = 1.0 - 2.0 * q;
                let sin = 2.0 * (q * (1.0 - q)).sqrt();
                Some(([sin * x, sin * y, cos], 2.0 * TAU))
            }
            Self::Facets { o, alpha, eta } => {
                let r = q / (1.0 - q);
                let m = twin::normalized([r * x * alpha[0], r * y * alpha[1], 1.0]);
                let cos = dot(o, m);
                let i = if eta == 0.0 {
                    Some(twin::mirrored(o, m))
                } else {
                    twin::refracted(o, m, eta)
                };
                let i = i.filter(|_| cos > 0.0)?;
                // With s = r^2 / (1 + r^2), D m.z d omega_m is ds dphi / 2 pi; and Walter (2007),
                // equations 14 and 17.
                let ds = 2.0 * r * ((1.0 + r) / (1.0 + r * r)).powi(2);
                let facet = ds / (twin::density(m, alpha) * m[2]);
                let spread = if eta == 0.0 {
                    4.0 * cos
                } else {
                    let far = dot(i, m);
                    (cos + eta * far).powi(2) / (eta * eta * far.abs())
                };
                Some((i, facet * spread))
            }
        }
    }
}

const RINGS: usize = 16;
const SECTORS: usize = 12;
/// Points along each side of a cell at which the pdf is taken.
const FINE: usize = 24;

/// Draws from `bsdf` and tests counts of cells against its pdf: one map for reflected directions,
/// one for transmitted, and one count for draws that are not valid, which is what the pdf lacks to
/// integrate to 1.
pub(crate) fn chi_square(
    suite: &mut Suite,
    name: &str,
    bsdf: &impl Bsdf,
    o: [f64; 3],
    maps: [Map; 2],
) {
    const DRAWS: usize = 1 << 17;
    const CELLS: usize = RINGS * SECTORS;
    let mut source = Source(17);
    let mut observed = vec![0u64; 2 * CELLS + 1];
    for _ in 0..DRAWS / LANES {
        let u = std::array::from_fn(|_| source.unit_lanes());
        let drawn = bsdf.sample(splat(o), u);
        for lane in 0..LANES {
            if drawn.pdf.as_array()[lane] == 0.0 {
                observed[2 * CELLS] += 1;
                continue;
            }
            let w = drawn.direction.lane(lane).map(f64::from);
            let side = usize::from(w[2] < 0.0);
            let [q, turn] = maps[side].map(w);
            let ring = ((q * RINGS as f64) as usize).min(RINGS - 1);
            let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
            observed[side * CELLS + ring * SECTORS + sector] += 1;
        }
    }
    let mut expected: Vec<f64> = (0..2 * CELLS)
        .map(|cell| {
            let (side, ring, sector) = (cell / CELLS, cell % CELLS / SECTORS, cell % SECTORS);
            let corner = [ring as f64 / RINGS as f64, sector as f64 / SECTORS as f64];
            let extent = [1.0 / RINGS as f64, 1.0 / SECTORS as f64];
            DRAWS as f64 * cell_probability(bsdf, o, maps[side], side, corner, extent)
        })
        .collect();
    let valid: f64 = expected.iter().sum();
    // The quadrature's own error where the horizon cuts cells; a pdf that integrates to more than 1
    // fails here.
    assert!(
        valid < (1.0 + 1e-3) * DRAWS as f64,
        "{name}: pdf integrates to {}",
        valid / DRAWS as f64
    );
    // Few invalid draws are of the order of the quadrature's error: they are counted with the fullest
    // cell, many for themselves.
    let invalid = DRAWS as f64 - valid;
    let missed = observed.pop().expect("the last cell");
    if invalid.max(missed as f64) > 1e-2 * DRAWS as f64 {
        observed.push(missed);
        expected.push(invalid);
    } else {
        let fullest = (0..expected.len())
            .max_by(|&a, &b| expected[a].total_cmp(&expected[b]))
            .expect("cells");
        observed[fullest] += missed;
        expected[fullest] += invalid;
    }
    // Where the horizon cuts a corner off a cell, the quadrature may miss it and expect nothing; what
    // falls there is counted with the other small cells. A side of the surface that is never
    // expected stays one where nothing may fall.
    for side in 0..2 {
        let cells = side * CELLS..(side + 1) * CELLS;
        if expected[cells.clone()].iter().any(|&e| e > 0.0) {
            for e in &mut expected[cells] {
                *e = e.max(f64::MIN_POSITIVE);
            }
        }
    }
    suite.test(name, &observed, &expected);
}

/// Integral of the pdf over a cell of the map, on one side of the surface; midpoint rule.
fn cell_probability(
    bsdf: &impl Bsdf,
    o: [f64; 3],
    map: Map,
    side: usize,
    corner: [f64; 2],
    extent: [f64; 2],
) -> f64 {
    let part = 1.0 / FINE as f64;
    let mut sum = 0.0;
    for row in 0..FINE {
        for first in (0..FINE).step_by(LANES) {
            let points: [Option<([f64; 3], f64)>; LANES] = std::array::from_fn(|lane| {
                map.unmap([
                    corner[0] + extent[0] * part * (row as f64 + 0.5),
                    corner[1] + extent[1] * part * ((first + lane) as f64 + 0.5),
                ])
            });
            let directions = points.map(|p| p.map_or([0.0, 0.0, 1.0], |p| p.0));
            let pdf = bsdf.evaluate(splat(o), lanes_of(directions)).pdf;
            for lane in 0..LANES {
                if let Some((w, density)) = points[lane]
                    && usize::from(w[2] < 0.0) == side
                {
                    sum += f64::from(pdf.as_array()[lane]) * density;
                }
            }
        }
    }
    sum * part * part * extent[0] * extent[1]
}

/// What a white furnace shows of a BSDF from one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Albedo {
    /// Mean of weight, the largest and the smallest of the three channels; what is transmitted
    /// counted `eta^2` times.
    pub(crate) most: f64,
    pub(crate) least: f64,
    /// Half the width of the confidence interval of either.
    pub(crate) half: f64,
}

/// Puts the surface in a furnace in equilibrium: radiance 1 on the side of `o`, `eta^2` on the other
/// side. Randomised quasi-Monte Carlo: 16 shifts of a rank-1 rule (Roberts' generalised golden
/// ratio), Student's t over the 16, corrected for `comparisons` tests.
pub(crate) fn furnace(bsdf: &impl Bsdf, o: [f64; 3], eta: f64, comparisons: usize) -> Albedo {
    const SHIFTS: usize = 16;
    const POINTS: usize = 1 << 12;
    const GOLDEN: f64 = 1.220_744_084_605_759_6;
    let mut source = Source(29);
    let step: [f64; 3] = std::array::from_fn(|k| GOLDEN.powi(-(k as i32 + 1)));
    let means: [[f64; 3]; SHIFTS] = std::array::from_fn(|_| {
        let shift: [f64; 3] = std::array::from_fn(|_| f64::from(source.unit()));
        let mut sum = [0.0; 3];
        for first in (0..POINTS).step_by(LANES) {
            let u = std::array::from_fn(|k| {
                Fx::new(std::array::from_fn(|lane| {
                    let at = (shift[k] + step[k] * (first + lane) as f64).fract();
                    ((at * 16_777_216.0).floor() / 16_777_216.0) as f32
                }))
            });
            let drawn = bsdf.sample(splat(o), u);
            for lane in 0..LANES {
                let transmitted = drawn.direction.z.as_array()[lane] < 0.0;
                let radiance = if transmitted { eta * eta } else { 1.0 };
                for c in 0..3 {
                    sum[c] += radiance * f64::from(drawn.weight.lane(lane)[c]);
                }
            }
        }
        sum.map(|s| s / POINTS as f64)
    });
    let n = SHIFTS as f64;
    let mut all = [(0.0, 0.0); 3];
    for (c, (mean, deviation)) in all.iter_mut().enumerate() {
        *mean = means.iter().map(|m| m[c]).sum::<f64>() / n;
        let square = |m: &[f64; 3]| (m[c] - *mean).powi(2);
        *deviation = (means.iter().map(square).sum::<f64>() / (n - 1.0)).sqrt();
    }
    let student = StudentsT::new(0.0, 1.0, n - 1.0).expect("positive parameters");
    let quantile = student.inverse_cdf(1.0 - 0.5 * SIGNIFICANCE / comparisons as f64);
    let deviation = all.iter().map(|a| a.1).fold(0.0, f64::max);
    Albedo {
        most: all.iter().map(|a| a.0).fold(f64::MIN, f64::max),
        least: all.iter().map(|a| a.0).fold(f64::MAX, f64::min),
        // A weight is a handful of roundings of its own.
        half: quantile * deviation / n.sqrt() + 16.0 * ROUNDING,
    }
}

/// Every corner of the unit cube, and points near them: finite numbers in every lane; where valid a
/// unit direction, a positive pdf and a weight that is not negative.
pub(crate) fn corners(name: &str, bsdf: &impl Bsdf, o: [f64; 3]) {
    for v in CORNERS {
        for w in CORNERS {
            let drawn = bsdf.sample(splat(o), [Fx::new(CORNERS), Fx::splat(v), Fx::splat(w)]);
            for lane in 0..LANES {
                let at = format!(
                    "{name} from {o:?} at ({}, {v}, {w}): {drawn:?}",
                    CORNERS[lane]
                );
                let i = drawn.direction.lane(lane).map(f64::from);
                let weight = drawn.weight.lane(lane);
                let pdf = drawn.pdf.as_array()[lane];
                let valid = drawn.valid.to_bitmask() >> lane & 1 == 1;
                assert!(i.iter().all(|c| c.is_finite()), "{at}");
                assert!(weight.iter().all(|c| c.is_finite() && *c >= 0.0), "{at}");
                if valid {
                    assert!(pdf == DELTA_PDF || (pdf.is_finite() && pdf > 0.0), "{at}");
                    // A sum of three squares of components that are each a few roundings off.
                    assert!((dot(i, i) - 1.0).abs() < 32.0 * ROUNDING, "{at}");
                    assert!(i[2] != 0.0, "{at}");
                } else {
                    assert!(pdf == 0.0 && weight == [0.0; 3], "{at}");
                }
            }
        }
    }
}

/// What `sample` says of its draws, `evaluate` says too: pdf, and weight times pdf, within
/// `bound(o, i)` relatively.
pub(crate) fn consistent(
    name: &str,
    bsdf: &impl Bsdf,
    o: [f64; 3],
    bound: impl Fn([f64; 3], [f64; 3]) -> f64,
) {
    let mut source = Source(31);
    for _ in 0..256 {
        let drawn = bsdf.sample(splat(o), std::array::from_fn(|_| source.unit_lanes()));
        let again = bsdf.evaluate(splat(o), drawn.direction);
        for lane in 0..LANES {
            let pdf = drawn.pdf.as_array()[lane];
            if pdf == 0.0 || pdf == DELTA_PDF {
                continue;
            }
            let i = drawn.direction.lane(lane).map(f64::from);
            let bound = bound(o, i);
            let pairs = (0..3).map(|c| {
                let value = f64::from(drawn.weight.lane(lane)[c]) * f64::from(pdf);
                (value, f64::from(again.value.lane(lane)[c]))
            });
            let pdfs = (f64::from(pdf), f64::from(again.pdf.as_array()[lane]));
            for (sampled, evaluated) in pairs.chain([pdfs]) {
                let off = (sampled - evaluated).abs();
                assert!(
                    off <= bound * sampled.max(evaluated),
                    "{name}: {sampled} drawn, {evaluated} evaluated from {o:?} to {i:?}, {bound:e}"
                );
            }
        }
    }
}

/// A direction with components in f32's own numbers, so that f32 and f64 see the same one.
pub(crate) fn rounded(w: [f64; 3]) -> [f64; 3] {
    w.map(|c| f64::from(c as f32))
}

/// Asserts that lane 0 and the twin agree within `bound`, relatively.
pub(crate) fn assert_close(name: &str, lane: f64, twin: f64, bound: f64) {
    assert!(
        (lane - twin).abs() <= bound * twin.abs().max(f64::from(f32::MIN_POSITIVE)),
        "{name}: {lane:e} for {twin:e}, off by {:e} where {bound:e} may be",
        (lane / twin - 1.0).abs()
    );
}
