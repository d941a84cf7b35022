//! Camera rays: through a filtered point of the pixel, by the projection that the scene asks for.
//!
//! The filter is realised by importance sampling (see `filter`): the point is drawn from the filter
//! about the pixel's centre, and the sample weighs 1. Of the camera's block of random numbers the
//! first two are for that, the other two for the lens, if there is one.
//!
//! Each [`Projection`] is compiled into an instance of the kernel of its own: four, times the
//! samplers. Which one runs is decided once a call.
//!
//! Cost: [`COST`].

mod orthographic;
mod panorama;
mod perspective;
mod thin_lens;

pub use orthographic::Orthographic;
pub use panorama::Panorama;
pub use perspective::Perspective;
pub use thin_lens::ThinLens;

use crate::bare::COMPLETE;
use crate::cost::{Cost, item};
use crate::filter;
use crate::lanes::{Fx, LANES, Ux, iota, padded, store, store_u32, to_f32};
use crate::queues::{LAST_RAY, PathsMut};
use crate::rays::NO_PRIMITIVE;
use crate::sampler::{CAMERA_BLOCK, Sampler};
use crate::vec3::Vec3x;
use std::ops::Range;

/// A camera ray.
pub const COST: Cost = Cost::new(0, item::<PathsMut<'static>>()).operations(40);

/// From points of the image to rays.
pub trait Projection: Copy {
    /// Origins, and directions of length 1 to rounding, of the rays through the points that lie
    /// `(x, y)` pixels from the image's top left corner, also a filter's radius outside of it.
    /// `lens` is a point of the unit square for the point of the lens, which is left alone where
    /// there is no lens.
    fn ray(&self, x: Fx, y: Fx, lens: [Fx; 2]) -> (Vec3x, Vec3x);
}

/// A camera, ready for pixels.
#[derive(Clone, Copy, Debug)]
pub enum Camera {
    /// A pinhole.
    Perspective(Perspective),
    /// A lens: depth of field.
    ThinLens(ThinLens),
    /// Parallel rays.
    Orthographic(Orthographic),
    /// All directions.
    Panorama(Panorama),
}

/// A run of camera samples: slots of one tile and sample range, pixel by pixel.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// Left edge of the tile in pixels.
    pub x: u32,
    /// Top edge of the tile in pixels.
    pub y: u32,
    /// Pixels across the tile.
    pub width: u32,
    /// First sample index.
    pub first_sample: u32,
    /// Samples a pixel.
    pub samples: u32,
}

/// What the kernel needs for the whole render.
#[derive(Clone, Debug)]
pub struct Lens<'a> {
    /// The camera.
    pub camera: Camera,
    /// Inverse distribution of the pixel filter; see `filter`.
    pub filter: &'a [f32],
    /// Whether a camera ray is its path's last ray.
    pub last_ray: bool,
}

/// Writes the camera rays of `slots` to items `at ..` of `paths`; up to a vector behind them is
/// overwritten.
pub fn camera_rays<S: Sampler>(
    lens: &Lens,
    window: Window,
    slots: Range<usize>,
    sampler: S,
    paths: &mut PathsMut,
    at: usize,
) {
    match lens.camera {
        Camera::Perspective(c) => fill(c, lens, window, slots, sampler, paths, at),
        _ if !COMPLETE => unreachable!("a pinhole is all there is"),
        Camera::ThinLens(c) => fill(c, lens, window, slots, sampler, paths, at),
        Camera::Orthographic(c) => fill(c, lens, window, slots, sampler, paths, at),
        Camera::Panorama(c) => fill(c, lens, window, slots, sampler, paths, at),
    }
}

/// [`camera_rays`] of one projection.
fn fill<P: Projection, S: Sampler>(
    projection: P,
    lens: &Lens,
    window: Window,
    slots: Range<usize>,
    sampler: S,
    paths: &mut PathsMut,
    at: usize,
) {
    let n = slots.len();
    let bounces = Ux::splat(if lens.last_ray { LAST_RAY } else { 0 });
    let slot = slots.start as u32;
    let (pixel, mut offset) = (slot / window.samples, slot % window.samples);
    let (mut px, mut py) = (pixel % window.width, pixel / window.width);
    for i in (0..padded(n)).step_by(LANES) {
        let (mut x, mut y, mut sample) = ([0; LANES], [0; LANES], [0; LANES]);
        for lane in 0..LANES {
            (x[lane], y[lane]) = (window.x + px, window.y + py);
            sample[lane] = window.first_sample + offset;
            offset += 1;
            if offset == window.samples {
                offset = 0;
                px += 1;
                if px == window.width {
                    px = 0;
                    py += 1;
                }
            }
        }
        let (x, y, sample) = (Ux::new(x), Ux::new(y), Ux::new(sample));
        let name = sampler.pixel(x, y);
        let [u, v, s, t] = sampler.draw4(name, sample, Ux::splat(CAMERA_BLOCK));
        let half = Fx::splat(0.5);
        let fx = to_f32(x) + half + filter::sample(lens.filter, u);
        let fy = to_f32(y) + half + filter::sample(lens.filter, v);
        let (origin, direction) = projection.ray(fx, fy, [s, t]);
        let to = at + i;
        origin.store(&mut paths.origin, to);
        direction.store(&mut paths.direction, to);
        Vec3x::splat([1.0; 3]).store(&mut paths.throughput, to);
        store(paths.pdf, to, Fx::splat(f32::INFINITY));
        store_u32(paths.leaves, to, Ux::splat(NO_PRIMITIVE));
        store_u32(paths.slot, to, iota(slot + i as u32));
        store_u32(paths.pixel, to, name);
        store_u32(paths.sample, to, sample);
        store_u32(paths.bounces, to, bounces);
    }
}
