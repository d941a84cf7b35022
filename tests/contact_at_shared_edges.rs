//! A ray that starts in a plane, or as little above it as surfaces start rays, does not meet the
//! neighbour across an edge that it starts at: the distance's sign is right however near 0 it is.

mod tracing;

use huygens::geometry::Geometry;
use huygens::scene::Mesh;
use huygens_kernels::lanes::{Fx, Ux};
use huygens_kernels::rays::NO_PRIMITIVE;
use huygens_kernels::surface::{Corners, spawn};
use huygens_kernels::tables::Triangles;
use tracing::{Random, RaySet, mesh};

/// `n * n` squares of two triangles in the plane of `x` and `y`, `size` wide in all.
fn sheet(n: u32, size: f32, at: [f32; 3], x: [f32; 3], y: [f32; 3]) -> Mesh {
    let mut vertices = Vec::new();
    let mut indices = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let [u, v] = [i, j].map(|k| size * (k as f32 / n as f32 - 0.5));
            vertices.push(std::array::from_fn(|a| at[a] + (u * x[a] + v * y[a])));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let k = j * (n + 1) + i;
            indices.push([k, k + 1, k + n + 1]);
            indices.push([k + 1, k + n + 2, k + n + 1]);
        }
    }
    mesh(vertices, indices)
}

/// Rays from within a millionth of the longest edges, to both sides.
fn rays(mesh: &Mesh, n: usize) -> RaySet {
    let triangles = Triangles {
        vertices: &mesh.vertices,
        indices: &mesh.indices,
        material: &mesh.material,
    };
    let mut random = Random(61);
    let mut rays = RaySet::default();
    while rays.len() < n {
        let primitive = random.below(mesh.triangles()) as u32;
        let corners = Corners::gather(&triangles, Ux::splat(primitive));
        // On the edge from the second corner to the third, or on the third's, or just inside.
        let (along, off) = (
            random.unit(),
            1e-6 * random.unit() * (random.bits() & 1) as f32,
        );
        let (u, v) = if primitive & 1 == 0 {
            ((1.0 - along) * (1.0 - off), along * (1.0 - off))
        } else {
            (off, along * (1.0 - off))
        };
        let (p, s) = corners.point(Fx::splat(u), Fx::splat(v));
        let normal = corners.unit_normal();
        let normal = if rays.len() % 2 == 0 { normal } else { -normal };
        let origin = spawn(p, s, normal).lane(0);
        let normal = normal.lane(0);
        // Steep and flat, but not so flat that the direction's own rounding leads below the plane.
        let flat = 10f32.powi(-(random.below(4) as i32));
        let aside = random.point();
        let up: f32 = (0..3).map(|a| aside[a] * normal[a]).sum();
        let direction = std::array::from_fn(|a| aside[a] - up * normal[a] + flat * normal[a]);
        rays.push(origin, direction);
        let i = rays.len() - 1;
        rays.leaves[i] = primitive;
        rays.t_max[i] = 1e9;
    }
    rays
}

fn assert_free(name: &str, mesh: &Mesh) {
    let geometry = Geometry::build(mesh);
    let rays = rays(mesh, 3000);
    let (hits, occluded) = (rays.closest(&geometry), rays.occluded(&geometry));
    for (i, hit) in hits.iter().enumerate() {
        let ray = (rays.origin[i], rays.direction[i], rays.leaves[i]);
        assert_eq!(hit.primitive, NO_PRIMITIVE, "{name}: {ray:?}: {hit:?}");
        assert!(!occluded[i], "{name}: {ray:?}");
    }
}

#[test]
fn in_axis_planes() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Few triangles are tested without a tree, more with one.
    for n in [1, 6] {
        for size in [1e-3, 1.0, 1000.0] {
            for axis in 0..3 {
                let [x, y] = [axes[(axis + 1) % 3], axes[(axis + 2) % 3]];
                for height in [0.0, 0.25 * size, -7.3 * size] {
                    let at = axes[axis].map(|a| a * height);
                    let name = format!("{n}, {size}, axis {axis}, {height}");
                    assert_free(&name, &sheet(n, size, at, x, y));
                }
            }
        }
    }
}

#[test]
fn in_tilted_planes() {
    let mut random = Random(62);
    for n in [1, 6] {
        for i in 0..12 {
            // Multiples of an eighth, so that the sheet is flat to the last bit.
            let eighths = |x: f32| (8.0 * x).round() / 8.0;
            let [x, y, at] = [(); 3].map(|()| random.point().map(eighths));
            let across: f32 = (0..3)
                .map(|a| (x[(a + 1) % 3] * y[(a + 2) % 3] - x[(a + 2) % 3] * y[(a + 1) % 3]).abs())
                .sum();
            if across > 0.2 {
                let size = 6.0 * 2f32.powi(i - 4);
                assert_free(
                    &format!("{n}, {i}"),
                    &sheet(n, size, at.map(|a| a * size), x, y),
                );
            }
        }
    }
}
