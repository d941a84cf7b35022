//! The scene's camera in pixels: what the generate kernel takes.

use crate::scene::{Camera, Extent, FilmSpec, Projection};
use glam::DVec3;
use huygens_kernels::camera;
use huygens_kernels::images::Cone;
use std::f64::consts::{PI, TAU};

/// The camera of a film.
pub(crate) fn in_pixels(c: &Camera, film: &FilmSpec) -> camera::Camera {
    match c.projection {
        Projection::Perspective { extent, lens: None } => {
            camera::Camera::Perspective(pinhole(c, extent, film))
        }
        Projection::Perspective {
            extent,
            lens: Some(lens),
        } => {
            let (radius, focus) = (f64::from(lens.radius), f64::from(lens.focus));
            let axes = |length: f64| [c.right, c.up].map(|axis| f32s(vector(axis) * length));
            camera::Camera::ThinLens(camera::ThinLens {
                pinhole: pinhole(c, extent, film),
                radii: axes(radius),
                slopes: axes(radius / focus),
            })
        }
        Projection::Orthographic { extent } => {
            let Image {
                corner,
                right,
                down,
            } = Image::new(c, extent, film, vector(c.origin));
            camera::Camera::Orthographic(camera::Orthographic {
                corner,
                right,
                down,
                forward: c.forward,
            })
        }
        Projection::Panorama => camera::Camera::Panorama(camera::Panorama {
            origin: c.origin,
            forward: c.forward,
            right: c.right,
            up: c.up,
            turns: [film.width, 2 * film.height].map(|pixels| (1.0 / f64::from(pixels)) as f32),
        }),
    }
}

/// The cone of a camera's rays, by the narrower side of a pixel in the middle of the image.
pub(crate) fn cone(c: &Camera, film: &FilmSpec) -> Cone {
    let narrower = |across: f64, up: f64| {
        let (width, height) = (f64::from(film.width), f64::from(film.height));
        (across / width).min(up / height)
    };
    let pixel = |e: Extent| {
        narrower(
            2.0 * f64::from(e.half_width),
            2.0 * f64::from(e.half_height),
        )
    };
    match c.projection {
        Projection::Perspective { extent, .. } => Cone::of_pixels(0.0, pixel(extent)),
        Projection::Orthographic { extent } => Cone::of_pixels(pixel(extent), 0.0),
        Projection::Panorama => Cone::of_pixels(0.0, narrower(TAU, PI)),
    }
}

fn pinhole(c: &Camera, extent: Extent, film: &FilmSpec) -> camera::Perspective {
    let Image {
        corner,
        right,
        down,
    } = Image::new(c, extent, film, vector(c.forward));
    camera::Perspective {
        origin: c.origin,
        corner,
        right,
        down,
    }
}

/// Top left corner and pixels of an image about `middle`.
struct Image {
    corner: [f32; 3],
    right: [f32; 3],
    down: [f32; 3],
}

impl Image {
    fn new(c: &Camera, extent: Extent, film: &FilmSpec, middle: DVec3) -> Self {
        let half_right = vector(c.right) * f64::from(extent.half_width);
        let half_up = vector(c.up) * f64::from(extent.half_height);
        Self {
            corner: f32s(middle - half_right + half_up),
            right: f32s(half_right * (2.0 / f64::from(film.width))),
            down: f32s(half_up * (-2.0 / f64::from(film.height))),
        }
    }
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

fn f32s(v: DVec3) -> [f32; 3] {
    v.to_array().map(|c| c as f32)
}
