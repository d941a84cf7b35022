//! A ray that leaves a flat, tessellated surface must not meet the other triangles of its plane,
//! wherever the plane lies, however large it is, and however flat the ray is: the hazard is
//! shadow acne, and the guard is the error-bounded spawn offset, not an epsilon.

use glam::{DQuat, DVec3};
use huygens::geometry::Geometry;
use huygens::scene::Mesh;
use huygens_kernels::hemisphere::{sample_cosine, sample_uniform, to_world};
use huygens_kernels::lanes::{Fx, LANES, Ux, iota, padded};
use huygens_kernels::rays::{Hits, NO_PRIMITIVE, Rays};
use huygens_kernels::sampler::{Independent, Sampler};
use huygens_kernels::surface::Surface;
use huygens_kernels::tables::Triangles;
use huygens_kernels::vec3::Vec3x;

/// Squares of the sheet along each side.
const SIDE: u32 = 12;

/// A flat sheet of unequal triangles, `size` across, turned by `turn` and moved by `offset`. Its
/// vertices are rounded to f32, so it is flat to within that rounding only when it lies in an axis
/// plane: `turn` is one of the rotations that keep it there.
fn sheet(size: f64, turn: DQuat, offset: DVec3) -> Mesh {
    let at = |i: u32| {
        let t = f64::from(i) / f64::from(SIDE);
        (t * t * 0.5 + t * 0.5) * size
    };
    let mut mesh = Mesh::default();
    for y in 0..=SIDE {
        for x in 0..=SIDE {
            let p = turn * DVec3::new(at(x), at(y), 0.0) + offset;
            mesh.vertices.push(p.to_array().map(|c| c as f32));
        }
    }
    for y in 0..SIDE {
        for x in 0..SIDE {
            let i = y * (SIDE + 1) + x;
            mesh.indices.push([i, i + 1, i + SIDE + 1]);
            mesh.indices.push([i + 1, i + SIDE + 2, i + SIDE + 1]);
        }
    }
    mesh.material = vec![0; mesh.indices.len()];
    mesh
}

/// Rays from `n` points of the sheet towards one side of it; how many meet the sheet.
fn hits(mesh: &Mesh, towards: [f32; 3], n: usize, uniform: bool) -> usize {
    let triangles = Triangles {
        vertices: &mesh.vertices,
        indices: &mesh.indices,
        material: &mesh.material,
        others: None,
    };
    let sampler = Independent { seed: 7 };
    let size = padded(n);
    let mut columns: [Vec<f32>; 6] = std::array::from_fn(|_| vec![0.0; size]);
    let mut leaves = vec![0; size];
    for i in (0..size).step_by(LANES) {
        let lane = iota(i as u32);
        let [u, v, a, b] = sampler.draw4(lane, Ux::splat(0), Ux::splat(0));
        let [_, _, pick, _] = sampler.draw4(lane, Ux::splat(0), Ux::splat(1));
        let primitive = huygens_kernels::lanes::to_u32(pick * Fx::splat(mesh.triangles() as f32))
            .min(Ux::splat(mesh.triangles() as u32 - 1));
        // A path that came against `towards`.
        let surface = Surface::at(
            &triangles,
            primitive,
            u * (Fx::ONE - v),
            v,
            -Vec3x::splat(towards),
            || None,
        );
        // The second half as flat as the samplers can make them.
        let flat = if i < size / 2 {
            a
        } else {
            Fx::ONE - a * Fx::splat(1e-6)
        };
        let flat = flat.fast_min(Fx::splat(1.0 - 1.0 / 16_777_216.0));
        let local = if uniform {
            sample_uniform(flat, b)
        } else {
            sample_cosine(flat, b)
        };
        let direction = to_world(surface.normal, local);
        for lane in 0..LANES {
            let (o, d) = (surface.origin.lane(lane), direction.lane(lane));
            for c in 0..3 {
                columns[c][i + lane] = o[c];
                columns[3 + c][i + lane] = d[c];
            }
            leaves[i + lane] = primitive.as_array()[lane];
        }
    }
    let mut hit = vec![0; size];
    let (mut t, mut u, mut v) = (vec![0.0; size], vec![0.0; size], vec![0.0; size]);
    Geometry::build(mesh).closest(
        Rays {
            len: n,
            origin: [&columns[0], &columns[1], &columns[2]],
            direction: [&columns[3], &columns[4], &columns[5]],
            leaves: &leaves,
        },
        Hits {
            primitive: &mut hit,
            t: &mut t,
            u: &mut u,
            v: &mut v,
        },
    );
    hit[..n].iter().filter(|&&p| p != NO_PRIMITIVE).count()
}

#[test]
fn axis_planes_near_and_far_small_and_large() {
    let turns = [
        (DQuat::IDENTITY, [0.0, 0.0, 1.0f32]),
        (
            DQuat::from_xyzw(0.0, 1.0, 0.0, 1.0).normalize(),
            [1.0, 0.0, 0.0],
        ),
        (
            DQuat::from_xyzw(1.0, 0.0, 0.0, 1.0).normalize(),
            [0.0, 1.0, 0.0],
        ),
    ];
    for size in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for far in [0.0, 0.3, 1.0, 17.0, 1000.0] {
            for (turn, axis) in turns {
                let offset = DVec3::new(1.0, -0.7, 0.4) * far * size;
                let mesh = sheet(size, turn, offset);
                for side in [1.0, -1.0] {
                    for uniform in [true, false] {
                        let n = hits(&mesh, axis.map(|c| c * side), 2048, uniform);
                        assert_eq!(n, 0, "size {size}, offset {far} sizes, towards {axis:?}");
                    }
                }
            }
        }
    }
}
