//! What corners of triangles carry, of the world and of copies, for the oracle.

use super::surface::{normal_of, uv_of};
use super::vector;
use crate::scene::Mesh;
use glam::{DAffine3, DVec2, DVec3};

/// Three corners.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    pub(super) places: [DVec3; 3],
    /// Unit normals, if all have one.
    pub(super) normals: Option<[DVec3; 3]>,
    pub(super) uvs: Option<[DVec2; 3]>,
}

impl Carried {
    /// Those of triangle `i`.
    pub(super) fn of(mesh: &Mesh, i: usize) -> Self {
        let corners = mesh.indices[i].map(|v| v as usize);
        Self {
            places: mesh.corners(i).map(vector),
            normals: all(corners, |v| normal_of(mesh, v)),
            uvs: all(corners, |v| uv_of(mesh, v)),
        }
    }

    /// The same in the world of a copy. A map that mirrors would turn the front over; it stays the
    /// front.
    pub(super) fn placed(self, map: &DAffine3) -> Self {
        let turn = map.matrix3.inverse().transpose();
        let placed = Self {
            places: self.places.map(|p| map.transform_point3(p)),
            normals: self.normals.map(|n| n.map(|n| (turn * n).normalize())),
            uvs: self.uvs,
        };
        if map.matrix3.determinant() < 0.0 {
            Self {
                places: swapped(placed.places),
                normals: placed.normals.map(swapped),
                uvs: placed.uvs.map(swapped),
            }
        } else {
            placed
        }
    }

    /// Texture coordinates; 0 where there are none.
    pub(super) fn uv(&self, [u, v]: [f64; 2]) -> DVec2 {
        let mixed = |[a, b, c]: [DVec2; 3]| a * (1.0 - u - v) + b * u + c * v;
        self.uvs.map_or(DVec2::ZERO, mixed)
    }

    /// Derivatives of the place by u and v, if there are any.
    pub(super) fn derivatives(&self) -> Option<[DVec3; 2]> {
        let [a, b, c] = self.uvs?;
        let (d1, d2) = (b - a, c - a);
        let determinant = d1.perp_dot(d2);
        let [a, b, c] = self.places;
        let (e1, e2) = (b - a, c - a);
        let by_u = (e1 * d2.y - e2 * d1.y) / determinant;
        let by_v = (e2 * d1.x - e1 * d2.x) / determinant;
        (determinant != 0.0).then_some([by_u, by_v])
    }
}

fn swapped<T>([a, b, c]: [T; 3]) -> [T; 3] {
    [a, c, b]
}

/// Of three corners, if all of them have it.
fn all<T: Copy>(corners: [usize; 3], of: impl Fn(usize) -> Option<T>) -> Option<[T; 3]> {
    let [a, b, c] = corners.map(of);
    Some([a?, b?, c?])
}
