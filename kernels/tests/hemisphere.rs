//! Directions on the hemisphere: are they distributed as their pdfs say, and are they sound?

mod common;

use common::{CORNERS, Source, Suite, integrate};
use huygens_kernels::hemisphere::{
    UNIFORM_PDF, cosine_pdf, sample_cosine, sample_uniform, to_world,
};
use huygens_kernels::lanes::{Fx, LANES};
use huygens_kernels::vec3::Vec3x;
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Half a unit in the last place of 1: one rounding.
const ROUNDING: f64 = 1.0 / 16_777_216.0;
/// Bound of `math::sin_cos_turn`.
const SIN_COS: f64 = 1.2e-7;

type Sample = fn(Fx, Fx) -> Vec3x;
type Pdf = fn(f64) -> f64;

fn uniform_pdf_at(_cos: f64) -> f64 {
    f64::from(UNIFORM_PDF)
}

fn cosine_pdf_at(cos: f64) -> f64 {
    f64::from(cosine_pdf(Fx::splat(cos as f32)).as_array()[0])
}

/// Each strategy: its name, its kernel, its pdf as the kernels compute it.
const STRATEGIES: [(&str, Sample, Pdf); 2] = [
    ("uniform", sample_uniform, uniform_pdf_at),
    ("cosine", sample_cosine, cosine_pdf_at),
];

#[test]
fn pdfs_integrate_to_one() {
    for (name, _, pdf) in STRATEGIES {
        // The solid angle of a ring is 2 pi d(cos theta). Simpson is exact for these; what is left
        // is the rounding of 1/pi, of the cosine and of their product.
        let integral = TAU * integrate(pdf, 0.0, 1.0);
        assert!(
            (integral - 1.0).abs() < 3.0 * ROUNDING,
            "{name}: {integral}"
        );
    }
}

#[test]
fn samples_follow_their_pdf() {
    const RINGS: usize = 24;
    const SECTORS: usize = 32;
    const DRAWS: usize = 1 << 20;
    let mut suite = Suite::default();
    for (name, sample, pdf) in STRATEGIES {
        let mut source = Source(11);
        let mut observed = [0u64; RINGS * SECTORS];
        for _ in 0..DRAWS / LANES {
            let w = sample(source.unit_lanes(), source.unit_lanes());
            for lane in 0..LANES {
                let [x, y, z] = w.lane(lane).map(f64::from);
                let turn = (y.atan2(x) / TAU).rem_euclid(1.0);
                let ring = ((z * RINGS as f64) as usize).min(RINGS - 1);
                let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
                observed[ring * SECTORS + sector] += 1;
            }
        }
        let expected: Vec<f64> = (0..RINGS * SECTORS)
            .map(|cell| {
                let at = |ring: usize| ring as f64 / RINGS as f64;
                let ring = cell / SECTORS;
                let share = integrate(pdf, at(ring), at(ring + 1)) * TAU / SECTORS as f64;
                share * DRAWS as f64
            })
            .collect();
        suite.test(name, &observed, &expected);
    }
    suite.finish();
}

/// Asserts that lane `lane` of `w` is a direction that a pdf may be divided for.
fn assert_sound(name: &str, w: Vec3x, lane: usize, u: f32, v: f32) {
    let w = w.lane(lane).map(f64::from);
    assert!(w.iter().all(|c| c.is_finite()), "{name}({u}, {v}) = {w:?}");
    assert!(w[2] > 0.0, "{name}({u}, {v}) = {w:?}");
    let length = w.iter().map(|c| c * c).sum::<f64>().sqrt();
    // Half of what the square may be off: six roundings, and sine and cosine.
    let bound = 3.0 * ROUNDING + SIN_COS * 2f64.sqrt();
    assert!(
        (length - 1.0).abs() <= bound,
        "|{name}({u}, {v})| = {length}"
    );
}

#[test]
fn the_ends_of_the_unit_square_give_sound_directions() {
    for (name, sample, pdf) in STRATEGIES {
        for v in CORNERS {
            let w = sample(Fx::new(CORNERS), Fx::splat(v));
            for lane in 0..LANES {
                assert_sound(name, w, lane, CORNERS[lane], v);
                let p = pdf(f64::from(w.lane(lane)[2]));
                assert!(p > 0.0 && p.is_finite(), "{name}: pdf {p}");
            }
        }
    }
}

/// From the formulas, in f64: `cos_theta` by strategy, then the turn.
fn twin(cosine: bool, u: f64, v: f64) -> [f64; 3] {
    let z = if cosine { (1.0 - u).sqrt() } else { 1.0 - u };
    let r = (1.0 - z * z).sqrt();
    [r * (TAU * v).cos(), r * (TAU * v).sin(), z]
}

/// Duff et al. (2017), listing 3, in f64: the images of x, y and z.
fn frame_twin(n: [f64; 3]) -> [[f64; 3]; 3] {
    let [x, y, z] = n;
    let sign = 1f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [
        [1.0 + sign * x * x * a, sign * b, -sign * x],
        [b, sign + y * y * a, -y],
        n,
    ]
}

fn axes() -> [Vec3x; 3] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3x::splat)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn assert_frame(n: [f32; 3]) {
    let frame = axes().map(|axis| to_world(Vec3x::splat(n), axis).lane(3).map(f64::from));
    let twin = frame_twin(n.map(f64::from));
    for i in 0..3 {
        for c in 0..3 {
            // Six roundings of numbers of at most 2 on the longest way to a component, half a
            // rounding of 2 being one of 1's.
            let off = (frame[i][c] - twin[i][c]).abs();
            assert!(off <= 12.0 * ROUNDING, "{n:?}: axis {i} is {:?}", frame[i]);
        }
        for j in 0..3 {
            // Each product of two axes sums what two components may be off, three times; and `n`
            // itself is a unit vector to two roundings.
            let expected = f64::from(u8::from(i == j));
            let product = dot(frame[i], frame[j]);
            assert!(
                (product - expected).abs() <= 24.0 * ROUNDING,
                "{n:?}: {i}.{j} = {product}"
            );
        }
    }
    let [t, b, _] = frame;
    let cross = [
        t[1] * b[2] - t[2] * b[1],
        t[2] * b[0] - t[0] * b[2],
        t[0] * b[1] - t[1] * b[0],
    ];
    assert!(dot(cross, frame[2]) > 0.9, "{n:?}: left-handed");
    assert_eq!(frame[2], n.map(f64::from), "z goes to the normal itself");
}

#[test]
fn frames_are_orthonormal_at_the_poles_and_the_equator() {
    let mut normals = Vec::new();
    for x in [0.0f32, -0.0] {
        for y in [0.0f32, -0.0] {
            normals.extend([[x, y, 1.0], [x, y, -1.0]]);
            normals.extend([[1.0, y, x], [-1.0, y, x], [x, 1.0, y], [x, -1.0, y]]);
        }
    }
    // Close to the poles, down to where z rounds to -1 and to denormal slopes.
    for exponent in 1..=149 {
        let slope = (-f64::from(exponent)).exp2();
        let z = (1.0 - slope * slope).sqrt() as f32;
        let slope = slope as f32;
        for z in [z, -z] {
            normals.extend([[slope, 0.0, z], [-0.0, slope, z], [-slope, -0.0, z]]);
        }
        let (long, short) = (z, slope);
        normals.extend([
            [long, 0.0, short],
            [long, 0.0, -short],
            [0.0, -long, -short],
        ]);
    }
    normals.into_iter().for_each(assert_frame);
}

proptest! {
    #[test]
    fn samples_agree_with_their_twins(bits in prop::array::uniform8((0u32..1 << 24, 0u32..1 << 24))) {
        let unit = |b: u32| b as f32 / 16_777_216.0;
        let (u, v) = (bits.map(|b| unit(b.0)), bits.map(|b| unit(b.1)));
        for (cosine, (name, sample, _)) in STRATEGIES.into_iter().enumerate() {
            let w = sample(Fx::new(u), Fx::new(v));
            for lane in 0..LANES {
                assert_sound(name, w, lane, u[lane], v[lane]);
                let twin = twin(cosine == 1, f64::from(u[lane]), f64::from(v[lane]));
                for (c, value) in w.lane(lane).map(f64::from).into_iter().enumerate() {
                    // Radius and product, two roundings each at most, and sine or cosine.
                    let off = (value - twin[c]).abs();
                    prop_assert!(off <= 4.0 * ROUNDING + SIN_COS, "{name}: {value} for {twin:?}");
                }
            }
        }
    }

    #[test]
    fn frames_are_orthonormal(seed: u64) {
        assert_frame(Source(seed).direction());
    }
}
