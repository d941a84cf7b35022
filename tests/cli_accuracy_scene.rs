//! `huygens accuracy SCENE`: what it prints and writes, what it keeps, and what it refuses.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// A folder with the Cornell box in it: studies keep their references beside the scene.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.toml");
    std::fs::copy(scene, folder.path().join("box.toml")).expect("copied");
    folder
}

fn huygens(folder: &Path, args: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder)
        .args(["accuracy", "box.toml"])
        .args(args.split_whitespace())
        .output()
        .expect("huygens runs")
}

/// A small study that must succeed; what it printed and its JSON.
fn study(folder: &Path, args: &str) -> (String, Value) {
    let small = "--size 16x16 --reference-error 20% --json a.json";
    let output = huygens(folder, &format!("{small} {args}"));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
    let json = std::fs::read_to_string(folder.join("a.json")).expect("written");
    let text = String::from_utf8(output.stdout).expect("text");
    (text, serde_json::from_str(&json).expect("JSON"))
}

fn curves(json: &Value) -> &[Value] {
    json["curves"].as_array().expect("curves")
}

/// Removes everything that is measured in seconds or follows from that.
fn without_seconds(json: &mut Value) {
    match json {
        Value::Object(fields) => {
            let timed = ["seconds", "advice", "efficiency", "time_to_error", "what"];
            for name in timed {
                fields.remove(name);
            }
            fields.values_mut().for_each(without_seconds);
        }
        Value::Array(values) => values.iter_mut().for_each(without_seconds),
        _ => {}
    }
}

#[test]
fn every_choice_is_measured_and_told() {
    let folder = folder();
    let (text, json) = study(folder.path(), "--spp 4 --repetitions 2");
    assert_eq!(json["ended"], "complete");
    let families = [
        "base", "strategy", "sampler", "combined", "lights", "depth", "roulette", "split", "wave",
    ];
    for family in families.into_iter().chain(["precision"]) {
        assert!(
            curves(&json).iter().any(|c| c["family"] == family),
            "{family}"
        );
    }
    for curve in curves(&json) {
        let points = curve["points"].as_array().expect("points");
        let samples: Vec<u64> = points
            .iter()
            .filter_map(|p| p["samples"].as_u64())
            .collect();
        assert_eq!(samples, [1, 2, 4], "{curve}");
        for point in points {
            for field in ["seconds", "rmse", "error", "variance"] {
                assert!(
                    point[field].as_f64().expect("a number") > 0.0,
                    "{field} of {point}"
                );
            }
        }
        // An observer's error in builds that know of it.
        let seen = points.iter().map(|p| p["flip"].as_f64());
        assert!(seen.clone().all(|s| s.is_some() == cfg!(feature = "flip")));
        assert!(seen.flatten().all(|s| (0.0..=1.0).contains(&s)));
        let name = curve["name"].as_str().expect("a name");
        assert!(text.contains(&format!(" {name} ")), "{text}");
    }
    assert!(text.contains("error against time in seconds\n"));
    let advice = json["advice"].as_str().expect("advice");
    assert!(advice.contains(" reaches an error of 2% in "), "{advice}");
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words(&text).contains(&words(advice)));
    assert!(
        advice.contains("Rays for the same samples: split 2 "),
        "{advice}"
    );
    let met = &json["target_met"];
    assert_eq!(met["goal"], 0.02);
    assert_eq!(met["renders"], 2);
    assert!(met["estimated"].as_f64() <= Some(0.02), "{met}");
    assert!(
        advice.contains("Rendered until 2.0%, it ends after "),
        "{advice}"
    );
}

/// Copies are part of the scene that is studied: here a black one hides a third of a white sky.
#[test]
fn scenes_of_copies_are_studied_whole() {
    let folder = folder();
    let scene = "[film]\nwidth = 16\nheight = 16\n[sky]\nradiance = 1\n[camera]\norigin = [0, 0, 4]\ntarget = [0, 0, 0]\nfov = 60\n\
                 [materials.black]\nalbedo = 0\n[[objects.a.shapes]]\nmaterial = \"black\"\n\
                 box = { min = [-1, -1, -1], max = [1, 1, 1] }\n[[instances]]\nobject = \"a\"\n";
    std::fs::write(folder.path().join("box.toml"), scene).expect("written");
    let (_, json) = study(folder.path(), "--spp 2 --vary wave");
    let brightness = json["reference"]["brightness"].as_f64().expect("known");
    // 1 - (1 / (3 tan 30 degrees))^2 = 0.667, but for the filter.
    assert!((brightness - 2.0 / 3.0).abs() < 0.05, "{brightness}");
}

/// A wave's capacity is no choice of the image, and everything but time is a function of the seed.
#[test]
fn a_study_is_a_function_of_its_seed_and_its_reference() {
    let folder = folder();
    let run = |args: &str| {
        let (_, mut json) = study(folder.path(), &format!("--spp 2 --vary wave {args}"));
        without_seconds(&mut json);
        json["curves"].clone()
    };
    let first = run("--threads 1");
    assert_eq!(first, run("--threads 2"));
    assert_ne!(first, run("--seed 1"));
    assert_ne!(
        first[0]["points"], first[1]["points"],
        "choices are independent"
    );
}

#[test]
fn the_reference_is_kept_and_used_again_for_the_same_image_only() {
    let folder = folder();
    let what = |args: &str| {
        let (_, json) = study(folder.path(), &format!("--spp 1 --vary depth {args}"));
        json["reference"]["what"]
            .as_str()
            .expect("words")
            .to_owned()
    };
    let made = |what: &str| what.starts_with("made here, ");
    assert!(made(&what("--no-cache")));
    assert!(!folder.path().join("box.reference-16x16.exr").exists());
    assert!(made(&what("")));
    assert_eq!(what(""), "box.reference-16x16.exr");
    // Another depth, and a smaller error.
    assert!(made(&what("--max-depth 3")));
    assert!(made(&what("--reference-error 5%")));
    assert_eq!(
        what("--reference box.reference-16x16.exr"),
        "box.reference-16x16.exr"
    );
}

/// Depth is the one choice that is biased: a maximum depth of 1 leaves out two fifths of the light
/// here (docs/accuracy.md).
#[test]
fn bias_and_noise_are_told_apart() {
    let folder = folder();
    let args = "--spp 16 --vary depth,strategy --repetitions 6 --reference-error 3% \
                --target-error 10%";
    let (text, json) = study(folder.path(), args);
    let find = |name: &str| {
        curves(&json)
            .iter()
            .find(|c| c["name"] == name)
            .expect(name)
    };
    let last = |curve: &Value| curve["points"][4].clone();
    let number = |v: &Value| v.as_f64().expect("a number");
    let believed = |p: &Value| number(&p["bias_squared"]) / number(&p["bias_squared_error"]);
    let shallow = last(find("max depth 1"));
    assert!(believed(&shallow) > 8.0, "{shallow}");
    let floor = &find("max depth 1")["time_to_error"];
    let at = floor
        .as_array()
        .expect("costs")
        .iter()
        .find(|t| t["error"] == 0.1);
    let at = at.expect("the target");
    assert_eq!(at["seconds"], Value::Null);
    assert!((number(&at["floor"]).powi(2) / number(&shallow["bias_squared"]) - 1.0).abs() < 1e-9);
    assert!(text.contains("stays"), "{text}");
    // Five standard errors either way, of each of three strategies: a chance of 2e-6.
    for name in ["mis+sobol", "light+sobol", "cosine+sobol"] {
        let point = last(find(name));
        assert!(believed(&point).abs() < 5.0, "{name}: {point}");
        // Both parts make up the whole.
        let whole = number(&point["error"]).powi(2);
        let parts = number(&point["variance"]) + number(&point["bias_squared"]);
        assert!((parts / whole - 1.0).abs() < 1e-6, "{name}: {point}");
    }
}

#[test]
fn a_budget_ends_the_study_with_what_there_is() {
    let folder = folder();
    // So that the budget is for the ladder alone.
    study(folder.path(), "--spp 1 --vary depth");
    let start = std::time::Instant::now();
    let (text, json) = study(folder.path(), "--spp 1048576 --budget 3s");
    // Much longer than it takes, for a machine that is busy.
    assert!(start.elapsed().as_secs() < 30);
    assert_eq!(json["ended"], "budget");
    let last = |c: &Value| c["points"].as_array().map_or(0, Vec::len);
    assert!(curves(&json).iter().all(|c| (1..21).contains(&last(c))));
    assert!(text.ends_with("samples a pixel\n"), "{text}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_shows_what_is_done() {
    let folder = folder();
    study(folder.path(), "--spp 1 --vary depth");
    let args = "--size 16x16 --reference-error 20% --spp 1048576 --json b.json --html b.html";
    let child = Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder.path())
        .args(["accuracy", "box.toml"])
        .args(args.split_whitespace())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("huygens starts");
    std::thread::sleep(std::time::Duration::from_secs(2));
    // SAFETY: kill takes two numbers and touches no memory; the child has not been waited for, so
    // its id is still its own.
    assert_eq!(unsafe { libc::kill(child.id() as i32, libc::SIGINT) }, 0);
    let output = child.wait_with_output().expect("it ends");
    let message = String::from_utf8(output.stderr).expect("text");
    assert_eq!(message, "interrupted: showed what there is\n");
    assert_eq!(output.status.code(), Some(130));
    let json = std::fs::read_to_string(folder.path().join("b.json")).expect("written");
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["ended"], "interrupted");
    assert!(folder.path().join("b.html").exists());
}

/// Must be refused with a message that starts like this, and leave nothing behind.
fn refused(args: &str, message: &str) {
    let folder = folder();
    let output = huygens(folder.path(), args);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(stderr.starts_with(message), "{stderr}");
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    assert_eq!(folder.path().read_dir().expect("a folder").count(), 1);
}

#[test]
fn what_is_refused() {
    refused(
        "--samples 64",
        "error: --samples is for integrals; the ladder of a scene ends at --spp\n",
    );
    refused(
        "--integrator normals",
        "error: only the integrators path and direct can be studied; the others have no choices\n",
    );
    refused(
        "--ao-distance 1 --strict",
        "warning: --ao-distance does nothing: the integrator is not ao\nerror: --strict makes the ",
    );
    refused("--max-memory 1k", "error: the scene needs about ");
    refused(
        "--reference nothing.exr",
        "error: cannot read nothing.exr: ",
    );
    refused(
        "--vary colour",
        "error: invalid value 'colour' for '--vary <NAME,...>'\n  [possible values: strategy, \
         sampler, combined, lights, depth, roulette, split, textures, wave, precision, \
         target]\n",
    );
    refused(
        "--target-error 2",
        "error: invalid value '2' for '--target-error <ERROR>': expected a share above 0 and at \
         most 1, such as 1% or 0.01\n",
    );
    refused(
        "--svg nowhere",
        "error: cannot write nowhere/plot.svg: the folder nowhere does not exist\n",
    );
    refused(
        "--budget 1ms",
        "error: the budget of 1.00 ms is too short for a reference and the first rung\n  help: ",
    );
}
