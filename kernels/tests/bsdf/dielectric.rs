//! Glass, polished and rough, thick and thin.

use crate::common::{Source, Suite};
use crate::harness::{
    COSINES, Map, ROUNDING, assert_close, chi_square, consistent, corners, direction, dot, furnace,
    rounded, splat,
};
use crate::twin;
use huygens_kernels::bsdf::{
    ALPHA_FLOOR, Bsdf, DELTA_PDF, RoughDielectric, SmoothDielectric, TransmissionEnergy,
};
use huygens_kernels::lanes::{Fx, Mask};
use huygens_kernels::vec3::Vec3x;

const INDICES: [f32; 5] = [1.5, 1.0 / 1.5, 1.1, 2.4, 0.8];
const WIDTHS: [f32; 5] = [ALPHA_FLOOR, 0.03, 0.2, 0.5, 1.0];

fn mask(yes: bool) -> Mask {
    if yes {
        Fx::ONE.simd_eq(Fx::ONE)
    } else {
        Fx::ZERO
    }
}

fn smooth(eta: f32, thin: bool) -> SmoothDielectric {
    SmoothDielectric {
        eta: Fx::splat(eta),
        thin: mask(thin),
        reflection: Vec3x::splat([1.0; 3]),
        transmission: Vec3x::splat([1.0; 3]),
    }
}

fn rough(eta: f32, alpha: f32, thin: bool) -> RoughDielectric<'static> {
    RoughDielectric {
        surface: smooth(eta, thin),
        alpha: Fx::splat(alpha),
        energy: TransmissionEnergy::table(),
        compensated: mask(true),
    }
}

/// Whether what passes is too narrow to be evaluated.
fn unspread(eta: f64, alpha: f64) -> bool {
    (eta - 1.0).abs() / eta.max(1.0) * alpha < f64::from(ALPHA_FLOOR)
}

fn lane(x: Fx) -> f64 {
    f64::from(x.as_array()[0])
}

#[test]
fn polished_glass_reflects_and_refracts_as_fresnel_and_snell_say() {
    let mut source = Source(1);
    for eta in INDICES {
        for thin in [false, true] {
            let bsdf = smooth(eta, thin);
            let n = f64::from(eta);
            for _ in 0..1000 {
                let mut o = source.direction();
                o[2] = o[2].abs().max(1e-3);
                let u = source.unit();
                let drawn = bsdf.sample(Vec3x::splat(o), [Fx::ZERO, Fx::ZERO, Fx::splat(u)]);
                let (o, u) = (o.map(f64::from), f64::from(u));
                let r = twin::fresnel(o[2].min(1.0), n, 0.0);
                let r = if thin { 2.0 * r / (1.0 + r) } else { r };
                let i = drawn.direction.lane(0).map(f64::from);
                let weight = lane(drawn.weight.x);
                // Draws that close to the reflectance may go either way.
                if (u - r).abs() < 1e-5 {
                    continue;
                }
                assert_eq!(lane(drawn.pdf), f64::from(DELTA_PDF));
                if u < r {
                    assert_eq!((i, weight), ([-o[0], -o[1], o[2]], 1.0));
                } else if thin {
                    assert_eq!((i, weight), (o.map(|c| -c), 1.0));
                } else {
                    // Snell's law for the tangential part; a unit vector; 1 / eta^2.
                    assert!((i[0] * n + o[0]).abs() <= 4.0 * ROUNDING * n);
                    assert!((i[1] * n + o[1]).abs() <= 4.0 * ROUNDING * n);
                    // o.z was raised in a few cases: its length is its own.
                    let length = (n * n - 1.0 + dot(o, o)).sqrt() / n;
                    let bound = 8.0 * ROUNDING / (i[2] * i[2]).min(1.0) + 2e-6;
                    assert!(
                        (dot(i, i).sqrt() - length).abs() <= bound && i[2] < 0.0,
                        "{i:?}"
                    );
                    assert!((weight * n * n - 1.0).abs() <= 4.0 * ROUNDING);
                }
            }
            for cos in COSINES {
                corners("polished", &bsdf, direction(cos, 0.4));
            }
        }
    }
}

#[test]
fn index_one_lets_all_light_go_straight_on() {
    let mut source = Source(2);
    for _ in 0..2000 {
        let mut o = source.direction();
        o[2] = o[2].abs().max(1e-6);
        let u: [Fx; 3] = std::array::from_fn(|_| source.unit_lanes());
        let alpha = source.unit().max(ALPHA_FLOOR);
        let o = Vec3x::splat(o);
        for thin in [false, true] {
            let polished = smooth(1.0, thin).sample(o, u);
            assert_eq!(polished.direction.lane(0), (-o).lane(0));
            assert_eq!(polished.weight.lane(0), [1.0; 3]);
            assert_eq!(polished.pdf.as_array()[0], DELTA_PDF);
        }
        let frosted = rough(1.0, alpha, false).sample(o, u);
        assert_eq!(frosted.direction.lane(0), (-o).lane(0));
        assert_eq!(frosted.weight.lane(0), [1.0; 3]);
        assert_eq!(frosted.pdf.as_array()[0], DELTA_PDF);
        let nothing = rough(1.0, alpha, false).evaluate(o, -o);
        assert_eq!(
            (nothing.pdf.as_array()[0], nothing.value.lane(0)),
            (0.0, [0.0; 3])
        );
    }
}

#[test]
fn total_reflection_lets_nothing_pass() {
    let mut source = Source(3);
    let bsdf = smooth(1.0 / 1.5, false);
    let edge = (1.0 - 1.0 / 2.25f64).sqrt();
    for cos in [0.01, 0.3, 0.7, edge - 1e-6] {
        for _ in 0..100 {
            let u = std::array::from_fn(|_| source.unit_lanes());
            let drawn = bsdf.sample(splat(direction(cos, 0.2)), u);
            assert!(drawn.valid.all() && drawn.direction.z.simd_gt(Fx::ZERO).all());
        }
    }
}

#[test]
fn samples_follow_their_pdf() {
    let mut suite = Suite::default();
    for eta in INDICES {
        for alpha in WIDTHS {
            for cos in [0.05, 0.6, 1.0] {
                for thin in [false, true] {
                    let n = f64::from(eta);
                    let unspread = !thin && unspread(n, f64::from(alpha));
                    // What a rounding of the directions does to a facet's slope in widths; as for
                    // metals, but over |o + eta i|.
                    let blur = 1.0 / (cos * f64::from(alpha) * (n - 1.0).abs().min(1.0));
                    if unspread || blur * ROUNDING > 0.01 || (thin && eta != 1.5) {
                        continue;
                    }
                    let o = rounded(direction(cos, 0.7));
                    let name = format!("dielectric {eta} {alpha} {thin} from {cos}");
                    let up = Map::reflecting(o, [alpha; 2]);
                    let down = Map::Facets {
                        o,
                        alpha: [f64::from(alpha); 2],
                        eta: n,
                    };
                    let down = if thin { Map::Even } else { down };
                    if thin && alpha < 0.2 {
                        continue;
                    }
                    chi_square(&mut suite, &name, &rough(eta, alpha, thin), o, [up, down]);
                }
            }
        }
    }
    suite.finish();
}

#[test]
fn a_furnace_keeps_all_light_and_gains_none() {
    let comparisons = COSINES.len() * (WIDTHS.len() + 1) * (INDICES.len() + 2) * 2;
    for eta in INDICES.into_iter().chain([1.02, 0.96]) {
        for cos in COSINES {
            let o = direction(cos, 0.0);
            for thin in [false, true] {
                if thin && eta != 1.5 {
                    continue;
                }
                let radiance = if thin { 1.0 } else { f64::from(eta) };
                let polished = furnace(&smooth(eta, thin), o, radiance, comparisons);
                assert!(
                    (polished.most - 1.0).abs() <= polished.half,
                    "{eta} {cos}: {polished:?}"
                );
                for alpha in WIDTHS {
                    let albedo = furnace(&rough(eta, alpha, thin), o, radiance, comparisons);
                    let name = format!("{eta} {alpha} {thin} from {cos}: {albedo:?}");
                    assert!(albedo.most <= 1.0 + albedo.half, "{name}");
                    // From within the denser medium, the edge of total reflection is what the table
                    // of E follows least well, and its margin weighs more where E is a half.
                    let least = if eta < 1.0 { 0.98 } else { 0.99 };
                    assert!(albedo.least >= least - albedo.half, "{name}");
                }
            }
        }
    }
}

/// As for metals: half a rounding in each component of `o + eta i`, over its length, moves the facet,
/// D with it by up to 2/alpha, its cosines, and the square of that length. Fresnel's amplitudes are
/// off by some roundings and by what their cosines are, `dr = 2 (c dq + q dc) / (c + q)^2`, where
/// `dq = c dc / q` grows towards the edge of total reflection; `R` by twice that times the amplitude,
/// relative to the part of the light that is meant.
fn bound(o: [f64; 3], i: [f64; 3], alpha: f64, eta: f64, passed: bool) -> f64 {
    let by = if passed { eta } else { 1.0 };
    let h: [f64; 3] = std::array::from_fn(|c| o[c] + by * i[c]);
    let length = dot(h, h).sqrt();
    let m = h.map(|c| c / length);
    let (near, far) = (dot(o, m).abs(), dot(i, m).abs());
    let turned = (1.0 + by) / length;
    let q = (eta * eta - 1.0 + near * near).max(0.0).sqrt();
    let r = twin::fresnel(near.min(1.0), eta, 0.0);
    let part = if passed { 1.0 - r } else { r };
    let amplitude = 8.0 + 4.0 * (turned + 1.0) * (near * near / q + q) / (near + q).powi(2);
    let fresnel = 2.0 * r.sqrt() * amplitude / part;
    (64.0 + turned * (2.0 / alpha + 4.0 / near.min(far) + 2.0) + fresnel) * ROUNDING
}

#[test]
fn the_ends_of_the_unit_cube_and_grazing_directions_are_sound() {
    for eta in [1.5, 0.8, 1.0, 1.02, 0.97, 4.0] {
        for alpha in WIDTHS {
            for cos in COSINES.into_iter().chain([1e-7]) {
                for thin in [false, true] {
                    let o = rounded(direction(cos, 0.7));
                    let bsdf = rough(eta, alpha, thin);
                    corners(&format!("dielectric {eta} {alpha} {thin}"), &bsdf, o);
                    let (a, n) = (f64::from(alpha), f64::from(eta));
                    consistent("dielectric", &bsdf, o, |o, i| {
                        let passed = i[2] < 0.0;
                        let i = if thin { [i[0], i[1], i[2].abs()] } else { i };
                        let bound = bound(o, i, a, n, passed && !thin);
                        // At the edge of total reflection nothing is promised.
                        let bound = if bound.is_nan() { 1.0 } else { bound };
                        4.0 * bound + 4.0 * ROUNDING / i[2].abs()
                    });
                }
            }
        }
    }
}

#[test]
fn lanes_agree_with_the_formula_in_f64_and_what_is_scaled_is_reciprocal() {
    let table = TransmissionEnergy::table();
    let mut source = Source(51);
    let mut compared = [0; 2];
    for eta in INDICES {
        for alpha in WIDTHS {
            let (a, n) = (f64::from(alpha), f64::from(eta));
            let bsdf = rough(eta, alpha, false);
            for _ in 0..400 {
                let mut o = source.direction();
                o[2] = o[2].abs().max(1e-3);
                let o = rounded(o.map(f64::from));
                let drawn = bsdf.sample(splat(o), std::array::from_fn(|_| source.unit_lanes()));
                let mut i = drawn.direction.lane(0).map(f64::from);
                if source.unit() < 0.3 {
                    i = source.direction().map(f64::from);
                }
                let passed = i[2] < 0.0;
                if i[2].abs() < 1e-3 || (passed && unspread(n, a)) {
                    continue;
                }
                let there = bsdf.evaluate(splat(o), splat(i));
                let kept =
                    lane(table.albedo(Fx::splat(o[2] as f32), Fx::splat(alpha), Fx::splat(eta)));
                let (value, pdf) = if passed {
                    twin::refraction(o, i, a, n)
                } else {
                    let h = twin::normalized(twin::sum(o, i));
                    let r = twin::fresnel(dot(o, h).min(1.0), n, 0.0);
                    let (value, pdf) = twin::reflection(o, i, [a, a]);
                    (r * value, r * pdf)
                };
                let bound = bound(o, i, a, n, passed);
                // Too close to the edge of what a facet can do to say on which side f32 falls.
                if bound.is_nan() || bound > 0.1 {
                    continue;
                }
                compared[usize::from(passed)] += usize::from(pdf > 0.0);
                let name = format!("{eta} {alpha} {o:?} {i:?}");
                assert_close(&name, lane(there.value.x) * kept, value, bound);
                assert_close(&name, lane(there.pdf), pdf, bound);

                // n^2 f(o, i) = f(i, o), the near side being the far one, once both are freed of E.
                let (from, to, inverse) = if passed {
                    ([i[0], i[1], -i[2]], [o[0], o[1], -o[2]], 1.0 / eta)
                } else {
                    (i, o, eta)
                };
                let back = rough(inverse, alpha, false).evaluate(splat(from), splat(to));
                let kept_back = lane(table.albedo(
                    Fx::splat(from[2] as f32),
                    Fx::splat(alpha),
                    Fx::splat(inverse),
                ));
                let scale = if passed { n * n } else { 1.0 };
                let there = lane(there.value.x) * kept * scale / i[2].abs();
                let back = lane(back.value.x) * kept_back / o[2];
                let returning = self::bound(from, to, a, f64::from(inverse), passed);
                assert_close(
                    &format!("back {name}"),
                    back,
                    there,
                    2.0 * (bound + returning),
                );
            }
        }
    }
    // Enough were met for the comparison to be one.
    assert!(compared.iter().all(|&c| c > 1000), "{compared:?}");
}

#[test]
fn no_weight_is_above_eight() {
    let mut source = Source(55);
    for eta in INDICES.into_iter().chain([0.94, 0.97, 1.06, 4.0]) {
        for alpha in WIDTHS {
            for cos in COSINES {
                let bsdf = rough(eta, alpha, false);
                for _ in 0..100 {
                    let u = std::array::from_fn(|_| source.unit_lanes());
                    let drawn = bsdf.sample(splat(direction(cos, 1.0)), u);
                    let passed = drawn.direction.z.simd_lt(Fx::ZERO);
                    let scale = passed.select(Fx::splat(eta * eta), Fx::ONE);
                    let weight = drawn.weight.x * scale;
                    assert!(
                        weight.simd_le(Fx::splat(8.0)).all(),
                        "{eta} {alpha} {cos}: {weight:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn tints_and_walls() {
    // A tinted thin wall of roughness 0.3: what passes is what is reflected, mirrored, by (1 - R')/R'.
    let mut bsdf = rough(1.5, 0.3, true);
    bsdf.surface.reflection = Vec3x::splat([1.0, 0.5, 0.25]);
    bsdf.surface.transmission = Vec3x::splat([0.25, 0.5, 1.0]);
    let mut source = Source(6);
    for _ in 0..500 {
        let up = |mut w: [f32; 3]| {
            w[2] = w[2].abs().max(1e-2);
            rounded(w.map(f64::from))
        };
        let (o, i) = (up(source.direction()), up(source.direction()));
        let h = twin::normalized(twin::sum(o, i));
        let r = twin::fresnel(dot(o, h).min(1.0), 1.5, 0.0);
        let r = 2.0 * r / (1.0 + r);
        let reflected = bsdf
            .evaluate(splat(o), splat(i))
            .value
            .lane(0)
            .map(f64::from);
        let passed = bsdf
            .evaluate(splat(o), splat([i[0], i[1], -i[2]]))
            .value
            .lane(0);
        for c in 0..3 {
            let tint = [1.0, 0.5, 0.25][c] / [0.25, 0.5, 1.0][c];
            let expected = reflected[c] / tint * (1.0 - r) / r;
            // Roundings of R over R and over 1 - R, which at grazing is some hundredths.
            let bound = 64.0 * ROUNDING / r.min(1.0 - r);
            assert_close("thin", f64::from(passed[c]), expected, bound);
        }
    }
}

/// What compensation multiplies is a function of `o` alone: without it, every value and weight is the
/// one of single scattering.
#[test]
fn without_compensation_facets_scatter_once() {
    let mut source = Source(57);
    for (eta, thin) in [(1.5, false), (1.0 / 1.5, false), (1.5, true)] {
        for alpha in [0.05, 0.3, 1.0] {
            let whole = rough(eta, alpha, thin);
            let once = RoughDielectric {
                compensated: mask(false),
                ..whole
            };
            for _ in 0..200 {
                let mut o = source.direction();
                o[2] = o[2].abs().max(0.01);
                let (o, u) = (
                    Vec3x::splat(o),
                    std::array::from_fn(|_| source.unit_lanes()),
                );
                let albedo = if thin {
                    Fx::ONE - whole.energy.reflection.lost(o.z, whole.alpha)
                } else {
                    whole.energy.albedo(o.z, whole.alpha, whole.surface.eta)
                };
                let (a, b) = (whole.sample(o, u), once.sample(o, u));
                assert_eq!(a.direction.lane(0), b.direction.lane(0));
                assert_eq!(a.pdf, b.pdf);
                let name = format!("{eta} {alpha} {thin}");
                let scaled = |x: Vec3x| lane(x.x * albedo);
                assert_close(&name, lane(b.weight.x), scaled(a.weight), 4.0 * ROUNDING);
                let [a, b] = [&whole, &once].map(|glass| glass.evaluate(o, a.direction));
                assert_close(&name, lane(b.value.x), scaled(a.value), 4.0 * ROUNDING);
            }
        }
    }
}
