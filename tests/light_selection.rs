//! However lights are chosen, the image is the same; what a tree gains is less noise.

mod common;

use common::picture::{Picture, by_reference, by_wave, independent};
use common::scenes::{Builder, camera_along_z};
use common::statistics::{SIGNIFICANCE, same};
use huygens::effects::light_selection;
use huygens::scene::{Camera, Light, LightKind, Scene, Sky, Spot};
use huygens::settings::{Integrator, LightSelection, Settings, Strategy};

/// Numbers in [0, 1) (SplitMix64; Steele, Lea, Flood, OOPSLA 2014).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }
}

/// A floor `wide` each way and a plate above it, under `lamps` triangles of about `size` that face
/// anywhere, every other one to both sides. They reflect nothing and stay clear of the rest: between
/// surfaces that meet, a light sample's variance has no bound.
fn lamps_over_a_floor(lamps: usize, wide: f32, size: f32) -> Scene {
    let mut numbers = Numbers(61);
    let mut b = Builder::new();
    let grey = b.material([0.7, 0.6, 0.5], [0.0; 3]);
    let warm = b.material([0.0; 3], [9.0, 6.0, 2.0]);
    let cold = b.material([0.0; 3], [2.0, 4.0, 9.0]);
    b.two_sided();
    b.quad(
        grey,
        [
            [-wide, -1.0, wide],
            [wide, -1.0, wide],
            [wide, -1.0, -wide],
            [-wide, -1.0, -wide],
        ],
    );
    b.quad(
        grey,
        [
            [-1.0, -0.5, -3.0],
            [0.5, -0.5, -3.0],
            [0.5, 0.3, -4.0],
            [-1.0, 0.3, -4.0],
        ],
    );
    for lamp in 0..lamps {
        let size = size * (0.5 + numbers.next());
        let place = [
            wide * (2.0 * numbers.next() - 1.0),
            0.5 + size + 2.0 * numbers.next(),
            wide * (2.0 * numbers.next() - 1.0) * 0.8 - 0.2 * wide,
        ];
        let corner = |numbers: &mut Numbers| place.map(|c| c + size * (numbers.next() - 0.5));
        let corners = std::array::from_fn(|_| corner(&mut numbers));
        b.triangle([warm, cold][lamp % 2], corners, false);
    }
    b.scene(camera_along_z([0.0; 3], -1.0, 0.7), 6, 6)
}

fn settings(strategy: Strategy, light_selection: LightSelection, spp: u32) -> Settings {
    Settings {
        strategy,
        light_selection,
        spp,
        max_depth: Some(2),
        ..independent()
    }
}

const SELECTIONS: [LightSelection; 3] = [
    LightSelection::Uniform,
    LightSelection::Power,
    LightSelection::Tree,
];

fn expected(scene: &Scene) -> Picture {
    let reference = Settings {
        integrator: Integrator::Reference,
        seed: 1,
        ..settings(Strategy::Cosine, LightSelection::Auto, 131_072)
    };
    by_reference(scene, &reference)
}

fn assert_all_agree(scene: &Scene, strategies: &[Strategy]) {
    let expected = expected(scene);
    let level = SIGNIFICANCE / (strategies.len() * SELECTIONS.len()) as f64;
    for &strategy in strategies {
        for selection in SELECTIONS {
            let rendered = by_wave(scene, &settings(strategy, selection, 32_768));
            same(&rendered, &expected, level)
                .unwrap_or_else(|difference| panic!("{strategy:?}, {selection:?}: {difference}"));
            // The means of both are known to 0.9% together at worst: seven of those.
            assert!(
                same(&rendered.scaled(1.06), &expected, level).is_err(),
                "{strategy:?}, {selection:?}: 6% more passes too"
            );
        }
    }
}

#[test]
fn among_triangles() {
    let scene = lamps_over_a_floor(40, 3.0, 1.0);
    assert_all_agree(&scene, &[Strategy::Light, Strategy::Mis]);
}

#[test]
fn among_lights_of_all_kinds() {
    let mut scene = lamps_over_a_floor(12, 3.0, 1.0);
    let mut numbers = Numbers(63);
    for k in 0..9 {
        let mut number = || 2.0 * numbers.next() - 1.0;
        let position = [2.0 * number(), 1.0 + number(), 2.0 * number() - 2.0];
        let spot = Spot {
            axis: [0.0, -1.0, 0.0],
            dark: 0.7,
            full: if k % 2 == 0 { 0.7 } else { 0.9 },
        };
        scene.lights.push(Light {
            name: format!("light {k}"),
            kind: LightKind::Point {
                position,
                intensity: [0.4, 0.3, 0.3],
                spot: (k % 3 != 0).then_some(spot),
            },
        });
    }
    scene.lights.push(Light {
        name: "sun".into(),
        kind: LightKind::Distant {
            from: [0.6, 0.8, 0.0],
            irradiance: [0.3; 3],
            half_angle: 25.0,
        },
    });
    scene.sky = Some(Sky::constant([0.1, 0.15, 0.2]));
    // Of the last, directions find all but points and spots, among which it chooses.
    assert_all_agree(&scene, &[Strategy::Light, Strategy::Mis, Strategy::Cosine]);
}

#[test]
fn many_lights_get_a_tree_and_few_do_not() {
    let chosen = |scene: &Scene, asked, strategy| {
        let settings = settings(strategy, asked, 1);
        light_selection(scene, &settings)
    };
    let (many, few) = (
        lamps_over_a_floor(40, 3.0, 1.0),
        lamps_over_a_floor(3, 3.0, 1.0),
    );
    let auto = LightSelection::Auto;
    let said = |(selection, reason): (LightSelection, String)| (selection, reason);
    assert_eq!(
        said(chosen(&many, auto, Strategy::Mis)),
        (
            LightSelection::Tree,
            "40 lights at a finite distance".into()
        )
    );
    assert_eq!(chosen(&few, auto, Strategy::Mis).0, LightSelection::Power);
    // What directions find is not sampled, so it is not chosen from.
    assert_eq!(
        chosen(&many, auto, Strategy::Cosine).0,
        LightSelection::Power
    );
    assert_eq!(
        chosen(&few, LightSelection::Tree, Strategy::Mis).0,
        LightSelection::Tree
    );
    let mut none = lamps_over_a_floor(0, 3.0, 1.0);
    none.sky = Some(Sky::constant([1.0; 3]));
    assert_eq!(
        chosen(&none, LightSelection::Tree, Strategy::Mis),
        (
            LightSelection::Power,
            "no light at a finite distance".into()
        )
    );
}

/// 400 lamps over a wide floor, most of which hardly reach the part of it that the camera, below all
/// of them, looks down on.
#[test]
fn a_tree_takes_most_of_the_noise_of_many_lights() {
    let mut scene = lamps_over_a_floor(400, 20.0, 0.3);
    scene.camera = Camera {
        forward: [0.0, -1.0, 0.0],
        right: [1.0, 0.0, 0.0],
        up: [0.0, 0.0, -1.0],
        ..camera_along_z([2.0, 0.0, 2.0], -1.0, 1.0)
    };
    let variance = |selection| {
        let settings = Settings {
            max_depth: Some(1),
            ..settings(Strategy::Mis, selection, 4096)
        };
        let picture = by_wave(&scene, &settings);
        picture.variance.as_flattened().iter().sum::<f64>()
    };
    let [uniform, power, tree] = SELECTIONS.map(variance);
    // 5.9 and 4.8 times when this was written.
    assert!(tree * 4.0 < power.min(uniform), "{tree} {power} {uniform}");
}
