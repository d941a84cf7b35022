//! A scene without light is black, a scene without surfaces is sky, and nothing goes wrong in
//! either.

mod common;

use common::picture::render;
use common::scenes::{Builder, camera_along_z, cornell_box};
use huygens::film::Film;
use huygens::geometry::Geometry;
use huygens::scene::Sky;
use huygens::settings::{Settings, Strategy};
use huygens::wave::{self, Control};

const STRATEGIES: [Strategy; 4] = [
    Strategy::Uniform,
    Strategy::Cosine,
    Strategy::Light,
    Strategy::Mis,
];

fn settings(strategy: Strategy) -> Settings {
    Settings {
        strategy,
        spp: 8,
        ..Settings::default()
    }
}

#[test]
fn no_light_renders_black() {
    let mut scene = cornell_box(9);
    for material in &mut scene.materials {
        material.emission = [0.0; 3].into();
    }
    for strategy in STRATEGIES {
        // `render` asserts that nothing was dropped.
        let (image, stats) = render(&scene, &settings(strategy));
        assert!(
            image.mean.iter().flatten().all(|&v| v == 0.0),
            "{strategy:?}"
        );
        assert_eq!(
            stats.shadow_rays, 0,
            "{strategy:?}: there is no light to look for"
        );
    }
}

#[test]
fn no_surface_renders_the_sky() {
    let mut scene = Builder::new().scene(camera_along_z([0.0; 3], -1.0, 1.0), 5, 3);
    for sky in [None, Some([0.25, 0.5, 3.0])] {
        scene.sky = sky.map(Sky::constant);
        for strategy in STRATEGIES {
            let image = render(&scene, &settings(strategy)).0;
            // Sums of eight equal numbers are exact.
            assert_eq!(
                image.mean,
                vec![sky.unwrap_or_default(); 15],
                "{strategy:?}"
            );
        }
    }
}

#[test]
fn rays_that_cannot_be_traced_are_counted_and_named() {
    let mut scene = cornell_box(4);
    scene.sky = Some(Sky::constant([1.0; 3]));
    scene.camera.origin[1] = f32::NAN;
    let settings = settings(Strategy::Mis);
    let film = Film::new(4, 4, settings.tile);
    let geometry = Geometry::build(&scene.mesh);
    let stats = wave::render(&scene, &geometry, &settings, &film, &Control::default());
    let [lost] = &stats.untraceable[..] else {
        panic!("{:?}", stats.untraceable);
    };
    assert_eq!((lost.stage, lost.count), ("intersect", 4 * 4 * 8));
    assert!(
        lost.examples
            .iter()
            .all(|&(x, y, s)| x < 4 && y < 4 && s < 8)
    );
    // Each is counted once, and none brings the sky to the film.
    assert!(stats.dropped.is_empty(), "{:?}", stats.dropped);
    assert!(film.develop().mean.iter().flatten().all(|&v| v == 0.0));
}
