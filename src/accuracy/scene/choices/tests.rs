//! Choices are as many as scenes have, each once.

use super::*;
use crate::settings::{Strategy, TextureLod};
use std::collections::BTreeSet;

fn scene(change: impl FnOnce(&mut Settings)) -> Scene {
    shipped("cornell-box", change)
}

fn shipped(name: &str, change: impl FnOnce(&mut Settings)) -> Scene {
    let path = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let mut scene = crate::scene::load(path.as_ref()).expect("it ships");
    change(&mut scene.settings);
    scene
}

fn names(scene: &Scene, families: &[Family]) -> Vec<String> {
    let choices = choices(scene, families);
    choices.into_iter().map(|c| c.name).collect()
}

#[test]
fn every_choice_has_a_name_of_its_own_and_settings_of_its_own() {
    let scene = scene(|_| {});
    let all = choices(&scene, Family::value_variants());
    let names: BTreeSet<&str> = all.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names.len(), all.len());
    for (i, a) in all.iter().enumerate() {
        assert!(all[..i].iter().all(|b| a.settings != b.settings), "{a:?}");
    }
}

#[test]
fn the_base_comes_first_and_is_not_repeated() {
    let names = names(&scene(|_| {}), &[Family::Strategy]);
    let expected = ["mis+sobol", "uniform+sobol", "cosine+sobol", "light+sobol"];
    assert_eq!(names, expected);
}

#[test]
fn depths_stay_below_the_scenes_own() {
    let names = names(&scene(|s| s.max_depth = Some(4)), &[Family::Depth]);
    assert_eq!(names, ["mis+sobol", "max depth 1", "max depth 2"]);
}

#[test]
fn images_are_read_in_the_other_way_where_there_are_any() {
    let of = |name, change: fn(&mut Settings)| names(&shipped(name, change), &[Family::Textures]);
    assert_eq!(of("cornell-box", |_| ()), ["mis+sobol"]);
    assert_eq!(of("textures", |_| ()), ["mis+sobol", "finest images"]);
    let finest = of("textures", |s| s.texture_lod = TextureLod::Finest);
    assert_eq!(finest, ["mis+sobol", "images by footprint"]);
}

#[test]
fn lights_are_chosen_in_the_ways_that_the_scene_has_not_already() {
    let of = |name, change: fn(&mut Settings)| names(&shipped(name, change), &[Family::Lights]);
    // Two triangles: by power, as it is.
    let few = ["mis+sobol", "lights by uniform", "lights by tree"];
    assert_eq!(of("cornell-box", |_| ()), few);
    let many = ["mis+sobol", "lights by uniform", "lights by power"];
    assert_eq!(of("many-lights", |_| ()), many);
    // Light found by directions is not chosen.
    let cosine = of("many-lights", |s| s.strategy = Strategy::Cosine);
    assert_eq!(cosine, ["cosine+sobol"]);
}
