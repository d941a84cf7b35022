//! The command line: what is refused before a scene is even read, with its exact message.

use std::path::Path;
use std::process::{Command, Output};

/// Runs `huygens` in `folder`.
fn huygens(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder)
        .args(args)
        .output()
        .expect("huygens runs")
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().to_string_lossy().into())
        .collect();
    names.sort();
    names
}

/// Runs `huygens render scene.toml` with `args` in a folder that holds only `sub/`; it must be
/// refused with exactly `message`, and leave the folder as it was.
fn refused(args: &[&str], message: &str) {
    let folder = folder();
    std::fs::create_dir(folder.path().join("sub")).expect("made");
    let mut all = vec!["render", "scene.toml"];
    all.extend(args);
    let output = huygens(folder.path(), &all);
    assert_eq!(String::from_utf8_lossy(&output.stderr), message);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(names(folder.path()), ["sub"]);
    assert!(output.stdout.is_empty());
    assert!(names(&folder.path().join("sub")).is_empty());
}

/// What clap prints after its own messages.
const MORE: &str = "\n\nFor more information, try '--help'.\n";

#[test]
fn output_in_a_missing_folder() {
    refused(
        &["-o", "nowhere/a.exr"],
        "error: cannot write nowhere/a.exr: the folder nowhere does not exist\n  \
         help: create it first, or name another\n",
    );
}

#[test]
fn output_that_is_a_folder() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("sub.png")).expect("made");
    let output = huygens(folder.path(), &["render", "scene.toml", "-o", "sub.png"]);
    let expected = "error: cannot write sub.png: it is a folder\n  help: name a file\n";
    assert_eq!(String::from_utf8_lossy(&output.stderr), expected);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn output_below_a_file() {
    let folder = folder();
    std::fs::write(folder.path().join("plain"), "").expect("written");
    let output = huygens(
        folder.path(),
        &["render", "scene.toml", "-o", "plain/a.exr"],
    );
    let expected = "error: cannot write plain/a.exr: plain is not a folder\n";
    assert_eq!(String::from_utf8_lossy(&output.stderr), expected);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn output_of_an_unknown_format() {
    refused(
        &["-o", "a.exr", "-o", "a.jpg"],
        "error: cannot write a.jpg: unknown image format .jpg\n  \
         help: expected a name that ends in .exr or .png\n",
    );
    refused(
        &["-o", "a"],
        "error: cannot write a: the name has no extension\n  \
         help: expected a name that ends in .exr or .png\n",
    );
}

#[test]
fn statistics_in_a_missing_folder() {
    refused(
        &["--stats", "nowhere/s.json"],
        "error: cannot write nowhere/s.json: the folder nowhere does not exist\n  \
         help: create it first, or name another\n",
    );
}

#[test]
fn numbers_of_samples_that_are_none() {
    for wrong in ["0", "-1", "2147483648"] {
        refused(
            &["--spp", wrong],
            &format!(
                "error: invalid value '{wrong}' for '--spp <N>': {wrong} is not in \
                 1..=2147483647{MORE}"
            ),
        );
    }
}

#[test]
fn sizes_that_are_none() {
    let message = |value: &str, why: &str| {
        format!("error: invalid value '{value}' for '--size <WxH>': {why}{MORE}")
    };
    for wrong in ["0x10", "10x0"] {
        let why = "a side of 0 pixels; expected 1 to 65535";
        refused(&["--size", wrong], &message(wrong, why));
    }
    let why = "expected WIDTHxHEIGHT, such as 640x480, found 10";
    refused(&["--size", "10"], &message("10", why));
}

#[test]
fn options_out_of_range() {
    for (option, value, place, why) in [
        (
            "--max-depth",
            "-1",
            "N|none",
            "expected 0 to 2147483647, or none",
        ),
        (
            "--exposure",
            "nan",
            "STOPS",
            "expected a number of stops from -64 to 64",
        ),
        (
            "--ao-distance",
            "-2",
            "LENGTH",
            "expected a finite number above 0",
        ),
        ("--threads", "-1", "N", "-1 is not in 0..=1024"),
        ("--wave", "8", "N", "8 is not in 64..=1048576"),
        ("--tile", "0", "N", "0 is not in 1..=1024"),
    ] {
        let message =
            format!("error: invalid value '{value}' for '{option} <{place}>': {why}{MORE}");
        refused(&[option, value], &message);
    }
}

#[test]
fn an_unknown_strategy_is_answered_with_the_known_ones() {
    refused(
        &["--strategy", "mss"],
        &format!(
            "error: invalid value 'mss' for '--strategy <NAME>'\n  [possible values: uniform, \
             cosine, light, mis]\n\n  tip: a similar value exists: 'mis'{MORE}"
        ),
    );
}

/// The file is only looked through: read, it would be refused for its last index.
#[test]
fn a_scene_beyond_the_memory_allowed_is_refused_unread() {
    let folder = folder();
    let vertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
               property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
               end_header\n";
    let scene = "[film]\nwidth = 10\nheight = 10\n[[shapes]]\nply = \"a.ply\"\n\
                 [[shapes]]\nobj = \"a.obj\"\n[[shapes]]\nobj = \"a.obj\"\n\
                 [[shapes]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n";
    for (name, text) in [
        ("a.ply", format!("{ply}{vertices}4 0 1 2 9\n")),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n".to_owned()),
        ("s.toml", scene.to_owned()),
    ] {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    for command in ["render", "inspect"] {
        let run = |size: &str| huygens(folder.path(), &[command, "s.toml", "--max-memory", size]);
        let output = run("9k");
        // 2 + 2 * 1 + 12 triangles, 4 + 2 * 3 + 8 vertices, 100 pixels.
        assert_eq!(
            String::from_utf8_lossy(&output.stderr),
            "error: the scene needs about 9.86 kB of memory while it renders, more than the \
             9.00 kB of --max-memory\n  help: vertices 216 B, vertex indices 192 B, material \
             indices 64 B, bvh nodes 256 B, bvh triangles 736 B, film 5.60 kB, image 2.80 kB\n"
        );
        assert_eq!(output.status.code(), Some(2));
        let output = run("20k");
        assert_eq!(
            String::from_utf8_lossy(&output.stderr),
            "error: a.ply: face 0 has vertex index 9, expected one of the 4 vertices, from 0\n"
        );
        assert_eq!(output.status.code(), Some(2));
        assert_eq!(names(folder.path()), ["a.obj", "a.ply", "s.toml"]);
    }
    let why = "expected a size such as 800M or 4G, found 4X";
    let message = format!("error: invalid value '4X' for '--max-memory <SIZE>': {why}{MORE}");
    refused(&["--max-memory", "4X"], &message);
}

/// Nothing colours what is not read on a terminal.
#[test]
fn no_escape_codes_reach_a_file() {
    let folder = folder();
    for args in [
        &["render", "a.toml", "-o", "x/a.exr"][..],
        &["render", "a.toml", "--spp", "x"],
        &["render", "--help"],
        &[],
    ] {
        let output = huygens(folder.path(), args);
        assert!(!output.stdout.contains(&0x1b), "{args:?}");
        assert!(!output.stderr.contains(&0x1b), "{args:?}");
    }
}

#[test]
fn help_and_version_succeed() {
    let folder = folder();
    for args in [
        &["--help"][..],
        &["render", "--help"],
        &["inspect", "--help"],
        &["accuracy", "--help"],
        &["diff", "--help"],
        &["--version"],
    ] {
        let output = huygens(folder.path(), args);
        assert_eq!(output.status.code(), Some(0), "{args:?}");
        assert!(output.stderr.is_empty());
    }
    let version = huygens(folder.path(), &["--version"]).stdout;
    let expected = concat!("huygens ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!(String::from_utf8_lossy(&version), expected);
}

/// Every option of the page about the command line is in `--help`, and the other way round.
#[test]
fn the_documentation_lists_exactly_the_options_there_are() {
    let folder = folder();
    let page = include_str!("../docs/command-line.md");
    for (command, known) in [
        ("render", "--strict"),
        ("inspect", "--strict"),
        ("accuracy", "--budget"),
        ("diff", "--scale"),
        ("profile", "--trace"),
        ("bench", "--compare"),
    ] {
        let help = huygens(folder.path(), &[command, "--help"]).stdout;
        let help = String::from_utf8(help).expect("text");
        let heading = format!("## huygens {command}");
        let section = page
            .split("\n## ")
            .find(|s| heading.ends_with(&s[..s.find('\n').unwrap()]));
        let documented = options(section.expect("a section"));
        assert!(documented.contains(known));
        assert_eq!(documented, options(&help), "{command}");
    }
}

/// All `--options` in a text, but for `--help`.
fn options(text: &str) -> std::collections::BTreeSet<&str> {
    let end = |c: char| !c.is_ascii_lowercase() && c != '-';
    text.match_indices("--")
        .map(|(at, _)| text[at..].split(end).next().unwrap())
        .filter(|o| o.len() > 3 && *o != "--help" && !o.starts_with("---"))
        .collect()
}
