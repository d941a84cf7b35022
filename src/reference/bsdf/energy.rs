//! Albedos of single scattering, by quadrature in f64, as functions of the cosine; made at first use.
//!
//! An albedo is the mean of a weight that never exceeds 1 over visible normals, which the midpoint rule
//! takes over the unit square that names them. The weight goes to 0 where directions leave the
//! hemisphere, so that the rule is off by some `1 / POINTS^2`, 2e-4; the curves are as much off
//! between their points. `docs/bsdf.md` says how much farther the kernels' tables may be off.

use super::facets::{Facets, reflect};
use super::fresnel::{fresnel, refract, schlick};
use super::principled::charlie;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// Points along each side of the unit square.
const POINTS: u32 = 64;
/// Points of a curve.
const NODES: usize = 160;
/// Azimuths at which what is not round is looked at, over a quarter turn.
const TURNS: usize = 17;
/// Widths at which curves are there for materials whose roughness varies.
const WIDTHS: usize = 33;

/// A function of the cosine, linear between points that lie evenly in `ln(1 + cos / scale)`: evenly up
/// to `scale`, at equal ratios beyond.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    scale: f64,
    values: Vec<f64>,
}

impl Curve {
    pub(super) fn new(scale: f64, nodes: usize, of: impl Fn(f64) -> f64) -> Self {
        let at = |node: usize| {
            let t = node as f64 / (nodes - 1) as f64;
            let cos = scale * ((t * (1.0 / scale).ln_1p()).exp_m1());
            of(cos.clamp(1e-9, 1.0))
        };
        Self {
            scale,
            values: (0..nodes).map(at).collect(),
        }
    }

    pub(super) fn at(&self, cos: f64) -> f64 {
        let t = (cos.max(0.0) / self.scale).ln_1p() / (1.0 / self.scale).ln_1p();
        let last = self.values.len() - 1;
        let place = t.min(1.0) * last as f64;
        let low = (place as usize).min(last - 1);
        let part = place - low as f64;
        self.values[low] * (1.0 - part) + self.values[low + 1] * part
    }

    /// `2 int f(c) c dc`.
    fn mean(&self) -> f64 {
        const STEPS: u32 = 4096;
        // In the root of the cosine, which puts more points where albedos are steep.
        let part = |i| {
            let root = (f64::from(i) + 0.5) / f64::from(STEPS);
            4.0 * root.powi(3) * self.at(root * root)
        };
        (0..STEPS).map(part).sum::<f64>() / f64::from(STEPS)
    }

    fn largest(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }
}

/// What single scattering off facets loses of the light of each direction, `1 - E(w)`.
#[derive(Clone, Debug)]
pub(super) struct Loss {
    /// By azimuth from the x axis, over a quarter turn; a single one if the facets are round.
    by_turn: Vec<Curve>,
    /// Its mean, weighed by the cosine.
    pub(super) mean: f64,
}

impl Loss {
    pub(super) fn new(facets: Facets) -> Self {
        let [x, y] = facets.alpha;
        let (turns, nodes) = if x == y {
            (1, NODES)
        } else {
            (TURNS, NODES / 2)
        };
        let curve = |turn: usize| {
            let azimuth = 0.5 * PI * turn as f64 / (turns.max(2) - 1) as f64;
            let lost = |cos| 1.0 - mean_visible(facets, direction(cos, azimuth), |_, _| 1.0);
            Curve::new(x.min(y), nodes, lost)
        };
        let by_turn: Vec<Curve> = (0..turns).map(curve).collect();
        // By the trapezoidal rule over azimuths.
        let means = by_turn.iter().map(Curve::mean);
        let ends = by_turn[0].mean() + by_turn[turns - 1].mean();
        let mean = match turns {
            1 => by_turn[0].mean(),
            _ => (means.sum::<f64>() - 0.5 * ends) / (turns - 1) as f64,
        };
        Self { by_turn, mean }
    }

    pub(super) fn of(&self, w: DVec3) -> f64 {
        let last = self.by_turn.len() - 1;
        if last == 0 {
            return self.by_turn[0].at(w.z);
        }
        let place = w.y.abs().atan2(w.x.abs()) / (0.5 * PI) * last as f64;
        let low = (place as usize).min(last - 1);
        let part = place - low as f64;
        let [a, b] = [low, low + 1].map(|turn| self.by_turn[turn].at(w.z));
        a * (1.0 - part) + b * part
    }
}

/// A function of the cosine for each width that a material's roughness may come to.
#[derive(Debug)]
pub(super) struct Ladder<T> {
    /// The only width there is, if its roughness does not vary.
    only: Option<f64>,
    rungs: Vec<OnceLock<T>>,
}

impl<T> Ladder<T> {
    pub(super) fn new(only: Option<f64>) -> Self {
        let rungs = if only.is_some() { 1 } else { WIDTHS };
        Self {
            only,
            rungs: (0..rungs).map(|_| OnceLock::new()).collect(),
        }
    }

    /// The value for width `alpha`: linear in its root between those that `make` gives for the widths of
    /// two rungs.
    pub(super) fn at(&self, alpha: f64, make: impl Fn(f64) -> T, value: impl Fn(&T) -> f64) -> f64 {
        let rung = |i: usize, alpha| value(self.rungs[i].get_or_init(|| make(alpha)));
        if let Some(only) = self.only {
            return rung(0, only);
        }
        let last = WIDTHS - 1;
        let floor = super::FLOOR.sqrt();
        let place = (alpha.sqrt() - floor) / (1.0 - floor) * last as f64;
        let place = place.clamp(0.0, last as f64);
        let low = (place as usize).min(last - 1);
        let part = place - low as f64;
        let width = |i: usize| (floor + (1.0 - floor) * i as f64 / last as f64).powi(2);
        let [a, b] = [low, low + 1].map(|i| rung(i, width(i)));
        a * (1.0 - part) + b * part
    }
}

/// Albedo of facets that reflect everything.
pub(super) fn reflected(alpha: f64) -> Curve {
    mirrored(alpha, |_, _| 1.0)
}

/// Albedo of facets that reflect by Schlick's term alone.
pub(super) fn reflected_by_schlick(alpha: f64) -> Curve {
    mirrored(alpha, |o, m| schlick(o.dot(m)))
}

fn mirrored(alpha: f64, weight: impl Fn(DVec3, DVec3) -> f64) -> Curve {
    let facets = Facets::isotropic(alpha);
    Curve::new(alpha, NODES, |cos| {
        mean_visible(facets, direction(cos, 0.0), &weight)
    })
}

/// What a boundary of relative index `eta` reflects and passes.
pub(super) fn reflected_and_passed(alpha: f64, eta: f64) -> Curve {
    let facets = Facets::isotropic(alpha);
    Curve::new(alpha, NODES, |cos| {
        let o = direction(cos, 0.0);
        over_square(|u, v| {
            let m = facets.visible(o, u, v);
            let r = fresnel(o.dot(m), eta, 0.0);
            let up = reflect(o, m);
            let reflected = if up.z > 0.0 {
                r * facets.shadowing(o, up)
            } else {
                0.0
            };
            let passed = match refract(o, m, eta) {
                Some(i) if i.z < 0.0 => (1.0 - r) * facets.shadowing(o, i),
                _ => 0.0,
            };
            reflected + passed
        })
    })
}

/// Albedo of sheen as published, and what the lobe is multiplied with so that none is above 1.
pub(super) fn sheen(roughness: f64) -> (Curve, f64) {
    // d omega = 2 root d root dphi, root being that of the cosine.
    let albedo = |cos| {
        let o = direction(cos, 0.0);
        let part = |u: f64, v: f64| {
            let i = direction(u * u, TAU * v);
            2.0 * u * charlie(o, i, roughness)
        };
        TAU * over_square(part)
    };
    let curve = Curve::new(0.1, NODES, albedo);
    let scale = 1.0 / curve.largest().max(1.0);
    (curve, scale)
}

/// Mean of `weight(o, m)` times shadowing over normals visible from `o` whose reflection is above.
fn mean_visible(facets: Facets, o: DVec3, weight: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    over_square(|u, v| {
        let m = facets.visible(o, u, v);
        let i = reflect(o, m);
        if i.z > 0.0 {
            weight(o, m) * facets.shadowing(o, i)
        } else {
            0.0
        }
    })
}

fn over_square(of: impl Fn(f64, f64) -> f64) -> f64 {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(POINTS);
    let rows = (0..POINTS).map(|i| (0..POINTS).map(|j| of(at(i), at(j))).sum::<f64>());
    rows.sum::<f64>() / f64::from(POINTS * POINTS)
}

fn direction(cos: f64, azimuth: f64) -> DVec3 {
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
}
