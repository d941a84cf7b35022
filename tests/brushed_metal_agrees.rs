//! Brushed metal lies along texture coordinates, in the wave and in the reference.

mod common;
mod scene_folder;

use common::agreement::{assert_images_agree, of_images};
use common::picture::{Picture, by_wave};
use common::statistics::{SIGNIFICANCE, same};
use huygens::effects::Effects;
use huygens::scene::Scene;
use huygens::settings::{Settings, Strategy};
use scene_folder::Folder;

/// Shapes under a lamp and a sky of two colours, of a metal without compensation, whose tables are not
/// in question here.
fn room(anisotropy: f32, shapes: &str) -> Scene {
    let text = format!(
        "[camera]\norigin = [0.6, 0.9, 1.6]\ntarget = [0.5, 0.2, 0]\nfov = 40\n\
         [film]\nwidth = 8\nheight = 8\nfilter = \"box\"\n\
         [sky]\nradiance = [0.9, 0.5, 0.2]\nnadir = [0.1, 0.4, 0.8]\n\
         [materials.m]\nkind = \"conductor\"\nmetal = \"silver\"\nroughness = 0.6\n\
         anisotropy = {anisotropy}\ncompensation = false\n\
         [materials.lamp]\nalbedo = 0\nemission = 2\n\
         [[shapes]]\nmaterial = \"lamp\"\n\
         rectangle = {{ corner = [0.1, 1.2, 0.8], edges = [[0, 0, -0.9], [0.9, 0, 0]] }}\n{shapes}"
    );
    Folder::new().with("s.toml", text).scene("s.toml")
}

/// A floor whose (u, v) are turned against its edges by `degrees`.
fn floor(degrees: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let at = |x: f64, y: f64| format!("[{}, {}]", cos * x - sin * y, sin * x + cos * y);
    format!(
        "[[shapes]]\nmaterial = \"m\"\n\
         mesh = {{ vertices = [[0, 0, 1], [1.2, 0, 1], [1.2, 0, 0], [0, 0, 0]], \
         faces = [[0, 1, 2, 3]], uvs = [{}, {}, {}, {}] }}\n",
        at(0.0, 0.0),
        at(1.0, 0.0),
        at(1.0, 1.0),
        at(0.0, 1.0)
    )
}

const BALL: &str =
    "[[shapes]]\nmaterial = \"m\"\nsphere = { center = [0.55, 0.35, 0.1], radius = 0.45 }\n";

#[test]
fn on_a_floor_whose_coordinates_are_turned() {
    assert_images_agree(&room(0.9, &floor(35.0)));
}

#[test]
fn on_a_sphere_along_its_circles_of_latitude() {
    assert_images_agree(&room(0.9, BALL));
}

/// Smooth normals, stretched, and once mirrored.
#[test]
fn on_copies() {
    let tent = "[[objects.tent.shapes]]\nmaterial = \"m\"\n\
         mesh = { vertices = [[0, 0, 0], [1, 0, 0], [1, 0.5, -0.6], [0, 0.5, -0.6]], \
         faces = [[0, 1, 2], [0, 2, 3]], uvs = [[0, 0], [1, 0.4], [0.8, 1], [-0.3, 1]], \
         normals = [[-0.3, 1, 0.8], [0.3, 1, 0.8], [0.2, 1, 0.4], [-0.2, 1, 0.4]] }\n\
         [[instances]]\nobject = \"tent\"\ntransform = [{ scale = [0.6, 1.4, 1] }]\n\
         [[instances]]\nobject = \"tent\"\ntransform = [{ scale = [-0.5, 1, 0.9] }, \
         { rotate = { axis = [0, 0, 1], degrees = 15 } }, { translate = [1.2, 0, 0.1] }]\n";
    assert_images_agree(&room(-0.8, tent));
}

fn seen(scene: &Scene, seed: u32) -> Picture {
    let settings = Settings {
        seed,
        spp: 4096,
        ..of_images(Strategy::Mis)
    };
    by_wave(scene, &settings)
}

/// Along u and along v are a quarter turn apart, and not the same.
#[test]
fn a_quarter_turn_of_the_coordinates_turns_the_brush() {
    let along_u = seen(&room(0.9, &floor(0.0)), 1);
    let along_v = seen(&room(-0.9, &floor(90.0)), 2);
    same(&along_v, &along_u, SIGNIFICANCE).unwrap();
    let turned = seen(&room(0.9, &floor(90.0)), 2);
    assert!(same(&turned, &along_u, SIGNIFICANCE).is_err());
}

/// It calls for a stage and a queue where there are coordinates, and for nothing where there are none.
#[test]
fn without_coordinates_nothing_is_aligned() {
    let bare = "[[shapes]]\nmaterial = \"m\"\n\
         mesh = { vertices = [[0, 0, 1], [1, 0, 1], [1, 0, 0]], faces = [[0, 1, 2]] }\n";
    let asks = |scene: &Scene| {
        let effects = Effects::of(scene, &scene.settings);
        let found = effects.list.into_iter();
        found
            .filter(|e| e.name == "anisotropy along u")
            .map(|e| e.reason)
            .collect::<Vec<_>>()
    };
    let mut scene = room(0.9, bare);
    scene.mesh.uvs.clear();
    assert_eq!(asks(&scene), Vec::<String>::new());
    assert_eq!(asks(&room(0.9, BALL)), ["material `m`"]);
    assert_eq!(asks(&room(0.0, BALL)), Vec::<String>::new());
}
