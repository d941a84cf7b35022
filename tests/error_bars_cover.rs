//! The variance that a film estimates makes error bars that hold as often as they say.

mod common;

use common::picture::{independent, over_seeds, render};
use common::scenes::{Builder, cornell_box, floor_from_above};
use huygens::estimate::normal_quantile;
use huygens::scene::{Scene, Sky};
use huygens::settings::{Integrator, Settings, Strategy};

/// How often intervals of level 0.95 about the pixels of 24 renders hold the truth, of how many.
fn covered(scene: &Scene, settings: &Settings) -> (f64, f64) {
    let truth = over_seeds(
        scene,
        &Settings {
            spp: 4096,
            ..settings.clone()
        },
        16,
        0.0,
    );
    let half = -normal_quantile(0.025);
    let (mut inside, mut all) = (0, 0);
    for seed in 100..124 {
        let settings = Settings {
            seed,
            ..settings.clone()
        };
        let image = render(scene, &settings).0;
        for (i, (mean, variance)) in image.mean.iter().zip(&image.variance).enumerate() {
            for c in 0..3 {
                let v = f64::from(variance[c]);
                // A pixel that is the same in every sample has no error to cover.
                if v > 0.0 {
                    let apart = (f64::from(mean[c]) - truth.mean[i][c]).abs();
                    // The truth's own noise is a 64th of a render's variance.
                    inside += i32::from(apart <= half * (v + truth.variance[i][c]).sqrt());
                    all += 1;
                }
            }
        }
    }
    (f64::from(inside), f64::from(all))
}

fn assert_covers(what: &str, scene: &Scene, settings: &Settings) {
    let (inside, all) = covered(scene, settings);
    assert!(all > 2000.0, "{what}: there is noise");
    // The channels of a pixel go together, so a third of the values are independent: binomially
    // scattered, five standard deviations (6e-7). Skewed samples cost coverage in proportion to 1/n
    // (P. Hall, "The Bootstrap and Edgeworth Expansion", 1992, section 2.3): for a skewness g of the
    // samples and a normal quantile z, g^2 z (z^4 + 2 z^2 - 3) phi(z) / (9 n) to first order, which is
    // 0.2% at g = 3 and n = 1024.
    let scatter = 5.0 * (0.95 * 0.05 / (all / 3.0)).sqrt();
    let share = inside / all;
    assert!(
        (share - 0.95).abs() < scatter + 0.002,
        "{what}: {share} of {all}"
    );
}

fn settings(spp: u32) -> Settings {
    Settings {
        integrator: Integrator::Direct,
        strategy: Strategy::Light,
        spp,
        ..independent()
    }
}

#[test]
fn under_a_sky_with_something_in_the_way() {
    let mut b = Builder::new();
    let grey = b.material([0.5; 3], [0.0; 3]);
    b.quad(
        grey,
        [
            [-1.0, 1.0, -1.0],
            [1.0, 1.0, -1.0],
            [1.0, 1.0, 1.0],
            [-1.0, 1.0, 1.0],
        ],
    );
    let mut scene = floor_from_above(0.5, b);
    (scene.film.width, scene.film.height) = (8, 8);
    scene.sky = Some(Sky::constant([1.0, 2.0, 3.0]));
    assert_covers("sky", &scene, &settings(1024));
}

#[test]
fn in_the_direct_light_of_the_cornell_box() {
    assert_covers("box", &cornell_box(10), &settings(1024));
}
