//! From what a file says of the camera to the frame that kernels read.

use super::compiled::{FilmSpec, Mesh, Perspective};
use super::degrees;
use super::description::{Camera, FovAxis};
use super::error::SceneError;
use super::toml::SceneFile;
use super::transform::{affine, is_singular, vector};
use super::values::Finite;
use glam::DVec3;
use std::ops::Range;

/// Field of view of a camera that says none, in degrees.
const FOV: f64 = 40.0;

/// The camera of a scene file, whose table is at `span`.
pub(super) fn compile(
    camera: &Camera,
    span: Range<usize>,
    film: FilmSpec,
    file: &SceneFile,
) -> Result<Perspective, SceneError> {
    let (origin, forward, up) = match (&camera.matrix, &camera.origin, &camera.target) {
        (Some(matrix), None, None) if camera.up.is_none() => {
            from_matrix(matrix.get_ref()).map_err(|e| file.error(matrix.span(), e))?
        }
        (None, Some(origin), Some(target)) => {
            let (from, to) = (vector(*origin.get_ref()), vector(*target.get_ref()));
            let Some(forward) = (to - from).try_normalize() else {
                let message = "target and origin are the same point, expected two";
                return Err(file.error(target.span(), message));
            };
            let (up, up_span) = match &camera.up {
                Some(up) => (vector(*up.get_ref()), up.span()),
                None => (DVec3::Y, target.span()),
            };
            if up == DVec3::ZERO {
                return Err(file.error(up_span, "up is zero, expected a direction"));
            }
            // What is lost to cancellation in target - origin turns the direction by as much.
            let lost = (from.abs() + to.abs()).max_element() / (to - from).length();
            if is_parallel(forward, up, lost) {
                let up = up.to_array();
                let message = format!("the camera looks along its up vector {up:?}");
                return Err(file.error(up_span, message));
            }
            (from, forward, up)
        }
        _ => {
            let message = "expected either `origin` and `target` (and `up`) or `matrix`";
            return Err(file.error(span, message));
        }
    };
    let fov = camera.fov.map_or(FOV, |f| f.0);
    frame(origin, forward, up, fov, camera.fov_axis, film)
        .ok_or_else(|| file.error(span, "the field of view is too narrow for 32-bit floats"))
}

/// Columns of a camera-to-world matrix: right, up, back, position.
fn from_matrix(rows: &[[Finite; 4]; 4]) -> Result<(DVec3, DVec3, DVec3), String> {
    let map = affine(rows)?;
    if is_singular(&map.matrix3) {
        return Err("the camera's matrix is singular".to_owned());
    }
    if map.matrix3.determinant() < 0.0 {
        return Err("the camera's matrix mirrors, expected right, up and back columns".to_owned());
    }
    let [_, up, back] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    Ok((map.translation, -back.normalize(), up))
}

/// Whether unit `forward` and `up` span no plane, beyond rounding: each normalised component
/// carries at most 3 roundings, each component of the cross product 3 more on terms of at most 1.
fn is_parallel(forward: DVec3, up: DVec3, lost: f64) -> bool {
    let up = (up / up.abs().max_element()).normalize();
    forward.cross(up).length() <= 16.0 * f64::EPSILON * (1.0 + lost)
}

/// An orthonormal frame looking along unit `forward`. `None` where f32 cannot hold it.
fn frame(
    origin: DVec3,
    forward: DVec3,
    up: DVec3,
    fov: f64,
    axis: FovAxis,
    film: FilmSpec,
) -> Option<Perspective> {
    let up = up / up.abs().max_element();
    let right = forward.cross(up.normalize()).normalize();
    let up = right.cross(forward);
    let (sin, cos) = degrees::sin_cos(fov / 2.0);
    let half = sin / cos;
    let (width, height) = (f64::from(film.width), f64::from(film.height));
    let spans_width = match axis {
        FovAxis::X => true,
        FovAxis::Y => false,
        FovAxis::Smaller => film.width < film.height,
    };
    let (half_width, half_height) = if spans_width {
        (half, half * height / width)
    } else {
        (half * width / height, half)
    };
    let camera = Perspective {
        origin: origin.as_vec3().to_array(),
        forward: forward.as_vec3().to_array(),
        right: right.as_vec3().to_array(),
        up: up.as_vec3().to_array(),
        half_width: half_width as f32,
        half_height: half_height as f32,
    };
    let sizes = [camera.half_width, camera.half_height];
    let holds = sizes.iter().all(|&s| s > 0.0 && s.is_finite())
        && camera.origin.iter().all(|x| x.is_finite());
    holds.then_some(camera)
}

/// A three-quarter view, y up, in which the mesh's bounding sphere just fits. Without a mesh: from
/// the world's origin along -z. `None` where the mesh is too large to stand back from.
pub(super) fn framing(mesh: &Mesh, film: FilmSpec) -> Option<Perspective> {
    let corners = || {
        let vertex = |&v: &u32| DVec3::from_array(mesh.vertices[v as usize].map(f64::from));
        mesh.indices.iter().flatten().map(vertex)
    };
    let Some(first) = corners().next() else {
        return frame(
            DVec3::ZERO,
            DVec3::NEG_Z,
            DVec3::Y,
            FOV,
            FovAxis::Smaller,
            film,
        );
    };
    let (low, high) = corners().fold((first, first), |(l, h), v| (l.min(v), h.max(v)));
    let centre = 0.5 * (low + high);
    let radius = corners()
        .map(|v| v.distance_squared(centre))
        .fold(0.0, f64::max)
        .sqrt();
    let towards = DVec3::new(0.55, 0.4, 0.75).normalize();
    let distance = radius / degrees::sin_cos(FOV / 2.0).0;
    let origin = centre + distance * towards;
    frame(origin, -towards, DVec3::Y, FOV, FovAxis::Smaller, film)
}
