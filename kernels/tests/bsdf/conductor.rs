//! Metals.

use crate::common::{Source, Suite};
use crate::harness::{
    COSINES, Map, ROUNDING, assert_close, chi_square, consistent, corners, direction, dot, furnace,
    rounded, splat,
};
use crate::twin;
use huygens_kernels::bsdf::fresnel::{METALS, Metal, conductor_mean};
use huygens_kernels::bsdf::{
    ALPHA_FLOOR, Bsdf, DELTA_PDF, ReflectionEnergy, RoughConductor, SmoothConductor,
};
use huygens_kernels::lanes::Fx;
use huygens_kernels::vec3::Vec3x;
use std::f64::consts::PI;

const WIDTHS: [[f32; 2]; 9] = [
    [ALPHA_FLOOR, ALPHA_FLOOR],
    [0.0023, 0.0023],
    [0.02, 0.02],
    [0.2, 0.2],
    [0.6, 0.6],
    [1.0, 1.0],
    [0.5, 0.05],
    [0.01, 0.3],
    [1.0, 0.1],
];

/// Reflects everything.
const MIRROR: Metal = Metal {
    symbol: "mirror",
    eta: [0.0; 3],
    k: [1.0; 3],
};

fn rough(metal: &Metal, alpha: [f32; 2]) -> RoughConductor<'static> {
    let mean = |c: usize| conductor_mean(f64::from(metal.eta[c]), f64::from(metal.k[c])) as f32;
    RoughConductor {
        eta: Vec3x::splat(metal.eta),
        k: Vec3x::splat(metal.k),
        mean: Vec3x::splat([mean(0), mean(1), mean(2)]),
        alpha: alpha.map(Fx::splat),
        energy: ReflectionEnergy::table(),
    }
}

#[test]
fn samples_follow_their_pdf() {
    let mut suite = Suite::default();
    for alpha in WIDTHS {
        for cos in COSINES {
            // A direction in f32 is off by half a rounding, its facet by that over 2 o.m, and its slope
            // in widths by that over alpha: where this comes near a cell's width, here at a cosine
            // and a width of 1e-3, the directions themselves cannot carry the lobe.
            let blur = ROUNDING / (2.0 * cos * f64::from(alpha[0].min(alpha[1])));
            if blur > 0.01 {
                continue;
            }
            let o = direction(cos, 0.7);
            let map = if alpha[0].min(alpha[1]) < 0.5 {
                Map::reflecting(o, alpha)
            } else {
                Map::Even
            };
            let name = format!("conductor {alpha:?} from {cos}");
            chi_square(
                &mut suite,
                &name,
                &rough(&METALS[0], alpha),
                o,
                [map, Map::Even],
            );
        }
    }
    suite.finish();
}

#[test]
fn a_perfect_mirror_of_any_roughness_keeps_all_light_and_gains_none() {
    let comparisons = 2 * 2 * COSINES.len() * WIDTHS.len();
    for alpha in WIDTHS {
        for cos in COSINES {
            for azimuth in [0.0, 1.2] {
                let o = direction(cos, azimuth);
                let albedo = furnace(&rough(&MIRROR, alpha), o, 1.0, comparisons);
                assert!(
                    albedo.most <= 1.0 + albedo.half,
                    "{alpha:?} {cos}: {albedo:?}"
                );
                if alpha[0] == alpha[1] {
                    assert!(
                        albedo.least >= 0.99 - albedo.half,
                        "{alpha:?} {cos}: {albedo:?}"
                    );
                }
                let gold = furnace(&rough(&METALS[0], alpha), o, 1.0, comparisons);
                assert!(gold.most <= 1.0 + gold.half, "{alpha:?} {cos}: {gold:?}");
            }
        }
    }
}

/// How far f32 may be off, relatively, for `o` and `i` that both sides are given exactly: roundings
/// of the factors, and what half a rounding in each component of the half vector, over its length
/// before it is made one, does to D, whose logarithm changes by at most 2/alpha with it (twice over,
/// for the components and for the length).
fn bound(o: [f64; 3], i: [f64; 3], alpha: [f32; 2]) -> f64 {
    let h: [f64; 3] = std::array::from_fn(|c| o[c] + i[c]);
    let narrow = f64::from(alpha[0].min(alpha[1]));
    (48.0 + 4.0 / (narrow * dot(h, h).sqrt())) * ROUNDING
}

#[test]
fn the_ends_of_the_unit_cube_and_grazing_directions_are_sound() {
    for alpha in WIDTHS {
        for cos in COSINES.into_iter().chain([1e-7, 1e-20]) {
            for azimuth in [0.0, 0.7] {
                let bsdf = rough(&METALS[2], alpha);
                let o = direction(cos, azimuth);
                corners("conductor", &bsdf, o);
                // A drawn direction is rounded, as `o` is, and i.z by half a rounding of what it
                // was computed from, which moves the value by that over i.z.
                consistent("conductor", &bsdf, o, |o, i| {
                    4.0 * bound(o, i, alpha) + 4.0 * ROUNDING / i[2]
                });
            }
        }
    }
}

#[test]
fn lanes_agree_with_the_formula_in_f64_and_both_ways_round() {
    let table = ReflectionEnergy::table();
    let mut source = Source(41);
    for alpha in WIDTHS {
        for _ in 0..500 {
            let up = |w: [f32; 3]| rounded([w[0], w[1], w[2].abs().max(1e-3)].map(f64::from));
            let o = up(source.direction());
            // Half of them in the lobe, where it is narrow.
            let near = rough(&MIRROR, alpha).sample(splat(o), [0.3, 0.4, 1.0].map(Fx::splat));
            let near = near.direction.lane(0);
            let i = if source.unit() < 0.5 && near[2] > 1e-3 {
                near.map(f64::from)
            } else {
                up(source.direction())
            };
            let metal = &METALS[2];
            let bsdf = rough(metal, alpha);
            let there = bsdf.evaluate(splat(o), splat(i));
            let back = bsdf.evaluate(splat(i), splat(o));

            let widths = alpha.map(f64::from);
            let (once, pdf) = twin::reflection(o, i, widths);
            let h = twin::normalized(twin::sum(o, i));
            let lane = |x: Fx| f64::from(x.as_array()[0]);
            let geometric = Fx::splat(alpha[0] * alpha[1]).sqrt();
            let lost = |w: [f64; 3]| {
                let at = |width: Fx| lane(table.lost(Fx::splat(w[2] as f32), width));
                at(geometric).min(at(Fx::splat(alpha[0].min(alpha[1]))))
            };
            let lost_mean = lane(table.mean_lost(geometric));
            let kept = 1.0 - lost_mean;
            let bound = bound(o, i, alpha);
            for c in 0..3 {
                let (eta, k) = (f64::from(metal.eta[c]), f64::from(metal.k[c]));
                let mean = conductor_mean(eta, k);
                let again = mean * mean * kept / (1.0 - mean * (1.0 - kept));
                let shape = if lost_mean > 0.0 {
                    lost(o) * lost(i) / (PI * lost_mean)
                } else {
                    0.0
                };
                let f = twin::fresnel(dot(o, h).min(1.0), eta, k);
                let twin = f * once / i[2] + again * shape;
                let value = f64::from(there.value.lane(0)[c]) / i[2];
                assert_close(&format!("{alpha:?} {o:?} {i:?}"), value, twin, bound);
                let value = f64::from(back.value.lane(0)[c]) / o[2];
                assert_close(&format!("{alpha:?} {o:?} {i:?} back"), value, twin, bound);
            }
            let twin = lost(o) * i[2] / PI + (1.0 - lost(o)) * pdf;
            assert_close("pdf", lane(there.pdf), twin, bound);
        }
    }
}

#[test]
fn energy_is_never_underestimated_and_hardly_overestimated() {
    let table = ReflectionEnergy::table();
    for alpha in [0.05f32, 0.1, 0.17, 0.33, 0.5, 0.71, 0.9, 1.0] {
        for cos in [0.05f32, 0.11, 0.2, 0.37, 0.55, 0.8, 0.95, 1.0] {
            let taken = 1.0 - table.lost(Fx::splat(cos), Fx::splat(alpha)).as_array()[0];
            let truth = twin::reflected_energy(f64::from(cos), f64::from(alpha), 512);
            // The table's promise, and what halving the quadrature's step shows of its own error.
            let coarse = twin::reflected_energy(f64::from(cos), f64::from(alpha), 256);
            let own = (truth - coarse).abs();
            let off = f64::from(taken) - truth;
            assert!(
                (-own..=2.5e-3 + own).contains(&off),
                "{alpha} {cos}: {off} {own}"
            );
        }
        // The mean is that of the table's own function.
        const STEPS: u32 = 1 << 12;
        let at = |k: u32| {
            let cos = (f64::from(k) + 0.5) / f64::from(STEPS);
            let e = table.lost(Fx::splat(cos as f32), Fx::splat(alpha));
            2.0 * cos * f64::from(e.as_array()[0]) / f64::from(STEPS)
        };
        let mean = (0..STEPS).map(at).sum::<f64>();
        let taken = f64::from(table.mean_lost(Fx::splat(alpha)).as_array()[0]);
        // The table's promise.
        assert!((mean - taken).abs() < 1e-4, "{alpha}: {mean} {taken}");
    }
}

#[test]
fn a_polished_metal_is_a_delta_lobe() {
    let metal = &METALS[1];
    let bsdf = SmoothConductor {
        eta: Vec3x::splat(metal.eta),
        k: Vec3x::splat(metal.k),
    };
    for cos in COSINES {
        let o = rounded(direction(cos, 0.7));
        corners("mirror", &bsdf, o);
        let drawn = bsdf.sample(splat(o), [Fx::ZERO; 3]);
        assert_eq!(drawn.pdf.as_array()[0], DELTA_PDF);
        assert_eq!(drawn.direction.lane(0).map(f64::from), [-o[0], -o[1], o[2]]);
        for c in 0..3 {
            let twin = twin::fresnel(o[2], f64::from(metal.eta[c]), f64::from(metal.k[c]));
            let weight = f64::from(drawn.weight.lane(0)[c]);
            assert!((weight - twin).abs() <= 32.0 * ROUNDING, "{weight} {twin}");
        }
        let nothing = bsdf.evaluate(splat(o), drawn.direction);
        assert_eq!(
            (nothing.pdf.as_array()[0], nothing.value.lane(0)),
            (0.0, [0.0; 3])
        );
    }
}
