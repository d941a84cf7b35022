//! The oracle itself, against answers that need no renderer.

mod common;

use common::picture::{Picture, by_reference};
use common::scenes::{Builder, camera_along_z, cornell_box, floor_from_above, furnace};
use common::statistics::{SIGNIFICANCE, assert_mean, same};
use huygens::estimate::Running;
use huygens::film::{Job, SampleBuffer, Tile};
use huygens::reference::Reference;
use huygens::scene::{Scene, Sky};
use huygens::settings::{Settings, Strategy};
use std::sync::atomic::AtomicBool;

fn settings(strategy: Strategy, max_depth: u32, spp: u32) -> Settings {
    Settings {
        strategy,
        max_depth: Some(max_depth),
        spp,
        ..Settings::default()
    }
}

/// All samples of all pixels of channel 0, for scenes in which all pixels mean the same.
fn mean(scene: &Scene, settings: &Settings) -> Running {
    let reference = Reference::new(scene, settings);
    let (w, h) = (scene.film.width, scene.film.height);
    let pixels = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
    pixels
        .flat_map(|(x, y)| (0..settings.spp).map(move |s| (x, y, s)))
        .map(|(x, y, s)| reference.render_sample(x, y, s)[0])
        .collect()
}

#[test]
fn a_furnace_cut_at_n_gives_the_geometric_series() {
    for (i, albedo) in [0.0f32, 0.1, 0.5, 0.9, 0.99].into_iter().enumerate() {
        for depth in 0..=6 {
            let rho = f64::from(albedo);
            let expected: f64 = (0..=depth).map(|k| rho.powi(k as i32)).sum();
            // By the cosine every path carries the same, so there is no noise at all.
            let cosine = mean(&furnace(albedo), &settings(Strategy::Cosine, depth, 64));
            assert!((cosine.mean() / expected - 1.0).abs() < 64.0 * f64::EPSILON);
            assert!(cosine.variance().unwrap() < 1e-20 * expected);
            if depth > 0 && i > 0 {
                let uniform = mean(&furnace(albedo), &settings(Strategy::Uniform, depth, 4096));
                assert_mean("uniform", (&uniform).into(), expected, 4 * 6);
            }
        }
    }
}

#[test]
fn the_deepest_recursion_fits_a_thread_and_closes_the_furnace() {
    let unlimited = Settings {
        strategy: Strategy::Cosine,
        max_depth: Some(u32::MAX),
        spp: 4,
        ..Settings::default()
    };
    let rho = f64::from(0.99f32);
    let closed = mean(&furnace(0.99), &unlimited).mean();
    // The series cut at 2048, to as many roundings.
    let expected = (1.0 - rho.powi(2049)) / (1.0 - rho);
    assert!((closed / expected - 1.0).abs() < 2048.0 * f64::EPSILON);
}

#[test]
fn a_lambertian_floor_under_a_sky_reflects_its_albedo() {
    let mut scene = floor_from_above(0.3, Builder::new());
    scene.sky = Some(Sky::constant([2.0, 2.0, 2.0]));
    let reflected = mean(&scene, &settings(Strategy::Uniform, 1, 16_384));
    assert_mean("floor", (&reflected).into(), 2.0 * f64::from(0.3f32), 1);
    // A ray that meets nothing sees the sky itself.
    let li = Reference::new(&scene, &scene.settings).li(
        &mut rand_pcg::Pcg64::new(0, 0),
        [0.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        0,
    );
    assert_eq!(li, [2.0; 3]);
}

#[test]
fn emission_leaves_the_front_only_unless_two_sided() {
    // A square before a camera that looks along -z; its front faces +z, towards the camera.
    let square = |forward: f32, two_sided: bool| {
        let mut b = Builder::new();
        let light = b.material([0.5; 3], [3.0; 3]);
        if two_sided {
            b.two_sided();
        }
        let d = 1e2;
        b.quad(
            light,
            [[-d, -d, 0.0], [d, -d, 0.0], [d, d, 0.0], [-d, d, 0.0]],
        );
        let scene = b.scene(camera_along_z([0.0, 0.0, -forward], forward, 1.0), 2, 2);
        mean(&scene, &settings(Strategy::Cosine, 0, 16)).mean()
    };
    assert_eq!(square(-1.0, false), 3.0);
    assert_eq!(square(1.0, false), 0.0);
    assert_eq!(square(1.0, true), 3.0);
}

#[test]
fn the_image_does_not_depend_on_how_it_is_cut_into_jobs() {
    let scene = cornell_box(6);
    let reference = Reference::new(&scene, &settings(Strategy::Uniform, 3, 64));
    let render = |job: &Job| {
        let mut buffer = SampleBuffer::new(job.slots());
        assert!(reference.render_job(job, &mut buffer, &AtomicBool::new(false)));
        buffer
    };
    let tile = |x, y, width, height| Tile {
        x,
        y,
        width,
        height,
    };
    let job = |tile, first_sample, samples| Job {
        tile_index: 0,
        tile,
        first_sample,
        samples,
    };
    let whole = render(&job(tile(0, 0, 6, 6), 0, 64));
    let part = render(&job(tile(2, 3, 4, 2), 5, 40));
    let mut lit = 0;
    for (i, value) in part.radiance[1].iter().enumerate() {
        let (pixel, sample) = (i / 40, 5 + i % 40);
        let (x, y) = (2 + pixel % 4, 3 + pixel / 4);
        assert_eq!(*value, whole.radiance[1][(y * 6 + x) * 64 + sample]);
        lit += u32::from(*value > 0.0);
    }
    assert!(lit > 0);
}

#[test]
fn hemisphere_strategies_agree_on_the_cornell_box() {
    let scene = cornell_box(4);
    let [uniform, cosine]: [Picture; 2] = [Strategy::Uniform, Strategy::Cosine]
        .map(|strategy| by_reference(&scene, &settings(strategy, 4, 32_768)));
    same(&uniform, &cosine, SIGNIFICANCE).unwrap();
    // A tenth more in one of them would have been seen.
    assert!(same(&uniform, &cosine.scaled(1.1), SIGNIFICANCE).is_err());
}

#[test]
fn the_first_pixel_is_the_top_left_one() {
    // A camera at the origin that looks along -z: right is +x, up is +y. The lit square covers the
    // upper left quarter of its view and nothing else.
    let mut b = Builder::new();
    let light = b.material([0.0; 3], [1.0; 3]);
    let (near, far) = (0.0, -9.0);
    b.quad(
        light,
        [
            [far, near, -1.0],
            [near, near, -1.0],
            [near, 9.0, -1.0],
            [far, 9.0, -1.0],
        ],
    );
    let scene = b.scene(camera_along_z([0.0; 3], -1.0, 1.0), 2, 2);
    let picture = by_reference(&scene, &settings(Strategy::Cosine, 0, 16));
    let lit: Vec<f64> = picture.mean.iter().map(|p| p[0]).collect();
    assert_eq!(lit, [1.0, 0.0, 0.0, 0.0]);
}
