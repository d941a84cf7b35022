//! `[settings]` of a scene file: how paths go on and end, in the words of the command line.

mod scene_folder;

use huygens::settings::{Settings, TextureLod};
use scene_folder::Folder;

fn settings(text: &str) -> Settings {
    let scene = format!("[sky]\nradiance = 1\n[settings]\n{text}\n");
    Folder::new().scene_of(&scene).settings
}

#[track_caller]
fn refused(text: &str, message: &str) {
    let folder = Folder::new().with("s.toml", format!("[settings]\n{text}\n"));
    assert_eq!(folder.error("s.toml"), message);
}

#[test]
fn roulette_is_a_boolean_or_a_word() {
    let usual = Settings::default().survival;
    for (text, on, survival) in [
        ("", true, usual),
        ("roulette = true", true, usual),
        ("roulette = \"on\"", true, usual),
        ("roulette = false", false, usual),
        ("roulette = \"off\"", false, usual),
        ("roulette = \"aggressive\"", true, Settings::AGGRESSIVE),
    ] {
        let said = settings(text);
        assert_eq!((said.roulette, said.survival), (on, survival), "{text}");
    }
    refused(
        "roulette = \"often\"",
        "s.toml:2:12: settings.roulette: found string \"often\", expected true, false, \"on\", \"off\" or \
         \"aggressive\"",
    );
}

#[test]
fn branches_are_a_number_or_several() {
    assert_eq!(settings("").split, [0; 0]);
    assert_eq!(settings("split = 4").split, [4]);
    assert_eq!(settings("split = [4, 1, 2]").split, [4, 1, 2]);
    assert_eq!(settings("split = []").split, [0; 0]);
    assert_eq!(settings("split = 65536").split, [65_536]);
    for (wrong, found) in [
        ("0", "[0]"),
        ("-1", "[-1]"),
        ("[2, 0]", "[2, 0]"),
        ("65537", "[65537]"),
        ("[256, 257]", "[256, 257]"),
        ("[1, 1, 1, 1, 1, 1, 1, 1, 1]", "[1, 1, 1, 1, 1, 1, 1, 1, 1]"),
        ("[4294967295, 4294967295, 3]", "[4294967295, 4294967295, 3]"),
    ] {
        refused(
            &format!("split = {wrong}"),
            &format!(
                "s.toml:2:9: settings.split: found {found}, expected at most 8 whole numbers from 1 \
                 whose product is at most 65536"
            ),
        );
    }
}

/// As on the command line: one ray a pixel, unless more are asked for.
#[test]
fn whitted_takes_one_sample() {
    assert_eq!(settings("integrator = \"whitted\"").spp, 1);
    assert_eq!(settings("integrator = \"whitted\"\nspp = 4").spp, 4);
    assert_eq!(settings("integrator = \"path\"").spp, 64);
}

#[test]
fn images_are_read_by_footprint_or_at_their_finest() {
    for (text, lod) in [
        ("", TextureLod::Footprint),
        ("texture_lod = \"footprint\"", TextureLod::Footprint),
        ("texture_lod = \"finest\"", TextureLod::Finest),
    ] {
        assert_eq!(settings(text).texture_lod, lod, "{text}");
    }
    refused(
        "texture_lod = \"best\"",
        "s.toml:2:15: settings.texture_lod: unknown value `best`, expected `footprint` or `finest`",
    );
}
