//! `huygens profile`: what it prints and writes.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn profile(folder: &Path, args: &[&str]) -> Output {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-box.toml");
    Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder)
        .args(["profile".as_ref(), scene.as_os_str()])
        .args(["--size", "64x64", "--threads", "2", "--time", "200ms"])
        .args(args)
        .output()
        .expect("it starts")
}

fn json(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).expect("it was written");
    serde_json::from_str(&text).expect("it is JSON")
}

/// The rules of the Trace Event Format's JSON object form, for the phases that are in use.
fn ensure_trace_events(trace: &Value) {
    let events = trace["traceEvents"].as_array().expect("a list of events");
    assert!(["ms", "ns"].contains(&trace["displayTimeUnit"].as_str().expect("a unit")));
    for event in events {
        let text = |key: &str| event[key].as_str().is_some_and(|s| !s.is_empty());
        let time = |key: &str| {
            event[key]
                .as_f64()
                .is_some_and(|t| t.is_finite() && t >= 0.0)
        };
        assert!(text("name") && text("ph"), "{event}");
        assert!(event["pid"].is_u64() && event["tid"].is_u64(), "{event}");
        match event["ph"].as_str().expect("a phase") {
            // Complete events.
            "X" => assert!(time("ts") && time("dur") && text("cat"), "{event}"),
            // Instant events, with a scope.
            "i" => assert!(time("ts") && event["s"] == "t", "{event}"),
            // Metadata, of which two are in use.
            "M" => {
                let known = ["process_name", "thread_name"];
                assert!(known.contains(&event["name"].as_str().expect("a name")));
                assert!(event["args"]["name"].is_string(), "{event}");
            }
            other => panic!("phase {other} is not in use"),
        }
    }
}

#[test]
fn a_profile_has_a_report_a_timeline_and_a_roofline() {
    let folder = tempfile::tempdir().expect("a folder");
    let args = [
        "--json",
        "p.json",
        "--trace",
        "t.json",
        "--trace-slices",
        "40",
        "--roofline",
        "r.svg",
    ];
    let output = profile(folder.path(), &args);
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success(), "{text}");
    for expected in [
        "kernel",
        "intersect",
        "shade: surface",
        "rays by bounce",
        "roofline",
    ] {
        assert!(text.contains(expected), "no {expected} in {text}");
    }

    let profile = json(&folder.path().join("p.json"));
    assert_eq!(profile["schema"], 1);
    let kernels = profile["kernels"].as_array().expect("kernels");
    let shares: f64 = kernels
        .iter()
        .map(|k| k["share"].as_f64().expect("a share"))
        .sum();
    // At most nine roundings of numbers up to 1.
    assert!((shares - 1.0).abs() <= 16.0 * f64::EPSILON, "{shares}");
    // The last wave's camera rays are stopped before they are traced.
    let traced = profile["bounces"][0]["rays"].as_u64();
    assert!(traced > Some(0) && traced <= kernels[0]["items"].as_u64());

    let trace = json(&folder.path().join("t.json"));
    ensure_trace_events(&trace);
    let events = trace["traceEvents"].as_array().expect("events");
    let slices = |worker: u64| {
        let own = |e: &&Value| e["ph"] == "X" && e["tid"] == worker;
        events.iter().filter(own).collect::<Vec<_>>()
    };
    for worker in [1, 2] {
        let slices = slices(worker);
        assert!(!slices.is_empty() && slices.len() <= 40, "worker {worker}");
        // A row's slices do not overlap, or a viewer nests them: to a rounding of microseconds.
        for pair in slices.windows(2) {
            let number = |i: usize, key: &str| pair[i][key].as_f64().expect("a time");
            assert!(number(0, "ts") + number(0, "dur") <= number(1, "ts") + 1e-2);
        }
    }

    let svg = std::fs::read_to_string(folder.path().join("r.svg")).expect("it was written");
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
}

#[test]
fn all_of_a_scene_is_profiled_not_only_its_triangles() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/glass-and-metal.toml");
    let output = Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder.path())
        .args(["profile".as_ref(), scene.as_os_str()])
        .args(["--size", "64x36", "--time", "1s", "--json", "p.json"])
        .output()
        .expect("it starts");
    assert!(output.status.success());
    let profile = json(&folder.path().join("p.json"));
    let kernels = profile["kernels"].as_array().expect("kernels");
    // Metal and glass are on its spheres alone.
    for kernel in ["shade: rough conductor", "shade: smooth dielectric"] {
        assert!(kernels.iter().any(|k| k["name"] == kernel), "no {kernel}");
    }
}

#[test]
fn a_profile_that_cannot_be_written_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = profile(folder.path(), &["--trace", "missing/t.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    let error = String::from_utf8(output.stderr).expect("text");
    assert!(error.contains("missing"), "{error}");
}

#[test]
fn a_timeline_of_no_slices_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = profile(folder.path(), &["--trace-slices", "0"]);
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).expect("text");
    assert!(error.contains("0 is not in 1..=10000000"), "{error}");
}
