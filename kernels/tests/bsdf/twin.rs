//! The formulas in f64, as their sources write them.

use crate::harness::dot;
use std::f64::consts::{PI, TAU};

pub(crate) fn scaled(a: [f64; 3], s: f64) -> [f64; 3] {
    a.map(|c| c * s)
}

pub(crate) fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] + b[c])
}

pub(crate) fn normalized(a: [f64; 3]) -> [f64; 3] {
    scaled(a, 1.0 / dot(a, a).sqrt())
}

pub(crate) fn mirrored(o: [f64; 3], m: [f64; 3]) -> [f64; 3] {
    sum(scaled(m, 2.0 * dot(o, m)), scaled(o, -1.0))
}

/// Refraction at a facet of normal `m`, `eta` of the far side over the near side: Walter (2007),
/// equation 40. None where reflection is total.
pub(crate) fn refracted(o: [f64; 3], m: [f64; 3], eta: f64) -> Option<[f64; 3]> {
    let cos = dot(o, m);
    let square = 1.0 + (cos * cos - 1.0) / (eta * eta);
    (square > 0.0).then(|| {
        let along = cos / eta - square.sqrt();
        sum(scaled(m, along), scaled(o, -1.0 / eta))
    })
}

/// Complex numbers, as far as Fresnel needs them.
type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn over(a: Complex, b: Complex) -> Complex {
    let n = b.0 * b.0 + b.1 * b.1;
    let (re, im) = times(a, (b.0, -b.1));
    (re / n, im / n)
}

fn root(a: Complex) -> Complex {
    let size = a.0.hypot(a.1);
    let re = (0.5 * (size + a.0)).max(0.0).sqrt();
    (re, (0.5 * (size - a.0)).max(0.0).sqrt().copysign(a.1))
}

/// Unpolarised reflectance for a complex relative index `eta + i k`, from Snell's law and the two
/// amplitudes in complex numbers; dielectrics have `k = 0`.
pub(crate) fn fresnel(cos: f64, eta: f64, k: f64) -> f64 {
    let index = (eta, k);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let sin_t = over((sin, 0.0), index);
    let square = times(sin_t, sin_t);
    let cos_t = root((1.0 - square.0, -square.1));
    let far = times(index, cos_t);
    let s = over((cos - far.0, -far.1), (cos + far.0, far.1));
    let near = times(index, (cos, 0.0));
    let p = over(
        (near.0 - cos_t.0, near.1 - cos_t.1),
        (near.0 + cos_t.0, near.1 + cos_t.1),
    );
    0.5 * (s.0 * s.0 + s.1 * s.1 + p.0 * p.0 + p.1 * p.1)
}

/// `tan^2` of the angle to z, weighed by widths squared: Heitz (2014), equations 80 and 85.
fn stretched_tan2(w: [f64; 3], alpha: [f64; 2], power: i32) -> f64 {
    let part = |c: usize| w[c] * w[c] * alpha[c].powi(power);
    (part(0) + part(1)) / (w[2] * w[2])
}

/// GGX's density of facets: Heitz (2014), equation 85.
pub(crate) fn density(m: [f64; 3], alpha: [f64; 2]) -> f64 {
    let tan2 = stretched_tan2(m, alpha, -2);
    1.0 / (PI * alpha[0] * alpha[1] * m[2].powi(4) * (1.0 + tan2).powi(2))
}

/// Smith's Lambda: Heitz (2014), equation 86.
pub(crate) fn lambda(w: [f64; 3], alpha: [f64; 2]) -> f64 {
    0.5 * ((1.0 + stretched_tan2(w, alpha, 2)).sqrt() - 1.0)
}

/// `D G2 |cos_i| / (4 o.z i.z)`, height-correlated, and the pdf of visible normals reflected,
/// `D G1 (o.h) / (o.z 4 o.h)`.
pub(crate) fn reflection(o: [f64; 3], i: [f64; 3], alpha: [f64; 2]) -> (f64, f64) {
    let h = normalized(sum(o, i));
    let d = density(h, alpha);
    let g2 = 1.0 / (1.0 + lambda(o, alpha) + lambda(i, alpha));
    let g1 = 1.0 / (1.0 + lambda(o, alpha));
    (d * g2 / (4.0 * o[2]), d * g1 / (4.0 * o[2]))
}

/// `int D G2 / (4 o.z) d omega_i` for isotropic facets, over facets: with `tan m = alpha r` the
/// measure `D m.z d omega_m` is `2 r / (1 + r^2)^2 dr dphi / 2 pi`, and
/// `d omega_i = 4 (o.m) d omega_m`. Midpoint rule in `r / (1 + r)`.
pub(crate) fn reflected_energy(cos: f64, alpha: f64, points: usize) -> f64 {
    let o = [(1.0 - cos * cos).sqrt(), 0.0, cos];
    let mut total = 0.0;
    for a in 0..points {
        let q = (a as f64 + 0.5) / points as f64;
        let r = q / (1.0 - q);
        let tan = alpha * r;
        let weight = 2.0 * r * ((1.0 + r) / (1.0 + r * r)).powi(2);
        for b in 0..points {
            let (y, x) = (TAU * (b as f64 + 0.5) / points as f64).sin_cos();
            let m = normalized([tan * x, tan * y, 1.0]);
            let i = mirrored(o, m);
            if dot(o, m) > 0.0 && i[2] > 0.0 {
                let widths = [alpha; 2];
                let g2 = 1.0 / (1.0 + lambda(o, widths) + lambda(i, widths));
                total += weight * g2 * dot(o, m) / (m[2] * o[2]);
            }
        }
    }
    total / (points * points) as f64
}

/// Value and pdf of a refraction, for radiance: Walter (2007), equations 17, 21 and 39, the light
/// coming along `i` from the far side, with GGX, height-correlated shadowing, visible normals.
pub(crate) fn refraction(o: [f64; 3], i: [f64; 3], alpha: f64, eta: f64) -> (f64, f64) {
    let h = normalized(sum(o, scaled(i, eta)));
    let h = scaled(h, h[2].signum());
    let (near, far) = (dot(o, h), dot(i, h));
    if near <= 0.0 || far >= 0.0 {
        return (0.0, 0.0);
    }
    let widths = [alpha; 2];
    let passed = 1.0 - fresnel(near, eta, 0.0);
    let d = density(h, widths);
    let g1 = 1.0 / (1.0 + lambda(o, widths));
    let g2 = 1.0 / (1.0 + lambda(o, widths) + lambda(i, widths));
    let square = (near + eta * far).powi(2);
    let f = (near * far / (o[2] * i[2])).abs() * passed * g2 * d / square;
    let visible = d * g1 * near / o[2];
    let pdf = passed * visible * eta * eta * far.abs() / square;
    (f * i[2].abs(), pdf)
}
