//! The image is a function of scene, settings and seed: not of threads, wave, tiles or the day.

mod common;
mod scene_folder;

use common::picture::render;
use common::scenes::{Builder, cornell_box, floor_from_above};
use huygens::effects::light_selection;
use huygens::film::Image;
use huygens::scene::{Environment, Light, LightKind, Scene, Sky};
use huygens::settings::{Integrator, LightSelection, Sampler, Settings, Strategy};
use scene_folder::Folder;
use std::sync::Arc;

/// Means and variances, bit by bit, and counts.
fn bits(image: &Image) -> (Vec<[u32; 3]>, Vec<[u32; 3]>, &[u32]) {
    let column = |c: &[[f32; 3]]| c.iter().map(|p| p.map(f32::to_bits)).collect();
    (column(&image.mean), column(&image.variance), &image.samples)
}

/// Renders `scene` in every way that must not matter.
fn assert_identical(scene: &Scene, base: &Settings) {
    let whole = render(scene, base).0;
    assert!(
        whole.mean.iter().flatten().any(|&v| v > 0.0),
        "not a black picture"
    );
    for (threads, wave, tile) in [
        (1, base.wave, base.tile),
        (2, base.wave, base.tile),
        (3, base.wave, base.tile),
        (1, 256, base.tile),
        (1, 16_384, base.tile),
        (1, base.wave, 8),
        (1, base.wave, 64),
        (3, 256, 8),
        (2, 16_384, 64),
    ] {
        let settings = Settings {
            threads,
            wave,
            tile,
            ..base.clone()
        };
        let image = render(scene, &settings).0;
        assert!(
            bits(&image) == bits(&whole),
            "{threads} threads, wave {wave}, tile {tile} change the image of {base:?}"
        );
    }
}

fn settings(strategy: Strategy, integrator: Integrator) -> Settings {
    Settings {
        strategy,
        integrator,
        spp: 100,
        seed: 5,
        ..Settings::default()
    }
}

/// Not square, and no multiple of any tile.
fn box_70_by_51() -> Scene {
    let mut scene = cornell_box(70);
    scene.film.height = 51;
    scene
}

#[test]
fn on_the_cornell_box() {
    let scene = box_70_by_51();
    assert_identical(&scene, &settings(Strategy::Mis, Integrator::Path));
}

#[test]
fn with_every_strategy_and_integrator() {
    let mut scene = box_70_by_51();
    (scene.film.width, scene.film.height) = (21, 18);
    for strategy in [Strategy::Uniform, Strategy::Cosine, Strategy::Light] {
        assert_identical(&scene, &settings(strategy, Integrator::Path));
    }
    for integrator in [
        Integrator::Direct,
        Integrator::Ao,
        Integrator::Normals,
        Integrator::Depth,
        Integrator::Albedo,
        Integrator::Reference,
    ] {
        let short = Settings {
            spp: 5,
            ..settings(Strategy::Mis, integrator)
        };
        assert_identical(&scene, &short);
    }
}

#[test]
fn with_every_sampler() {
    let mut scene = box_70_by_51();
    (scene.film.width, scene.film.height) = (21, 18);
    for sampler in [
        Sampler::Independent,
        Sampler::Stratified,
        Sampler::Sobol,
        Sampler::BlueNoise,
    ] {
        for spp in [64, 75] {
            let settings = Settings {
                sampler,
                spp,
                ..settings(Strategy::Mis, Integrator::Path)
            };
            assert_identical(&scene, &settings);
        }
    }
}

#[test]
fn under_a_sky() {
    let mut scene = floor_from_above(0.5, Builder::new());
    scene.sky = Some(Sky::Gradient {
        zenith: [0.25, 0.5, 1.0],
        nadir: [0.5, 0.25, 0.125],
    });
    (scene.film.width, scene.film.height) = (33, 40);
    scene.camera.projection = common::scenes::pinhole(1.0, 1.2);
    assert_identical(&scene, &settings(Strategy::Mis, Integrator::Path));
}

/// Along a light tree, beside a map and a disc.
#[test]
fn among_lights_of_many_kinds() {
    let mut scene = box_70_by_51();
    let light = |kind| Light {
        name: String::new(),
        kind,
    };
    let point = |k: usize| LightKind::Point {
        position: [40.0 + 28.0 * k as f32, 300.0, 280.0],
        intensity: [4000.0, 3000.0, 2000.0],
        spot: None,
    };
    scene.lights = (0..18).map(|k| light(point(k))).collect();
    scene.lights.push(light(LightKind::Distant {
        from: [0.0, 0.0, -1.0],
        irradiance: [1.0, 2.0, 3.0],
        half_angle: 3.0,
    }));
    scene.sky = Some(Sky::Map(Arc::new(Environment {
        width: 2,
        height: 1,
        texels: vec![[0.1, 0.2, 0.3], [0.9, 0.5, 0.1]],
        frame: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    })));
    let base = Settings {
        spp: 40,
        ..settings(Strategy::Mis, Integrator::Path)
    };
    let (selection, _) = light_selection(&scene, &base);
    assert_eq!(selection, LightSelection::Tree);
    assert_identical(&scene, &base);
}

#[test]
fn through_a_lens() {
    let mut scene = box_70_by_51();
    scene.camera.projection = common::scenes::thin_lens(0.4, 40.0, 1000.0);
    assert_identical(&scene, &settings(Strategy::Mis, Integrator::Direct));
}

/// Images of several kinds, a normal map, a mask and partial opacity, on a sphere and a copy too, and
/// branches on top of it.
#[test]
fn with_images_and_opacity() {
    let folder = Folder::new();
    let image = image::ImageBuffer::from_fn(16, 16, |x, y| {
        image::Rgba([
            15 * x as u8,
            15 * y as u8,
            220,
            if (x + y) % 5 < 3 { 230 } else { 30 },
        ])
    });
    image.save(folder.path("i.png")).unwrap();
    let sheet = |y: f64, material: &str| {
        format!(
            "[[shapes]]\nmaterial = \"{material}\"\n\
             rectangle = {{ corner = [-0.6, {y}, 0.6], edges = [[1.2, 0.1, 0], [0, 0, -1.2]] }}\n"
        )
    };
    let text = format!(
        "[camera]\norigin = [0.3, 2.2, 1.5]\ntarget = [0, 0.2, 0]\n\
         [film]\nwidth = 37\nheight = 21\n[sky]\nradiance = 0.3\n\
         [materials.floor]\nkind = \"principled\"\nbase_color = {{ file = \"i.png\", scale = 9 }}\n\
         roughness = {{ file = \"i.png\" }}\nnormal_map = {{ file = \"i.png\" }}\n\
         [materials.mask]\nalbedo = {{ file = \"i.png\" }}\nalpha = {{ file = \"i.png\" }}\nalpha_cutoff = 0.5\n\
         [materials.veil]\nalpha = 0.4\n[materials.lamp]\nalbedo = 0\nemission = {{ file = \"i.png\", factor = 9 }}\n\
         [[shapes]]\nmaterial = \"floor\"\n\
         rectangle = {{ corner = [-2, 0, 2], edges = [[4, 0, 0], [0, 0, -4]] }}\n\
         [[shapes]]\nmaterial = \"floor\"\nsphere = {{ center = [-0.5, 0.3, 0.6], radius = 0.3 }}\n\
         [[objects.leaf.shapes]]\nmaterial = \"mask\"\n\
         rectangle = {{ corner = [0, 0, 0], edges = [[0.5, 0, 0], [0, 0.5, 0]] }}\n\
         [[instances]]\nobject = \"leaf\"\ntransform = [{{ translate = [0.4, 0, 0.7] }}]\n\
         [[shapes]]\nmaterial = \"lamp\"\n\
         rectangle = {{ corner = [0.3, 1.6, 0.4], edges = [[0, 0, -0.5], [0.5, 0, 0]] }}\n{}{}",
        sheet(0.4, "mask"),
        sheet(0.7, "veil")
    );
    let scene = folder.scene_of(&text);
    let base = Settings {
        spp: 40,
        ..settings(Strategy::Mis, Integrator::Path)
    };
    assert_identical(&scene, &base);
    let branching = Settings {
        spp: 10,
        split: vec![2, 2],
        ..base
    };
    assert_identical(&scene, &branching);
}

#[test]
fn another_seed_is_another_image() {
    let scene = box_70_by_51();
    let base = Settings {
        spp: 1,
        ..settings(Strategy::Mis, Integrator::Path)
    };
    let other = Settings {
        seed: 6,
        ..base.clone()
    };
    assert!(bits(&render(&scene, &base).0) != bits(&render(&scene, &other).0));
}
