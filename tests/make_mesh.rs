//! The generated meshes are what their header says: closed, and the same each time.

#[allow(dead_code, reason = "its main is that of a program")]
#[path = "../examples/make_mesh.rs"]
mod make_mesh;

use make_mesh::Icosphere;
use std::collections::HashSet;

#[test]
fn an_icosphere_is_closed_and_faces_outwards() {
    for n in 1..8 {
        let sphere = Icosphere { n };
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        let mut keep = |v| {
            vertices.push(v);
            Ok(())
        };
        sphere.vertices(&mut keep).unwrap();
        let mut keep = |t| {
            triangles.push(t);
            Ok(())
        };
        sphere.triangles(&mut keep).unwrap();
        assert_eq!(vertices.len() as u64, 10 * n * n + 2);
        assert_eq!(triangles.len() as u64, 20 * n * n);
        let edges: HashSet<[u32; 2]> = triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .collect();
        assert_eq!(
            edges.len(),
            3 * triangles.len(),
            "an edge runs one way once"
        );
        assert!(
            edges.iter().all(|&[a, b]| edges.contains(&[b, a])),
            "and the other way once"
        );
        let distinct: HashSet<_> = vertices.iter().map(|v| v.map(f32::to_bits)).collect();
        assert_eq!(distinct.len(), vertices.len());
        let volume: f64 = triangles
            .iter()
            .map(|t| {
                let corner = |i: u32| glam::DVec3::from_array(vertices[i as usize].map(f64::from));
                let [a, b, c] = t.map(corner);
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        // Between the octahedron's and the sphere's of the largest displaced radius.
        assert!((1.0..6.0).contains(&volume), "{volume}");
    }
}
