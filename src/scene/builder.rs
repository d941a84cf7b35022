//! Collects placed triangles into the one mesh of a scene and keeps what [`Mesh`] promises.

use super::compiled::Mesh;
use glam::{DAffine3, DVec3};

/// A growing [`Mesh`].
#[derive(Debug, Default)]
pub(super) struct Builder {
    pub(super) mesh: Mesh,
    /// Triangles of zero area that were left out.
    pub(super) dropped: usize,
}

/// Triangles of one shape in its own space.
pub(super) struct Placed<'a, V> {
    pub(super) vertices: V,
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) transform: DAffine3,
}

impl Builder {
    /// Appends a shape; `material` gives each triangle's material.
    ///
    /// Vertices are placed in f64 and rounded once. A transformation that mirrors also turns each
    /// triangle over, so that what was the front stays the front.
    pub(super) fn append(
        &mut self,
        shape: Placed<'_, impl Iterator<Item = DVec3>>,
        material: impl Fn(usize) -> u32,
    ) -> Result<(), String> {
        let mesh = &mut self.mesh;
        let base = mesh.vertices.len();
        for vertex in shape.vertices {
            let placed = shape.transform.transform_point3(vertex).as_vec3();
            if !placed.is_finite() {
                return Err("a vertex lies beyond the range of 32-bit floats".to_owned());
            }
            mesh.vertices.push(placed.to_array());
        }
        let Ok(_) = u32::try_from(mesh.vertices.len()) else {
            return Err("the scene has more than 4294967295 vertices".to_owned());
        };
        let base = base as u32;
        let mirrors = shape.transform.matrix3.determinant() < 0.0;
        for (i, &[a, b, c]) in shape.triangles.iter().enumerate() {
            let corners = if mirrors { [a, c, b] } else { [a, b, c] }.map(|v| base + v);
            if has_area(corners.map(|v| mesh.vertices[v as usize])) {
                mesh.indices.push(corners);
                mesh.material.push(material(i));
            } else {
                self.dropped += 1;
            }
        }
        Ok(())
    }
}

/// Whether a triangle has a normal: its area, in f64 from its f32 corners, is not zero.
///
/// Differences of f32 are at most 2^129, their products at most 2^259: nothing overflows, and the
/// smallest difference, 2^-149, squares to well within f64's range.
pub(super) fn has_area(corners: [[f32; 3]; 3]) -> bool {
    let [a, b, c] = corners.map(|v| DVec3::from_array(v.map(f64::from)));
    (b - a).cross(c - a).try_normalize().is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_has_no_area_is_dropped() {
        let x = [1.0, 0.0, 0.0];
        assert!(has_area([[0.0; 3], x, [0.0, 1.0, 0.0]]));
        assert!(!has_area([[0.0; 3], x, [0.0; 3]]));
        assert!(!has_area([[0.0; 3], x, [2.0, 0.0, 0.0]]));
        let tiny = f32::from_bits(1);
        assert!(has_area([[0.0; 3], [tiny, 0.0, 0.0], [0.0, tiny, 0.0]]));
        let huge = f32::MAX;
        assert!(has_area([
            [-huge, -huge, 0.0],
            [huge, 0.0, 0.0],
            [0.0, huge, 0.0]
        ]));
    }

    #[test]
    fn a_mirror_keeps_the_front_in_front() {
        // Faces +z; mirrored in x it still faces +z.
        let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let mut builder = Builder::default();
        let shape = Placed {
            vertices: vertices.into_iter(),
            triangles: &[[0, 1, 2]],
            transform: DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0)),
        };
        builder.append(shape, |_| 0).unwrap();
        let [a, b, c] = builder.mesh.corners(0).map(glam::Vec3::from_array);
        assert_eq!((b - a).cross(c - a).to_array(), [0.0, 0.0, 2.0]);
    }
}
