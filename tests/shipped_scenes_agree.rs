//! The wave gives the image of the f64 reference on every scene of `scenes/` that the reference can
//! render in bearable time.

mod common;

use common::picture::{by_reference, by_wave, independent};
use common::statistics::{SIGNIFICANCE, same};
use huygens::reference::Reference;
use huygens::scene::{self, Bsdf, LightKind, Material, Scene};
use huygens::settings::{Integrator, Settings, Strategy, TextureLod};
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

/// Makes suns that are discs 45 degrees wide, as bright as they are on what faces them. The reference samples
/// lights on diffuse surfaces alone, and finds what others reflect by following directions: one of 26,000 that
/// are spread over the hemisphere meets a sun of 1 degree, too few of so many samples to tell it from none.
fn widen_suns(scene: &mut Scene) {
    for light in &mut scene.lights {
        if let LightKind::Distant { half_angle, .. } = &mut light.kind
            && *half_angle > 0.0
        {
            *half_angle = half_angle.max(22.5);
        }
    }
}

#[test]
fn shipped_scenes_look_the_same_in_f64() {
    let (mut compared, mut left) = (0, Vec::<(String, String)>::new());
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
        widen_suns(&mut scene);
        // A path of one wavelength tells less of three channels.
        let times = if scene.disperses() { 3 } else { 1 };
        let settings = |integrator, spp: u32| Settings {
            integrator,
            strategy: Strategy::Mis,
            spp: times * spp,
            max_depth: Some(DEPTH),
            // As the reference does: over footprints of an eighth of the image, images and the slopes of bump
            // maps would be another picture. `textured_surfaces_agree` holds footprints against it.
            texture_lod: TextureLod::Finest,
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
        // How much too bright or too dark a picture has to be to be seen: 5%, though lamps fill parts
        // of pixels; more through polished glass, where few paths find the lamps.
        let clear =
            |m: &Material| matches!(&m.bsdf, Bsdf::Dielectric(g) if g.roughness == 0.0.into());
        let seen = if scene.materials.iter().any(clear) {
            0.2
        } else {
            0.05
        };
        for factor in [1.0 - seen, 1.0 + seen] {
            let wrong = same(&rendered.scaled(factor), &expected, level);
            assert!(
                wrong.is_err(),
                "{name}: {factor} times the image passes too"
            );
        }
        compared += 1;
    }
    println!("{compared} compared; not compared: {left:?}");
    let expected = [
        ("bedroom", "too many triangles"),
        ("many-lights", "too many triangles"),
    ];
    assert_eq!(left, expected.map(|(name, why)| (name.into(), why.into())));
}
