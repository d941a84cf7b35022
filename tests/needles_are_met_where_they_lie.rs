//! The distance to a triangle is as exact on needles as on any other.

mod tracing;

use huygens::geometry::Geometry;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::{Random, RaySet, soup};

const U: f64 = 1.0 / 16_777_216.0;

type Vector = [f64; 3];

fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

/// The distance along the ray to the triangle's plane, and the bound of `kernels/src/triangle.rs`.
fn distance(corners: [[f32; 3]; 3], origin: [f32; 3], direction: [f32; 3]) -> (f64, f64) {
    let d = direction.map(f64::from);
    let [a, b, c] = corners.map(|p| sub(p.map(f64::from), origin.map(f64::from)));
    let normal = cross(sub(b, a), sub(c, a));
    let length = |v: Vector| dot(v, v).sqrt();
    let cos = dot(normal, d).abs() / (length(normal) * length(d));
    let size = [a, b, c]
        .iter()
        .flatten()
        .fold(0.0f64, |m, x| m.max(x.abs()));
    let bound = (7.1 / cos + 23.0) * U * size / length(d);
    (dot(normal, a) / dot(normal, d), bound)
}

/// A triangle 1 long and `width` wide somewhere, with an acute corner at one end or at both.
fn needle(random: &mut Random, width: f32) -> [[f32; 3]; 3] {
    let (at, along, across) = (random.point(), random.point(), random.point());
    let third = if random.bits() & 1 == 0 { 0.0 } else { 0.5 };
    let corner = |x: f32, y: f32| std::array::from_fn(|k| at[k] + x * along[k] + y * across[k]);
    [corner(0.0, 0.0), corner(1.0, 0.0), corner(third, width)]
}

#[test]
fn from_stout_ones_to_some_a_hundred_thousand_times_as_long_as_wide() {
    let mut random = Random(1);
    for fineness in [0, 4, 8, 10, 12, 14, 16] {
        let triangles: Vec<_> = (0..60)
            .map(|_| needle(&mut random, 0.5f32.powi(fineness)))
            .collect();
        let mesh = soup(&triangles);
        let mut rays = RaySet::default();
        for i in 0..6000 {
            // To a point inside of a triangle, so that the ray meets that one or another.
            let [a, b, c] = triangles[i % triangles.len()];
            let (u, v) = (random.unit(), random.unit());
            let (u, v) = (u.min(1.0 - v), v.min(1.0 - u));
            let origin = random.point().map(|x| 3.0 * x);
            let towards = |k: usize| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]) - origin[k];
            rays.push(origin, std::array::from_fn(towards));
        }
        let hits = rays.closest(&Geometry::build(&mesh));
        let (mut met, mut worst) = (0, 0.0f64);
        for (i, hit) in hits.iter().enumerate() {
            if hit.primitive == NO_PRIMITIVE {
                continue;
            }
            met += 1;
            let corners = mesh.corners(hit.primitive as usize);
            let (t, bound) = distance(corners, rays.origin[i], rays.direction[i]);
            let off = (f64::from(hit.t) - t).abs();
            assert!(
                off <= bound,
                "1 : 2^{fineness}, ray {i}: {hit:?} should be at {t} +- {bound}"
            );
            worst = worst.max(off / bound);
        }
        // Of the finest, rounding of the rays' own directions lets most pass by.
        assert!(met > 200, "1 : 2^{fineness}: only {met} met");
        println!("1 : 2^{fineness}: {met} met, worst {worst:.2} of the bound");
    }
}
