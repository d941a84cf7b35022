//! Russian roulette ends paths and leaves the expectation as it is.

mod common;

use common::picture::{Picture, by_wave, render};
use common::scenes::cornell_box;
use common::statistics::{SIGNIFICANCE, same};
use huygens::scene::Scene;
use huygens::settings::{Settings, Strategy};

fn settings(strategy: Strategy, roulette: bool) -> Settings {
    Settings {
        strategy,
        roulette,
        spp: 16_384,
        max_depth: None,
        // The two renders must not share their noise.
        seed: u32::from(roulette),
        ..Settings::default()
    }
}

/// The Cornell box from lower down, where the light, which would be most of the noise, is out of
/// sight.
fn scene() -> Scene {
    let mut scene = cornell_box(12);
    scene.camera.origin[1] = 100.0;
    scene
}

#[test]
fn roulette_on_and_off_have_the_same_mean() {
    for strategy in [Strategy::Light, Strategy::Mis] {
        let [off, on]: [Picture; 2] =
            [false, true].map(|roulette| by_wave(&scene(), &settings(strategy, roulette)));
        same(&off, &on, SIGNIFICANCE / 2.0).unwrap_or_else(|e| panic!("{strategy:?}: {e}"));
        assert!(
            same(&off, &on.scaled(1.01), SIGNIFICANCE / 2.0).is_err(),
            "{strategy:?}: 1% must be seen"
        );
    }
}

#[test]
fn roulette_does_end_paths() {
    let [off, on] =
        [false, true].map(|roulette| render(&scene(), &settings(Strategy::Mis, roulette)).1);
    assert!(
        on.mean_depth < off.mean_depth,
        "{} of {}",
        on.mean_depth,
        off.mean_depth
    );
    assert!(on.bounce_rays < off.bounce_rays);
}
