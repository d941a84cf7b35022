//! The wave gives the image of the f64 reference on every scene of `scenes/` that the reference can
//! render in bearable time.

mod common;

use common::picture::{by_reference, by_wave, independent};
use common::statistics::{SIGNIFICANCE, same};
use huygens::reference::Reference;
use huygens::scene;
use huygens::settings::{Integrator, Settings, Strategy};
use std::path::{Path, PathBuf};

/// Scattering events: enough for light from everywhere to everywhere.
const DEPTH: u32 = 5;

fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = std::fs::read_dir(folder).expect("it ships");
    let paths = files.map(|file| file.expect("readable").path());
    let mut scenes: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    scenes.sort();
    scenes
}

#[test]
fn shipped_scenes_look_the_same_in_f64() {
    let (mut compared, mut left) = (0, Vec::new());
    let scenes = shipped();
    for path in &scenes {
        let name = path
            .file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let mut scene = scene::load(path).expect("it ships");
        if !Reference::supports(&scene) {
            let why = scene.beyond_reference();
            left.push((name, why.unwrap_or_else(|| "too many triangles".into())));
            continue;
        }
        (scene.film.width, scene.film.height) = (8, 6);
        let settings = |integrator, spp| Settings {
            integrator,
            strategy: Strategy::Mis,
            spp,
            max_depth: Some(DEPTH),
            ..independent()
        };
        let reference = Settings {
            seed: 1,
            ..settings(Integrator::Reference, 8192)
        };
        let expected = by_reference(&scene, &reference);
        let rendered = by_wave(&scene, &settings(Integrator::Path, 16_384));
        let level = SIGNIFICANCE / scenes.len() as f64;
        if let Err(difference) = same(&rendered, &expected, level) {
            let path = rendered.leave_behind(&format!("shipped_scenes_agree-{name}"));
            panic!("{name}: {difference} (the render is in {path})");
        }
        // What is 5% too bright or too dark is seen, though lamps fill parts of pixels.
        for factor in [0.95, 1.05] {
            let wrong = same(&rendered.scaled(factor), &expected, level);
            assert!(
                wrong.is_err(),
                "{name}: {factor} times the image passes too"
            );
        }
        compared += 1;
    }
    println!("{compared} compared; not compared: {left:?}");
    assert!(compared >= 4, "{left:?}");
    // Nothing but size is a reason to leave a scene out.
    assert!(
        left.iter().all(|(_, why)| why == "too many triangles"),
        "{left:?}"
    );
}
