//! Renders that end by their error: they reach it, know it, and do not depend on who computed them.

mod common;

use common::picture::{Picture, by_wave, independent};
use common::scenes::cornell_box;
use common::statistics::{SIGNIFICANCE, same, threshold};
use huygens::accuracy::{Ended, Goal, Rounds, render_rounds};
use huygens::estimate::{Running, student_quantile};
use huygens::geometry::Geometry;
use huygens::scene::Scene;
use huygens::settings::{Integrator, Sampler, Settings, Strategy};
use huygens::wave::Control;

fn rounds(scene: &Scene, settings: &Settings, error: f64, spp: u32) -> Rounds {
    let geometry = Geometry::build(&scene.mesh);
    let goal = Goal {
        error: Some(error),
        spp,
    };
    render_rounds(scene, &geometry, settings, goal, &Control::default())
}

/// The relative error of `image` against `truth`, as the documentation defines it; the truth's own
/// noise taken out.
fn error(image: &[[f32; 3]], truth: &Picture) -> f64 {
    let values = truth.mean.as_flattened();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let floor = 0.01 * mean * mean;
    let noise = truth.variance.as_flattened();
    let each = image.as_flattened().iter().zip(values).zip(noise);
    let squares = each.map(|((a, b), v)| ((f64::from(*a) - b).powi(2) - v) / (b * b + floor));
    (squares.sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
fn the_error_is_reached_and_is_what_it_is_said_to_be() {
    // Four blocks: the ceiling with the light, and others.
    let scene = cornell_box(40);
    let many = Settings {
        spp: 1 << 13,
        seed: 77,
        ..independent()
    };
    let truth = by_wave(&scene, &many);
    for sampler in [Sampler::Independent, Sampler::Sobol] {
        let (mut ratio, mut uneven) = (Running::new(), 0);
        for seed in 0..4 {
            let settings = Settings {
                sampler,
                seed,
                ..Settings::default()
            };
            let done = rounds(&scene, &settings, 0.1, 1 << 14);
            assert_eq!(done.ended, Ended::Error);
            assert!(done.error <= 0.1 && done.error > 0.07, "{}", done.error);
            ratio.push(error(&done.image.mean, &truth) / done.error);
            let counts = &done.image.samples;
            uneven += u32::from(counts.iter().min() < counts.iter().max());
        }
        assert!(uneven > 1, "{sampler:?}: some blocks need more samples");
        // The promise is a tenth; Sobol's estimate may be too large, never too small, by more.
        let [low, high] = ratio.confidence_interval(0.999).expect("four");
        assert!(low < 1.1, "{sampler:?}: {ratio:?}");
        if sampler == Sampler::Independent {
            assert!(high > 0.9, "{sampler:?}: {ratio:?}");
        }
        assert!((ratio.mean() - 1.0).abs() < 0.1, "{sampler:?}: {ratio:?}");
    }
}

#[test]
fn the_image_does_not_depend_on_threads_wave_or_tiles() {
    let scene = cornell_box(36);
    let run = |threads, wave, tile| {
        let settings = Settings {
            threads,
            wave,
            tile,
            ..Settings::default()
        };
        let done = rounds(&scene, &settings, 0.2, 4096);
        (done.image, done.error.to_bits())
    };
    let whole = run(1, 2048, 32);
    for (threads, wave, tile) in [(2, 2048, 32), (3, 100, 8), (1, 16_384, 64)] {
        assert!(
            run(threads, wave, tile) == whole,
            "{threads}, {wave}, {tile}"
        );
    }
}

/// Renders that stop when they look calm are biased; the mean of 64 of them must not show it, within
/// error bars that are an eighth of one render's.
#[test]
fn the_bias_of_stopping_is_far_below_the_noise() {
    let scene = cornell_box(12);
    let many = Settings {
        spp: 1 << 15,
        seed: 78,
        ..independent()
    };
    let truth = by_wave(&scene, &many);
    let mut pixels = vec![[Running::new(); 3]; truth.mean.len()];
    let mut samples = Running::new();
    for seed in 0..64 {
        let settings = Settings {
            seed,
            ..independent()
        };
        let done = rounds(&scene, &settings, 0.15, 1 << 14);
        samples.push(done.image.samples[0].into());
        for (pixel, mean) in pixels.iter_mut().zip(&done.image.mean) {
            (0..3).for_each(|c| pixel[c].push(mean[c].into()));
        }
    }
    assert!(
        samples.variance() > Some(0.0),
        "they do stop at different times"
    );
    // Wider by what Student's distribution exceeds a normal one, as in `over_seeds`.
    let z = threshold(SIGNIFICANCE, 3 * pixels.len());
    let student = 1.0 + (z * z + 1.0) / (4.0 * 63.0);
    let bar = |r: &Running| (r.standard_error().expect("64") * student).powi(2);
    let stopped = Picture {
        mean: pixels.iter().map(|p| p.map(|c| c.mean())).collect(),
        variance: pixels.iter().map(|p| p.each_ref().map(bar)).collect(),
        skewness: vec![[0.0; 3]; pixels.len()],
        ..truth.clone()
    };
    if let Err(wrong) = same(&stopped, &truth, SIGNIFICANCE) {
        panic!("{wrong}");
    }
}

/// Whole images of error bars, in the direct light of the box: intervals of level 0.95 hold the truth in
/// 95% of the pixels, although a render goes on where it looks noisy and stops where it looks calm.
#[test]
fn intervals_of_renders_that_stopped_hold_as_often_as_they_say() {
    let scene = cornell_box(40);
    let direct = Settings {
        integrator: Integrator::Direct,
        strategy: Strategy::Light,
        ..independent()
    };
    let many = Settings {
        spp: 1 << 14,
        seed: 79,
        ..direct.clone()
    };
    let truth = by_wave(&scene, &many);
    let (mut inside, mut all, mut samples) = (0.0, 0f64, Running::new());
    for seed in 0..8 {
        let settings = Settings {
            seed,
            ..direct.clone()
        };
        let done = rounds(&scene, &settings, 0.03, 1 << 14);
        assert_eq!(done.ended, Ended::Error);
        for (i, &n) in done.image.samples.iter().enumerate() {
            samples.push(n.into());
            // Eight rounds of 4 samples, then rounds of 16.
            let freedom = 7 + u64::from(n - 32) / 16;
            let reach = -student_quantile(0.025, freedom);
            for c in 0..3 {
                let variance = f64::from(done.image.variance[i][c]);
                // A pixel that is the same in every sample has no error to cover.
                if variance > 0.0 {
                    let apart = (f64::from(done.image.mean[i][c]) - truth.mean[i][c]).abs();
                    let bar = (variance + truth.variance[i][c]).sqrt();
                    inside += f64::from(u8::from(apart <= reach * bar));
                    all += 1.0;
                }
            }
        }
    }
    assert!(
        samples.variance() > Some(0.0),
        "blocks stop at different times"
    );
    // As in `error_bars_cover`: five standard deviations of a share of pixels, and what samples of a
    // skewness of 3 cost, 0.2% at 1024 of them.
    let scatter = 5.0 * (0.95 * 0.05 / (all / 3.0)).sqrt();
    let skewed = 0.002 * 1024.0 / samples.mean();
    let share = inside / all;
    assert!(
        (share - 0.95).abs() < scatter + skewed,
        "{share} of {all}, at {} samples",
        samples.mean()
    );
}

#[test]
fn the_ceiling_holds_to_the_sample() {
    let scene = cornell_box(8);
    for spp in [1, 3, 31, 32, 50] {
        let done = rounds(&scene, &Settings::default(), 1e-6, spp);
        assert_eq!(done.ended, Ended::Samples);
        assert!(done.image.samples.iter().all(|&n| n == spp), "{spp}");
        assert_eq!(done.error.is_finite(), spp > 4, "two rounds at least");
    }
}
