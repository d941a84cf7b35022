//! Lambert and EON.

use crate::common::{Source, Suite};
use crate::harness::{
    COSINES, Map, ROUNDING, assert_close, chi_square, consistent, corners, direction, furnace,
    rounded, splat,
};
use huygens_kernels::bsdf::{Bsdf, Lambert, RoughDiffuse};
use huygens_kernels::lanes::{Fx, LANES};
use huygens_kernels::vec3::Vec3x;
use std::f64::consts::PI;

const ROUGHNESS: [f32; 4] = [0.0, 0.2, 0.6, 1.0];

fn rough(albedo: [f32; 3], roughness: f32) -> RoughDiffuse {
    RoughDiffuse {
        albedo: Vec3x::splat(albedo),
        roughness: Fx::splat(roughness),
    }
}

#[test]
fn samples_follow_their_pdf() {
    let mut suite = Suite::default();
    for cos in COSINES {
        let o = direction(cos, 0.7);
        let lambert = Lambert {
            albedo: Vec3x::splat([0.5; 3]),
        };
        let maps = [Map::Even; 2];
        chi_square(&mut suite, &format!("Lambert {cos}"), &lambert, o, maps);
        for r in ROUGHNESS {
            let name = format!("EON {r} {cos}");
            chi_square(&mut suite, &name, &rough([0.5; 3], r), o, maps);
        }
    }
    suite.finish();
}

#[test]
fn a_white_surface_keeps_all_light_and_a_grey_one_never_gains() {
    let comparisons = 2 * COSINES.len() * ROUGHNESS.len();
    for cos in COSINES {
        for r in ROUGHNESS {
            let o = direction(cos, 0.0);
            let white = furnace(&rough([1.0; 3], r), o, 1.0, comparisons);
            // E is exact to acos, off by 3e-7 at most, times 2 for the other factors.
            let bound = white.half + 6e-7;
            assert!((white.most - 1.0).abs() <= bound, "{cos} {r}: {white:?}");
            let grey = furnace(&rough([0.9, 0.5, 0.0], r), o, 1.0, comparisons);
            assert!(grey.most <= 0.9 + grey.half, "{cos} {r}: {grey:?}");
            assert_eq!(grey.least, 0.0);
        }
    }
}

#[test]
fn the_ends_of_the_unit_cube_and_grazing_directions_are_sound() {
    for cos in COSINES.into_iter().chain([1e-7, 1e-20]) {
        for r in ROUGHNESS {
            corners("EON", &rough([1.0, 0.5, 0.0], r), direction(cos, 2.0));
            consistent("EON", &rough([1.0; 3], r), direction(cos, 2.0), |_, _| {
                4.0 * ROUNDING
            });
        }
        let albedo = Vec3x::splat([1.0; 3]);
        corners("Lambert", &Lambert { albedo }, direction(cos, 2.0));
    }
}

#[test]
fn no_weight_is_above_four() {
    let mut source = Source(5);
    for cos in [1e-6, 1e-3, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0] {
        for r in 1..=20 {
            let bsdf = rough([1.0; 3], r as f32 / 20.0);
            for _ in 0..256 {
                let u = std::array::from_fn(|_| source.unit_lanes());
                let weight = bsdf.sample(splat(direction(cos, 0.0)), u).weight.x;
                assert!(
                    weight.simd_le(Fx::splat(4.0)).all(),
                    "{cos} {r}: {weight:?}"
                );
            }
        }
    }
}

/// EON as its authors write it (listings 1 and 2), in f64: `f`, with the exact `E_FON`.
fn twin(albedo: f64, r: f64, o: [f64; 3], i: [f64; 3]) -> f64 {
    let a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * r);
    let energy = |mu: f64| {
        let s = (1.0 - mu * mu).max(0.0).sqrt();
        let g = s * (mu.acos() - s * mu) + 2.0 / 3.0 * ((s / mu) * (1.0 - s.powi(3)) - s);
        a + r * a / PI * g
    };
    let s = o[0] * i[0] + o[1] * i[1];
    let over = if s > 0.0 { s / o[2].max(i[2]) } else { s };
    let mean = a * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * r);
    let once = albedo / PI * a * (1.0 + r * over);
    let again = albedo * albedo * mean / (1.0 - albedo * (1.0 - mean));
    once + again / PI * (1.0 - energy(o[2])) * (1.0 - energy(i[2])) / (1.0 - mean)
}

#[test]
fn lanes_agree_with_the_formula_in_f64_and_both_ways_round() {
    let mut source = Source(9);
    for _ in 0..2000 {
        let up = |w: [f32; 3]| [w[0], w[1], w[2].abs().max(1e-4)].map(f64::from);
        let (o, i) = (up(source.direction()), up(source.direction()));
        let (o, i) = (rounded(o), rounded(i));
        let roughness = 0.01 + 0.99 * source.unit();
        let albedo = [source.unit(), 1.0, 0.0];
        let bsdf = rough(albedo, roughness);
        let there = bsdf.evaluate(splat(o), splat(i));
        let back = bsdf.evaluate(splat(i), splat(o));
        // A (1 + r s/t) may cancel to 1 - r near 0: absolute in units of 1/pi. Ten roundings of
        // numbers of at most 1 + r/t, and the lack: 3e-7 of acos over a mean of 0.2153 at most
        // twice, its roughness cancelling.
        let magnitude = 1.0 + f64::from(roughness) / o[2].max(i[2]);
        let bound = (10.0 * ROUNDING * magnitude + 2.0 * 3e-7 / 0.2153) / PI;
        for c in 0..3 {
            let twin = twin(f64::from(albedo[c]), f64::from(roughness), o, i);
            let value = f64::from(there.value.lane(0)[c]) / i[2];
            assert!((value - twin).abs() <= bound, "{value} {twin} {o:?} {i:?}");
            let value = f64::from(back.value.lane(0)[c]) / o[2];
            assert!((value - twin).abs() <= bound, "{value} {twin} back");
        }
        assert_close(
            "pdf",
            f64::from(back.pdf.as_array()[0]),
            {
                let part = 0.5 * f64::from(roughness) * (1.0 - i[2]);
                part / (2.0 * PI) + (1.0 - part) * o[2] / PI
            },
            8.0 * ROUNDING,
        );
    }
}

#[test]
fn roughness_zero_is_lambert() {
    let mut source = Source(3);
    let albedo = Vec3x::splat([0.9, 0.4, 0.1]);
    for _ in 0..100 {
        let u: [Fx; 3] = std::array::from_fn(|_| source.unit_lanes());
        let o = splat(direction(f64::from(source.unit()).max(1e-3), 1.0));
        let a = rough([0.9, 0.4, 0.1], 0.0).sample(o, u);
        let b = Lambert { albedo }.sample(o, u);
        for lane in 0..LANES {
            assert_eq!(a.direction.lane(lane), b.direction.lane(lane));
            assert_eq!(a.weight.lane(lane), b.weight.lane(lane));
            assert_eq!(a.pdf.as_array()[lane], b.pdf.as_array()[lane]);
        }
        let below = b.direction * Fx::splat(-1.0);
        assert_eq!(
            Lambert { albedo }.evaluate(o, below).value.lane(0),
            [0.0; 3]
        );
    }
}
