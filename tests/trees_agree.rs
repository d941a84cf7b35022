//! What rays meet does not depend on the tree: every preset gives the same hits, bit for bit, also
//! where triangles are equally near, and references that were cut let nothing through.

mod tracing;

use huygens::geometry::{Geometry, Preset};
use huygens::scene::Mesh;
use huygens_kernels::bvh::MAX_DEPTH;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::{Random, RaySet, bumpy_sphere, cube, meshes, moved, random_soup, soup};

/// Rays between points in and around the mesh's box; every other one is aimed at a vertex or an
/// edge.
fn rays(mesh: &Mesh, bounds: [[f32; 3]; 2], n: usize) -> RaySet {
    let mut random = Random(31);
    let mut rays = RaySet::default();
    let mut point = |random: &mut Random| -> [f32; 3] {
        let p = random.point();
        let [low, high] = bounds;
        std::array::from_fn(|a| low[a] + (high[a] - low[a]) * (0.5 + 0.6 * p[a]))
    };
    for i in 0..n {
        let origin = point(&mut random);
        let [a, b, _] = mesh.corners(random.below(mesh.triangles()));
        let target = match i % 4 {
            0 | 1 => point(&mut random),
            2 => a,
            _ => {
                let s = random.unit();
                std::array::from_fn(|k| a[k] + s * (b[k] - a[k]))
            }
        };
        rays.push(origin, std::array::from_fn(|k| target[k] - origin[k]));
        // Half of the segments end just before what they are aimed at.
        *rays.t_max.last_mut().unwrap() = if i % 2 == 0 { 1.0 - 1e-3 } else { f32::INFINITY };
    }
    rays
}

fn assert_alike(name: &str, mesh: &Mesh, n: usize) {
    let plain = Geometry::build_with(mesh, Preset::Fast);
    let rays = rays(mesh, plain.bounds().unwrap(), n);
    let (hits, occluded) = (rays.closest(&plain), rays.occluded(&plain));
    for preset in [Preset::Balanced, Preset::Best] {
        let other = Geometry::build_with(mesh, preset);
        assert!(other.depth() <= MAX_DEPTH, "{name}: {preset:?}");
        assert_eq!(other.bounds(), plain.bounds(), "{name}: {preset:?}");
        for (i, (a, b)) in hits.iter().zip(rays.closest(&other)).enumerate() {
            let same = a.primitive == b.primitive
                && (a.primitive == NO_PRIMITIVE
                    || [a.t, a.u, a.v].map(f32::to_bits) == [b.t, b.u, b.v].map(f32::to_bits));
            assert!(
                same,
                "{name}, {preset:?}, ray {i}: {a:?} and {b:?}, {:?} along {:?}",
                rays.origin[i], rays.direction[i]
            );
        }
        assert_eq!(rays.occluded(&other), occluded, "{name}: {preset:?}");
    }
}

#[test]
fn over_triangles_of_all_sizes() {
    assert_alike("soup", &random_soup(3000, 1), 40_000);
    for (i, scale) in [1e-6, 1e6, 1e-17, 1e17].into_iter().enumerate() {
        let mesh = moved(random_soup(1000, i as u64), scale, [0.0; 3]);
        assert_alike(&format!("soup times {scale}"), &mesh, 10_000);
    }
    for offset in [[100.0, -3.0, 0.0], [1e5, 1e5, -1e5]] {
        let mesh = moved(random_soup(1000, 2), 1.0, offset);
        assert_alike(&format!("soup at {offset:?}"), &mesh, 10_000);
    }
}

#[test]
fn over_long_and_thin_triangles() {
    assert_alike("clutter", &meshes::clutter(150), 40_000);
    assert_alike("sticks", &meshes::sticks(3000), 40_000);
    // Flattened along an axis, boxes have no inside.
    let mut flat = meshes::clutter(50);
    for p in &mut flat.vertices {
        p[1] = 0.0;
    }
    assert_alike("flat", &flat, 10_000);
}

#[test]
fn where_many_triangles_are_equally_near() {
    // The same mesh three times over, then a stack of coplanar ones of different shapes.
    let once = meshes::clutter(40);
    let mut thrice = once.clone();
    for _ in 0..2 {
        thrice.indices.extend(&once.indices);
        thrice.material.extend(&once.material);
    }
    assert_alike("three times", &thrice, 10_000);
    let mut random = Random(5);
    let stack: Vec<_> = (0..500)
        .map(|i| {
            [(); 3].map(|()| {
                let [x, y, _] = random.point();
                [x, y, [0.0, 0.5][i % 2]]
            })
        })
        .collect();
    assert_alike("coplanar", &soup(&stack), 10_000);
}

#[test]
fn over_huge_triangles_among_tiny_ones() {
    let mut triangles: Vec<[[f32; 3]; 3]> = Vec::new();
    let tiny = moved(bumpy_sphere(3, 0.1), 1e-3, [0.5, 0.25, 0.125]);
    triangles.extend((0..tiny.triangles()).map(|i| tiny.corners(i)));
    let mut random = Random(8);
    for _ in 0..200 {
        triangles.push([(); 3].map(|()| random.point().map(|p| 1e3 * p)));
    }
    assert_alike("huge and tiny", &soup(&triangles), 20_000);
}

/// From just above a huge triangle the test's rounding is large against distances: references that
/// were cut too tightly would lose rays here.
#[test]
fn a_long_beam_has_no_leaks_from_inside() {
    for (length, at) in [(1e3, 0.0), (1e5, 0.0), (1e3, 77.0)] {
        let mut beam = cube();
        for p in &mut beam.vertices {
            // Along no axis, so that its boxes overlap with those of the others.
            let [x, y, z] = [length * p[0], 0.01 * p[1], 0.01 * p[2]];
            *p = [0.6 * x - 0.8 * y + at, 0.8 * x + 0.6 * y, z + at];
        }
        // Others beside it make the builder cut.
        let mut all = meshes::clutter(30);
        let first = all.vertices.len() as u32;
        let closed = beam.triangles();
        all.vertices.extend(&beam.vertices);
        all.indices
            .extend(beam.indices.iter().map(|t| t.map(|i| i + first)));
        all.material.resize(all.indices.len(), 0);
        let geometry = Geometry::build_with(&all, Preset::Best);
        let mut random = Random(17);
        let mut rays = RaySet::default();
        for i in 0..60_000 {
            let [x, y, z] = random.point();
            let [x, y, z] = [0.999 * length * x, 0.0099 * y, 0.0099 * z];
            let origin = [0.6 * x - 0.8 * y + at, 0.8 * x + 0.6 * y, z + at];
            let corners = beam.corners(random.below(closed));
            let (d, s) = (random.point(), random.unit());
            rays.push(
                origin,
                std::array::from_fn(|k| match i % 3 {
                    0 => d[k],
                    1 => corners[0][k] + s * (corners[1][k] - corners[0][k]) - origin[k],
                    _ => {
                        let inside = corners[1][k] + s * (corners[2][k] - corners[1][k]);
                        corners[0][k] + d[0].abs() * (inside - corners[0][k]) - origin[k]
                    }
                }),
            );
        }
        let escaped = rays.closest(&geometry).iter().filter(|h| h.primitive == NO_PRIMITIVE).count();
        assert_eq!(escaped, 0, "of {} from inside a beam of {length} at {at}", rays.len());
    }
}
