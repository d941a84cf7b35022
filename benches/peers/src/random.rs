//! Numbers for meshes and rays: the same on every machine and in every run.

use glam::Vec3;
use std::f64::consts::TAU;

/// SplitMix64 (G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators",
/// OOPSLA 2014).
#[derive(Clone, Debug)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 32) as u32
    }

    /// In `[0, 1)`, a multiple of 2^-24.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }

    /// In `[low, high)`.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// An index below `n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.bits()) * n as u64) >> 32) as usize
    }

    /// A point of the box.
    pub(crate) fn point(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        let t = Vec3::new(self.unit(), self.unit(), self.unit());
        low + (high - low) * t
    }

    /// A unit vector, uniform over the sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        let z = f64::from(self.unit()).mul_add(2.0, -1.0);
        let (sin, cos) = (f64::from(self.unit()) * TAU).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        glam::DVec3::new(r * cos, r * sin, z).as_vec3()
    }

    /// Cosine-weighted over the hemisphere about the unit vector `normal` (Malley's method).
    pub(crate) fn cosine(&mut self, normal: Vec3) -> Vec3 {
        let u = f64::from(self.unit());
        let (sin, cos) = (f64::from(self.unit()) * TAU).sin_cos();
        let (tangent, bitangent) = normal.as_dvec3().any_orthonormal_pair();
        let r = u.sqrt();
        (tangent * (r * cos) + bitangent * (r * sin) + normal.as_dvec3() * (1.0 - u).sqrt())
            .normalize()
            .as_vec3()
    }
}
