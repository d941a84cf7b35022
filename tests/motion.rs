//! What moves while the shutter is open: instances and the camera.

mod common;

use common::agreement::Agreement;
use common::picture::{by_wave, independent, render, same_bits_however_it_runs};
use common::scenes::{Builder, camera_along_z, pinhole};
use common::statistics::{ROUNDING, SIGNIFICANCE, assert_mean, same};
use glam::{DAffine3, DQuat, DVec3};
use huygens::scene::{Fog, Medium, Motion, Scene, Sky};
use huygens::settings::{Settings, Strategy};

fn motion(travel: [f32; 3], axis: DVec3, turns: f32) -> Motion {
    Motion {
        travel,
        axis: axis.normalize().as_vec3().to_array(),
        turns,
    }
}

/// A floor, a lamp, and two boxes of one object: one moves, the other stands. The object's triangles
/// come first in `b`.
fn stage(first: Option<Motion>) -> Scene {
    let mut b = Builder::new();
    let red = b.material([0.7, 0.3, 0.2], [0.0; 3]);
    // Fronts outside.
    b.room(red, [0.4, 0.3, 0.2], [-0.4, -0.3, -0.2]);
    let object = b.object();
    let grey = b.material([0.5; 3], [0.0; 3]);
    let lamp = b.material([0.2; 3], [8.0, 6.0, 4.0]);
    b.floor(grey);
    let panel = [
        [0.5, 1.3, -3.0],
        [0.5, 1.3, -4.0],
        [1.5, 1.3, -4.0],
        [1.5, 1.3, -3.0],
    ];
    b.quad(lamp, panel);
    let place = |angle: f64, at: [f64; 3]| {
        let turn = DQuat::from_rotation_y(angle);
        DAffine3::from_scale_rotation_translation(DVec3::new(1.0, 1.4, 1.0), turn, at.into())
    };
    b.instance(object, &place(0.5, [-0.6, -0.2, -3.0]), None);
    b.instance(object, &place(-0.3, [0.7, -0.5, -3.4]), None);
    let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 0.6), 6, 6);
    scene.instances[0].motion = first;
    scene.sky = Some(Sky::Gradient {
        zenith: [0.2, 0.3, 0.5],
        nadir: [0.1, 0.1, 0.0],
    });
    scene
}

fn assert_agree(scene: &Scene) {
    let agreement = Agreement {
        strategies: &[Strategy::Cosine, Strategy::Light, Strategy::Mis],
        reference: 12_000,
        wave: 8192,
        off: 1.05,
    };
    agreement.assert_of(scene);
    let settings = Settings {
        strategy: Strategy::Mis,
        spp: 8192,
        max_depth: Some(3),
        ..independent()
    };
    assert!(
        same(
            &by_wave(&scene.frozen(0.0), &settings),
            &by_wave(scene, &settings),
            SIGNIFICANCE
        )
        .is_err(),
        "a still picture passes too"
    );
}

#[test]
fn a_box_that_flies_and_turns_agrees_with_the_reference() {
    let tumbles = motion([0.8, 0.5, -0.3], DVec3::new(1.0, 2.0, 0.5), 0.3);
    assert_agree(&stage(Some(tumbles)));
}

#[test]
fn a_camera_that_moves_agrees_with_the_reference() {
    let mut scene = stage(None);
    scene.camera_motion = Some(motion([0.3, 0.1, 0.2], DVec3::new(0.2, 1.0, 0.1), 0.05));
    assert_agree(&scene);
}

#[test]
fn all_that_moves_together_agrees_with_the_reference() {
    let mut scene = stage(Some(motion([-0.5, 0.4, 0.0], DVec3::NEG_Z, 0.6)));
    scene.camera_motion = Some(motion([0.0, 0.2, -0.3], DVec3::X, 0.03));
    let half = [0.6, 0.6];
    scene.camera.projection = common::scenes::thin_lens(half[0], 0.1, 3.0);
    assert_agree(&scene);
}

/// A black card that crosses the view evenly covers a point for as long as its width takes: here for
/// 1 / 4 of the time.
#[test]
fn a_card_covers_a_point_for_its_share_of_the_time() {
    let mut b = Builder::new();
    let black = b.material([0.0; 3], [0.0; 3]);
    b.quad(
        black,
        [
            [-0.5, -1.0, 0.0],
            [0.5, -1.0, 0.0],
            [0.5, 1.0, 0.0],
            [-0.5, 1.0, 0.0],
        ],
    );
    let card = b.object();
    let start = DAffine3::from_translation(DVec3::new(-2.3, 0.0, -5.0));
    b.instance(card, &start, None);
    let mut camera = camera_along_z([0.0; 3], -1.0, 1.0);
    camera.projection = pinhole(1e-6, 1e-6);
    let mut scene = b.scene(camera, 2, 2);
    scene.instances[0].motion = Some(motion([4.0, 0.0, 0.0], DVec3::Y, 0.0));
    scene.sky = Some(Sky::Gradient {
        zenith: [1.0; 3],
        nadir: [1.0; 3],
    });
    let settings = Settings {
        spp: 20_000,
        ..independent()
    };
    let picture = by_wave(&scene, &settings);
    assert_mean("what is seen past it", picture.overall(0), 0.75, 1);
}

/// Rays start off what moves far enough: a convex body under an even sky is as bright as its
/// reflectance, at every moment, whatever its transformation.
#[test]
fn what_moves_does_not_shadow_itself() {
    for (scale, far) in [(1.0, 0.0), (1e-3, 1.0), (30.0, 1e4)] {
        let mut b = Builder::new();
        let grey = b.material([0.5; 3], [0.0; 3]);
        b.room(grey, [2.0, 1.5, 1.0], [-2.0, -1.5, -1.0]);
        let object = b.object();
        let at = DVec3::new(far, 0.5 * far, -4.0 * scale);
        let turn = DQuat::from_rotation_x(0.4);
        let sheared = DVec3::new(1.0, 1.2, 0.7) * scale;
        let map = DAffine3::from_scale_rotation_translation(sheared, turn, at);
        b.instance(object, &map, None);
        let mut camera = camera_along_z([far as f32, 0.5 * far as f32, 0.0], -1.0, 1.0);
        camera.projection = pinhole(0.05, 0.05);
        let mut scene = b.scene(camera, 4, 4);
        let way = [0.1, -0.1, 0.1].map(|x: f32| x * scale as f32);
        scene.instances[0].motion = Some(motion(way, DVec3::new(1.0, 1.0, 0.3), 0.9));
        scene.sky = Some(Sky::Gradient {
            zenith: [1.0; 3],
            nadir: [1.0; 3],
        });
        for strategy in [Strategy::Cosine, Strategy::Mis] {
            let settings = Settings {
                strategy,
                spp: 4000,
                max_depth: Some(1),
                roulette: false,
                ..independent()
            };
            let picture = by_wave(&scene, &settings);
            if strategy == Strategy::Cosine {
                // Every single path finds a half: nothing scatters.
                for mean in picture.mean.as_flattened() {
                    assert!((mean - 0.5).abs() <= ROUNDING, "{scale}: {mean}");
                }
            } else {
                assert_mean("mis", picture.overall(1), 0.5, 3);
            }
        }
    }
}

/// From inside of a closed box that turns and flies nothing is seen of the sky.
#[test]
fn a_closed_box_that_moves_has_no_leaks() {
    let mut b = Builder::new();
    let black = b.material([0.0; 3], [0.0; 3]);
    b.room(black, [-1.0, -1.5, -2.0], [1.0, 1.5, 2.0]);
    let object = b.object();
    b.instance(object, &DAffine3::from_rotation_x(0.3), None);
    let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 1.5), 16, 16);
    scene.instances[0].motion = Some(motion([0.3, 0.2, 0.1], DVec3::new(1.0, -1.0, 0.5), 1.0));
    scene.sky = Some(Sky::Gradient {
        zenith: [1.0; 3],
        nadir: [1.0; 3],
    });
    let settings = Settings {
        spp: 2000,
        ..independent()
    };
    let (image, stats) = render(&scene, &settings);
    assert!(image.mean.as_flattened().iter().all(|&v| v == 0.0));
    assert!(stats.camera_rays >= 512_000);
}

#[test]
fn bits_do_not_depend_on_the_wave() {
    let mut scene = stage(Some(motion([-0.5, 0.4, 0.0], DVec3::NEG_Z, 0.6)));
    scene.camera_motion = Some(motion([0.0, 0.2, -0.3], DVec3::X, 0.03));
    scene.media.push(Medium {
        name: "mist".into(),
        absorption: [0.0; 3],
        scattering: [0.1; 3],
        g: 0.2,
    });
    scene.fog = Some(Fog {
        medium: 0,
        bounds: None,
    });
    same_bits_however_it_runs(&scene);
}

/// Branches live at the moment of their path.
#[test]
fn branches_have_the_mean_of_single_paths() {
    let scene = stage(Some(motion(
        [0.8, 0.5, -0.3],
        DVec3::new(1.0, 2.0, 0.5),
        0.3,
    )));
    let settings = |split, spp, seed| Settings {
        split,
        spp,
        seed,
        max_depth: Some(3),
        ..independent()
    };
    let single = by_wave(&scene, &settings(vec![], 8000, 1));
    let branched = by_wave(&scene, &settings(vec![2, 2], 4000, 2));
    same(&branched, &single, SIGNIFICANCE).unwrap();
}
