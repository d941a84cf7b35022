//! Directions: uniform on the sphere, uniform and cosine-weighted on the hemisphere, in f64.
//!
//! Densities are in solid angle. By Archimedes' theorem the area of a zone of the unit sphere is
//! `2 pi` times its height, so a uniform `z` and a uniform angle about the axis make a uniform
//! direction; a cosine-weighted one has a uniform `z^2`, since `cos(theta)/pi d(omega) = 2 z dz
//! d(phi)/(2 pi)` (N. Malley lifts a uniform point of the disk: the same map).
//!
//! `kernels` has the same maps in f32 lanes, for the wave.

use super::Density;
use std::f64::consts::{FRAC_1_PI, TAU};

/// All directions alike: `pdf = 1/(4 pi)`.
#[derive(Clone, Copy, Debug, Default)]
pub struct UniformSphere;

/// All directions with `z > 0` alike: `pdf = 1/(2 pi)`.
#[derive(Clone, Copy, Debug, Default)]
pub struct UniformHemisphere;

/// Directions with `z > 0` by their cosine with the z axis: `pdf = z / pi`.
#[derive(Clone, Copy, Debug, Default)]
pub struct CosineHemisphere;

impl Density<2> for UniformSphere {
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        // 1 - z^2 with z = 1 - 2u, without cancellation.
        direction(1.0 - 2.0 * u, 4.0 * u * (1.0 - u), v)
    }

    fn pdf(&self, _: &[f64; 3]) -> f64 {
        0.25 * FRAC_1_PI
    }
}

impl Density<2> for UniformHemisphere {
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        direction(1.0 - u, u * (2.0 - u), v)
    }

    fn pdf(&self, direction: &[f64; 3]) -> f64 {
        if direction[2] > 0.0 {
            0.5 * FRAC_1_PI
        } else {
            0.0
        }
    }
}

impl Density<2> for CosineHemisphere {
    type Point = [f64; 3];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        direction((1.0 - u).sqrt(), u, v)
    }

    fn pdf(&self, direction: &[f64; 3]) -> f64 {
        FRAC_1_PI * direction[2].max(0.0)
    }
}

/// The unit vector of height `z` and distance `sqrt(r2)` from the axis, `turn` of a full turn about
/// it.
fn direction(z: f64, r2: f64, turn: f64) -> [f64; 3] {
    let (sin, cos) = (TAU * turn).sin_cos();
    let r = r2.sqrt();
    [r * cos, r * sin, z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_unit_vectors_with_a_positive_density_at_both_ends_of_the_domain() {
        let last = 1.0 - 0.5 * f64::EPSILON;
        for u in [0.0, 1e-300, 0.3, 0.5, last] {
            for v in [0.0, 0.25, 0.7, last] {
                check(&UniformSphere, [u, v]);
                check(&UniformHemisphere, [u, v]);
                check(&CosineHemisphere, [u, v]);
            }
        }
    }

    fn check(density: &impl Density<2, Point = [f64; 3]>, u: [f64; 2]) {
        let d = density.sample(u);
        let length2: f64 = d.iter().map(|c| c * c).sum();
        // Some ten roundings.
        assert!((length2 - 1.0).abs() < 8.0 * f64::EPSILON, "{u:?}: {d:?}");
        assert!(density.pdf(&d) > 0.0, "{u:?}: {d:?}");
    }
}
