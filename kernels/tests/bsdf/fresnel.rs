//! Fresnel's equations against complex arithmetic in f64, and the metals against what was measured.

use crate::common::Source;
use crate::harness::ROUNDING;
use crate::twin::fresnel;
use huygens_kernels::bsdf::fresnel::{METALS, conductor, conductor_mean, dielectric};
use huygens_kernels::lanes::Fx;

/// Some thirty roundings, of sums of positive terms and of differences that are a part of the result.
const BOUND: f64 = 32.0 * ROUNDING;

fn first(x: Fx) -> f64 {
    f64::from(x.as_array()[0])
}

fn cosines(source: &mut Source) -> f32 {
    // Half of them near grazing.
    let u = source.unit();
    if u < 0.5 { u * u * u } else { u }
}

#[test]
fn conductors_agree_with_complex_arithmetic() {
    let mut source = Source(1);
    for _ in 0..20_000 {
        let cos = cosines(&mut source);
        let (eta, k) = (4.0 * source.unit(), 8.0 * source.unit() + 0.01);
        let lane = first(conductor(Fx::splat(cos), Fx::splat(eta), Fx::splat(k)));
        let twin = fresnel(f64::from(cos), f64::from(eta), f64::from(k));
        assert!(
            (lane - twin).abs() <= BOUND,
            "{cos} {eta} {k}: {lane} {twin}"
        );
    }
}

#[test]
fn conductors_at_the_ends_of_their_domain() {
    let at =
        |cos: f32, eta: f32, k: f32| first(conductor(Fx::splat(cos), Fx::splat(eta), Fx::splat(k)));
    // Nothing that absorbs or bends is no surface, as far down as a cosine has a square.
    for cos in [0.0, 1e-15, 1e-3, 0.5, 1.0] {
        assert_eq!(at(cos, 1.0, 0.0), 0.0, "{cos}");
    }
    for cos in [0.0, 1e-20, 1e-3, 0.5, 1.0] {
        // Nothing but absorption: a perfect mirror.
        assert_eq!(at(cos, 0.0, 1.0), 1.0, "{cos}");
        for (eta, k) in [
            (0.0, 0.0),
            (1e-3, 1e-3),
            (10.0, 0.0),
            (0.05, 20.0),
            (100.0, 100.0),
        ] {
            let f = at(cos, eta, k);
            assert!((0.0..=1.0).contains(&f), "{cos} {eta} {k}: {f}");
        }
    }
    assert_eq!(at(0.0, 0.2, 3.0), 1.0);
}

#[test]
fn dielectrics_agree_with_complex_arithmetic() {
    let mut source = Source(2);
    for _ in 0..20_000 {
        let cos = cosines(&mut source);
        let eta = 0.3 + 2.7 * source.unit();
        let lane = dielectric(Fx::splat(cos), Fx::splat(eta));
        let (c, n) = (f64::from(cos), f64::from(eta));
        let radicand = n * n - 1.0 + c * c;
        // (c - q) and (eta^2 c - q) lose what eta near 1 leaves of them, and at the edge of total
        // reflection the radicand's roundings (two of c^2 and of eta^2 - 1) move q by their root's
        // derivative. All relative to sums of at least |q| + c.
        let slope = 4.0 * ROUNDING / (radicand.abs().sqrt() * (c + radicand.abs().sqrt()));
        let twin = fresnel(c, n, 0.0);
        let f = first(lane.reflectance);
        assert!(
            (f - twin).abs() <= BOUND + 4.0 * slope,
            "{cos} {eta}: {f} {twin}"
        );
        assert_eq!(lane.passes.any(), lane.q.as_array()[0] > 0.0);
        if lane.passes.any() {
            let q = first(lane.q);
            let off = 4.0 * ROUNDING * (1.0 + n * n) / radicand.abs().sqrt();
            assert!(
                (q - radicand.max(0.0).sqrt()).abs() <= off,
                "{cos} {eta}: {q}"
            );
        }
    }
}

#[test]
fn index_one_is_no_surface() {
    let mut source = Source(3);
    for _ in 0..10_000 {
        let cos = cosines(&mut source).max(1e-12);
        let lane = dielectric(Fx::splat(cos), Fx::ONE);
        assert_eq!(first(lane.reflectance), 0.0);
        assert_eq!(lane.q.as_array()[0], cos);
    }
}

#[test]
fn mean_reflectances_agree_with_f64() {
    for (eta, k) in [(0.2, 3.0), (1.5, 7.0), (2.9, 3.0), (0.0, 1.0), (0.05, 4.0)] {
        const STEPS: usize = 1 << 14;
        let at = |step: usize| {
            let cos = (step as f64 + 0.5) / STEPS as f64;
            2.0 * cos * fresnel(cos, eta, k)
        };
        let twin = (0..STEPS).map(at).sum::<f64>() / STEPS as f64;
        let mean = conductor_mean(eta, k);
        // What the rule of 64 intervals promises.
        assert!((mean - twin).abs() < 2e-6, "{eta} {k}: {mean} {twin}");
    }
}

/// Measured indices over the visible, from refractiveindex.info (CC0): wavelength in micrometres,
/// eta, k.
type Rows = &'static [[f64; 3]];
const MEASURED: [(&str, Rows); 5] = [
    (
        "Au",
        &[
            [0.3815, 1.46, 1.933],
            [0.3974, 1.47, 1.952],
            [0.4133, 1.46, 1.958],
            [0.4305, 1.45, 1.948],
            [0.4509, 1.38, 1.914],
            [0.4714, 1.31, 1.849],
            [0.4959, 1.04, 1.833],
            [0.5209, 0.62, 2.081],
            [0.5486, 0.43, 2.455],
            [0.5821, 0.29, 2.863],
            [0.6168, 0.21, 3.272],
            [0.6595, 0.14, 3.697],
            [0.7045, 0.13, 4.103],
            [0.7560, 0.14, 4.542],
        ],
    ),
    (
        "Ag",
        &[
            [0.3815, 0.05, 1.864],
            [0.3974, 0.05, 2.070],
            [0.4133, 0.05, 2.275],
            [0.4305, 0.04, 2.462],
            [0.4509, 0.04, 2.657],
            [0.4714, 0.05, 2.869],
            [0.4959, 0.05, 3.093],
            [0.5209, 0.05, 3.324],
            [0.5486, 0.06, 3.586],
            [0.5821, 0.05, 3.858],
            [0.6168, 0.06, 4.152],
            [0.6595, 0.05, 4.483],
            [0.7045, 0.04, 4.838],
            [0.7560, 0.03, 5.242],
        ],
    ),
    (
        "Cu",
        &[
            [0.3815, 1.33, 2.045],
            [0.3974, 1.32, 2.116],
            [0.4133, 1.28, 2.207],
            [0.4305, 1.25, 2.305],
            [0.4509, 1.24, 2.397],
            [0.4714, 1.25, 2.483],
            [0.4959, 1.22, 2.564],
            [0.5209, 1.18, 2.608],
            [0.5486, 1.02, 2.577],
            [0.5821, 0.70, 2.704],
            [0.6168, 0.30, 3.205],
            [0.6595, 0.22, 3.747],
            [0.7045, 0.21, 4.205],
            [0.7560, 0.24, 4.665],
        ],
    ),
    (
        "Al",
        &[
            [0.36466, 0.39877, 4.3957],
            [0.41328, 0.52135, 5.0008],
            [0.44280, 0.60790, 5.3676],
            [0.47687, 0.72780, 5.7781],
            [0.51660, 0.87340, 6.2418],
            [0.56357, 1.0728, 6.7839],
            [0.61993, 1.3660, 7.4052],
            [0.65225, 1.5724, 7.7354],
            [0.68881, 1.8301, 8.0601],
            [0.72932, 2.1606, 8.3565],
            [0.77491, 2.6154, 8.4914],
        ],
    ),
    (
        "Fe",
        &[
            [0.381, 2.12, 2.50],
            [0.397, 2.24, 2.58],
            [0.413, 2.35, 2.65],
            [0.431, 2.48, 2.71],
            [0.451, 2.59, 2.77],
            [0.471, 2.67, 2.82],
            [0.496, 2.74, 2.88],
            [0.521, 2.86, 2.91],
            [0.549, 2.95, 2.93],
            [0.582, 2.94, 2.99],
            [0.617, 2.88, 3.05],
            [0.659, 2.92, 3.10],
            [0.704, 2.86, 3.19],
            [0.756, 2.87, 3.28],
        ],
    ),
];

/// Wyman, Sloan, Shirley (2013), equation 4: the CIE 1931 matching functions, wavelength in nm.
fn xyz(nm: f64) -> [f64; 3] {
    let lobe = |scale: f64, mean: f64, below: f64, above: f64| {
        let t = (nm - mean) * if nm < mean { below } else { above };
        scale * (-0.5 * t * t).exp()
    };
    [
        lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(0.362, 442.0, 0.0624, 0.0374)
            - lobe(0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    ]
}

/// IEC 61966-2-1: XYZ to linear sRGB.
const TO_RGB: [[f64; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];

#[test]
fn metals() {
    let normal = |eta: f64, k: f64| fresnel(1.0, eta, k);
    for (symbol, rows) in MEASURED {
        let at = |nm: f64| -> [f64; 2] {
            let um = nm / 1000.0;
            let above = rows
                .iter()
                .position(|r| r[0] >= um)
                .expect("measured")
                .max(1);
            let (a, b) = (rows[above - 1], rows[above]);
            // Below the first measurement, its own.
            let t = ((um - a[0]) / (b[0] - a[0])).max(0.0);
            [1, 2].map(|c| a[c] + t * (b[c] - a[c]))
        };
        let metal = METALS.iter().find(|m| m.symbol == symbol).expect("a metal");
        for c in 0..3 {
            let mut sums = [0.0; 4];
            for nm in (380..=730).map(f64::from) {
                let v = xyz(nm);
                let weight: f64 = (0..3).map(|j| TO_RGB[c][j] * v[j]).sum();
                let [eta, k] = at(nm);
                for (sum, x) in sums.iter_mut().zip([1.0, eta, k, normal(eta, k)]) {
                    *sum += weight * x;
                }
            }
            let [eta, k, spectral] = [1, 2, 3].map(|j| sums[j] / sums[0]);
            // As many digits as are given.
            assert!(
                (eta - f64::from(metal.eta[c])).abs() <= 0.51e-4,
                "{symbol} {c}: {eta}"
            );
            assert!(
                (k - f64::from(metal.k[c])).abs() <= 0.51e-4,
                "{symbol} {c}: {k}"
            );
            let bound = if (symbol, c) == ("Au", 0) {
                0.04
            } else {
                0.014
            };
            assert!(
                (normal(eta, k) - spectral).abs() < bound,
                "{symbol} {c}: {spectral}"
            );
        }
    }
}
