//! A closed sphere of small triangles, in and out of which hills and valleys are moved.

use glam::{DVec3, Vec3};
use huygens::scene::Mesh;
use rayon::prelude::*;

/// An icosahedron whose triangles are cut in four `level` times, `20 * 4^level` of them, and whose
/// vertices are moved along their radius by a few octaves of noise. Closed: neighbours share
/// vertices.
pub(crate) fn displaced(level: u32) -> Mesh {
    let (mut vertices, mut indices) = icosahedron();
    for _ in 0..level {
        (vertices, indices) = cut(vertices, &indices);
    }
    let vertices: Vec<[f32; 3]> = vertices
        .par_iter()
        .map(|&p| {
            let hills = 0.9 * octaves(p * 2.5 + 3.0, 3) + 0.25 * octaves(p * 14.0, 6);
            (p * (1.0 + hills)).as_vec3().to_array()
        })
        .collect();
    Mesh {
        material: vec![0; indices.len()],
        vertices,
        indices,
        ..Mesh::default()
    }
}

/// On the unit sphere, fronts outside.
fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let g = 0.5 * (1.0 + 5f64.sqrt());
    let signs = [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)];
    let planes: [fn(f64, f64) -> DVec3; 3] = [
        |a, b| DVec3::new(a, b, 0.0),
        |a, b| DVec3::new(0.0, a, b),
        |a, b| DVec3::new(b, 0.0, a),
    ];
    let vertices = planes
        .iter()
        .flat_map(|plane| signs.map(|(a, b)| plane(a, b).normalize()));
    #[rustfmt::skip]
    let indices = vec![
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
        [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
        [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
        [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ];
    (vertices.collect(), indices)
}

/// Cuts each triangle in four.
///
/// The middle of an edge is found again through its lower vertex: none has more than six edges, so
/// six places a vertex are enough, and there is nothing to hash.
fn cut(mut vertices: Vec<DVec3>, indices: &[[u32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    const FREE: (u32, u32) = (u32::MAX, 0);
    let mut middles = vec![[FREE; 6]; vertices.len()];
    let mut middle = |a: u32, b: u32| {
        let (low, high) = (a.min(b), a.max(b));
        let place = middles[low as usize]
            .iter_mut()
            .find(|(to, _)| *to == high || *to == FREE.0)
            .expect("at most six edges a vertex");
        if place.0 == FREE.0 {
            let p = (vertices[low as usize] + vertices[high as usize]).normalize();
            *place = (high, vertices.len() as u32);
            vertices.push(p);
        }
        place.1
    };
    let mut finer = Vec::with_capacity(4 * indices.len());
    for &[a, b, c] in indices {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    (vertices, finer)
}

/// `n` octaves of value noise, between about -1 and 1.
fn octaves(mut p: DVec3, n: u32) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.5);
    for _ in 0..n {
        sum += weight * noise(p);
        p = p * 2.03 + 7.1;
        weight *= 0.5;
    }
    sum
}

/// Smooth between the hashes of lattice points, in `[-1, 1)`.
fn noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let w = f * f * (DVec3::splat(3.0) - 2.0 * f);
    let at = |corner: u32| {
        let bit = |axis: u32| f64::from(corner >> axis & 1);
        lattice(cell + DVec3::new(bit(0), bit(1), bit(2)))
    };
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let row = |corner: u32| mix(at(corner), at(corner + 1), w.x);
    mix(mix(row(0), row(2), w.y), mix(row(4), row(6), w.y), w.z)
}

fn lattice(p: DVec3) -> f64 {
    let [x, y, z] = [p.x, p.y, p.z].map(|c| c as i32 as u32);
    let mut h =
        x.wrapping_mul(0x8da6_b343) ^ y.wrapping_mul(0xd816_3841) ^ z.wrapping_mul(0xcb1a_b31f);
    h = (h ^ (h >> 13)).wrapping_mul(0x5bd1_e995);
    h ^= h >> 15;
    f64::from(h & 0x00ff_ffff) / 8_388_608.0 - 1.0
}

/// Where to look at it from.
pub(crate) const EYE: Vec3 = Vec3::new(2.2, 1.2, 2.6);

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn the_sphere_is_closed() {
        let mesh = displaced(4);
        assert_eq!(mesh.triangles(), 20 * 4usize.pow(4));
        // Each edge is walked once in each direction, and Euler's formula holds for a sphere.
        let mut walked = HashMap::new();
        for &[a, b, c] in &mesh.indices {
            for edge in [(a, b), (b, c), (c, a)] {
                *walked.entry(edge).or_insert(0) += 1;
            }
        }
        for (&(a, b), &times) in &walked {
            assert_eq!((times, walked.get(&(b, a))), (1, Some(&1)), "edge {a} {b}");
        }
        let edges = walked.len() / 2;
        assert_eq!(mesh.vertices.len() + mesh.triangles(), edges + 2);
    }

    #[test]
    fn the_middle_is_inside() {
        for p in displaced(5).vertices {
            assert!(Vec3::from_array(p).length() > 0.25, "{p:?}");
        }
    }
}
