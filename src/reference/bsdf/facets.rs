//! Facets of GGX, as their sources write them: E. Heitz, "Understanding the Masking-Shadowing
//! Function in Microfacet-Based BRDFs", JCGT 3(2), 2014 (equations 72, 85, 86, 99), with
//! height-correlated shadowing; drawn by visible normals as in E. Heitz, "Sampling the GGX
//! Distribution of Visible Normals", JCGT 7(4), 2018.

use super::super::random::uniform;
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::{PI, TAU};

/// A distribution of facets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facets {
    /// Widths along x and y.
    pub(super) alpha: [f64; 2],
}

/// `o` mirrored at the plane of normal `m`.
pub(super) fn reflect(o: DVec3, m: DVec3) -> DVec3 {
    2.0 * o.dot(m) * m - o
}

impl Facets {
    pub(super) fn isotropic(alpha: f64) -> Self {
        Self { alpha: [alpha; 2] }
    }

    /// `tan^2` of the angle to z, each axis weighed by a power of its width.
    fn tan2(&self, w: DVec3, power: i32) -> f64 {
        let [x, y] = self.alpha.map(|alpha| alpha.powi(power));
        (x * w.x * w.x + y * w.y * w.y) / (w.z * w.z)
    }

    /// `D(m)`.
    fn density(&self, m: DVec3) -> f64 {
        let [x, y] = self.alpha;
        let spread = 1.0 + self.tan2(m, -2);
        1.0 / (PI * x * y * m.z.powi(4) * spread * spread)
    }

    /// Smith's Lambda.
    fn lambda(&self, w: DVec3) -> f64 {
        0.5 * ((1.0 + self.tan2(w, 2)).sqrt() - 1.0)
    }

    /// `G2(o, i) / G1(o)`: what a visible normal's weight is. Its limit for grazing `i` is 0.
    pub(super) fn shadowing(&self, o: DVec3, i: DVec3) -> f64 {
        let seen = 1.0 + self.lambda(o);
        seen / (seen + self.lambda(i))
    }

    /// `D G2 |i.z| / (4 o.z i.z)`: reflection by facets that reflect everything, with its cosine.
    pub(super) fn reflection(&self, o: DVec3, i: DVec3, m: DVec3) -> f64 {
        self.density(m) / (4.0 * o.z * (1.0 + self.lambda(o) + self.lambda(i)))
    }

    /// Refraction into `i` by facets of normal `m` that pass everything, with its cosine, for
    /// radiance: B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR
    /// 2007, equation 21, with the light coming from the far side, of relative index `eta`.
    pub(super) fn refraction(&self, o: DVec3, i: DVec3, m: DVec3, eta: f64) -> f64 {
        let (near, far) = (o.dot(m), i.dot(m));
        let shadowed = self.density(m) / (1.0 + self.lambda(o) + self.lambda(i));
        (near * far).abs() / o.z * shadowed / (near + eta * far).powi(2)
    }

    /// A normal visible from `o`.
    pub(super) fn draw(&self, o: DVec3, rng: &mut impl Rng) -> DVec3 {
        self.visible(o, uniform(rng), uniform(rng))
    }

    /// The normal visible from `o` that `u` and `v` in `[0, 1)` name.
    pub(super) fn visible(&self, o: DVec3, u: f64, v: f64) -> DVec3 {
        let [x, y] = self.alpha;
        let stretched = DVec3::new(x * o.x, y * o.y, o.z).normalize();
        let across = DVec3::new(-stretched.y, stretched.x, 0.0)
            .try_normalize()
            .unwrap_or(DVec3::X);
        let up = stretched.cross(across);
        let (radius, (sin, cos)) = (u.sqrt(), (TAU * v).sin_cos());
        let s = 0.5 * (1.0 + stretched.z);
        let a = radius * cos;
        let b = (1.0 - s) * (1.0 - a * a).max(0.0).sqrt() + s * radius * sin;
        let c = (1.0 - a * a - b * b).max(0.0).sqrt();
        let n = a * across + b * up + c * stretched;
        DVec3::new(x * n.x, y * n.y, n.z.max(0.0)).normalize()
    }
}
