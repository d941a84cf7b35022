//! What a scene's camera is.

use huygens::scene::{Camera, Projection};
use serde::Serialize;
use std::fmt::Write;

/// The camera; see docs/stats.md.
#[derive(Debug, Serialize)]
pub(super) struct CameraContents {
    pub(super) origin: [f32; 3],
    pub(super) forward: [f32; 3],
    pub(super) up: [f32; 3],
    pub(super) kind: &'static str,
    /// None unless the rays fan out over an image plane.
    pub(super) horizontal_degrees: Option<f64>,
    pub(super) vertical_degrees: Option<f64>,
    /// None unless the rays are parallel.
    pub(super) width: Option<f32>,
    pub(super) height: Option<f32>,
    /// None without a lens.
    pub(super) aperture: Option<f32>,
    pub(super) focus: Option<f32>,
}

impl CameraContents {
    pub(super) fn of(camera: &Camera) -> Self {
        let degrees = |half: f32| Some(2.0 * f64::from(half).atan().to_degrees());
        let contents = |kind| Self {
            origin: camera.origin,
            forward: camera.forward,
            up: camera.up,
            kind,
            horizontal_degrees: None,
            vertical_degrees: None,
            width: None,
            height: None,
            aperture: None,
            focus: None,
        };
        match camera.projection {
            Projection::Perspective { extent, lens } => Self {
                horizontal_degrees: degrees(extent.half_width),
                vertical_degrees: degrees(extent.half_height),
                aperture: lens.map(|l| l.radius),
                focus: lens.map(|l| l.focus),
                ..contents("perspective")
            },
            Projection::Orthographic { extent } => Self {
                width: Some(2.0 * extent.half_width),
                height: Some(2.0 * extent.half_height),
                ..contents("orthographic")
            },
            Projection::Panorama => contents("panorama"),
        }
    }

    /// What a camera sees: degrees, scene units, or all around; and its lens.
    pub(super) fn view(&self) -> String {
        let mut text = String::new();
        if let (Some(x), Some(y)) = (self.horizontal_degrees, self.vertical_degrees) {
            let _ = write!(text, ", {x:.2} x {y:.2} degrees");
        }
        if let (Some(x), Some(y)) = (self.width, self.height) {
            let _ = write!(text, ", {x} x {y} units");
        }
        if let (Some(radius), Some(focus)) = (self.aperture, self.focus) {
            let _ = write!(text, ", lens of radius {radius} focused at {focus}");
        }
        text
    }
}
