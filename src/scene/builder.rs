//! Collects placed triangles into the one mesh of a scene and keeps what [`Mesh`] promises.

use super::compiled::Mesh;
use super::import::Imported;
use super::import::attributes::decode;
use glam::{DAffine3, DMat3, DVec3};
use huygens_kernels::octahedral;
use rayon::prelude::*;

/// Triangles or vertices that one task handles at least.
pub(super) const TASK: usize = 1 << 14;

/// A growing [`Mesh`].
#[derive(Debug, Default)]
pub(super) struct Builder {
    pub(super) mesh: Mesh,
    /// Triangles of zero area that were left out.
    pub(super) dropped: usize,
}

/// Triangles of one material in the space of their shape.
pub(super) struct Placed<'a> {
    pub(super) vertices: &'a [DVec3],
    /// Of the vertices, or empty.
    pub(super) normals: &'a [DVec3],
    /// Of the vertices, or empty.
    pub(super) uvs: &'a [[f32; 2]],
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) transform: DAffine3,
    pub(super) material: u32,
}

/// Vertices are placed in f64 and rounded once. A transformation that mirrors also turns each
/// triangle over, so that what was the front stays the front.
impl Builder {
    /// Appends a shape.
    pub(super) fn append(&mut self, shape: &Placed<'_>) -> Result<(), String> {
        let place = |&v: &DVec3| shape.transform.transform_point3(v).as_vec3().to_array();
        let vertices: Vec<[f32; 3]> = shape.vertices.iter().map(place).collect();
        let material = vec![shape.material; shape.triangles.len()];
        let mirrors = mirrors(&shape.transform);
        let turn = of_normals(&shape.transform);
        let code = |&n: &DVec3| octahedral::encode((turn * n).to_array());
        self.attach(shape.normals.iter().map(code).collect(), shape.uvs.to_vec());
        self.take(vertices, shape.triangles.to_vec(), material, mirrors)
    }

    /// Appends what a file holds, whose material indices are those of the scene already. Its tables
    /// are taken over or freed, not copied, as far as possible.
    pub(super) fn append_file(
        &mut self,
        mut file: Imported,
        transform: DAffine3,
    ) -> Result<(), String> {
        if transform != DAffine3::IDENTITY {
            file.vertices
                .par_iter_mut()
                .with_min_len(TASK)
                .for_each(|v| {
                    let vertex = DVec3::from_array(v.map(f64::from));
                    *v = transform.transform_point3(vertex).as_vec3().to_array();
                });
            let turn = of_normals(&transform);
            let codes = file.normals.par_iter_mut().with_min_len(TASK);
            codes.filter(|n| **n != octahedral::NONE).for_each(|n| {
                *n = octahedral::encode((turn * DVec3::from_array(decode(*n))).to_array());
            });
        }
        self.attach(file.normals, file.uvs);
        let mirrors = mirrors(&transform);
        self.take(file.vertices, file.triangles, file.material, mirrors)
    }

    /// Appends what the vertices carry that are appended next; nothing where that is empty.
    fn attach(&mut self, normals: Vec<u32>, uvs: Vec<[f32; 2]>) {
        let mesh = &mut self.mesh;
        let base = mesh.vertices.len();
        if !normals.is_empty() {
            mesh.normals.resize(base, Mesh::NO_NORMAL);
            extend(&mut mesh.normals, normals);
        }
        if !uvs.is_empty() {
            mesh.uvs.resize(base, Mesh::NO_UV);
            extend(&mut mesh.uvs, uvs);
        }
    }

    fn take(
        &mut self,
        vertices: Vec<[f32; 3]>,
        mut triangles: Vec<[u32; 3]>,
        mut material: Vec<u32>,
        mirrors: bool,
    ) -> Result<(), String> {
        let mesh = &mut self.mesh;
        if vertices.as_flattened().iter().any(|x| !x.is_finite()) {
            return Err("a vertex lies beyond the range of 32-bit floats".to_owned());
        }
        let base = mesh.vertices.len();
        if u32::try_from(base + vertices.len()).is_err() {
            return Err("the scene has more than 4294967295 vertices".to_owned());
        }
        extend(&mut mesh.vertices, vertices);
        // A triangle without area becomes one corner three times over, by which it is known below.
        let flat = |t: &[u32; 3]| t[0] == t[1];
        let place = |t: &mut [u32; 3]| {
            let [a, b, c] = *t;
            let corners = if mirrors { [a, c, b] } else { [a, b, c] }.map(|v| base as u32 + v);
            let keep = has_area(corners.map(|v| mesh.vertices[v as usize]));
            *t = if keep { corners } else { [corners[0]; 3] };
            usize::from(!keep)
        };
        let tasks = triangles.par_iter_mut().with_min_len(TASK);
        let dropped: usize = tasks.map(place).sum();
        if dropped > 0 {
            let mut all = triangles.iter();
            material.retain(|_| all.next().is_some_and(|t| !flat(t)));
            triangles.retain(|t| !flat(t));
            self.dropped += dropped;
        }
        extend(&mut mesh.indices, triangles);
        extend(&mut mesh.material, material);
        Ok(())
    }
}

/// What normals are multiplied with: the cofactors, which are the inverse's transpose up to a positive
/// factor where nothing is mirrored, and with the sign of the determinant where it is.
fn of_normals(transform: &DAffine3) -> DMat3 {
    let m = &transform.matrix3;
    let sign = m.determinant().signum();
    let column = |a: DVec3, b: DVec3| a.cross(b) * sign;
    DMat3::from_cols(
        column(m.y_axis, m.z_axis),
        column(m.z_axis, m.x_axis),
        column(m.x_axis, m.y_axis),
    )
}

fn mirrors(transform: &DAffine3) -> bool {
    transform.matrix3.determinant() < 0.0
}

/// Puts `more` behind `table`; without a copy if it is the first.
fn extend<T>(table: &mut Vec<T>, mut more: Vec<T>) {
    if table.is_empty() {
        *table = more;
    } else {
        table.append(&mut more);
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
            vertices: &vertices,
            normals: &[DVec3::new(1.0, 0.0, 1.0)],
            uvs: &[],
            triangles: &[[0, 1, 2]],
            transform: DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0)),
            material: 0,
        };
        builder.append(&shape).unwrap();
        let [a, b, c] = builder.mesh.corners(0).map(glam::Vec3::from_array);
        assert_eq!((b - a).cross(c - a).to_array(), [0.0, 0.0, 2.0]);
        // A normal leans less where the shape is stretched, and to the other side.
        let leaning = DVec3::from_array(decode(builder.mesh.normals[0]));
        assert!((leaning - DVec3::new(-0.5, 0.0, 1.0).normalize()).length() < 1e-4);
    }
}
