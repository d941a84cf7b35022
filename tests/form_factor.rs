//! The direct light of a rectangle on a plane, against the closed-form form factor.

mod common;

use common::picture::mean_by_wave;
use common::scenes::{Builder, floor_from_above};
use common::statistics::assert_mean;
use huygens::settings::{Integrator, Settings, Strategy};
use std::f64::consts::PI;

/// Form factor from a plane element at the origin that faces up to the parallel rectangle
/// `x[0]..x[1]` by `z[0]..z[1]` at height `h`.
///
/// J. Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", configuration B-4
/// (rectangle with a corner above the element); other rectangles are sums and differences of such.
fn form_factor(x: [f32; 2], z: [f32; 2], h: f32) -> f64 {
    let corner = |a: f32, b: f32| {
        let (a, b) = (f64::from(a) / f64::from(h), f64::from(b) / f64::from(h));
        let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
        (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) / (2.0 * PI)
    };
    corner(x[1], z[1]) - corner(x[0], z[1]) - corner(x[1], z[0]) + corner(x[0], z[0])
}

/// Rectangles beside the camera, across it, and grazing.
const RECTANGLES: [([f32; 2], [f32; 2], f32); 3] = [
    ([0.3, 1.5], [-0.5, 0.8], 2.0),
    ([-1.0, 2.0], [-1.5, 0.5], 1.25),
    ([3.0, 9.0], [-2.0, 4.0], 1.5),
];

const ALBEDO: f32 = 0.6;
const RADIANCE: f32 = 5.0;

/// A rectangle that faces down.
fn add_light(b: &mut Builder, material: u32, (x, z, h): ([f32; 2], [f32; 2], f32)) {
    let corners = [
        [x[0], h, z[0]],
        [x[1], h, z[0]],
        [x[1], h, z[1]],
        [x[0], h, z[1]],
    ];
    b.quad(material, corners);
}

fn settings(strategy: Strategy) -> Settings {
    Settings {
        strategy,
        integrator: Integrator::Direct,
        spp: 16_384,
        ..Settings::default()
    }
}

#[test]
fn the_closed_form_is_the_integral() {
    for (x, z, h) in RECTANGLES {
        let (nx, nz) = (400, 400);
        let size = |r: [f32; 2], n: i32| f64::from(r[1] - r[0]) / f64::from(n);
        let h2 = f64::from(h).powi(2);
        let mut sum = 0.0;
        for i in 0..nx {
            for j in 0..nz {
                let at = |r: [f32; 2], n, k| f64::from(r[0]) + (f64::from(k) + 0.5) * size(r, n);
                let d2 = at(x, nx, i).powi(2) + at(z, nz, j).powi(2) + h2;
                sum += h2 / (PI * d2 * d2);
            }
        }
        let integral = sum * size(x, nx) * size(z, nz);
        // The midpoint rule's error is (step / distance)^2 to a small factor.
        let step = size(x, nx).max(size(z, nz)) / f64::from(h);
        assert!((integral / form_factor(x, z, h) - 1.0).abs() < step * step);
    }
}

#[test]
fn a_rectangle_lights_a_floor_by_its_form_factor() {
    for (strategy, rectangle) in [
        Strategy::Light,
        Strategy::Mis,
        Strategy::Cosine,
        Strategy::Uniform,
    ]
    .into_iter()
    .flat_map(|s| RECTANGLES.map(|r| (s, r)))
    {
        let mut b = Builder::new();
        let light = b.material([0.0; 3], [RADIANCE; 3]);
        add_light(&mut b, light, rectangle);
        let scene = floor_from_above(ALBEDO, b);
        let (x, z, h) = rectangle;
        let expected = f64::from(ALBEDO) * f64::from(RADIANCE) * form_factor(x, z, h);
        let mean = mean_by_wave(&scene, &settings(strategy));
        assert_mean(&format!("{strategy:?}, {rectangle:?}"), mean, expected, 12);
        if strategy == Strategy::Mis {
            let error = mean.variance.sqrt() / expected;
            assert!(error < 0.01, "an error of {error} would show nothing");
        }
    }
}

/// Lights of very different power, one of them two-sided and one with its back to the floor.
#[test]
fn several_lights_add_up() {
    for strategy in [Strategy::Light, Strategy::Mis, Strategy::Cosine] {
        let mut b = Builder::new();
        let [first, second, third] = RECTANGLES;
        let bright = b.material([0.0; 3], [20.0; 3]);
        let dim = b.material([0.0; 3], [0.5; 3]);
        b.two_sided();
        add_light(&mut b, bright, third);
        add_light(&mut b, dim, second);
        // Above the other lights, and facing up: its back is all that the floor could see.
        let (x, z, h) = first;
        let corners = [
            [x[0], h, z[1]],
            [x[1], h, z[1]],
            [x[1], h, z[0]],
            [x[0], h, z[0]],
        ];
        b.quad(bright, corners);
        let scene = floor_from_above(ALBEDO, b);
        let factor = |(x, z, h)| form_factor(x, z, h);
        let expected = f64::from(ALBEDO) * (20.0 * factor(third) + 0.5 * factor(second));
        let mean = mean_by_wave(&scene, &settings(strategy));
        assert_mean(&format!("{strategy:?}"), mean, expected, 3);
    }
}
