//! From what a file says of the camera to the frame that kernels read.

use super::compiled::{Camera, Extent, FilmSpec, Projection};
use super::degrees;
use super::description::{self, FovAxis};
use super::error::SceneError;
use super::placed::Placed;
use super::projection;
use super::toml::SceneFile;
use super::transform::{affine, direction, is_singular, vector};
use super::values::Finite;
use glam::DVec3;
use std::ops::Range;

/// Field of view of a camera that says none, in degrees.
pub(super) const FOV: f64 = 40.0;

/// Where a camera stands and how it is turned.
pub(super) struct Placement {
    pub(super) origin: DVec3,
    /// A unit vector.
    pub(super) forward: DVec3,
    /// A unit vector, not along `forward`.
    pub(super) up: DVec3,
    /// How far away its target is, if it has one.
    pub(super) target: Option<f64>,
}

/// The camera of a scene file, whose table is at `span`.
pub(super) fn compile(
    camera: &description::Camera,
    span: Range<usize>,
    film: FilmSpec,
    file: &SceneFile,
) -> Result<Camera, SceneError> {
    let placement = placement(camera, span.clone(), file)?;
    let projection = projection::compile(camera, span.clone(), &placement, film, file)?;
    let message = "the camera's position is too far away for 32-bit floats";
    frame(&placement, projection).ok_or_else(|| file.error(span, message))
}

fn placement(
    camera: &description::Camera,
    span: Range<usize>,
    file: &SceneFile,
) -> Result<Placement, SceneError> {
    match (&camera.matrix, &camera.origin, &camera.target) {
        (Some(matrix), None, None) if camera.up.is_none() => {
            from_matrix(matrix.get_ref()).map_err(|e| file.error(matrix.span(), e))
        }
        (None, Some(origin), Some(target)) => {
            let (from, to) = (vector(*origin.get_ref()), vector(*target.get_ref()));
            let Some(forward) = direction(to - from) else {
                let message = "target and origin are the same point, expected two";
                return Err(file.error(target.span(), message));
            };
            let (up, up_span) = match &camera.up {
                Some(up) => (vector(*up.get_ref()), up.span()),
                None => (DVec3::Y, target.span()),
            };
            let Some(up_unit) = direction(up) else {
                return Err(file.error(up_span, "up is zero, expected a direction"));
            };
            // What is lost to cancellation in target - origin turns the direction by as much.
            let lost = (from.abs() + to.abs()).max_element() / (to - from).length();
            if is_parallel(forward, up_unit, lost) {
                let up = up.to_array();
                let message =
                    format!("the camera looks along its up vector {up:?}, expected another");
                return Err(file.error(up_span, message));
            }
            Ok(Placement {
                origin: from,
                forward,
                up: up_unit,
                target: Some((to - from).length()),
            })
        }
        _ => {
            let message = "expected either `origin` and `target` (and `up`) or `matrix`";
            Err(file.error(span, message))
        }
    }
}

/// Columns of a camera-to-world matrix: right, up, back, position.
fn from_matrix(rows: &[[Finite; 4]; 4]) -> Result<Placement, String> {
    let map = affine(rows)?;
    if is_singular(&map.matrix3) {
        return Err("the camera's matrix is singular".to_owned());
    }
    if map.matrix3.determinant() < 0.0 {
        return Err("the camera's matrix mirrors, expected right, up and back columns".to_owned());
    }
    let unit = |v| direction(v).ok_or_else(|| "the camera's matrix is singular".to_owned());
    let [up, back] = [unit(map.matrix3.y_axis)?, unit(map.matrix3.z_axis)?];
    Ok(Placement {
        origin: map.translation,
        forward: -back,
        up,
        target: None,
    })
}

/// Whether unit vectors `forward` and `up` span no plane, beyond rounding: each normalised component
/// carries at most 3 roundings, each component of the cross product 3 more on terms of at most 1.
fn is_parallel(forward: DVec3, up: DVec3, lost: f64) -> bool {
    forward.cross(up).length() <= 16.0 * f64::EPSILON * (1.0 + lost)
}

/// An orthonormal frame, as near to upright as the view allows. `None` where f32 cannot hold it.
fn frame(placement: &Placement, projection: Projection) -> Option<Camera> {
    let forward = placement.forward;
    let right = forward.cross(placement.up).normalize();
    let up = right.cross(forward);
    let camera = Camera {
        origin: placement.origin.as_vec3().to_array(),
        forward: forward.as_vec3().to_array(),
        right: right.as_vec3().to_array(),
        up: up.as_vec3().to_array(),
        projection,
    };
    camera
        .origin
        .iter()
        .all(|x| x.is_finite())
        .then_some(camera)
}

/// Half the image at distance 1 for a field of view in degrees. `None` where f32 cannot hold it.
pub(super) fn extent(fov: f64, axis: FovAxis, film: FilmSpec) -> Option<Extent> {
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
    halves(half_width, half_height)
}

/// In f32, where that can hold it.
pub(super) fn halves(half_width: f64, half_height: f64) -> Option<Extent> {
    let extent = Extent {
        half_width: half_width as f32,
        half_height: half_height as f32,
    };
    let sizes = [extent.half_width, extent.half_height];
    let holds = sizes.iter().all(|&s| s > 0.0 && s.is_finite());
    holds.then_some(extent)
}

/// A three-quarter view, y up, from as near as all of the mesh can be seen, and a little further.
/// Without a mesh: from the world's origin along -z. `None` where the mesh is too large to stand
/// back from.
pub(super) fn framing(placed: &Placed<'_>, film: FilmSpec) -> Option<Camera> {
    let extent = extent(FOV, FovAxis::Smaller, film)?;
    let projection = Projection::Perspective { extent, lens: None };
    let view = |origin, forward| {
        let placement = Placement {
            origin,
            forward,
            up: DVec3::Y,
            target: None,
        };
        frame(&placement, projection)
    };
    let Some(first) = placed.points().next() else {
        return view(DVec3::ZERO, DVec3::NEG_Z);
    };
    let both = |(l, h): (DVec3, DVec3), v: DVec3| (l.min(v), h.max(v));
    let (low, high) = placed.points().fold((first, first), both);
    let centre = 0.5 * (low + high);
    let towards = DVec3::new(0.55, 0.4, 0.75).normalize();
    let at_centre = view(centre, -towards)?;
    let axis = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let right = axis(at_centre.right) / f64::from(extent.half_width);
    let up = axis(at_centre.up) / f64::from(extent.half_height);
    // A point is in the image if neither offset exceeds its depth, which is the camera's distance
    // less how far the point lies towards the camera.
    let distance = placed
        .points()
        .map(|v| v - centre)
        .map(|v| v.dot(towards) + v.dot(right).abs().max(v.dot(up).abs()))
        .fold(0.0, f64::max);
    let margin = 0.05 * (high - low).length();
    view(centre + (distance + margin) * towards, -towards)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Filter, Mesh};
    use proptest::prelude::*;

    fn film(width: u32, height: u32) -> FilmSpec {
        FilmSpec {
            width,
            height,
            filter: Filter::Box,
        }
    }

    #[test]
    fn field_of_view_spans_the_axis_it_names() {
        let halves = |axis, film| {
            let extent = extent(90.0, axis, film).unwrap();
            (extent.half_width, extent.half_height)
        };
        // The tangent of 45 degrees is 1 to an ulp of f64, so exactly in f32.
        assert_eq!(halves(FovAxis::X, film(200, 100)), (1.0, 0.5));
        assert_eq!(halves(FovAxis::Y, film(200, 100)), (2.0, 1.0));
        assert_eq!(halves(FovAxis::Smaller, film(200, 100)), (2.0, 1.0));
        assert_eq!(halves(FovAxis::Smaller, film(100, 200)), (1.0, 2.0));
    }

    #[test]
    fn a_frame_is_upright_and_right_is_right() {
        let placement = Placement {
            origin: DVec3::ZERO,
            forward: DVec3::NEG_Z,
            up: DVec3::Y,
            target: None,
        };
        let camera = frame(&placement, Projection::Panorama).unwrap();
        assert_eq!(camera.right, [1.0, 0.0, 0.0]);
        assert_eq!(camera.up, [0.0, 1.0, 0.0]);
    }

    proptest! {
        /// Every vertex of a framed mesh is in front of the camera and in the image.
        #[test]
        fn framing_shows_the_whole_mesh(
            vertices in prop::collection::vec(prop::array::uniform3(-1.0f32..1.0), 3..20),
            scale in -20i32..20,
            shift in -100.0f32..100.0,
            portrait: bool,
        ) {
            let scale = 2.0f32.powi(scale);
            let vertices: Vec<_> = vertices.iter().map(|v| v.map(|x| (x + shift) * scale)).collect();
            let last = vertices.len() as u32 - 1;
            let mesh = Mesh {
                indices: (0..last - 1).map(|i| [i, i + 1, last]).collect(),
                vertices,
                material: Vec::new(), ..Mesh::default() };
            let film = if portrait { film(90, 160) } else { film(160, 90) };
            let camera = framing(&Placed::triangles(&mesh), film).unwrap();
            let axis = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
            let Projection::Perspective { extent, lens: None } = camera.projection else {
                panic!("a pinhole");
            };
            for &v in &mesh.vertices {
                let to = axis(v) - axis(camera.origin);
                let depth = to.dot(axis(camera.forward));
                prop_assert!(depth > 0.0);
                prop_assert!(to.dot(axis(camera.right)).abs() <= depth * f64::from(extent.half_width));
                prop_assert!(to.dot(axis(camera.up)).abs() <= depth * f64::from(extent.half_height));
            }
        }
    }
}
