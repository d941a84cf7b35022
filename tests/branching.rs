//! Several ways on from a surface: as many rays as the formula says, the same light, and the same
//! image whatever the queues hold.

mod common;

use common::picture::{by_wave, independent, over_seeds, render};
use common::scenes::{cornell_box, furnace};
use common::statistics::{SIGNIFICANCE, same, threshold};
use huygens::settings::{Integrator, Sampler, Settings, Strategy};

/// `N^b` rays at bounce `b`: in a closed room without roulette every ray meets a surface, so the counts
/// are exact. Factors beyond the maximum depth do nothing.
#[test]
fn rays_grow_as_the_product_of_the_factors() {
    let scene = furnace(0.5);
    let spp = 3;
    let camera = u64::from(spp * scene.film.width * scene.film.height);
    for split in [
        vec![],
        vec![1],
        vec![3],
        vec![2, 3],
        vec![4, 1, 5],
        vec![7, 7, 7],
    ] {
        let settings = Settings {
            strategy: Strategy::Mis,
            roulette: false,
            max_depth: Some(3),
            split: split.clone(),
            spp,
            // Less than the branches of one path, in the last case.
            wave: 256,
            ..Settings::default()
        };
        let (_, stats) = render(&scene, &settings);
        let stage = |name: &str| {
            let stage = stats.stages.iter().find(|s| s.name == name).expect(name);
            stage
                .bounces
                .iter()
                .map(|b| b.items_in)
                .collect::<Vec<u64>>()
        };
        let factor = |b: usize| u64::from(split.get(b).copied().unwrap_or(1));
        let rays = |bounce: usize| camera * (0..bounce).map(factor).product::<u64>();
        let expected: Vec<u64> = (0..=3).map(rays).collect();
        assert_eq!(stage("intersect"), expected, "{split:?}");
        // Each of the ways on looks for light, from the surface that it leaves.
        let on = stage("shade: surface");
        assert_eq!(on[..3], expected[1..], "{split:?}");
        assert!(on[3..].iter().all(|&n| n == 0));
        let total: u64 = expected[1..].iter().sum();
        assert_eq!((stats.camera_rays, stats.bounce_rays), (camera, total));
    }
}

/// With every number of a path independent, so that the error bars hold.
#[test]
fn branches_have_the_mean_of_the_single_sum() {
    let scene = cornell_box(12);
    for strategy in [Strategy::Cosine, Strategy::Light, Strategy::Mis] {
        for roulette in [true, false] {
            let mut settings = Settings {
                strategy,
                roulette,
                max_depth: Some(6),
                // A cosine alone meets the light rarely: enough of them for means to be normal.
                spp: if strategy == Strategy::Cosine {
                    8192
                } else {
                    1024
                },
                ..independent()
            };
            let single = by_wave(&scene, &settings);
            settings.split = vec![4, 2];
            settings.seed = 1;
            settings.spp /= 4;
            let branching = by_wave(&scene, &settings);
            if let Err(wrong) = same(&single, &branching, SIGNIFICANCE / 6.0) {
                panic!("{strategy:?}, roulette {roulette}: {wrong}");
            }
        }
    }
}

/// The other samplers' branches complete each other, and the error bars are those of many seeds.
#[test]
fn branches_of_every_sampler_have_the_mean_of_the_single_sum() {
    let scene = cornell_box(8);
    let z = threshold(SIGNIFICANCE, 3 * 64);
    for sampler in [Sampler::Stratified, Sampler::Sobol, Sampler::BlueNoise] {
        let mut settings = Settings {
            sampler,
            spp: 64,
            ..Settings::default()
        };
        let single = over_seeds(&scene, &settings, 32, z);
        (settings.split, settings.spp, settings.seed) = (vec![4, 3], 16, 99);
        let branching = over_seeds(&scene, &settings, 32, z);
        if let Err(wrong) = same(&single, &branching, SIGNIFICANCE / 3.0) {
            panic!("{sampler:?}: {wrong}");
        }
    }
}

/// A factor beyond the queue's capacity is worked off in parts.
#[test]
fn the_image_does_not_depend_on_what_the_queues_hold() {
    let scene = cornell_box(10);
    for split in [vec![2], vec![3, 5], vec![300, 2]] {
        let bits = |threads: usize, wave: usize, tile: u32| {
            let settings = Settings {
                split: split.clone(),
                spp: 5,
                threads,
                wave,
                tile,
                ..Settings::default()
            };
            let image = render(&scene, &settings).0;
            assert!(image.mean.iter().flatten().any(|&v| v > 0.0));
            image.mean.map_bits()
        };
        let whole = bits(1, 2048, 32);
        for (threads, wave, tile) in [(1, 64, 32), (2, 16_384, 8), (3, 100, 4), (1, 1, 10)] {
            let other = bits(threads, wave, tile);
            assert!(
                whole == other,
                "{split:?}: {threads} threads, wave {wave}, tile {tile}"
            );
        }
    }
}

trait MapBits {
    fn map_bits(&self) -> Vec<[u32; 3]>;
}

impl MapBits for Vec<[f32; 3]> {
    fn map_bits(&self) -> Vec<[u32; 3]> {
        self.iter().map(|p| p.map(f32::to_bits)).collect()
    }
}

/// One way on is no branching, and quick looks have no way on.
#[test]
fn a_factor_of_one_changes_nothing() {
    let scene = cornell_box(10);
    for integrator in [Integrator::Path, Integrator::Ao, Integrator::Albedo] {
        let image = |split: &[u32]| {
            let settings = Settings {
                integrator,
                split: split.to_vec(),
                spp: 4,
                ..Settings::default()
            };
            render(&scene, &settings).0.mean
        };
        let single = image(&[]);
        assert!(image(&[1]) == single && image(&[1, 1]) == single);
        let branching = image(&[3]);
        assert_eq!(branching == single, integrator != Integrator::Path);
    }
}

/// What varies before the first surface (an edge through the pixel) stays; what varies after it falls.
#[test]
fn branches_lower_the_variance_of_a_camera_sample() {
    let scene = cornell_box(12);
    let variance = |split: Vec<u32>| {
        let settings = Settings {
            split,
            spp: 64,
            ..independent()
        };
        let image = render(&scene, &settings).0;
        image.variance
    };
    let (single, branching) = (variance(vec![]), variance(vec![4]));
    let pairs = single.as_flattened().iter().zip(branching.as_flattened());
    let lower = pairs
        .filter(|(single, branching)| branching < single)
        .count();
    // Of 432 variances that each are known to some 20%; without effect, half of them with a standard
    // deviation of 10.
    assert!(lower > 216 + 80, "{lower}");
}

/// As long as there are no mirrors.
#[test]
fn whitted_is_direct_light_by_lights_alone() {
    let scene = cornell_box(16);
    let settings = |integrator| Settings {
        integrator,
        strategy: Strategy::Light,
        spp: 8,
        ..Settings::default()
    };
    let (whitted, stats) = render(&scene, &settings(Integrator::Whitted));
    let (direct, _) = render(&scene, &settings(Integrator::Direct));
    assert!(whitted.mean == direct.mean);
    assert_eq!(stats.bounce_rays, 0);
    let cosine = Settings {
        strategy: Strategy::Cosine,
        ..settings(Integrator::Whitted)
    };
    assert!(
        render(&scene, &cosine).0.mean == direct.mean,
        "whatever the strategy"
    );
}
