//! `huygens render --target-error` and `--time`, from the command line to the files: how renders end, and
//! what is recorded of it. Nothing here asks how long anything took.

use huygens::film::exr::{ExrImage, read_exr};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.toml");

fn render(folder: &Path, args: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder)
        .args(["render", SCENE, "--size", "24x24"])
        .args("-o a.exr --variance --stats s.json --quiet".split_whitespace())
        .args(args.split_whitespace())
        .output()
        .expect("huygens runs")
}

/// What a render that must succeed leaves behind, and what it says on the standard error.
fn rendered(args: &str) -> (ExrImage, Value, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let output = render(folder.path(), args);
    let said = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(0), "{said}");
    let stats = std::fs::read_to_string(folder.path().join("s.json")).expect("written");
    let stats = serde_json::from_str(&stats).expect("JSON");
    let image = read_exr(&folder.path().join("a.exr")).expect("an EXR");
    (image, stats, said)
}

fn samples(image: &ExrImage) -> (u32, u32) {
    let all = image.samples.as_ref().expect("asked for");
    let least = all.iter().min().expect("pixels");
    (*least, *all.iter().max().expect("pixels"))
}

/// The relative error that the file's own means and variances come to (docs/accuracy.md).
fn error_of(image: &ExrImage) -> f64 {
    let values = || image.rgb.as_flattened().iter().map(|&v| f64::from(v));
    let n = values().count() as f64;
    let floor = 0.01 * (values().sum::<f64>() / n).powi(2);
    let variance = image.variance.as_ref().expect("asked for").as_flattened();
    let each = values().zip(variance.iter().map(|&v| f64::from(v)));
    let sum: f64 = each.map(|(m, v)| v / ((m * m - v).max(0.0) + floor)).sum();
    (sum / n).sqrt()
}

#[test]
fn it_ends_at_the_error_and_not_at_the_ceiling() {
    let (image, stats, said) = rendered("--target-error 20% --spp 100000");
    assert_eq!(said, "");
    assert_eq!(stats["target_error"], 0.2);
    assert_eq!(stats["interrupted"], false);
    let error = stats["error"].as_f64().expect("estimated");
    assert!(error <= 0.2 && error > 0.0, "{error}");
    // It is that of the file, but for f32.
    assert!(
        (error_of(&image) / error - 1.0).abs() < 1e-5,
        "{error} and {}",
        error_of(&image)
    );
    let (_, most) = samples(&image);
    assert!(most < 100_000, "{most}");
}

#[test]
fn a_smaller_error_takes_more_samples() {
    let spent = |error| samples(&rendered(&format!("--target-error {error}")).0).1;
    assert!(spent("10%") > spent("20%"));
}

#[test]
fn at_the_ceiling_it_says_what_it_is_short_of() {
    let (image, stats, said) = rendered("--target-error 0.1% --spp 40");
    assert_eq!(samples(&image), (40, 40));
    let error = stats["error"].as_f64().expect("estimated");
    assert!(error > 0.001);
    let expected = format!(
        "warning: the error is {:.2}% by estimate, short of the 0.10% asked for\n",
        100.0 * error
    );
    assert_eq!(said, expected);
    let (image, stats, said) = rendered("--target-error 0.1% --spp 2");
    assert_eq!(samples(&image), (2, 2));
    assert_eq!(stats["error"], Value::Null);
    assert_eq!(said, "warning: too few samples to estimate an error\n");
}

/// With either kind of sampler: those without an end go on as one sequence, the others in rounds.
#[test]
fn time_ends_a_render_that_would_never_end() {
    for sampler in ["sobol", "stratified"] {
        let (image, stats, said) = rendered(&format!("--time 300ms --sampler {sampler}"));
        assert_eq!(said, "");
        assert_eq!(stats["time"], 0.3, "{sampler}: {stats}");
        assert_eq!(stats["interrupted"], false);
        let (least, most) = samples(&image);
        assert!(
            most > 0 && most < 100_000_000,
            "{sampler}: {least} to {most}"
        );
    }
}

#[test]
fn the_ceiling_comes_before_a_time_that_is_long() {
    for sampler in ["sobol", "stratified"] {
        let (image, stats, said) = rendered(&format!("--time 1h --spp 8 --sampler {sampler}"));
        assert_eq!(said, "");
        assert_eq!(samples(&image), (8, 8), "{sampler}");
        assert_eq!(stats["interrupted"], false);
    }
}

/// The error is reached first, so the time does not matter, for any number of threads.
#[test]
fn the_image_of_an_error_is_the_same_whoever_computes_it() {
    let image = |threads: u32| {
        let args = format!("--target-error 20% --time 1h --seed 5 --threads {threads}");
        let (image, ..) = rendered(&args);
        (image.rgb, image.samples)
    };
    assert!(image(1) == image(3));
}

#[test]
fn what_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    for (args, why) in [
        ("--target-error 0", "expected a share above 0"),
        ("--target-error 101%", "expected a share above 0"),
        ("--time 0s", "expected a time above 0"),
        ("--time soon", "expected a time above 0"),
    ] {
        let output = render(folder.path(), args);
        let said = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{args}: {said}");
        assert!(said.contains(why), "{args}: {said}");
    }
    assert_eq!(folder.path().read_dir().expect("a folder").count(), 0);
}
