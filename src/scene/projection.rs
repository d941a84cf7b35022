//! What a file says of a camera's kind, field of view and lens.

use super::camera::{FOV, Placement, extent, halves};
use super::compiled::{Extent, FilmSpec, Lens, Projection};
use super::description::{Camera, CameraKind};
use super::error::SceneError;
use super::toml::SceneFile;
use super::transform::vector;
use std::ops::Range;

/// How the camera of a scene file, whose table is at `span`, projects.
pub(super) fn compile(
    camera: &Camera,
    span: Range<usize>,
    placement: &Placement,
    film: FilmSpec,
    file: &SceneFile,
) -> Result<Projection, SceneError> {
    nothing_needless(camera, file)?;
    match camera.kind {
        CameraKind::Perspective => {
            let fov = camera.fov.as_ref().map_or(FOV, |f| f.get_ref().0);
            let axis = camera.fov_axis.as_ref().map(|a| *a.get_ref());
            let message = "the field of view is too narrow for 32-bit floats";
            let extent = extent(fov, axis.unwrap_or_default(), film)
                .ok_or_else(|| file.error(span, message))?;
            let lens = lens(camera, placement, file)?;
            Ok(Projection::Perspective { extent, lens })
        }
        CameraKind::Orthographic => {
            let Some(width) = &camera.width else {
                let message = "an orthographic camera needs `width`, \
                               the extent of the image in scene units";
                return Err(file.error(span, message));
            };
            let message = "the image is too small or too large for 32-bit floats";
            let extent = of_width(width.get_ref().0, film)
                .ok_or_else(|| file.error(width.span(), message))?;
            Ok(Projection::Orthographic { extent })
        }
        CameraKind::Panorama => Ok(Projection::Panorama),
    }
}

/// Half the image of a width in scene units.
fn of_width(width: f64, film: FilmSpec) -> Option<Extent> {
    let half = 0.5 * width;
    halves(half, half * f64::from(film.height) / f64::from(film.width))
}

/// An error about the first key that the camera's kind has no use for.
fn nothing_needless(camera: &Camera, file: &SceneFile) -> Result<(), SceneError> {
    use CameraKind::{Orthographic, Panorama, Perspective};
    let keys = [
        ("fov", camera.fov.as_ref().map(|k| k.span()), Perspective),
        (
            "fov_axis",
            camera.fov_axis.as_ref().map(|k| k.span()),
            Perspective,
        ),
        (
            "aperture",
            camera.aperture.as_ref().map(|k| k.span()),
            Perspective,
        ),
        (
            "focus",
            camera.focus.as_ref().map(|k| k.span()),
            Perspective,
        ),
        (
            "focus_at",
            camera.focus_at.as_ref().map(|k| k.span()),
            Perspective,
        ),
        (
            "width",
            camera.width.as_ref().map(|k| k.span()),
            Orthographic,
        ),
    ];
    let name = |kind| match kind {
        Perspective => "perspective",
        Orthographic => "orthographic",
        Panorama => "panorama",
    };
    for (key, span, kind) in keys {
        if let Some(span) = span
            && kind != camera.kind
        {
            let (needs, is) = (name(kind), name(camera.kind));
            let message = format!("`{key}` is for kind = \"{needs}\", the camera is \"{is}\"");
            return Err(file.error(span, message));
        }
    }
    Ok(())
}

/// The lens that the file asks for, unless its radius is 0.
fn lens(
    camera: &Camera,
    placement: &Placement,
    file: &SceneFile,
) -> Result<Option<Lens>, SceneError> {
    let Some(aperture) = &camera.aperture else {
        let focus = camera.focus.as_ref().map(|k| k.span());
        return match focus.or(camera.focus_at.as_ref().map(|k| k.span())) {
            Some(span) => {
                let message = "does nothing without `aperture`, the radius of the lens";
                Err(file.error(span, message))
            }
            None => Ok(None),
        };
    };
    let (focus, span) = match (&camera.focus, &camera.focus_at) {
        (Some(_), Some(at)) => {
            let message = "expected either `focus` or `focus_at`, found both";
            return Err(file.error(at.span(), message));
        }
        (Some(focus), None) => (focus.get_ref().0, focus.span()),
        (None, Some(at)) => {
            let to = vector(*at.get_ref()) - placement.origin;
            let distance = to.dot(placement.forward);
            if distance <= 0.0 {
                let message = "the point lies behind the camera, expected one before it";
                return Err(file.error(at.span(), message));
            }
            (distance, at.span())
        }
        (None, None) => match placement.target {
            Some(distance) => (distance, aperture.span()),
            None => {
                let message = "a lens needs `focus` or `focus_at` where there is no `target`";
                return Err(file.error(aperture.span(), message));
            }
        },
    };
    let radius = aperture.get_ref().0;
    let slope = (radius / focus) as f32;
    if focus as f32 > 0.0 && (focus as f32).is_finite() && slope.is_finite() {
        let (radius, focus) = (radius as f32, focus as f32);
        return Ok((radius > 0.0).then_some(Lens { radius, focus }));
    }
    Err(file.error(span, "the focus is too near or too far for 32-bit floats"))
}
