//! The command line from a scene file to finished outputs.

use huygens::film::exr::{ExrImage, read_exr};
use std::path::Path;
use std::process::{Command, Output};

/// A square of side 2 that glows, seen from wherever a bare `.obj` is looked at.
const OBJ: &str = "mtllib a.mtl\nusemtl lamp\n\
                   v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
const MTL: &str = "newmtl lamp\nKd 0.5 0.5 0.5\nKe 1 2 3\n";

/// A folder with the scene in it.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a.obj"), OBJ).expect("written");
    std::fs::write(folder.path().join("a.mtl"), MTL).expect("written");
    folder
}

fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_huygens"));
    command.current_dir(folder).args(["render", "a.obj"]);
    command
        .args(["--size", "20x12", "--spp", "3", "--tile", "8"])
        .args(args);
    command
}

fn render(folder: &Path, args: &[&str]) -> Output {
    command(folder, args).output().expect("huygens runs")
}

/// Renders, which must succeed without a word on the standard error; returns the standard output.
fn rendered(folder: &Path, args: &[&str]) -> String {
    let output = render(folder, args);
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
    String::from_utf8(output.stdout).expect("text")
}

fn exr(folder: &Path) -> ExrImage {
    read_exr(&folder.join("a.exr")).expect("an EXR")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |e: std::io::Result<std::fs::DirEntry>| e.expect("an entry").file_name();
    let mut names: Vec<String> = entries.map(|e| name(e).to_string_lossy().into()).collect();
    names.sort();
    names
}

#[test]
fn without_an_output_it_writes_both_formats_beside_where_it_runs() {
    let folder = folder();
    let summary = rendered(folder.path(), &[]);
    assert_eq!(names(folder.path()), ["a.exr", "a.mtl", "a.obj", "a.png"]);
    assert!(
        summary.starts_with("a\n  settings --size 20x12 --spp 3 "),
        "{summary}"
    );
    assert!(
        summary.ends_with("  wrote    a.exr\n  wrote    a.png\n"),
        "{summary}"
    );
}

#[test]
fn quiet_prints_nothing_at_all() {
    let folder = folder();
    assert_eq!(rendered(folder.path(), &["--quiet"]), "");
}

#[test]
fn an_exr_has_its_pixels_its_variance_and_what_made_it() {
    let folder = folder();
    rendered(folder.path(), &["-o", "a.exr", "--variance", "--seed", "7"]);
    let image = exr(folder.path());
    assert_eq!((image.width, image.height), (20, 12));
    assert_eq!(image.samples.expect("asked for"), vec![3; 20 * 12]);
    assert!(
        image
            .variance
            .expect("asked for")
            .iter()
            .flatten()
            .all(|v| v.is_finite())
    );
    assert!(image.rgb.iter().flatten().any(|&v| v > 0.0));
    assert_eq!(image.attributes["huygens.scene"], "a");
    assert_eq!(image.attributes["huygens.spp"], "3");
    assert_eq!(image.attributes["huygens.seed"], "7");
    assert!(image.attributes["huygens.settings"].contains("--size 20x12 --spp 3 "));
}

#[test]
fn half_and_float_hold_the_same_image() {
    let folder = folder();
    rendered(folder.path(), &["-o", "a.exr"]);
    let float = exr(folder.path());
    rendered(folder.path(), &["-o", "a.exr", "--half"]);
    for (half, float) in exr(folder.path())
        .rgb
        .iter()
        .flatten()
        .zip(float.rgb.iter().flatten())
    {
        // Eleven significant bits, or 2^-25 below the normal range.
        let bound = (float.abs() * f32::powi(2.0, -11)).max(f32::powi(2.0, -25));
        assert!((half - float).abs() <= bound, "{half} for {float}");
    }
}

#[test]
fn a_png_has_the_size_asked_for() {
    let folder = folder();
    rendered(
        folder.path(),
        &["-o", "b.png", "--exposure", "-1", "--tone-map", "none"],
    );
    let image = image::open(folder.path().join("b.png"))
        .expect("a PNG")
        .into_rgb8();
    assert_eq!(image.dimensions(), (20, 12));
}

#[test]
fn the_work_options_do_not_change_a_bit_of_the_image() {
    let folder = folder();
    rendered(folder.path(), &["-o", "a.exr", "--threads", "1"]);
    let expected = exr(folder.path()).rgb;
    rendered(
        folder.path(),
        &[
            "-o",
            "a.exr",
            "--threads",
            "3",
            "--wave",
            "64",
            "--tile",
            "5",
        ],
    );
    assert!(exr(folder.path()).rgb == expected);
}

#[test]
fn the_image_does_not_depend_on_the_tree() {
    let folder = folder();
    rendered(folder.path(), &["-o", "a.exr", "--bvh", "balanced"]);
    let expected = exr(folder.path()).rgb;
    for preset in ["fast", "best"] {
        rendered(folder.path(), &["-o", "a.exr", "--bvh", preset]);
        assert!(exr(folder.path()).rgb == expected, "{preset}");
    }
}

#[test]
fn statistics_add_up() {
    let folder = folder();
    rendered(
        folder.path(),
        &["-o", "a.exr", "--stats", "s.json", "--threads", "2"],
    );
    let text = std::fs::read_to_string(folder.path().join("s.json")).expect("written");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let number = |path: &str| {
        stats
            .pointer(path)
            .and_then(|v| v.as_u64())
            .expect("a number")
    };
    assert_eq!(number("/schema"), 2);
    assert_eq!(number("/samples/done"), 20 * 12 * 3);
    assert_eq!(number("/samples/asked"), 20 * 12 * 3);
    assert_eq!(number("/rays/camera"), 20 * 12 * 3);
    let rays = ["camera", "bounce", "shadow"].map(|k| number(&format!("/rays/{k}")));
    assert_eq!(number("/rays/total"), rays.iter().sum::<u64>());
    assert_eq!(number("/dropped/total"), 0);
    assert_eq!(number("/untraceable/total"), 0);
    assert_eq!(number("/threads"), 2);
    assert_eq!(stats["interrupted"], false);
    assert_eq!(stats["outputs"], serde_json::json!(["a.exr"]));
    assert!(!stats["stages"].as_array().expect("a list").is_empty());
}

#[test]
fn a_missing_material_file_warns_once_and_strict_refuses_it() {
    let folder = folder();
    std::fs::remove_file(folder.path().join("a.mtl")).expect("removed");
    let output = render(folder.path(), &["--quiet"]);
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let about = |l: &&str| l.starts_with("warning: ") && l.contains("a.mtl");
    assert_eq!(stderr.lines().filter(about).count(), 1, "{stderr}");

    for name in ["a.exr", "a.png"] {
        std::fs::remove_file(folder.path().join(name)).expect("removed");
    }
    let output = render(folder.path(), &["--strict"]);
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    let last = stderr.lines().last().expect("an error");
    assert!(last.starts_with("error: --strict makes the "), "{stderr}");
    assert_eq!(names(folder.path()), ["a.obj"]);
}

#[test]
fn of_an_option_given_twice_the_last_counts() {
    let folder = folder();
    rendered(folder.path(), &["-o", "a.exr", "--size", "7x5"]);
    assert_eq!(
        (exr(folder.path()).width, exr(folder.path()).height),
        (7, 5)
    );
}

#[test]
fn the_sampler_is_that_of_the_option_or_of_the_scene_and_is_written_down() {
    let folder = folder();
    let scene = "[settings]\nsampler = \"blue-noise\"\n[[shapes]]\nobj = \"a.obj\"\n";
    std::fs::write(folder.path().join("a.toml"), scene).expect("written");
    let mut images = Vec::new();
    for (option, name) in [
        (None, "blue-noise"),
        (Some("independent"), "independent"),
        (Some("stratified"), "stratified"),
        (Some("sobol"), "sobol"),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_huygens"));
        command
            .current_dir(folder.path())
            .args(["render", "a.toml"]);
        command.args(["--size", "20x12", "--spp", "3", "-o", "a.exr"]);
        command.args(["--stats", "a.json"]);
        command.args(option.map(|name| ["--sampler", name]).iter().flatten());
        let output = command.output().expect("huygens runs");
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let summary = String::from_utf8(output.stdout).expect("text");
        let said = format!(" --sampler {name} ");
        assert!(summary.contains(&said), "{summary}");
        let stats = std::fs::read_to_string(folder.path().join("a.json")).expect("written");
        let stats: serde_json::Value = serde_json::from_str(&stats).expect("JSON");
        assert_eq!(stats["settings"]["sampler"], name);
        let image = exr(folder.path());
        assert!(image.attributes["huygens.settings"].contains(&said));
        images.push(image.rgb);
    }
    // Each does sample in a way of its own.
    for (i, image) in images.iter().enumerate() {
        assert!(images[..i].iter().all(|other| other != image), "{i}");
    }
}

#[test]
fn a_sampler_for_the_reference_does_nothing() {
    let folder = folder();
    let options = ["-o", "a.png", "--integrator", "reference"];
    let output = render(
        folder.path(),
        &[&options[..], &["--sampler", "sobol"]].concat(),
    );
    assert_eq!(
        String::from_utf8_lossy(&output.stderr),
        "warning: --sampler does nothing: the integrator reference has numbers of its own\n"
    );
}

/// Of the scene, unless the option says otherwise; told where it is not the usual.
#[test]
fn the_level_of_images_is_that_of_the_option_or_of_the_scene_and_is_written_down() {
    let folder = folder();
    let scene = "[settings]\ntexture_lod = \"finest\"\n[[shapes]]\nobj = \"a.obj\"\n";
    std::fs::write(folder.path().join("a.toml"), scene).expect("written");
    for (option, name) in [
        (None, "finest"),
        (Some("footprint"), "footprint"),
        (Some("finest"), "finest"),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_huygens"));
        command
            .current_dir(folder.path())
            .args(["render", "a.toml", "--size", "4x4", "--spp", "1"])
            .args(["-o", "a.exr", "--stats", "a.json", "--quiet"])
            .args(option.map(|name| ["--texture-lod", name]).iter().flatten());
        let output = command.output().expect("huygens runs");
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let stats = std::fs::read_to_string(folder.path().join("a.json")).expect("written");
        let stats: serde_json::Value = serde_json::from_str(&stats).expect("JSON");
        assert_eq!(stats["settings"]["texture_lod"], name);
        let said =
            exr(folder.path()).attributes["huygens.settings"].contains("--texture-lod finest");
        assert_eq!(said, name == "finest");
    }
    let options = "-o a.png --integrator reference --texture-lod footprint";
    let output = render(
        folder.path(),
        &options.split_whitespace().collect::<Vec<_>>(),
    );
    assert_eq!(
        String::from_utf8_lossy(&output.stderr),
        "warning: --texture-lod does nothing: the integrator reference reads images at their finest\n"
    );
}

#[test]
fn options_that_do_nothing_are_named() {
    let folder = folder();
    let output = render(
        folder.path(),
        &["-o", "a.png", "--half", "--ao-distance", "1"],
    );
    let expected = "warning: --ao-distance does nothing: the integrator is not ao\n\
                    warning: --half does nothing: no .exr is written\n";
    assert_eq!(String::from_utf8_lossy(&output.stderr), expected);
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn a_missing_scene_is_wrong_input_and_leaves_nothing() {
    let folder = folder();
    for name in ["a.obj", "a.mtl"] {
        std::fs::remove_file(folder.path().join(name)).expect("removed");
    }
    let output = render(folder.path(), &[]);
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert!(stderr.starts_with("error: "), "{stderr}");
    assert_eq!(output.status.code(), Some(2));
    assert!(names(folder.path()).is_empty());
}
