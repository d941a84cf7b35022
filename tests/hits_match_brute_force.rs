//! The closest hit is the true one, to within what f32 can know.

mod tracing;

use huygens::geometry::Geometry;
use huygens::scene::Mesh;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::{Random, RaySet, bumpy_sphere, cube, moved, oracle, random_soup};

fn rays_through(scale: f32, offset: [f32; 3], n: usize) -> RaySet {
    let mut random = Random(17);
    let mut rays = RaySet::default();
    for i in 0..n {
        let p = random.point();
        let origin = std::array::from_fn(|a| offset[a] + scale * 1.5 * p[a]);
        // Lengths from 1e-10 to 1e10: directions need not be normalised.
        let length = 10f32.powi((i % 21) as i32 - 10);
        rays.push(origin, random.point().map(|d| d * length));
    }
    rays
}

fn assert_agreement(name: &str, mesh: &Mesh, rays: &RaySet) {
    let geometry = Geometry::build(mesh);
    let hits = rays.closest(&geometry);
    let occluded = rays.occluded(&geometry);
    let mut met = 0;
    for (i, &hit) in hits.iter().enumerate() {
        if let Err(why) = oracle::check(mesh, rays, i, hit) {
            panic!("{name}: {why}");
        }
        assert_eq!(
            occluded[i],
            hit.primitive != NO_PRIMITIVE,
            "{name}: ray {i}"
        );
        if hit.primitive != NO_PRIMITIVE {
            met += 1;
            assert_on_ray(name, mesh, rays, i, hit);
        }
    }
    let share = f64::from(met) / rays.len() as f64;
    assert!(
        (0.1..0.99).contains(&share),
        "{name}: {share} of the rays hit"
    );
}

/// The barycentric weights name a point of the triangle, at the distance stated.
fn assert_on_ray(name: &str, mesh: &Mesh, rays: &RaySet, i: usize, hit: tracing::Hit) {
    let corners = mesh.corners(hit.primitive as usize);
    let (u, v, t) = (f64::from(hit.u), f64::from(hit.v), f64::from(hit.t));
    // Two divisions and a sum, each rounded by at most 2^-24 of 1.
    let over = 4.0 / 16_777_216.0;
    assert!(
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 + over,
        "{name}: ray {i}: {hit:?}"
    );
    let verdict = oracle::judge(corners, rays.origin[i], rays.direction[i]);
    let mut size = 0.0f64;
    let mut apart = 0.0f64;
    for a in 0..3 {
        let (o, d) = (
            f64::from(rays.origin[i][a]),
            f64::from(rays.direction[i][a]),
        );
        let [p, q, r] = corners.map(|c| f64::from(c[a]));
        let on_triangle = (1.0 - u - v) * p + u * q + v * r;
        apart = apart.max((on_triangle - (o + t * d)).abs() - verdict.error * d.abs());
        size = size.max(p.abs().max(q.abs()).max(r.abs()) + o.abs());
    }
    // The sheared corners' rounding (at most 4 of 2^-24, twice for the two ends of an edge),
    // against the size of what was subtracted; seen edge-on, the weights tell less, and the oracle
    // says how much less for the distance along the ray.
    let bound = 16.0 * size / 16_777_216.0;
    assert!(
        apart <= bound,
        "{name}: ray {i}: {apart} apart, bound {bound}: {hit:?}"
    );
}

#[test]
fn in_a_soup_of_all_sizes() {
    assert_agreement(
        "soup",
        &random_soup(2000, 1),
        &rays_through(1.0, [0.0; 3], 1500),
    );
}

#[test]
fn in_a_sphere_and_a_cube() {
    assert_agreement(
        "sphere",
        &bumpy_sphere(3, 0.1),
        &rays_through(1.0, [0.0; 3], 1500),
    );
    assert_agreement("cube", &cube(), &rays_through(1.0, [0.0; 3], 3000));
}

#[test]
fn at_scales_from_a_millionth_to_a_million() {
    for scale in [1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6] {
        let mesh = moved(random_soup(500, 2), scale, [0.0; 3]);
        assert_agreement(
            &format!("scale {scale}"),
            &mesh,
            &rays_through(scale, [0.0; 3], 500),
        );
    }
}

#[test]
fn far_from_the_origin() {
    let offset = [1000.0, -3000.0, 2000.0];
    let mesh = moved(random_soup(500, 3), 1.0, offset);
    assert_agreement("far", &mesh, &rays_through(1.0, offset, 500));
}

#[test]
fn at_scales_where_products_overflow_or_vanish() {
    for scale in [1e-30, 1e-20, 1e16, 1e25] {
        let mesh = moved(random_soup(200, 4), scale, [0.0; 3]);
        let mut rays = rays_through(scale, [0.0; 3], 300);
        for direction in &mut rays.direction {
            let longest = direction.iter().fold(0.0f32, |m, d| m.max(d.abs()));
            *direction = direction.map(|d| d / longest);
        }
        assert_agreement(&format!("scale {scale}"), &mesh, &rays);
    }
}

#[test]
fn equally_near_triangles_give_the_smallest_index() {
    // Five copies of a soup, shuffled into different leaves.
    let one = random_soup(300, 5);
    let mut all = one.clone();
    for _ in 0..4 {
        all.indices.extend_from_slice(&one.indices);
        all.material.extend_from_slice(&one.material);
    }
    let rays = rays_through(1.0, [0.0; 3], 2000);
    let expected = rays.closest(&Geometry::build(&one));
    let found = rays.closest(&Geometry::build(&all));
    for (i, (a, b)) in expected.iter().zip(&found).enumerate() {
        assert_eq!(a.primitive, b.primitive, "ray {i}");
        if a.primitive != NO_PRIMITIVE {
            assert_eq!(a, b, "ray {i}");
        }
    }
}
