//! Lights that images and opacities vary: the wave beside the reference.

mod common;
mod scene_folder;

use common::picture::{by_reference, by_wave, independent, render};
use common::statistics::same;
use huygens::scene::Scene;
use huygens::settings::{LightSelection, Settings, Strategy};
use image::{ImageBuffer, Rgba};
use scene_folder::Folder;

/// A floor before a screen that wears `m` and shines on it, with a post between them. The screen is
/// of eight triangles, each of which shows a part of the image, some of it black.
fn screen(material: &str) -> Scene {
    seen(
        material,
        "origin = [0.3, 1.6, 2.5]\ntarget = [0, 0.4, -0.6]\nfov = 48",
        2,
    )
}

/// The same from elsewhere, on a floor of that half size.
fn seen(material: &str, camera: &str, half: u32) -> Scene {
    let folder = Folder::new();
    let image = ImageBuffer::from_fn(6, 4, |x, y| {
        let bright = if x < 2 { 0 } else { 50 * x as u8 };
        Rgba([
            bright,
            80 * y as u8,
            255 - bright,
            if (x + y) % 2 == 0 { 220 } else { 90 },
        ])
    });
    image.save(folder.path("i.png")).unwrap();
    let quad = |k: usize| {
        let (x, u) = (-1.0 + 0.5 * k as f64, 0.25 * k as f64);
        format!(
            "[[shapes]]\nmaterial = \"m\"\nmesh = {{ vertices = [[{x}, 0.2, -1], [{0}, 0.2, -1], \
             [{0}, 1.2, -1], [{x}, 1.2, -1]], faces = [[0, 1, 2, 3]], \
             uvs = [[{u}, 0], [{1}, 0], [{1}, 1], [{u}, 1]] }}\n",
            x + 0.5,
            u + 0.25
        )
    };
    let quads: String = (0..4).map(quad).collect();
    let text = format!(
        "[camera]\n{camera}\n\
         [film]\nwidth = 8\nheight = 8\nfilter = \"box\"\n[sky]\nradiance = 0.05\n\
         [materials.m]\nalbedo = 0.3\ntwo_sided = true\n{material}\n\
         [[shapes]]\n\
         rectangle = {{ corner = [-{half}, 0, {half}], edges = [[{0}, 0, 0], [0, 0, -{0}]] }}\n\
         [[shapes]]\nbox = {{ min = [-0.1, 0, -0.4], max = [0.1, 0.5, -0.2] }}\n{quads}",
        2 * half
    );
    folder.scene_of(&text)
}

fn settings(strategy: Strategy) -> Settings {
    Settings {
        strategy,
        spp: 1024,
        max_depth: Some(2),
        ..independent()
    }
}

/// By every strategy and selection of lights, as the reference sees it.
#[track_caller]
fn assert_agrees(scene: &Scene) {
    assert_eq!(scene.warnings, Vec::<String>::new());
    // Directions find the screen rarely: as many samples as make their mean a normal variable.
    let many = Settings {
        spp: 16_384,
        ..settings(Strategy::Cosine)
    };
    let truth = by_reference(scene, &many);
    let agrees = |what: &str, settings: &Settings| {
        let seen = by_wave(scene, settings);
        // Five pictures at 1e-5 together.
        if let Err(difference) = same(&seen, &truth, 1e-5 / 5.0) {
            panic!("{what}: {difference}");
        }
    };
    agrees("cosine", &settings(Strategy::Cosine));
    agrees("mis", &settings(Strategy::Mis));
    for selection in [
        LightSelection::Power,
        LightSelection::Uniform,
        LightSelection::Tree,
    ] {
        let settings = Settings {
            light_selection: selection,
            ..settings(Strategy::Light)
        };
        agrees(&format!("{selection:?}"), &settings);
    }
}

#[test]
fn images() {
    assert_agrees(&screen(
        "emission = { file = \"i.png\", factor = [4, 3, 5], wrap = \"clamp\" }",
    ));
}

#[test]
fn masks() {
    assert_agrees(&screen(
        "emission = [2, 3, 1]\nalpha = { file = \"i.png\", filter = \"nearest\" }\nalpha_cutoff = 0.5",
    ));
}

#[test]
fn images_of_partial_opacity() {
    assert_agrees(&screen(
        "emission = { file = \"i.png\", factor = 4 }\nalpha = { file = \"i.png\", scale = 0.5 }",
    ));
}

/// A ball that shines with an image, turned, over a floor.
#[test]
fn images_on_spheres() {
    let folder = Folder::new();
    let image = ImageBuffer::from_fn(6, 4, |x, y| image::Rgb([40 * x as u8, 80 * y as u8, 150]));
    image.save(folder.path("i.png")).unwrap();
    let scene = folder.scene_of(
        "[camera]\norigin = [0.3, 1.6, 2.5]\ntarget = [0, 0.4, 0]\nfov = 48\n\
         [film]\nwidth = 8\nheight = 8\nfilter = \"box\"\n[sky]\nradiance = 0.05\n\
         [materials.m]\nalbedo = 0.3\nemission = { file = \"i.png\", factor = [4, 3, 5] }\n\
         [[shapes]]\nrectangle = { corner = [-2, 0, 2], edges = [[4, 0, 0], [0, 0, -4]] }\n\
         [[shapes]]\nmaterial = \"m\"\nsphere = { center = [0, 0, 0], radius = 0.4 }\n\
         transform = [{ rotate = { axis = [1, 0, 1], degrees = 40 } }, { translate = [0, 0.7, 0] }]\n",
    );
    assert_agrees(&scene);
}

/// Selection by what each triangle's part of the image holds: the image has less noise than by what
/// the image may hold at most, which is what `uniform` amounts to for triangles of one size.
#[test]
fn bright_parts_are_chosen_more_often() {
    // From so far away that all of the screen lights the floor alike.
    let scene = seen(
        "emission = { file = \"i.png\", factor = [4, 0, 0] }",
        "origin = [0, 6, 14]\ntarget = [0, 0, 12]\nfov = 10",
        20,
    );
    let noise = |light_selection| {
        let settings = Settings {
            light_selection,
            spp: 256,
            ..settings(Strategy::Light)
        };
        let image = render(&scene, &settings).0;
        image.variance.iter().map(|v| f64::from(v[0])).sum::<f64>()
    };
    let (power, uniform) = (noise(LightSelection::Power), noise(LightSelection::Uniform));
    // The left third of the image is black, so a good third of uniform samples is spent on nothing.
    assert!(power < 0.8 * uniform, "{power} {uniform}");
}
