//! `huygens diff`: what it prints and writes, and what it refuses.

use huygens::film::Image;
use huygens::film::exr::{ExrOptions, Metadata, write_exr};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

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

/// Writes an image of 2 by 2 pixels, all of `value`, but for the first one's `first`.
fn write(folder: &Path, name: &str, value: f32, first: [f32; 3], variance: Option<f32>) {
    let mut mean = vec![[value; 3]; 4];
    mean[0] = first;
    let image = Image {
        width: 2,
        height: 2,
        mean,
        variance: vec![[variance.unwrap_or(0.0); 3]; 4],
        samples: vec![2; 4],
    };
    let options = ExrOptions {
        half: false,
        variance: variance.is_some(),
    };
    let metadata = Metadata::default();
    write_exr(&folder.join(name), &image, &metadata, options).expect("written");
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text")
}

/// Numbers that are exact in binary, and what is printed of them to the letter.
#[test]
fn the_measures_of_two_small_images() {
    let folder = folder();
    write(folder.path(), "a.exr", 1.0, [2.0, 1.0, 1.0], None);
    write(folder.path(), "b.exr", 1.0, [1.0; 3], None);
    let output = huygens(folder.path(), &["diff", "a.exr", "b.exr"]);
    assert_eq!(text(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
    // One of twelve numbers differs, by 1; relMSE is 1/12 over 1.01.
    let expected = "a.exr against b.exr, 2 x 2 pixels\n  \
                    MSE      8.333e-2\n  \
                    RMSE     2.887e-1\n  \
                    relMSE   8.251e-2 without the worst 0.1% of the pixels, 8.251e-2 with them\n  \
                    MAE      8.333e-2\n  \
                    max      1.000e0 at (0, 0)\n  \
                    bias     R +2.500e-1\n           G +0.000e0\n           B +0.000e0\n";
    assert_eq!(text(&output.stdout), expected);
}

#[test]
fn an_error_image_and_json() {
    let folder = folder();
    write(
        folder.path(),
        "a.exr",
        1.0,
        [f32::NAN, 1.0, 1.0],
        Some(0.25),
    );
    write(folder.path(), "b.exr", 1.5, [1.0; 3], Some(0.25));
    let args = "diff a.exr b.exr -o e.png --scale 0.5 --json d.json --quiet";
    let args: Vec<&str> = args.split(' ').collect();
    let output = huygens(folder.path(), &args);
    let warnings = "warning: 1 pixel left out, not finite in both images\n\
                    warning: both images are renders of one scene with one seed, so their noise may \
                    be the same; the intervals take it as independent\n";
    assert_eq!(text(&output.stderr), warnings);
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.is_empty());

    let json = std::fs::read_to_string(folder.path().join("d.json")).expect("written");
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["mse"], 0.25);
    assert_eq!(json["noise"], 0.5);
    assert_eq!(json["noise_of"], "both");
    assert_eq!((&json["pixels"], &json["left_out"]), (&3.into(), &1.into()));
    assert_eq!(json["bias"], Value::from(vec![-0.5; 3]));
    // 1.96 times the root of 0.5/3, to the digits that 1.96 has.
    let low = json["bias_interval"][2][0].as_f64().expect("known");
    assert!(
        (low + 0.5 + 1.96 * (0.5f64 / 3.0).sqrt()).abs() < 0.5e-4,
        "{low}"
    );

    let image = image::open(folder.path().join("e.png"))
        .expect("a PNG")
        .into_rgb8();
    let white = image.get_pixel(1, 0).0;
    let none = image.get_pixel(0, 0).0;
    assert!(white.iter().all(|&v| v >= 240), "{white:?}");
    assert!(none[0] == 0 && none[2] == 255, "{none:?}");
}

/// Must be refused with exactly `message`, without a new file.
fn refused(folder: &Path, args: &[&str], message: &str) {
    let count = || folder.read_dir().expect("a folder").count();
    let before = count();
    let mut all = vec!["diff"];
    all.extend(args);
    let output = huygens(folder, &all);
    assert_eq!(text(&output.stderr), message);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    assert_eq!(count(), before);
}

#[test]
fn what_is_refused() {
    let folder = folder();
    let folder = folder.path();
    write(folder, "a.exr", 1.0, [1.0; 3], None);
    write(folder, "nan.exr", f32::NAN, [f32::NAN; 3], None);
    let image = Image {
        width: 3,
        height: 1,
        mean: vec![[0.0; 3]; 3],
        variance: vec![[0.0; 3]; 3],
        samples: vec![1; 3],
    };
    let (metadata, options) = (Metadata::default(), ExrOptions::default());
    write_exr(&folder.join("wide.exr"), &image, &metadata, options).expect("written");
    std::fs::write(folder.join("text.exr"), "no image").expect("written");

    refused(
        folder,
        &["a.exr", "wide.exr", "-o", "e.png", "--json", "d.json"],
        "error: cannot compare a.exr with wide.exr: the image has 2 x 2 pixels, the reference 3 x 1; \
         expected one size\n",
    );
    refused(
        folder,
        &["a.exr", "nan.exr"],
        "error: cannot compare a.exr with nan.exr: no pixel is finite in both images\n",
    );
    refused(
        folder,
        &["a.exr", "none.exr"],
        "error: cannot read none.exr: No such file or directory (os error 2)\n",
    );
    refused(
        folder,
        &["text.exr", "a.exr"],
        "error: cannot read text.exr: invalid: file identifier missing\n",
    );
    refused(
        folder,
        &["a.exr", "a.exr", "-o", "e.exr"],
        "error: cannot write e.exr: an error image is a .png\n",
    );
    refused(
        folder,
        &["a.exr", "a.exr", "-o", "nowhere/e.png"],
        "error: cannot write nowhere/e.png: the folder nowhere does not exist\n  \
         help: create it first, or name another\n",
    );
    refused(
        folder,
        &["a.exr", "a.exr", "--scale", "0"],
        "error: invalid value '0' for '--scale <ERROR>': expected a finite number above 0\n\n\
         For more information, try '--help'.\n",
    );
}
