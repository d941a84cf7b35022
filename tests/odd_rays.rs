//! Rays that are not rays, rays that start or end on something, and rays that go nowhere.

mod tracing;

use huygens::geometry::Geometry;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::{Random, RaySet, bumpy_sphere, cube, random_soup, soup};

#[test]
fn that_are_not_finite_meet_nothing() {
    let geometry = Geometry::build(&bumpy_sphere(3, 0.05));
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut rays = RaySet::default();
    for value in bad {
        for axis in 0..3 {
            let mut odd = [0.1, 0.2, 0.3];
            odd[axis] = value;
            rays.push(odd, [0.0, 0.0, 1.0]);
            rays.push([0.0; 3], odd);
        }
    }
    rays.push([0.0; 3], [0.0, -0.0, 0.0]);
    let hits = rays.closest(&geometry);
    assert!(hits.iter().all(|h| h.primitive == NO_PRIMITIVE), "{hits:?}");
    assert!(rays.occluded(&geometry).iter().all(|o| !o));
}

#[test]
fn that_are_not_finite_leave_their_neighbours_alone() {
    let geometry = Geometry::build(&bumpy_sphere(3, 0.05));
    let mut random = Random(31);
    let mut rays = RaySet::default();
    for _ in 0..1000 {
        rays.push([0.0; 3], random.point());
    }
    let expected = rays.closest(&geometry);
    for i in (0..1000).step_by(7) {
        rays.direction[i][1] = f32::NAN;
    }
    for (i, hit) in rays.closest(&geometry).into_iter().enumerate() {
        if i % 7 == 0 {
            assert_eq!(hit.primitive, NO_PRIMITIVE);
        } else {
            assert_eq!(hit, expected[i]);
        }
    }
}

#[test]
fn that_leave_a_triangle_do_not_hit_it() {
    let mesh = random_soup(1000, 12);
    let geometry = Geometry::build(&mesh);
    let mut random = Random(37);
    let mut rays = RaySet::default();
    for _ in 0..4000 {
        rays.push(random.point(), random.point());
    }
    // Take the hits away one after the other: what comes next is never nearer, never the same.
    let first = rays.closest(&geometry);
    rays.leaves = first.iter().map(|h| h.primitive).collect();
    let second = rays.closest(&geometry);
    let mut both = 0;
    for (a, b) in first.iter().zip(&second) {
        if a.primitive != NO_PRIMITIVE && b.primitive != NO_PRIMITIVE {
            assert!(b.primitive != a.primitive && b.t >= a.t, "{a:?} {b:?}");
            both += 1;
        }
    }
    assert!(both > 500);
    // Occlusion without either of the two, just beyond the second, sees neither.
    rays.t_max = second
        .iter()
        .map(|h| {
            if h.primitive == NO_PRIMITIVE {
                0.0
            } else {
                h.t.next_up()
            }
        })
        .collect();
    rays.reaches = second.iter().map(|h| h.primitive).collect();
    assert!(rays.occluded(&geometry).iter().all(|o| !o));
    // With the second back it does, where there is one.
    rays.reaches.fill(NO_PRIMITIVE);
    for (occluded, hit) in rays.occluded(&geometry).iter().zip(&second) {
        assert_eq!(*occluded, hit.primitive != NO_PRIMITIVE);
    }
}

#[test]
fn that_end_on_a_triangle_do_not_reach_it() {
    let geometry = Geometry::build(&cube());
    let mut rays = RaySet::default();
    for t_max in [
        0.5,
        1.0,
        1.0f32.next_up(),
        2.0,
        f32::INFINITY,
        0.0,
        -1.0,
        f32::NAN,
    ] {
        rays.push([0.0, 0.1, 0.2], [1.0, 0.0, 0.0]);
        *rays.t_max.last_mut().unwrap() = t_max;
    }
    // The interval is open: at 1 the wall itself is not in the way.
    let expected = [false, false, true, true, true, false, false, false];
    assert_eq!(rays.occluded(&geometry), expected);
}

#[test]
fn that_start_on_a_plane_do_not_hit_it() {
    let wall = soup(&[[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]]);
    let geometry = Geometry::build(&wall);
    let mut rays = RaySet::default();
    rays.push([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    rays.push([0.1, -0.2, 0.0], [0.3, 0.2, -1.0]);
    // In the plane of the triangle: seen edge-on, it is not there.
    rays.push([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let hits = rays.closest(&geometry);
    assert!(hits.iter().all(|h| h.primitive == NO_PRIMITIVE), "{hits:?}");
}

#[test]
fn of_any_length_hit_alike() {
    let geometry = Geometry::build(&random_soup(1000, 13));
    let mut random = Random(41);
    let mut one = RaySet::default();
    for _ in 0..500 {
        one.push(random.point(), random.point());
    }
    let expected = one.closest(&geometry);
    for exponent in [-100, -20, 3, 60, 120] {
        let scale = 2f32.powi(exponent);
        let mut scaled = one.clone();
        for direction in &mut scaled.direction {
            *direction = direction.map(|d| d * scale);
        }
        for (a, b) in expected.iter().zip(scaled.closest(&geometry)) {
            assert_eq!(a.primitive, b.primitive);
            if a.primitive != NO_PRIMITIVE {
                // Powers of two round nothing.
                assert_eq!((a.t / scale, a.u, a.v), (b.t, b.u, b.v));
            }
        }
    }
}
