//! Signals to a render: what is there is written, whole, and nothing else is left behind.
#![cfg(unix)]

use huygens::film::exr::read_exr;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const OBJ: &str = "mtllib a.mtl\nusemtl lamp\n\
                   v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
const MTL: &str = "newmtl lamp\nKd 0.5 0.5 0.5\nKe 1 2 3\n";

/// A render that would take years.
const ENDLESS: &str =
    "render a.obj --size 20x12 --spp 2147483647 -o a.exr --variance --stats s.json";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a.obj"), OBJ).expect("written");
    std::fs::write(folder.path().join("a.mtl"), MTL).expect("written");
    folder
}

/// Runs `sh -c script` in `folder`, where `"$0"` is huygens, until it has rendered for a while.
fn started(folder: &Path, script: &str) -> Child {
    let child = Command::new("sh")
        .current_dir(folder)
        .args(["-c", script, env!("CARGO_BIN_EXE_huygens")])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a shell");
    std::thread::sleep(Duration::from_secs(1));
    child
}

fn send(child: &Child, signal: i32) {
    // SAFETY: kill takes two numbers and touches no memory; the child has not been waited for, so
    // its id is still its own.
    assert_eq!(unsafe { libc::kill(child.id() as i32, signal) }, 0);
}

/// Waits for the end, which must come soon with code 130; returns the standard error.
fn interrupted(child: Child) -> String {
    let asked = Instant::now();
    let output = child.wait_with_output().expect("it ends");
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(
        asked.elapsed() < Duration::from_secs(5),
        "{:?}",
        asked.elapsed()
    );
    stderr
}

#[test]
fn an_interrupt_writes_what_is_there() {
    for signal in [libc::SIGINT, libc::SIGTERM] {
        let folder = folder();
        let child = started(folder.path(), &format!("exec \"$0\" {ENDLESS}"));
        send(&child, signal);
        let stderr = interrupted(child);
        assert!(
            stderr.starts_with("interrupted: wrote the image with "),
            "{stderr}"
        );
        assert!(
            stderr.ends_with(" of 2147483647 samples a pixel\n"),
            "{stderr}"
        );

        let image = read_exr(&folder.path().join("a.exr")).expect("an EXR");
        let samples = image.samples.expect("asked for");
        assert!(samples.iter().any(|&n| n > 0));
        for (pixel, n) in image.rgb.iter().zip(samples) {
            assert!(n > 0 || *pixel == [0.0; 3]);
        }
        let text = std::fs::read_to_string(folder.path().join("s.json")).expect("written");
        let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(stats["interrupted"], true);

        let entries = std::fs::read_dir(folder.path()).expect("a folder");
        assert_eq!(entries.count(), 4, "two inputs, two outputs");
    }
}

/// `nohup huygens render …` outlives its terminal.
#[test]
fn a_hang_up_that_was_ignored_at_the_start_stays_ignored() {
    let folder = folder();
    let script = format!("trap '' HUP; exec \"$0\" {ENDLESS}");
    let mut child = started(folder.path(), &script);
    send(&child, libc::SIGHUP);
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().expect("a child").is_none(), "it ended");
    send(&child, libc::SIGINT);
    interrupted(child);
}
