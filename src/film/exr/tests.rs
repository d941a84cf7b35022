use super::*;

/// 37 x 21 pixels, so that the last block of 16 lines is not full.
fn image() -> Image {
    let n = 37 * 21;
    let value = |i: usize, c: usize| (i * 3 + c) as f32 * 0.37e-3;
    Image {
        width: 37,
        height: 21,
        mean: (0..n).map(|i| [0, 1, 2].map(|c| value(i, c))).collect(),
        variance: (0..n)
            .map(|i| [0, 1, 2].map(|c| value(i, c) * 1e-9))
            .collect(),
        samples: (0..n as u32).collect(),
    }
}

fn metadata() -> Metadata {
    Metadata {
        scene: "Größe 日本".into(),
        scene_hash: [0xab; 32],
        spp: 64,
        seed: u32::MAX,
        settings: "--integrator path".into(),
        seconds: 1.25,
    }
}

fn round_trip(image: &Image, metadata: &Metadata, options: ExrOptions) -> (ExrImage, usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    let cut = write_exr(&path, image, metadata, options).expect("written");
    (read_exr(&path).expect("read"), cut)
}

#[test]
fn floats_come_back_to_the_bit() {
    let options = ExrOptions {
        variance: true,
        ..ExrOptions::default()
    };
    let (read, cut) = round_trip(&image(), &metadata(), options);
    assert_eq!((read.width, read.height, cut), (37, 21, 0));
    assert!(read.rgb == image().mean);
    assert!(read.variance.expect("asked for") == image().variance);
    assert!(read.samples.expect("asked for") == image().samples);
}

#[test]
fn variance_is_left_out_unless_asked_for() {
    let (read, _) = round_trip(&image(), &metadata(), ExrOptions::default());
    assert_eq!((read.variance, read.samples), (None, None));
}

#[test]
fn halves_are_the_nearest_and_overflow_is_counted() {
    let mut image = image();
    image.mean[5] = [1e6, -1e6, 65_504.0];
    let options = ExrOptions {
        half: true,
        ..ExrOptions::default()
    };
    let (read, cut) = round_trip(&image, &metadata(), options);
    assert_eq!((read.rgb[5], cut), ([65_504.0, -65_504.0, 65_504.0], 2));
    for (half, full) in read.rgb.iter().flatten().zip(image.mean.iter().flatten()) {
        if full.abs() <= 65_504.0 {
            // Eleven significant bits, or 2^-25 below the normal range.
            let bound = (full.abs() * f32::powi(2.0, -11)).max(f32::powi(2.0, -25));
            assert!((half - full).abs() <= bound, "{half} for {full}");
        }
    }
}

#[test]
fn attributes_come_back_and_no_pixel_depends_on_them() {
    let (read, _) = round_trip(&image(), &metadata(), ExrOptions::default());
    let expected = [
        ("huygens.scene", "Größe 日本"),
        ("huygens.sceneHash", &"ab".repeat(32)),
        ("huygens.seconds", "1.25"),
        ("huygens.seed", "4294967295"),
        ("huygens.settings", "--integrator path"),
        ("huygens.spp", "64"),
        ("software", concat!("huygens ", env!("CARGO_PKG_VERSION"))),
    ];
    let found: Vec<(&str, &str)> = read
        .attributes
        .iter()
        .map(|(name, value)| (name.as_str(), value.as_str()))
        .collect();
    assert_eq!(found, expected);
    let (other, _) = round_trip(&image(), &Metadata::default(), ExrOptions::default());
    assert!(other.rgb == read.rgb);
}

#[test]
fn what_is_no_exr_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    let missing = read_exr(&path).expect_err("missing").to_string();
    let place = path.display();
    let expected = format!("cannot read {place}: No such file or directory (os error 2)");
    assert_eq!(missing, expected);
    std::fs::write(&path, "P6 1 1 255").expect("written");
    assert!(read_exr(&path).is_err());
}
