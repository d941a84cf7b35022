//! What rays meet does not depend on the tree: every preset gives the same hits, bit for bit, also
//! where triangles are equally near, and references that were cut lose no ray.

mod tracing;

use huygens::geometry::{Geometry, Preset};
use huygens::scene::Mesh;
use huygens_kernels::bvh::MAX_DEPTH;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::{Hit, Random, RaySet, bumpy_sphere, cube, meshes, moved, random_soup, soup};

/// Rays between points in and around the mesh's box; every other one is aimed at a vertex or an
/// edge.
fn rays(mesh: &Mesh, bounds: [[f32; 3]; 2], n: usize) -> RaySet {
    let mut random = Random(31);
    let mut rays = RaySet::default();
    let point = |random: &mut Random| -> [f32; 3] {
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
        *rays.t_max.last_mut().unwrap() = if i % 2 == 0 {
            1.0 - 1e-3
        } else {
            f32::INFINITY
        };
    }
    rays
}

fn assert_same(name: &str, rays: &RaySet, plain: &[Hit], other: &[Hit]) {
    for (i, (a, b)) in plain.iter().zip(other).enumerate() {
        let bits = |hit: &Hit| [hit.t, hit.u, hit.v].map(f32::to_bits);
        let same =
            a.primitive == b.primitive && (a.primitive == NO_PRIMITIVE || bits(a) == bits(b));
        assert!(
            same,
            "{name}, ray {i}: {a:?} and {b:?}, {:?} along {:?}",
            rays.origin[i], rays.direction[i]
        );
    }
}

fn assert_alike(name: &str, mesh: &Mesh, n: usize) {
    let plain = Geometry::build_with(mesh, Preset::Fast);
    let rays = rays(mesh, plain.bounds().unwrap(), n);
    let (hits, occluded) = (rays.closest(&plain), rays.occluded(&plain));
    for preset in [Preset::Balanced, Preset::Best] {
        let other = Geometry::build_with(mesh, preset);
        assert!(other.depth() <= MAX_DEPTH, "{name}: {preset:?}");
        assert_eq!(other.bounds(), plain.bounds(), "{name}: {preset:?}");
        assert_same(
            &format!("{name}, {preset:?}"),
            &rays,
            &hits,
            &rays.closest(&other),
        );
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
    // The same mesh three times over: distances are equal to the last bit. (Not so the distances at
    // which boxes around large triangles are entered: the triangle test is off by more than their
    // slack where a triangle is far larger than its distance, so there are none here.)
    let once = random_soup(1000, 3);
    let mut thrice = once.clone();
    for _ in 0..2 {
        thrice.indices.extend(&once.indices);
        thrice.material.extend(&once.material);
    }
    assert_alike("three times", &thrice, 10_000);
}

#[test]
fn in_a_stack_of_coplanar_triangles() {
    // Seen along z, all corners of a triangle are equally far, and the weighted mean of their
    // distances is off by a few roundings at most, which is less than the slack of boxes. (Seen
    // aslant, distances of crossing triangles differ by more than that, and which is nearer is not
    // determined.)
    let mut random = Random(5);
    let stack: Vec<_> = (0..500)
        .map(|i| {
            [(); 3].map(|()| {
                let [x, y, _] = random.point();
                [x, y, [0.0, 0.5][i % 2]]
            })
        })
        .collect();
    let mesh = soup(&stack);
    let mut rays = RaySet::default();
    for _ in 0..10_000 {
        let [x, y, z] = random.point();
        rays.push([x, y, 2.0 * z], [0.2 * x * y, 0.1 * y, -1.0]);
    }
    let plain = rays.closest(&Geometry::build_with(&mesh, Preset::Fast));
    for preset in [Preset::Balanced, Preset::Best] {
        let hits = rays.closest(&Geometry::build_with(&mesh, preset));
        assert_same(&format!("{preset:?}"), &rays, &plain, &hits);
    }
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

/// Inside a long beam, distances are small against the triangles' size. (The triangle test computes
/// them to about 2^-24 of length over width, squared, of the width; a beam 100 times as long as
/// wide leaves them good to a thousandth.)
#[test]
fn a_long_beam_has_no_leaks() {
    for (length, at) in [(1e3, 0.0), (1e5, 0.0), (1e3, 77.0)] {
        let thin = 1e-2 * length;
        // Along no axis, so that boxes of whole triangles are nearly empty.
        let turned = |[x, y, z]: [f32; 3]| [0.6 * x - 0.8 * y + at, 0.8 * x + 0.6 * y, z + at];
        let mut beam = cube();
        for p in &mut beam.vertices {
            *p = turned([length * p[0], thin * p[1], thin * p[2]]);
        }
        // Others beside it make the builder cut.
        let mut all = meshes::clutter(30);
        let first = all.vertices.len() as u32;
        all.vertices.extend(&beam.vertices);
        all.indices
            .extend(beam.indices.iter().map(|t| t.map(|i| i + first)));
        all.material.resize(all.indices.len(), 0);
        let mut random = Random(17);
        let mut rays = RaySet::default();
        for i in 0..30_000 {
            let [x, y, z] = random.point();
            let origin = turned([0.99 * length * x, 0.98 * thin * y, 0.98 * thin * z]);
            let [a, b, _] = beam.corners(random.below(beam.triangles()));
            let (d, s) = (random.point(), random.unit());
            let on_edge = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) - origin[k]);
            rays.push(origin, if i % 2 == 0 { d } else { on_edge });
        }
        for preset in [Preset::Balanced, Preset::Best] {
            let hits = rays.closest(&Geometry::build_with(&all, preset));
            let escaped = hits.iter().filter(|h| h.primitive == NO_PRIMITIVE).count();
            assert_eq!(escaped, 0, "{preset:?}, a beam of {length} at {at}");
        }
    }
}
