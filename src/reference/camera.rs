//! Camera rays of the reference.

use super::media::Within;
use super::random::uniform;
use super::vector;
use super::world::Ray;
use crate::scene::{Lens, Projection, Scene};
use glam::DVec3;
use rand_pcg::rand_core::Rng;
use std::f64::consts::PI;

/// The camera ray through a point of the film, in pixels from its top left corner. Draws from `rng`
/// where there is a lens.
pub(super) fn ray(scene: &Scene, x: f64, y: f64, rng: &mut impl Rng) -> Ray {
    let camera = &scene.camera;
    let (origin, forward) = (vector(camera.origin), vector(camera.forward));
    let (right, up) = (vector(camera.right), vector(camera.up));
    // From the middle of the film to its edges: -1 to 1, rightwards and upwards.
    let across = 2.0 * x / f64::from(scene.film.width) - 1.0;
    let upwards = 1.0 - 2.0 * y / f64::from(scene.film.height);
    let (origin, direction) = match camera.projection {
        Projection::Perspective { extent, lens } => {
            let right_of = f64::from(extent.half_width) * across;
            let above = f64::from(extent.half_height) * upwards;
            let pinhole = forward + right_of * right + above * up;
            match lens {
                None => (origin, pinhole),
                Some(lens) => {
                    let focus = origin + f64::from(lens.focus) * pinhole;
                    let [s, t] = lens_point(lens, rng);
                    let from = origin + s * right + t * up;
                    (from, focus - from)
                }
            }
        }
        Projection::Orthographic { extent } => {
            let right_of = f64::from(extent.half_width) * across;
            let above = f64::from(extent.half_height) * upwards;
            (origin + right_of * right + above * up, forward)
        }
        Projection::Panorama => {
            let (longitude, latitude) = (PI * across, 0.5 * PI * upwards);
            let level = longitude.cos() * forward + longitude.sin() * right;
            (origin, latitude.cos() * level + latitude.sin() * up)
        }
    };
    Ray {
        origin,
        direction: direction.normalize(),
        leaves: None,
        within: Within::Outside,
    }
}

/// A point of the lens, uniformly: one of the square around it that lies inside.
fn lens_point(lens: Lens, rng: &mut impl Rng) -> [f64; 2] {
    loop {
        let point: [f64; 2] = std::array::from_fn(|_| 2.0 * uniform(rng) - 1.0);
        if DVec3::new(point[0], point[1], 0.0).length_squared() <= 1.0 {
            return point.map(|c| c * f64::from(lens.radius));
        }
    }
}
