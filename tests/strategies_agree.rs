//! Every strategy of the wave, and the reference through the scheduler, give the Cornell box that
//! the reference once gave with many samples: tests/data/cornell-box.txt.
//!
//! To make that file again, after a change that is meant to change the answer:
//!
//! ```text
//! cargo test --release --test strategies_agree -- --ignored make_the_stored_picture
//! ```

mod common;

use common::picture::{Picture, by_reference, by_wave, independent, over_seeds};
use common::scenes::{Builder, camera_along_z, cornell_box};
use common::statistics::{SIGNIFICANCE, same, threshold};
use huygens::scene::{Scene, Sky};
use huygens::settings::{Integrator, Sampler, Settings, Strategy};

const STORED: &str = include_str!("data/cornell-box.txt");
const SIZE: u32 = 16;
const STORED_SPP: u32 = 1 << 18;

/// Four scattering events: light from every wall on every other, in paths short enough to store
/// an accurate answer.
const MAX_DEPTH: u32 = 4;

fn settings(integrator: Integrator, strategy: Strategy, spp: u32) -> Settings {
    Settings {
        integrator,
        strategy,
        spp,
        max_depth: Some(MAX_DEPTH),
        ..independent()
    }
}

/// What the stored file says.
struct Stored {
    picture: Picture,
    /// Variance and skewness of a single sample, with uniform and with cosine directions.
    uniform: Law,
    cosine: Law,
}

struct Law {
    variance: Vec<[f64; 3]>,
    skewness: Vec<[f64; 3]>,
}

impl Law {
    /// `picture`, of `spp` samples a pixel that follow this law, with the error that they have, not
    /// the one that they estimate: a dim pixel finds the light so rarely that its own estimate is
    /// small whenever its mean is.
    fn applied_to(&self, picture: Picture, spp: u32) -> Picture {
        let n = f64::from(spp);
        let divided =
            |column: &[[f64; 3]], by: f64| column.iter().map(|p| p.map(|v| v / by)).collect();
        Picture {
            variance: divided(&self.variance, n),
            skewness: divided(&self.skewness, n.sqrt()),
            ..picture
        }
    }
}

impl Stored {
    fn read() -> Self {
        let mut lines = STORED.lines().filter(|line| !line.starts_with('#'));
        let numbers = |line: &str| -> Vec<f64> {
            let number = |n: &str| n.parse().expect("a number");
            line.split_whitespace().map(number).collect()
        };
        let spp = numbers(lines.next().expect("a number of samples"))[0] as u32;
        let rows: Vec<_> = lines.map(numbers).collect();
        assert_eq!(rows.len(), (SIZE * SIZE) as usize, "a line a pixel");
        let column = |k: usize| -> Vec<[f64; 3]> {
            let pixel = |row: &Vec<f64>| [row[3 * k], row[3 * k + 1], row[3 * k + 2]];
            rows.iter().map(pixel).collect()
        };
        let law = |k: usize| Law {
            variance: column(k),
            skewness: column(k + 1),
        };
        let blank = Picture {
            width: SIZE as usize,
            height: SIZE as usize,
            mean: column(0),
            variance: Vec::new(),
            skewness: Vec::new(),
        };
        Self {
            picture: law(3).applied_to(blank, spp),
            uniform: law(1),
            cosine: law(3),
        }
    }
}

/// Five comparisons share [`SIGNIFICANCE`].
fn assert_agrees(name: &str, settings: &Settings, law: impl Fn(&Stored) -> Option<&Law>) {
    let stored = Stored::read();
    let mut rendered = by_wave(&cornell_box(SIZE), settings);
    if let Some(law) = law(&stored) {
        rendered = law.applied_to(rendered, settings.spp);
    }
    if let Err(difference) = same(&rendered, &stored.picture, SIGNIFICANCE / 5.0) {
        let path = rendered.leave_behind(&format!("strategies_agree-{name}"));
        panic!("{name}: {difference} (the render is in {path})");
    }
    // The same comparison must not pass an image that is 2% wrong, either way.
    for factor in [0.98, 1.02] {
        let wrong = same(
            &rendered.scaled(factor),
            &stored.picture,
            SIGNIFICANCE / 5.0,
        );
        assert!(
            wrong.is_err(),
            "{name}: {factor} times the image passes too"
        );
    }
}

// Blind directions find the small light rarely, so these need the known law, and as many samples as
// bring the error of the whole picture's mean to 0.3%: seven of those are 2%.

#[test]
fn uniform_agrees() {
    let settings = settings(Integrator::Path, Strategy::Uniform, 32_768);
    assert_agrees("uniform", &without_roulette(settings), |stored| {
        Some(&stored.uniform)
    });
}

#[test]
fn cosine_agrees() {
    let settings = settings(Integrator::Path, Strategy::Cosine, 24_576);
    assert_agrees("cosine", &without_roulette(settings), |stored| {
        Some(&stored.cosine)
    });
}

#[test]
fn reference_agrees() {
    let settings = settings(Integrator::Reference, Strategy::Cosine, 24_576);
    assert_agrees("reference", &settings, |stored| Some(&stored.cosine));
}

#[test]
fn light_agrees() {
    assert_agrees(
        "light",
        &settings(Integrator::Path, Strategy::Light, 8192),
        |_| None,
    );
}

#[test]
fn mis_agrees() {
    assert_agrees(
        "mis",
        &settings(Integrator::Path, Strategy::Mis, 8192),
        |_| None,
    );
}

/// Samplers, each with numbers of samples that it likes and such that it does not. Six comparisons
/// share [`SIGNIFICANCE`].
#[test]
fn every_sampler_agrees() {
    let stored = Stored::read().picture;
    let scene = cornell_box(SIZE);
    let level = SIGNIFICANCE / 6.0;
    for (sampler, spp) in [
        (Sampler::Stratified, 16),
        (Sampler::Stratified, 13),
        (Sampler::Sobol, 16),
        (Sampler::Sobol, 21),
        (Sampler::BlueNoise, 16),
        (Sampler::BlueNoise, 9),
    ] {
        let settings = Settings {
            sampler,
            ..settings(Integrator::Path, Strategy::Mis, spp)
        };
        let z = threshold(0.5 * level, 3 * stored.mean.len());
        // As many samples as `mis_agrees` takes.
        let rendered = over_seeds(&scene, &settings, 8192 / spp, z);
        if let Err(difference) = same(&rendered, &stored, level) {
            let path = rendered.leave_behind(&format!("every_sampler_agrees-{sampler:?}-{spp}"));
            panic!("{sampler:?}, {spp}: {difference} (the render is in {path})");
        }
        for factor in [0.98, 1.02] {
            let wrong = same(&rendered.scaled(factor), &stored, level);
            assert!(
                wrong.is_err(),
                "{sampler:?}: {factor} times the image passes too"
            );
        }
    }
}

/// The stored law of a sample is that of paths which only the depth ends.
fn without_roulette(mut settings: Settings) -> Settings {
    settings.roulette = false;
    settings
}

/// One wrong pixel in one channel is found too.
#[test]
fn a_wrong_pixel_is_seen() {
    let stored = Stored::read().picture;
    let mut wrong = stored.clone();
    wrong.mean[100][1] *= 1.3;
    same(&stored, &stored, SIGNIFICANCE).unwrap();
    let message = same(&wrong, &stored, SIGNIFICANCE).unwrap_err();
    assert!(message.starts_with("pixel (4, 6), channel 1"), "{message}");
}

/// A sky and a lamp, both of which light a floor and a tilted plate above it.
fn lamp_under_sky() -> Scene {
    let mut b = Builder::new();
    let grey = b.material([0.7, 0.5, 0.3], [0.0; 3]);
    let lamp = b.material([0.2; 3], [6.0, 8.0, 10.0]);
    b.quad(
        grey,
        [
            [-9.0, -1.0, 9.0],
            [9.0, -1.0, 9.0],
            [9.0, -1.0, -9.0],
            [-9.0, -1.0, -9.0],
        ],
    );
    b.quad(
        grey,
        [
            [-1.0, -0.5, -3.0],
            [0.5, -0.5, -3.0],
            [0.5, 0.5, -4.0],
            [-1.0, 0.5, -4.0],
        ],
    );
    b.quad(
        lamp,
        [
            [0.8, 1.0, -3.0],
            [0.8, 1.0, -4.0],
            [1.6, 1.0, -4.0],
            [1.6, 1.0, -3.0],
        ],
    );
    let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 0.7), 6, 6);
    scene.sky = Some(Sky::Gradient {
        zenith: [0.5, 0.7, 1.0],
        nadir: [0.4, 0.1, 0.0],
    });
    scene
}

#[test]
fn all_agree_under_a_sky() {
    let scene = lamp_under_sky();
    let reference = Settings {
        seed: 1,
        ..settings(Integrator::Reference, Strategy::Cosine, 16_384)
    };
    let expected = by_reference(&scene, &reference);
    for strategy in [
        Strategy::Uniform,
        Strategy::Cosine,
        Strategy::Light,
        Strategy::Mis,
    ] {
        let rendered = by_wave(&scene, &settings(Integrator::Path, strategy, 8192));
        same(&rendered, &expected, SIGNIFICANCE / 4.0)
            .unwrap_or_else(|difference| panic!("{strategy:?}: {difference}"));
        assert!(same(&rendered.scaled(1.02), &expected, SIGNIFICANCE / 4.0).is_err());
    }
}

/// Renders tests/data/cornell-box.txt: a few minutes.
#[test]
#[ignore = "makes the file that the others compare with"]
fn make_the_stored_picture() {
    let [uniform, cosine] = [Strategy::Uniform, Strategy::Cosine].map(|strategy| {
        let settings = Settings {
            // Not the seed of the tests: the reference is compared with this as well.
            seed: 1,
            ..settings(Integrator::Reference, strategy, STORED_SPP)
        };
        by_reference(&cornell_box(SIZE), &settings)
    });
    let mut text = format!(
        "# The Cornell box of tests/common/scenes.rs, {SIZE} x {SIZE}, depth {MAX_DEPTH}, by the f64 reference.\n\
         # First the number of samples a pixel, then a line a pixel in scanline order; each column is\n\
         # a red, a green and a blue number: mean radiance by cosine directions; variance and\n\
         # skewness of one sample, by uniform directions; the same by cosine directions.\n\
         # Made by tests/strategies_agree.rs, which says how.\n\
         {STORED_SPP}\n"
    );
    let n = f64::from(STORED_SPP);
    for i in 0..(SIZE * SIZE) as usize {
        let [u, c] = [&uniform, &cosine].map(|p| {
            [
                p.variance[i].map(|v| v * n),
                p.skewness[i].map(|s| s * n.sqrt()),
            ]
        });
        let mut row = cosine.mean[i].map(|m| format!("{m:.7e}")).join(" ");
        for column in [u, c].as_flattened() {
            row += "  ";
            row += &column.map(|m| format!("{m:.3e}")).join(" ");
        }
        text += &row;
        text.push('\n');
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cornell-box.txt");
    std::fs::write(path, text).expect("tests/data is writable");
}
