//! Normals and texture coordinates that a file gives to the corners of faces by indices of their
//! own: vertices are split where corners disagree, so that in the end every vertex has one of each.

use super::Imported;
use crate::scene::builder::TASK;
use crate::scene::compiled::Mesh;
use glam::DVec3;
use huygens_kernels::lanes::{LANES, Ux};
use huygens_kernels::octahedral;
use rayon::prelude::*;
use std::collections::HashMap;

/// No normal or texture coordinates at a corner.
pub(super) const NONE: u32 = u32::MAX;

/// A vertex that no corner has claimed yet.
const FREE: u32 = u32::MAX - 1;

/// How far, in radians, corners' normals may lie from the triangle's own to be taken for it: files
/// with four decimals are off by a tenth of this.
const FLAT: f64 = 1.0 / 1024.0;

/// What the corners of a file's triangles carry.
#[derive(Debug, Default)]
pub(super) struct Corners {
    /// Texture coordinates; NaN for what cannot be read.
    pub(super) uvs: Vec<[f32; 2]>,
    /// Codes of normals.
    pub(super) normals: Vec<u32>,
    /// Indices into `uvs` of the first so many triangles' corners, or [`NONE`].
    pub(super) uv: Vec<[u32; 3]>,
    /// Indices into `normals`, alike.
    pub(super) normal: Vec<[u32; 3]>,
}

/// Gives the vertices of `imported` what the corners of its triangles carry. Triangles whose corners
/// have the triangle's own normal, or not all of them one, get none. Returns the number of corners'
/// indices that are those of nothing.
pub(super) fn weld(imported: &mut Imported, mut corners: Corners) -> usize {
    let count = imported.triangles.len();
    let mut wrong = 0;
    for (indices, table) in [
        (&mut corners.uv, corners.uvs.len()),
        (&mut corners.normal, corners.normals.len()),
    ] {
        indices.resize(count, [NONE; 3]);
        let known = |i: &mut u32| {
            let wrong = *i != NONE && *i as usize >= table;
            *i = if wrong { NONE } else { *i };
            usize::from(wrong)
        };
        let of = |t: &mut [u32; 3]| t.iter_mut().map(known).sum::<usize>();
        let tasks = indices.par_iter_mut().with_min_len(TASK);
        wrong += tasks.map(of).sum::<usize>();
    }
    let whole = |t: &mut [u32; 3], has: &dyn Fn(u32) -> bool| {
        if !t.iter().all(|&i| i != NONE && has(i)) {
            *t = [NONE; 3];
        }
    };
    let uvs = &corners.uvs;
    let tasks = corners.uv.par_iter_mut().with_min_len(TASK);
    tasks.for_each(|t| whole(t, &|i| uvs[i as usize].iter().all(|x| x.is_finite())));
    let (normals, vertices) = (&corners.normals, &imported.vertices);
    let tasks = corners.normal.par_iter_mut().with_min_len(TASK);
    tasks.zip(&imported.triangles).for_each(|(t, triangle)| {
        whole(t, &|i| normals[i as usize] != octahedral::NONE);
        let corners = triangle.map(|v| vertices[v as usize]);
        if t[0] != NONE && is_flat(corners, t.map(|i| normals[i as usize])) {
            *t = [NONE; 3];
        }
    });
    let used = |indices: &[[u32; 3]]| indices.par_iter().any(|t| t[0] != NONE);
    let (has_uvs, has_normals) = (used(&corners.uv), used(&corners.normal));
    if !has_uvs && !has_normals {
        return wrong;
    }
    let mut claimed = vec![[FREE; 2]; imported.vertices.len()];
    let mut split: HashMap<[u32; 3], u32> = HashMap::new();
    let both = corners.uv.iter().zip(&corners.normal);
    for (triangle, (uv, normal)) in imported.triangles.iter_mut().zip(both) {
        for (k, vertex) in triangle.iter_mut().enumerate() {
            let carried = [uv[k], normal[k]];
            let place = &mut claimed[*vertex as usize];
            if *place == [FREE; 2] {
                *place = carried;
            } else if *place != carried {
                let position = imported.vertices[*vertex as usize];
                let key = [*vertex, carried[0], carried[1]];
                *vertex = *split.entry(key).or_insert_with(|| {
                    imported.vertices.push(position);
                    claimed.push(carried);
                    claimed.len() as u32 - 1
                });
            }
        }
    }
    let claims = claimed.par_iter().with_min_len(TASK);
    if has_uvs {
        let uv = |[i, _]: &[u32; 2]| corners.uvs.get(*i as usize).copied();
        let all = claims.clone().map(|c| uv(c).unwrap_or(Mesh::NO_UV));
        imported.uvs = all.collect();
    }
    if has_normals {
        let normal = |[_, i]: &[u32; 2]| corners.normals.get(*i as usize).copied();
        let all = claims.map(|c| normal(c).unwrap_or(Mesh::NO_NORMAL));
        imported.normals = all.collect();
    }
    wrong
}

/// Whether these corners' normals are the triangle's own, on either side.
fn is_flat(corners: [[f32; 3]; 3], codes: [u32; 3]) -> bool {
    let [a, b, c] = corners.map(|v| DVec3::from_array(v.map(f64::from)));
    let Some(own) = (b - a).cross(c - a).try_normalize() else {
        return true;
    };
    let mut lanes = [codes[0]; LANES];
    lanes[..3].copy_from_slice(&codes);
    let normals = octahedral::decode(Ux::new(lanes));
    (0..3).all(|lane| {
        let normal = DVec3::from_array(normals.lane(lane).map(f64::from));
        normal.cross(own).length() < FLAT
    })
}

/// A normal from its code.
pub(in crate::scene) fn decode(code: u32) -> [f64; 3] {
    octahedral::decode(Ux::splat(code)).lane(0).map(f64::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles of a square that share an edge.
    fn square() -> Imported {
        Imported {
            vertices: vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.0],
                [0.0, 1.0, 0.0],
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Imported::default()
        }
    }

    #[test]
    fn vertices_are_split_only_where_corners_disagree() {
        let mut seam = square();
        let corners = Corners {
            uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]],
            uv: vec![[0, 1, 2], [4, 2, 3]],
            ..Corners::default()
        };
        assert_eq!(weld(&mut seam, corners), 0);
        assert_eq!(seam.triangles, [[0, 1, 2], [4, 2, 3]]);
        assert_eq!(seam.vertices[4], seam.vertices[0]);
        assert_eq!(
            seam.uvs,
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]]
        );
        assert!(seam.normals.is_empty());
    }

    #[test]
    fn flat_normals_cost_nothing() {
        for z in [1.0, -1.0] {
            let mut flat = square();
            let corners = Corners {
                normals: vec![octahedral::encode([1e-4, 0.0, z])],
                normal: vec![[0; 3]; 2],
                ..Corners::default()
            };
            assert_eq!(weld(&mut flat, corners), 0);
            assert_eq!(flat.vertices.len(), 4);
            assert!(flat.normals.is_empty());
        }
    }

    #[test]
    fn smooth_beside_flat_and_indices_of_nothing() {
        let mut mixed = square();
        let tilted = octahedral::encode([1.0, 0.0, 1.0]);
        let corners = Corners {
            uvs: vec![[0.0, f32::NAN], [1.0, 1.0]],
            uv: vec![[0, 1, 1], [1, 1, 7]],
            normals: vec![tilted],
            normal: vec![[0; 3], [0, NONE, 0]],
        };
        assert_eq!(weld(&mut mixed, corners), 1);
        assert!(mixed.uvs.is_empty());
        // The second triangle is flat: it shares no vertex with the first.
        assert_eq!(mixed.triangles, [[0, 1, 2], [4, 5, 3]]);
        let none = Mesh::NO_NORMAL;
        assert_eq!(mixed.normals, [tilted, tilted, tilted, none, none, none]);
    }
}
