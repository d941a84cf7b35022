//! Light through dispersive glass: against a tracer of one wavelength a path in f64, and where the
//! answer is known.

mod common;

use common::picture::{Picture, by_samples, by_wave, independent, over_seeds, render};
use common::scenes::{Builder, camera_along_z};
use common::statistics::{SIGNIFICANCE, assert_mean, same, threshold};
use glam::DVec3;
use huygens::scene::material::{Cauchy, Dielectric};
use huygens::scene::{Bsdf, Scene, Sky};
use huygens::settings::{Sampler, Settings, Strategy};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

const ZENITH: [f32; 3] = [0.2, 0.4, 0.8];
const NADIR: [f32; 3] = [0.6, 0.3, 0.1];
/// Of the wall behind the prism.
const WALL: [f32; 3] = [4.0, 3.0, 2.0];
/// A glass that disperses more than any there is: colours lie wide apart.
const ABBE: f64 = 12.0;

fn glass(abbe: Option<f64>, roughness: f32) -> Bsdf {
    Bsdf::Dielectric(Box::new(Dielectric {
        ior: 1.5,
        dispersion: abbe.map(|v| Cauchy::from_abbe(1.5, v)),
        roughness: roughness.into(),
        ..Dielectric::default()
    }))
}

/// A prism, its edge up, before the camera; light that it bends meets the upper edge of a wall.
fn prism(bsdf: Bsdf) -> Scene {
    let mut b = Builder::new();
    let glass = b.material([1.0; 3], [0.0; 3]);
    let wall = b.material([0.0; 3], WALL);
    let end = |x: f32| [[x, -1.0, -2.0], [x, -1.0, -4.0], [x, 1.0, -3.0]];
    let (left, right) = (end(-3.0), end(3.0));
    b.triangle(glass, left, true);
    b.triangle(glass, right, false);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        b.quad(glass, [left[i], left[j], right[j], right[i]]);
    }
    let top = -3.2;
    b.quad(
        wall,
        [
            [-30.0, -30.0, -8.0],
            [30.0, -30.0, -8.0],
            [30.0, top, -8.0],
            [-30.0, top, -8.0],
        ],
    );
    let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 0.2), 5, 5);
    scene.materials[0].bsdf = bsdf;
    scene.sky = Some(Sky::Gradient {
        zenith: ZENITH,
        nadir: NADIR,
    });
    scene
}

/// The scene of [`prism`] by one path of one wavelength, all of it in f64: its own triangle test,
/// Fresnel equations and matching functions.
struct Oracle<'a> {
    scene: &'a Scene,
    cauchy: Cauchy,
    /// What makes the means of red, green and blue weights 1.
    scale: [f64; 3],
}

impl<'a> Oracle<'a> {
    fn new(scene: &'a Scene) -> Self {
        let steps = 20_000;
        let mut sums = [0.0; 3];
        for k in 0..steps {
            let w = primaries(380.0 + 350.0 * (f64::from(k) + 0.5) / f64::from(steps));
            (0..3).for_each(|c| sums[c] += w[c] / f64::from(steps));
        }
        Self {
            scene,
            cauchy: Cauchy::from_abbe(1.5, ABBE),
            scale: sums.map(|s| 1.0 / s),
        }
    }

    fn sample(&self, x: u32, y: u32, sample: u32) -> [f64; 3] {
        let name = (u64::from(sample) << 32) | u64::from(y << 16 | x);
        let mut rng = Pcg64::seed_from_u64(name);
        let mut uniform = move || (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        // Of the camera: 5 x 5 pixels over -0.2 .. 0.2 at distance 1.
        let across = (f64::from(x) + uniform()) / 5.0 * 0.4 - 0.2;
        let down = (f64::from(y) + uniform()) / 5.0 * 0.4 - 0.2;
        let mut origin = DVec3::ZERO;
        let mut direction = DVec3::new(across, -down, -1.0).normalize();
        let wavelength = 380.0 + 350.0 * uniform();
        let mut weight = [1.0; 3];
        let mut radiance = 1.0;
        let mut left = usize::MAX;
        loop {
            let Some((hit, t, outside)) = self.closest(origin, direction, left) else {
                let half = 0.5 * (direction.y + 1.0);
                let sky = |c: usize| f64::from(NADIR[c]) + f64::from(ZENITH[c] - NADIR[c]) * half;
                return [0, 1, 2].map(|c| sky(c) * weight[c] * radiance);
            };
            if self.scene.mesh.material[hit] == 1 {
                let front = outside.dot(direction) < 0.0;
                let emitted = WALL.map(|e| if front { f64::from(e) } else { 0.0 });
                return [0, 1, 2].map(|c| emitted[c] * weight[c] * radiance);
            }
            if left == usize::MAX {
                let w = primaries(wavelength);
                weight = [0, 1, 2].map(|c| w[c] * self.scale[c]);
            }
            let n = f64::from(self.cauchy.a) + f64::from(self.cauchy.b) / wavelength.powi(2);
            let cos = outside.dot(direction);
            let (normal, eta) = if cos < 0.0 {
                (outside, n)
            } else {
                (-outside, 1.0 / n)
            };
            let cos = cos.abs();
            let under = 1.0 - (1.0 - cos * cos) / (eta * eta);
            let reflectance = if under <= 0.0 {
                1.0
            } else {
                let inner = under.sqrt();
                let s = (cos - eta * inner) / (cos + eta * inner);
                let p = (eta * cos - inner) / (eta * cos + inner);
                0.5 * (s * s + p * p)
            };
            origin += t * direction;
            left = hit;
            if uniform() < reflectance {
                direction += 2.0 * cos * normal;
            } else {
                direction = direction / eta + (cos / eta - under.sqrt()) * normal;
                radiance /= eta * eta;
            }
        }
    }

    fn closest(&self, o: DVec3, d: DVec3, left: usize) -> Option<(usize, f64, DVec3)> {
        let mut best: Option<(usize, f64, DVec3)> = None;
        for i in (0..self.scene.mesh.triangles()).filter(|i| *i != left) {
            let corners = self.scene.mesh.corners(i);
            let [a, b, c] = corners.map(|p| DVec3::from_array(p.map(f64::from)));
            let normal = (b - a).cross(c - a);
            let t = (a - o).dot(normal) / d.dot(normal);
            let p = o + t * d;
            let inside = [(a, b), (b, c), (c, a)]
                .iter()
                .all(|&(from, to)| (to - from).cross(p - from).dot(normal) >= 0.0);
            // Coplanar halves of a face share its plane: what is left is left.
            if inside && t > 1e-9 && best.is_none_or(|(_, other, _)| t < other) {
                best = Some((i, t, normal.normalize()));
            }
        }
        best
    }
}

/// The matching functions of sRGB's primaries: CIE 1931 in the fit of Wyman, Sloan and Shirley (2013),
/// by IEC 61966-2-1's matrix.
fn primaries(nm: f64) -> [f64; 3] {
    let lobe = |scale: f64, mean: f64, below: f64, above: f64| {
        let t = (nm - mean) * if nm < mean { below } else { above };
        scale * (-0.5 * t * t).exp()
    };
    let x = lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323)
        - lobe(0.065, 501.1, 0.0490, 0.0382);
    let y = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322);
    let z = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725);
    [
        3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
        -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
        0.0556434 * x - 0.2040259 * y + 1.0572252 * z,
    ]
}

fn settings(spp: u32) -> Settings {
    Settings {
        spp,
        roulette: false,
        ..independent()
    }
}

#[test]
fn a_prism_agrees_with_paths_of_one_wavelength() {
    let scene = prism(glass(Some(ABBE), 0.0));
    let oracle = Oracle::new(&scene);
    let expected = by_samples(&scene, 40_000, |x, y, k| oracle.sample(x, y, k));
    let rendered = by_wave(&scene, &settings(20_000));
    same(&rendered, &expected, SIGNIFICANCE).unwrap();
    // Paths that end at random have the same mean, though throughput is negative in part.
    let ended = Settings {
        roulette: true,
        ..settings(20_000)
    };
    same(&by_wave(&scene, &ended), &expected, SIGNIFICANCE).unwrap();
    let plain = by_wave(&prism(glass(None, 0.0)), &settings(2000));
    assert!(same(&plain, &expected, SIGNIFICANCE).is_err());
    assert!(same(&rendered.scaled(1.03), &expected, SIGNIFICANCE).is_err());
}

/// What does not depend on wavelengths stays as it is: glass that hardly disperses is plain glass.
#[test]
fn without_dispersion_the_glass_is_plain() {
    for roughness in [0.0, 0.4] {
        let seeded = Settings {
            seed: 1,
            ..settings(20_000)
        };
        let plain = by_wave(&prism(glass(None, roughness)), &seeded);
        let limit = by_wave(&prism(glass(Some(1e9), roughness)), &settings(20_000));
        same(&limit, &plain, SIGNIFICANCE).unwrap();
    }
}

/// With light samples and without, through rough dispersive glass.
#[test]
fn rough_glass_has_one_image_with_and_without_light_samples() {
    let scene = prism(glass(Some(ABBE), 0.5));
    let with = |strategy, seed| {
        let settings = Settings {
            strategy,
            seed,
            ..settings(20_000)
        };
        by_wave(&scene, &settings)
    };
    let (expected, found) = (with(Strategy::Cosine, 1), with(Strategy::Mis, 2));
    same(&found, &expected, SIGNIFICANCE).unwrap();
    assert!(same(&found.scaled(1.05), &expected, SIGNIFICANCE).is_err());
}

/// Under an even sky glass is not to be seen, whatever the wavelength.
#[test]
fn a_furnace_stays_white() {
    let mut scene = prism(glass(Some(ABBE), 0.0));
    scene.materials[1].emission.factor = [0.0; 3];
    // The wall takes its part: without it, all paths end in the sky.
    scene.mesh.indices.truncate(8);
    scene.mesh.material.truncate(8);
    scene.sky = Some(Sky::Gradient {
        zenith: [1.0; 3],
        nadir: [1.0; 3],
    });
    let picture = by_wave(&scene, &settings(4000));
    for c in 0..3 {
        assert_mean(&format!("channel {c}"), picture.overall(c), 1.0, 3);
    }
    assert!(picture.variance[12][0] > 0.0, "seen through the prism");
}

/// A low-discrepancy sequence of wavelengths has the same mean.
#[test]
fn with_sobol_points_the_image_is_the_same() {
    let scene = prism(glass(Some(ABBE), 0.0));
    let sobol = Settings {
        sampler: Sampler::Sobol,
        ..settings(64)
    };
    let z = threshold(0.5 * SIGNIFICANCE, 3 * 25);
    let found = over_seeds(&scene, &sobol, 64, z);
    let expected = by_wave(&scene, &settings(20_000));
    same(&found, &expected, SIGNIFICANCE).unwrap();
}

/// A path whose only light is of negative weight goes on: red light is the same over a red floor as
/// over a white one, path by path.
#[test]
fn no_path_is_lost_where_all_that_is_left_is_negative() {
    let over = |floor: [f32; 3]| -> Picture {
        let mut scene = prism(glass(Some(ABBE), 0.0));
        let wall = &mut scene.materials[1];
        wall.emission.factor = [0.0; 3];
        wall.bsdf = Bsdf::Diffuse {
            reflectance: floor.into(),
            roughness: 0.0,
        };
        scene.sky = Some(Sky::Gradient {
            zenith: [1.0; 3],
            nadir: [0.5; 3],
        });
        by_wave(&scene, &settings(500))
    };
    let (red, white) = (over([0.8, 0.0, 0.0]), over([0.8; 3]));
    let channel = |p: &Picture| p.mean.iter().map(|m| m[0]).collect::<Vec<f64>>();
    assert_eq!(channel(&red), channel(&white));
}

#[test]
fn bits_do_not_depend_on_the_wave_nor_do_branches() {
    for split in [vec![], vec![3, 2]] {
        let scene = prism(glass(Some(ABBE), 0.3));
        let base = Settings {
            spp: 30,
            split,
            threads: 1,
            wave: 4096,
            ..Settings::default()
        };
        let bits = |settings: &Settings| -> Vec<[u32; 3]> {
            let image = render(&scene, settings).0;
            image.mean.iter().map(|p| p.map(f32::to_bits)).collect()
        };
        let whole = bits(&base);
        for (threads, wave, tile) in [(3, 64, 2), (2, 8, 3), (1, 500, 16)] {
            let settings = Settings {
                threads,
                wave,
                tile,
                ..base.clone()
            };
            assert!(bits(&settings) == whole, "{threads}, {wave}, {tile}");
        }
    }
}

/// Branches keep the wavelength of their path: their mean is that of single paths.
#[test]
fn branches_keep_their_wavelength() {
    let scene = prism(glass(Some(ABBE), 0.3));
    let branched = Settings {
        split: vec![2, 2],
        ..settings(5000)
    };
    let expected = Settings {
        seed: 1,
        ..settings(20_000)
    };
    let (a, b) = (by_wave(&scene, &branched), by_wave(&scene, &expected));
    same(&a, &b, SIGNIFICANCE).unwrap();
}
