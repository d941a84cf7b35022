//! `huygens bench`: its files, its comparisons and its exit codes. What it measures is measured, not
//! tested: times are replaced where a verdict is asked for.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};

fn bench(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder)
        .args(["bench", "--quick"])
        .args(args)
        .output()
        .expect("it starts")
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text")
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("text")
}

/// Numbers of the box, two runs.
fn saved(folder: &Path) -> Value {
    let args = [
        "--filter",
        "box",
        "--runs",
        "2",
        "--threads",
        "1",
        "--save",
        "a.json",
    ];
    let output = bench(folder, &args);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    for expected in ["box", "Msamples/CPU s", "intersect", "shade: surface"] {
        assert!(text.contains(expected), "no {expected} in {text}");
    }
    serde_json::from_str(&std::fs::read_to_string(folder.join("a.json")).expect("saved"))
        .expect("JSON")
}

fn fields(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(members) => {
            for (name, member) in members {
                let dot = if path.is_empty() { "" } else { "." };
                fields(member, &format!("{path}{dot}{name}"), found);
            }
        }
        Value::Array(elements) => elements
            .iter()
            .for_each(|e| fields(e, &format!("{path}[]"), found)),
        _ => drop(found.insert(path.to_owned())),
    }
}

#[test]
fn numbers_are_saved_as_documented_and_compared() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut numbers = saved(folder.path());
    let mut found = BTreeSet::new();
    fields(&numbers, "", &mut found);
    let page = include_str!("../docs/benchmarks.md");
    let section = page.split("\n## ").find(|s| s.starts_with("JSON"));
    let rows = section.expect("the section").lines();
    let documented = rows.filter_map(|row| row.strip_prefix("| `")?.split('`').next());
    let documented: BTreeSet<String> = documented.map(str::to_owned).collect();
    assert_eq!(found, documented);
    let scene = &numbers["scenes"][0];
    let samples = scene["width"].as_u64().unwrap() * scene["height"].as_u64().unwrap();
    let samples = samples * scene["spp"].as_u64().unwrap();
    assert_eq!(scene["runs"][0]["samples"], samples);
    assert_eq!(scene["runs"][0]["camera_rays"], samples);

    // As if it had taken a hundredth of the time: far beyond any noise.
    for run in numbers["scenes"][0]["runs"].as_array_mut().expect("runs") {
        let seconds = run["cpu_seconds"].as_f64().expect("seconds");
        run["cpu_seconds"] = (seconds / 100.0).into();
    }
    std::fs::write(folder.path().join("fast.json"), numbers.to_string()).expect("written");
    // Two runs have one degree of freedom, so even this factor needs the intervals to be narrow;
    // more runs make them so.
    let output = bench(
        folder.path(),
        &[
            "--filter",
            "box",
            "--runs",
            "2",
            "--threads",
            "1",
            "--compare",
            "fast.json",
        ],
    );
    let text = stdout(&output);
    assert!(text.contains("box "), "{text}");
    let slower = text
        .lines()
        .any(|l| l.starts_with("box  ") && l.ends_with("slower"));
    assert_eq!(
        output.status.code(),
        Some(if slower { 3 } else { 0 }),
        "{text}"
    );
    assert_eq!(
        slower,
        stderr(&output).contains("slower: more than 5 % slower: box")
    );
}

#[test]
fn a_sweep_has_a_column_for_each_number_of_threads_and_of_paths() {
    let folder = tempfile::tempdir().expect("a folder");
    let sweep = ["--threads", "1,2", "--wave", "512,2048"];
    let rest = ["--filter", "box", "--runs", "1"];
    let output = bench(folder.path(), &[sweep, rest].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    let (reports, tables) = text.split_once("\nsweep: ").expect("a sweep");
    assert_eq!(reports.matches("processor ns an item by stage").count(), 4);
    let (wall, alone) = tables
        .split_once("\nthe same without what others take")
        .expect("both");
    for column in ["1 x 512", "1 x 2048", "2 x 512", "2 x 2048"] {
        assert!(wall.contains(column), "no {column} in {text}");
    }
    // Rate, speed-up and efficiency: those of the first column are 1 and 100%.
    let row = wall.lines().find(|l| l.starts_with("box ")).expect("a row");
    assert_eq!(row.matches("x, ").count(), 4, "{row}");
    assert!(row.contains("(1.00x, 100%)"), "{row}");
    let row = alone
        .lines()
        .find(|l| l.starts_with("box "))
        .expect("a row");
    assert_eq!(row.matches(" = ").count(), 4, "{row}");
    assert!(row.contains("/ 1.000 = 100.0%"), "{row}");
}

#[test]
fn the_cost_of_the_accounting_is_measured_in_turns() {
    let folder = tempfile::tempdir().expect("a folder");
    let args = [
        "--accounting",
        "--filter",
        "box",
        "--runs",
        "2",
        "--threads",
        "1",
    ];
    let output = bench(folder.path(), &args);
    // What it costs is measured, not tested; two pairs say little.
    assert!(
        [Some(0), Some(3)].contains(&output.status.code()),
        "{}",
        stderr(&output)
    );
    let text = stdout(&output);
    for expected in ["2 pairs a scene", "\nbox ", "\nall scenes "] {
        assert!(text.contains(expected), "no {expected} in {text}");
    }
}

#[test]
fn what_cannot_be_compared_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |args: &[&str], message: &str| {
        let output = bench(folder.path(), args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(output.stdout.is_empty(), "{args:?}");
        let error = stderr(&output);
        assert!(error.contains(message), "{args:?}: {error}");
    };
    refused(
        &["--filter", "teapot"],
        "no scene of the suite is named like `teapot`; there are box,",
    );
    refused(&["--compare", "missing.json"], "cannot read missing.json");
    std::fs::write(folder.path().join("no.json"), "{}").expect("written");
    refused(
        &["--compare", "no.json"],
        "no.json holds no numbers of huygens bench",
    );
    refused(
        &["--threads", "1,2", "--compare", "no.json"],
        "a sweep cannot be compared",
    );
    refused(
        &["--against", "missing", "--runs", "1"],
        "cannot run missing",
    );
    refused(&["--save", "missing/a.json"], "missing");
    refused(&["--accounting", "--save", "a.json"], "cannot be used with");
    refused(
        &["--accounting", "--wave", "64,128"],
        "a sweep cannot be compared",
    );
    refused(&["--runs", "0"], "0 is not in 1..=1000");
    refused(
        &["--threshold", "-1"],
        "expected a number of per cent from 0 to 1000",
    );
}

#[test]
fn a_stage_can_be_run_by_itself() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = bench(folder.path(), &["--stage", "box/intersect"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stdout(&output), "box/intersect 4096\n");
    for wrong in ["box", "box/lunch", "teapot/sort"] {
        let output = bench(folder.path(), &["--stage", wrong]);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        let error = stderr(&output);
        assert!(
            error.contains("expected a scene (box, interior) and a stage"),
            "{error}"
        );
    }
}

#[test]
fn a_program_takes_turns_with_itself() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = env!("CARGO_BIN_EXE_huygens");
    let args = [
        "--filter",
        "box",
        "--runs",
        "2",
        "--threads",
        "1",
        "--against",
        own,
    ];
    let output = bench(folder.path(), &args);
    // What two runs say of times is theirs to say; that both were compared is ours to test.
    assert!(
        [Some(0), Some(3)].contains(&output.status.code()),
        "{}",
        stderr(&output)
    );
    let text = stdout(&output);
    for expected in ["box ", "box: intersect", "differences below 1% are none"] {
        assert!(text.contains(expected), "no {expected} in {text}");
    }
}
