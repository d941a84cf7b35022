//! Diffuse reflection: Lambert, and EON (J. Portsmouth, P. Kutz, S. Hill, "EON: A Practical
//! Energy-Preserving Rough Diffuse BRDF", JCGT 14(1), 2025), by the exact albedo of its section 4.

use super::{Drawn, cosine_direction};
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::PI;

/// Rough diffuse reflection; Lambert at roughness 0.
#[derive(Clone, Copy, Debug)]
pub(in crate::reference) struct Diffuse {
    pub(super) albedo: DVec3,
    pub(super) roughness: f64,
}

const C1: f64 = 0.5 - 2.0 / (3.0 * PI);
const C2: f64 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

impl Diffuse {
    /// `f |cos_i|`.
    pub(super) fn evaluate(&self, o: DVec3, i: DVec3) -> DVec3 {
        if i.z <= 0.0 {
            return DVec3::ZERO;
        }
        i.z / PI * self.pi_f(o, i)
    }

    pub(super) fn draw(&self, o: DVec3, rng: &mut impl Rng) -> Drawn {
        let direction = cosine_direction(rng);
        Drawn {
            direction,
            weight: self.pi_f(o, direction),
        }
    }

    fn pi_f(&self, o: DVec3, i: DVec3) -> DVec3 {
        let (r, rho) = (self.roughness, self.albedo);
        if r == 0.0 {
            return rho;
        }
        let scale = 1.0 / (1.0 + C1 * r);
        let s = o.dot(i) - o.z * i.z;
        let t = if s > 0.0 { o.z.max(i.z) } else { 1.0 };
        let once = rho * scale * (1.0 + r * s / t);
        let lacks = |cos: f64| 1.0 - scale * (1.0 + r * g(cos) / PI);
        let mean = scale * (1.0 + C2 * r);
        let colour = rho * rho * mean / (DVec3::ONE - rho * (1.0 - mean));
        once + colour * (lacks(o.z) * lacks(i.z) / (1.0 - mean))
    }
}

/// `G` of the paper's albedo. Below a cosine of 1e-9 it is that of 1e-9, to as much.
fn g(cos: f64) -> f64 {
    let cos = cos.clamp(1e-9, 1.0);
    let sin = (1.0 - cos * cos).sqrt();
    let tan = sin / cos;
    sin * (cos.acos() - sin * cos) + 2.0 / 3.0 * (tan * (1.0 - sin.powi(3)) - sin)
}
