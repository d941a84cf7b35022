//! Dispersion: indices at Fraunhofer's lines, and wavelengths that make white again.

mod common;

use common::{CORNERS, Source};
use huygens_kernels::dispersion::{Cauchy, LONGEST, SHORTEST, Spectrum, index_at, xyz};
use huygens_kernels::lanes::{Fx, LANES};

/// Half a unit in the last place of 1: one rounding.
const ROUNDING: f64 = 1.0 / 16_777_216.0;

fn first(x: Fx) -> f64 {
    f64::from(x.as_array()[0])
}

#[test]
fn glasses_have_the_index_and_the_number_that_they_were_made_from() {
    // BK7, SF11, diamond.
    for (n_d, v) in [(1.5168, 64.17), (1.78472, 25.76), (2.4175, 55.3)] {
        let glass = Cauchy::from_abbe(n_d, v);
        let at = |nm: f32| {
            first(index_at(
                [glass.a, glass.b, glass.c].map(Fx::splat),
                Fx::splat(nm),
            ))
        };
        assert!((at(587.56) - n_d).abs() <= 4.0 * ROUNDING * n_d);
        let back = (n_d - 1.0) / (at(486.13) - at(656.27));
        // Each index is off by four roundings of itself, against their difference.
        let bound = 8.0 * ROUNDING * n_d * v / (n_d - 1.0);
        assert!((back / v - 1.0).abs() <= bound, "{back} for {v}");
    }
    let plain = Cauchy::from_abbe(1.5, f64::INFINITY);
    assert_eq!((plain.a, plain.b, plain.c), (1.5, 0.0, 0.0));
}

/// A formula through three indices is that one if it is of its kind, and follows Sellmeier's as closely
/// as `docs/scene-format.md` says.
#[test]
fn indices_follow_the_formula_that_they_were_made_from() {
    let cauchy = |nm: f64| 1.7 + 1.3e4 / (nm * nm) + 4e8 / nm.powi(4);
    let found = Cauchy::through(cauchy);
    for k in 0..=350 {
        let nm = f64::from(SHORTEST) + f64::from(k);
        let x = [found.a, found.b, found.c].map(Fx::splat);
        let lane = first(index_at(x, Fx::splat(nm as f32)));
        // Three coefficients are rounded, and three steps of the kernel, each of a part of the index.
        assert!((found.at(nm) - cauchy(nm)).abs() <= 4.0 * ROUNDING * 1.8);
        assert!((lane - cauchy(nm)).abs() <= 8.0 * ROUNDING * 1.8);
    }
    // Schott's N-BK7 and SF11, and water at 20 C (M. Daimon, A. Masumura, 2007).
    for (b, c) in [
        (
            [1.039_612_12, 0.231_792_344, 1.010_469_45],
            [0.006_000_698_67, 0.020_017_914_4, 103.560_653],
        ),
        (
            [1.737_596_95, 0.313_747_346, 1.898_781_01],
            [0.013_188_707, 0.062_306_814_2, 155.236_29],
        ),
        (
            [0.568_402_756_5, 0.172_617_739_1, 0.020_862_189_58],
            [0.005_101_829_712, 0.018_211_539_36, 0.026_207_222_93],
        ),
    ] {
        let sellmeier = |nm: f64| {
            let l2 = (nm * 1e-3).powi(2);
            let sum: f64 = b.into_iter().zip(c).map(|(b, c)| b * l2 / (l2 - c)).sum();
            (1.0 + sum).sqrt()
        };
        let found = Cauchy::through(sellmeier);
        for k in 0..=350 {
            let nm = f64::from(SHORTEST) + f64::from(k);
            let off = (found.at(nm) - sellmeier(nm)).abs();
            assert!(off < 5e-4, "{off} at {nm} nm");
        }
    }
}

#[test]
fn matching_functions_agree_with_the_published_fit() {
    let mut source = Source(1);
    let lobe = |nm: f64, scale: f64, mean: f64, below: f64, above: f64| {
        let t = (nm - mean) * if nm < mean { below } else { above };
        scale * (-0.5 * t * t).exp()
    };
    for _ in 0..2000 {
        let nm = SHORTEST + (LONGEST - SHORTEST) * source.unit();
        let lane = xyz(Fx::splat(nm)).lane(0);
        let nm = f64::from(nm);
        let y = lobe(nm, 0.821, 568.8, 0.0213, 0.0247) + lobe(nm, 0.286, 530.9, 0.0613, 0.0322);
        // The exponent is at most 40 where the exponential is of a size that counts, and is rounded
        // four times; the exponential itself twice.
        assert!(
            (f64::from(lane[1]) - y).abs() <= 64.0 * ROUNDING,
            "{nm}: {} {y}",
            lane[1]
        );
    }
    // CIE 1931's peak of y is 1 at 555 nm; the fit is within 0.005 there.
    assert!((first(xyz(Fx::splat(555.0)).y) - 1.0).abs() < 5e-3);
}

#[test]
fn wavelengths_make_white() {
    // The mean of the weights over u, by the midpoint rule with many points in each of the 128
    // pieces, is 1 in all three channels.
    const POINTS: usize = 1 << 16;
    let spectrum = Spectrum::table();
    let (mut sums, mut most, mut size) = ([0.0; 3], 0.0f64, 0.0);
    for start in (0..POINTS).step_by(LANES) {
        let u = std::array::from_fn(|l| ((start + l) as f32 + 0.5) / POINTS as f32);
        let drawn = spectrum.sample(Fx::new(u));
        for lane in 0..LANES {
            let w = drawn.weight.lane(lane).map(f64::from);
            for c in 0..3 {
                sums[c] += w[c] / POINTS as f64;
                most = most.max(w[c].abs());
                size += w[c].abs() / 3.0 / POINTS as f64;
            }
        }
    }
    for sum in sums {
        // 512 points a piece of a smooth function of some units: h^2 / 24 of its second derivative,
        // below 1e-5; the table's own integrals to 1/8 nm, as well.
        assert!((sum - 1.0).abs() < 2e-5, "{sums:?}");
    }
    // What the header promises of the weights.
    assert!(most < 5.0 && size < 1.45, "{most} {size}");
}

#[test]
fn means_over_drawn_wavelengths_are_the_integrals() {
    // For what depends on the wavelength: sum of f(lambda) w / p over u against the integral of
    // f w over lambda by itself. A wrong p fails for one of the functions.
    const POINTS: usize = 1 << 16;
    let spectrum = Spectrum::table();
    let functions: [fn(f64) -> f64; 3] = [
        |nm| nm / 550.0,
        |nm| (nm / 550.0).powi(-4),
        |nm| (nm / 20.0).sin(),
    ];
    for f in functions {
        let (mut drawn, mut direct) = ([0.0; 3], [0.0; 3]);
        for start in (0..POINTS).step_by(LANES) {
            let u: [f32; LANES] =
                std::array::from_fn(|l| ((start + l) as f32 + 0.5) / POINTS as f32);
            let sample = spectrum.sample(Fx::new(u));
            let nm = u.map(|u| SHORTEST + (LONGEST - SHORTEST) * u);
            let w = spectrum.matching(Fx::new(nm));
            for lane in 0..LANES {
                let at = f64::from(sample.nanometres.as_array()[lane]);
                for c in 0..3 {
                    drawn[c] += f(at) * f64::from(sample.weight.lane(lane)[c]);
                    let w = f64::from(w.lane(lane)[c]) * f64::from(LONGEST - SHORTEST);
                    direct[c] += f(f64::from(nm[lane])) * w;
                }
            }
        }
        for c in 0..3 {
            let off = (drawn[c] - direct[c]).abs() / POINTS as f64;
            // As above: the midpoint rule on pieces of 512 points.
            assert!(off < 2e-5, "{drawn:?} {direct:?}");
        }
    }
}

#[test]
fn the_ends_of_the_unit_interval_are_wavelengths() {
    let drawn = Spectrum::table().sample(Fx::new(CORNERS));
    for lane in 0..LANES {
        let nm = drawn.nanometres.as_array()[lane];
        assert!((SHORTEST..=LONGEST).contains(&nm), "{nm}");
        assert!(drawn.weight.lane(lane).iter().all(|w| w.is_finite()));
    }
}
