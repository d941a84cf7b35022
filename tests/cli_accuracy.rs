//! `huygens accuracy`: what it prints and writes, and what it refuses.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn huygens(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder)
        .arg("accuracy")
        .args(args)
        .output()
        .expect("huygens runs")
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Runs a small study of `target`; returns what it printed and its JSON.
fn study(target: &str, args: &[&str]) -> (String, Value) {
    let folder = folder();
    let mut all = vec![target, "--samples", "1024", "--json", "a.json"];
    all.extend(args);
    let output = huygens(folder.path(), &all);
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
    let json = std::fs::read_to_string(folder.path().join("a.json")).expect("written");
    let text = String::from_utf8(output.stdout).expect("text");
    (text, serde_json::from_str(&json).expect("JSON"))
}

/// Sets everything that is measured in seconds to 0.
fn without_seconds(json: &mut Value) {
    match json {
        Value::Object(fields) => {
            for (name, value) in fields {
                if name == "seconds" {
                    *value = 0.into();
                }
                without_seconds(value);
            }
        }
        Value::Array(values) => values.iter_mut().for_each(without_seconds),
        _ => {}
    }
}

#[test]
fn every_target_has_its_table_its_slopes_and_its_charts() {
    for target in ["pi", "integral", "product", "peak", "box", "hemisphere"] {
        let (text, json) = study(target, &["--repetitions", "8"]);
        assert!(text.contains("error against samples\n"), "{text}");
        assert!(text.contains("error against time in seconds\n"), "{text}");
        assert_eq!(json["target"], target);
        assert_eq!(json["ended"], "complete");
        for curve in json["curves"].as_array().expect("curves") {
            let name = curve["name"].as_str().expect("a name");
            assert!(text.contains(&format!(" {name}: ")), "{text}");
            let points = curve["points"].as_array().expect("points");
            assert_eq!(points.len(), 5, "64 to 1024");
            for point in points {
                for field in ["samples", "seconds", "rmse"] {
                    assert!(point[field].as_f64().expect("a number") > 0.0, "{point}");
                }
            }
            let slope = curve["slope"].as_f64().expect("five points");
            let interval = &curve["slope_interval"];
            assert!(interval[0].as_f64() < Some(slope) && Some(slope) < interval[1].as_f64());
            assert!(text.contains(&format!("{slope:.3}")), "{text}");
        }
    }
}

#[test]
fn a_study_is_a_function_of_its_seed() {
    let run = |seed: &str| {
        let (_, mut json) = study("peak", &["--repetitions", "4", "--seed", seed]);
        without_seconds(&mut json);
        json
    };
    let first = run("1");
    assert_eq!(first, run("1"));
    let second = run("2");
    assert_ne!(first["curves"], second["curves"]);
}

/// The ladder of 2^26 samples would take minutes.
#[test]
fn a_budget_ends_the_ladder_early_and_says_so() {
    let folder = folder();
    let args = [
        "integral",
        "--samples",
        "67108864",
        "--budget",
        "200ms",
        "--json",
        "a.json",
    ];
    let start = std::time::Instant::now();
    let output = huygens(folder.path(), &args);
    // Much longer than it takes, for a machine that is busy.
    assert!(start.elapsed().as_secs() < 20);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).expect("text");
    let last = text.lines().last().expect("a line");
    assert!(last.starts_with("the budget ended it after "), "{last}");
    assert!(last.ends_with(" of 67108864 samples"), "{last}");
    let json = std::fs::read_to_string(folder.path().join("a.json")).expect("written");
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["ended"], "budget");
}

/// Ctrl-C shows and writes what there is.
#[cfg(unix)]
#[test]
fn an_interrupt_shows_the_rungs_that_are_done() {
    let folder = folder();
    let child = Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder.path())
        .args("accuracy pi --samples 67108864 --repetitions 1000 --json a.json".split(' '))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("huygens starts");
    std::thread::sleep(std::time::Duration::from_secs(1));
    // SAFETY: kill takes two numbers and touches no memory; the child has not been waited for, so
    // its id is still its own.
    assert_eq!(unsafe { libc::kill(child.id() as i32, libc::SIGINT) }, 0);
    let output = child.wait_with_output().expect("it ends");
    let message = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(
        message.starts_with("interrupted: showed what there is, up to "),
        "{message}"
    );
    assert!(message.ends_with(" of 67108864 samples\n"), "{message}");
    assert!(output.stdout.starts_with(b"pi: "));
    let json = std::fs::read_to_string(folder.path().join("a.json")).expect("written");
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["ended"], "interrupted");
    assert!(
        !json["curves"][0]["points"]
            .as_array()
            .expect("points")
            .is_empty()
    );
}

#[test]
fn quiet_prints_nothing() {
    let (text, json) = study("pi", &["--repetitions", "2", "--quiet"]);
    assert_eq!(text, "");
    assert_eq!(json["schema"], 1);
}

/// Must be refused with exactly `message`, and leave nothing behind.
fn refused(args: &[&str], message: &str) {
    let folder = folder();
    let output = huygens(folder.path(), args);
    assert_eq!(String::from_utf8_lossy(&output.stderr), message);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    assert_eq!(folder.path().read_dir().expect("a folder").count(), 0);
}

/// Every option that `--help` names and that integrals do not have.
#[test]
fn what_is_for_scenes_is_refused_for_integrals() {
    let both = "--json --html --svg --budget --repetitions --quiet --samples --seed --help";
    let help = huygens(folder().path(), &["--help"]).stdout;
    let help = String::from_utf8(help).expect("text");
    let options = help.lines().filter_map(|line| {
        let line = line.trim_start();
        let long = line.starts_with('-').then(|| line.find("--")).flatten();
        long.map(|at| line[at..].split([' ', '[']).next().expect("a word"))
    });
    let options: Vec<&str> = options
        .filter(|o| !both.split(' ').any(|b| b == *o))
        .collect();
    let values: std::collections::BTreeMap<&str, &str> = "--vary strategy --target-error 1% \
        --reference a.exr --reference-error 1% --max-memory 1G --spp 1 --size 8x8 --max-depth 1 \
        --integrator path --strategy mis --light-selection tree --sampler sobol --roulette on --split 2 \
        --texture-lod finest --filter box --ao-distance 1 --bvh fast --threads 1 --wave 64 --tile 8"
        .split_whitespace()
        .collect::<Vec<_>>()
        .chunks(2)
        .map(|pair| (pair[0], pair[1]))
        .collect();
    assert_eq!(options.len(), values.len() + 2, "{options:?}");
    for option in options {
        let message = format!("error: {option} is for scenes, and pi is an integral\n");
        // The two without a value are --no-cache and --strict.
        match values.get(option) {
            Some(value) => refused(&["pi", option, value], &message),
            None => refused(&["pi", option], &message),
        }
    }
}

#[test]
fn what_is_refused() {
    const MORE: &str = "\n\nFor more information, try '--help'.\n";
    refused(
        &["pie"],
        &format!(
            "error: invalid value 'pie' for '<TARGET>': expected a scene file, or one of pi, \
             integral, product, peak, box, hemisphere{MORE}"
        ),
    );
    refused(
        &["pi", "--seed", "1", "--size", "8x8"],
        "error: --size is for scenes, and pi is an integral\n",
    );
    for (option, value, place, why) in [
        ("--samples", "63", "N", "63 is not in 64..=67108864"),
        ("--samples", "-1", "N", "-1 is not in 64..=67108864"),
        ("--repetitions", "1", "N", "1 is not in 2..=1048576"),
        (
            "--budget",
            "soon",
            "TIME",
            "expected a time above 0, such as 90s, 500ms, 2m or 1h",
        ),
        (
            "--budget",
            "0s",
            "TIME",
            "expected a time above 0, such as 90s, 500ms, 2m or 1h",
        ),
    ] {
        let message =
            format!("error: invalid value '{value}' for '{option} <{place}>': {why}{MORE}");
        refused(&["pi", option, value], &message);
    }
    refused(
        &["pi", "--json", "nowhere/a.json"],
        "error: cannot write nowhere/a.json: the folder nowhere does not exist\n  \
         help: create it first, or name another\n",
    );
    refused(
        &["pi", "--budget", "0.000001ms", "--json", "a.json"],
        "error: the budget of 1.00 ns is too short for the first 64 samples\n",
    );
}
