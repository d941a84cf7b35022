//! Directions with zero components of either sign, and components too small to invert, are
//! ordinary: they meet what any other direction would meet.

mod tracing;

use huygens::geometry::Geometry;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::{Random, RaySet, bumpy_sphere, cube, moved, oracle, random_soup};

/// Every direction with components of -1, -0, 0 and 1, and with the smallest numbers there are.
fn directions() -> Vec<[f32; 3]> {
    let values = [-1.0, -0.0, 0.0, 1.0, 1e-30, -1e-38, 1e-45, -1e-45];
    let mut all = Vec::new();
    for x in values {
        for y in values {
            for z in values {
                if [x, y, z].iter().any(|&c: &f32| c != 0.0) {
                    all.push([x, y, z]);
                }
            }
        }
    }
    all
}

#[test]
fn match_brute_force() {
    let meshes = [
        cube(),
        random_soup(400, 8),
        bumpy_sphere(2, 0.1),
        moved(cube(), 0.5, [0.0, 0.5, 0.0]),
    ];
    let mut random = Random(3);
    for (m, mesh) in meshes.iter().enumerate() {
        let mut rays = RaySet::default();
        for direction in directions() {
            // Among them origins in the planes of the cube's faces and boxes.
            rays.push([0.0; 3], direction);
            rays.push([-0.0, 1.0, -3.0], direction);
            rays.push(random.point(), direction);
        }
        let hits = rays.closest(&Geometry::build(mesh));
        for (i, &hit) in hits.iter().enumerate() {
            if let Err(why) = oracle::check(mesh, &rays, i, hit) {
                panic!("mesh {m}, direction {:?}: {why}", rays.direction[i]);
            }
        }
    }
}

#[test]
fn hit_what_positive_zeros_hit() {
    let geometry = Geometry::build(&random_soup(2000, 9));
    let mut random = Random(4);
    let (mut negative, mut positive) = (RaySet::default(), RaySet::default());
    for i in 0..3000 {
        let origin = random.point();
        let mut direction = random.point();
        direction[i % 3] = -0.0;
        if i % 2 == 0 {
            direction[(i + 1) % 3] = -0.0;
        }
        negative.push(origin, direction);
        positive.push(origin, direction.map(|d| d + 0.0));
    }
    let (a, b) = (negative.closest(&geometry), positive.closest(&geometry));
    assert!(a.iter().filter(|h| h.primitive != NO_PRIMITIVE).count() > 500);
    for i in 0..negative.len() {
        assert_eq!(a[i].primitive, b[i].primitive, "ray {i}");
        if a[i].primitive != NO_PRIMITIVE {
            assert_eq!(a[i], b[i], "ray {i}");
        }
    }
    assert_eq!(negative.occluded(&geometry), positive.occluded(&geometry));
}

#[test]
fn that_graze_a_box_still_enter_it() {
    // A triangle in the plane x = 0 and a ray in the plane of its edge: the boxes' slabs are flat,
    // and contain the origin.
    let mesh = tracing::soup(&[
        [[0.0, -1.0, 2.0], [1.0, 1.0, 2.0], [0.0, 1.0, 2.0]],
        [[0.0, -1.0, 3.0], [-1.0, 1.0, 3.0], [0.0, 1.0, 3.0]],
    ]);
    let geometry = Geometry::build(&mesh);
    for zero in [0.0, -0.0] {
        let mut rays = RaySet::default();
        rays.push([0.0, 0.0, 0.0], [zero, zero, 1.0]);
        rays.push([-0.0, 0.0, 4.0], [zero, zero, -1.0]);
        let hits = rays.closest(&geometry);
        assert_eq!((hits[0].primitive, hits[0].t), (0, 2.0));
        assert_eq!((hits[1].primitive, hits[1].t), (1, 1.0));
    }
}
