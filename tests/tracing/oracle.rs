//! Brute force in f64, with bounds on how far an f32 answer may be from the truth.
//!
//! The test under scrutiny shears each corner, takes three edge functions and a weighted mean of
//! distances. With `u = 2^-24`, a sheared coordinate `(v - o) - s (w - p)` is rounded at most four
//! times, so it is off by at most `4u (|v - o| + |s (w - p)|)`, and by `e (1 + |w - p|)` where the
//! product or `s` itself underflows, `e = 2^-149` being the smallest number. An edge function is
//! a difference of two products of such, each rounded once more. From these come, for each
//! triangle: it is hit for certain, missed for certain, or in doubt; and an interval that holds the
//! distance.

use super::{Hit, RaySet};
use huygens::scene::Mesh;
use huygens_kernels::rays::NO_PRIMITIVE;

const U: f64 = 1.0 / 16_777_216.0;
/// The smallest positive f32.
const E: f64 = 1.401_298_464_324_817e-45;

/// What the truth allows an f32 test to answer for one triangle.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// Some answer within the rounding is a hit.
    pub possible: bool,
    /// Every answer within the rounding is a hit.
    pub certain: bool,
    /// The distance, and how far off it may be.
    pub t: f64,
    pub error: f64,
}

const MISS: Verdict = Verdict {
    possible: false,
    certain: false,
    t: f64::INFINITY,
    error: 0.0,
};

/// A corner, sheared, the size of what was subtracted to get there, and how far off f32 may be.
struct Corner {
    at: [f64; 3],
    size: [f64; 2],
    error: [f64; 2],
}

/// Judges one ray against one triangle.
pub fn judge(corners: [[f32; 3]; 3], origin: [f32; 3], direction: [f32; 3]) -> Verdict {
    let d = direction.map(f64::from);
    let main = (0..3).fold(0, |m, a| if d[a].abs() > d[m].abs() { a } else { m });
    let (ax, ay) = ((main + 1) % 3, (main + 2) % 3);
    let (sx, sy) = (d[ax] / d[main], d[ay] / d[main]);
    let p = corners.map(|c| {
        let r: [f64; 3] = std::array::from_fn(|a| f64::from(c[a]) - f64::from(origin[a]));
        let (x, y) = (r[ax] - sx * r[main], r[ay] - sy * r[main]);
        let size_x = r[ax].abs() + (sx * r[main]).abs();
        let size_y = r[ay].abs() + (sy * r[main]).abs();
        Corner {
            at: [x, y, r[main]],
            size: [size_x, size_y],
            error: [size_x, size_y].map(|size| 4.0 * U * size + E * (1.0 + r[main].abs())),
        }
    });
    let edge = |i: usize, j: usize| {
        let (a, b) = (&p[i], &p[j]);
        let product = |k: usize, l: usize| {
            let rounding = U * a.size[k] * b.size[l] + E;
            a.size[k] * b.error[l] + a.error[k] * b.size[l] + rounding
        };
        let value = a.at[0] * b.at[1] - a.at[1] * b.at[0];
        (value, product(0, 1) + product(1, 0))
    };
    let w = [edge(2, 1), edge(0, 2), edge(1, 0)];
    let det: f64 = w.iter().map(|e| e.0).sum();
    let slack: f64 = w.iter().map(|e| e.1).sum();
    let surely = |sign: f64| w.iter().all(|&(e, err)| sign * e > err);
    let maybe = |sign: f64| w.iter().all(|&(e, err)| sign * e >= -err);
    if !(maybe(1.0) || maybe(-1.0)) {
        return MISS;
    }
    // All weights have one sign, so the answer lies between the corners' distances; where the
    // triangle is not seen edge-on, it is also near the true one.
    let z = p.each_ref().map(|c| c.at[2] / d[main]);
    let (low, high) = (z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2]));
    let rounding = 12.0 * U * low.abs().max(high.abs());
    let (t, error) = if det.abs() > 2.0 * slack {
        let t = (0..3).map(|i| w[i].0 * z[i]).sum::<f64>() / det;
        let moved: f64 = (0..3).map(|i| w[i].1 * (z[i] - t).abs()).sum();
        (t, 2.0 * moved / det.abs() + rounding)
    } else {
        (0.5 * (low + high), 0.5 * (high - low) + rounding)
    };
    Verdict {
        possible: t + error > 0.0,
        certain: (surely(1.0) || surely(-1.0)) && det.abs() > 2.0 * slack && t - error > 0.0,
        t,
        error,
    }
}

/// Checks an answer against all triangles.
pub fn check(mesh: &Mesh, rays: &RaySet, i: usize, hit: Hit) -> Result<(), String> {
    let all = (0..mesh.triangles() as u32).filter(|&p| p != rays.leaves[i]);
    let verdict = |p: u32| judge(mesh.corners(p as usize), rays.origin[i], rays.direction[i]);
    let (from, to) = if hit.primitive == NO_PRIMITIVE {
        (f64::INFINITY, f64::INFINITY)
    } else {
        let v = verdict(hit.primitive);
        if !v.possible {
            return Err(format!("ray {i}: {hit:?} is no hit: {v:?}"));
        }
        // A distance beyond what f32 holds is reported as the largest it does.
        if (f64::from(hit.t) - v.t.min(f32::MAX.into())).abs() > v.error {
            return Err(format!("ray {i}: {hit:?} should be at {v:?}"));
        }
        (f64::from(hit.t), v.t + v.error)
    };
    for p in all {
        let v = verdict(p);
        if v.certain && v.t + v.error < from.min(to) {
            return Err(format!(
                "ray {i}: {hit:?}, but triangle {p} is nearer: {v:?}"
            ));
        }
    }
    Ok(())
}
