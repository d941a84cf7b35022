//! Light from spheres: where samples lie, and what they are worth, from all distances.

use huygens_kernels::instance::Guide;
use huygens_kernels::lanes::{Fx, Ux};
use huygens_kernels::light::Departure;
use huygens_kernels::others::Others;
use huygens_kernels::rays::NO_PRIMITIVE;
use huygens_kernels::sphere::Sphere;
use huygens_kernels::sphere_light::{pdf, sample};
use huygens_kernels::surface::Anchor;
use huygens_kernels::tables::{Lights, Materials, SLOTS, Tables, Triangles};
use huygens_kernels::vec3::Vec3x;
use std::f64::consts::PI;

const ONE: &[f32] = &[1.0];

/// Calls `test` with tables of one light, a sphere of radius `r` whose centre is `h` above the
/// origin, and with the origin of a floor.
fn with_lamp(h: f32, r: f32, test: impl Fn(&Tables, &Others, &Anchor)) {
    let centre = [0.0, h, 0.0];
    let spheres = [Sphere { centre, radius: r }];
    let guide = Guide::default();
    let others = Others {
        first: 0,
        spheres: &spheres,
        sphere_material: &[0],
        sphere_selection: ONE,
        sphere_turns: &[],
        instances: &[],
        motions: &[],
        guide: &guide,
        objects: &[],
    };
    let tables = Tables {
        triangles: Triangles {
            others: Some(others),
            ..Triangles::default()
        },
        materials: Materials {
            albedo: [ONE; 3],
            parameters: [ONE; SLOTS],
            emission: [ONE; 3],
            two_sided: &[u32::MAX],
            area_pdf: &[0.0],
        },
        lights: Lights {
            keep: ONE,
            alias: &[0],
            source: &[0],
            ..Lights::default()
        },
        ..Tables::default()
    };
    let anchor = Anchor {
        point: Vec3x::splat([0.0; 3]),
        normal: Vec3x::splat([0.0, 1.0, 0.0]),
        clearance: Fx::ZERO,
        both_sides: Fx::ZERO,
    };
    test(&tables, &others, &anchor);
}

/// Numbers in the middle of cells, and at both ends of what a sampler gives.
fn numbers(n: usize) -> impl Iterator<Item = f32> + Clone {
    (0..n).map(move |i| (i as f32 + 0.5) / n as f32)
}

#[test]
fn irradiance_is_the_form_factor_near_and_far() {
    let n = 64;
    for (h, r) in [
        (1.0001f32, 1.0f32),
        (1.01, 1.0),
        (2.0, 1.0),
        (50.0, 1.0),
        (1e6, 1.0),
        (1e-3, 1e-6),
        (3e18, 1e15),
    ] {
        with_lamp(h, r, |tables, others, anchor| {
            let mut sum = 0.0;
            for (u, v) in numbers(n).flat_map(|u| numbers(n).map(move |v| (u, v))) {
                let s = sample(tables, others, anchor, Ux::ZERO, Fx::splat(u), Fx::splat(v));
                assert_eq!(s.valid.to_bitmask(), 0xff, "h {h}, r {r}, u {u}, v {v}");
                sum += f64::from(s.direction.lane(0)[1] / s.pdf.as_array()[0]);
            }
            let factor = sum / (n * n) as f64 / PI;
            // (r / h)^2: J. Howell, "A Catalog of Radiation Heat Transfer Configuration Factors",
            // B-35. In u the integrand is linear, so the midpoints lose nothing. Rounding: that of
            // a dozen operations, and where the floor nearly touches that of 1 - (r / h)^2, which
            // under the root counts at most eps h / (h - r).
            let expected = (f64::from(r) / f64::from(h)).powi(2);
            let gap = f64::from(h / (h - r));
            let bound = f64::from(f32::EPSILON) * (16.0 + gap);
            let off = (factor / expected - 1.0).abs();
            assert!(off <= bound, "h {h}, r {r}: {factor} for {expected}");
        });
    }
}

#[test]
fn what_is_sampled_is_on_the_sphere_and_has_the_pdf_of_what_is_found() {
    let ends = [0.0, f32::EPSILON, 0.3, 0.75, 1.0 - 0.5 * f32::EPSILON];
    for (h, r) in [
        (2.0f32, 1.0f32),
        (1e4, 1.0),
        (0.5, 1.0),
        (0.0, 1.0),
        (1.0, 1e-5),
    ] {
        with_lamp(h, r, |tables, others, anchor| {
            for (u, v) in ends.into_iter().flat_map(|u| ends.map(|v| (u, v))) {
                let s = sample(tables, others, anchor, Ux::ZERO, Fx::splat(u), Fx::splat(v));
                let inside = h < r;
                let t = f64::from(s.t_max.as_array()[3]);
                let d = s.direction.lane(3).map(f64::from);
                let from = [t * d[0], t * d[1] - f64::from(h), t * d[2]];
                let distance = from.iter().map(|c| c * c).sum::<f64>().sqrt();
                let (radius, height) = (f64::from(r), f64::from(h));
                // Before the sphere, or within it from inside, by no more than rounding; at the
                // edge of the disc the depth hangs on the root of that.
                let short = 64.0 * f64::from(f32::EPSILON) * (height + radius);
                let depth = (2.0 * radius * short).sqrt() + short;
                assert!(
                    (distance - radius).abs() <= depth,
                    "h {h}, u {u}, v {v}: {distance}"
                );
                if inside {
                    assert!(
                        distance < radius,
                        "h {h}, u {u}, v {v}: the end lies outside"
                    );
                }
                assert_eq!(s.valid.to_bitmask(), 0xff, "h {h}, u {u}, v {v}");
                let expected = if inside { NO_PRIMITIVE } else { 0 };
                assert_eq!(s.primitive.as_array()[3], expected);
                let found = Departure {
                    origin: anchor.point,
                    direction: s.direction,
                    leaves: Ux::splat(NO_PRIMITIVE),
                    both_sides: Fx::ZERO,
                };
                let found = pdf(others, &found, Ux::ZERO);
                assert_eq!(found.as_array(), s.pdf.as_array());
                if inside {
                    let all = f64::from(s.pdf.as_array()[0]) * 4.0 * PI;
                    assert!((all - 1.0).abs() <= 8.0 * f64::from(f32::EPSILON));
                }
            }
        });
    }
}
