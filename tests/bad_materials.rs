//! What is wrong with what scene files say of materials.

mod material_folder;
mod scene_folder;

use huygens::scene::material::Bsdf;
use material_folder::{error, folder, scene, text};

#[test]
fn keys_of_other_kinds() {
    assert_eq!(
        error("[materials.m]\nior = 1.5\n"),
        "s.toml:2:7: materials.m.ior: `ior` is for materials of kind `dielectric`, `principled`, \
         this one is `diffuse`"
    );
    assert_eq!(
        error("[materials.m]\nkind = \"conductor\"\nalbedo = 0.5\n"),
        "s.toml:3:10: materials.m.albedo: `albedo` is for materials of kind `diffuse`, \
         this one is `conductor`"
    );
    assert_eq!(
        error("[materials.m]\nkind = \"mirror\"\n"),
        "s.toml:2:8: materials.m.kind: unknown value `mirror`, expected `diffuse`, `conductor`, \
         `dielectric`, `principled` or `mix`"
    );
    assert_eq!(
        error("[materials.m]\nalbedoo = 0.5\n"),
        "s.toml:2:1: unknown key `albedoo` in `materials.m`, did you mean `albedo`?"
    );
}

#[test]
fn metals_that_are_none() {
    assert_eq!(
        error("[materials.m]\nkind = \"conductor\"\nmetal = \"golf\"\n"),
        "s.toml:3:9: materials.m.metal: no metal `golf`, did you mean `gold`?"
    );
    let needs = "materials.m: a conductor needs either `metal` or `eta` and `k`";
    assert!(error("[materials.m]\nkind = \"conductor\"\neta = 1\n").ends_with(needs));
    assert_eq!(
        error("[materials.m]\nkind = \"conductor\"\neta = 0\nk = 1\n"),
        "s.toml:3:7: materials.m.eta: found 0, expected a finite number above 0"
    );
}

#[test]
fn numbers_that_no_surface_has() {
    for (line, wrong) in [
        (
            "kind = \"dielectric\"\nior = 0",
            "s.toml:3:7: materials.m.ior: found 0, expected a finite number above 0",
        ),
        (
            "kind = \"dielectric\"\nior = -1.5",
            "s.toml:3:7: materials.m.ior: found -1.5, expected a finite number above 0",
        ),
        (
            "kind = \"dielectric\"\nabbe = 0",
            "s.toml:3:8: materials.m.abbe: found 0, expected a finite number above 0",
        ),
        (
            "kind = \"dielectric\"\nabbe = 0.1",
            "s.toml:3:8: materials.m.abbe: makes the index of refraction -1.1710 at 730 nm, \
             expected it above 0 from 380 to 730 nm",
        ),
        (
            "kind = \"dielectric\"\ncauchy = [1, -0.2]",
            "s.toml:3:10: materials.m.cauchy: makes the index of refraction -0.3850 at 380 nm, \
             expected it above 0 from 380 to 730 nm",
        ),
        (
            "kind = \"dielectric\"\nabbe = 30\ncauchy = [1.5, 0.01]",
            "s.toml:4:10: materials.m.cauchy: found both `abbe` and `cauchy`, expected one",
        ),
        (
            "kind = \"dielectric\"\nior = 1.5\ncauchy = [1.5, 0.01]",
            "s.toml:3:7: materials.m.ior: found beside `cauchy`, which says the index already",
        ),
        (
            "abbe = 30",
            "s.toml:2:8: materials.m.abbe: `abbe` is for materials of kind `dielectric`, \
             `principled`, this one is `diffuse`",
        ),
        (
            "kind = \"dielectric\"\ncauchy = [1.5]",
            "s.toml:3:10: materials.m.cauchy: found 1 numbers, expected two or three",
        ),
        (
            "kind = \"dielectric\"\ncauchy = [1.5, 0.01]\nsellmeier = [[1, 0, 0], [0.01, 0, 0]]",
            "s.toml:4:13: materials.m.sellmeier: found both `cauchy` and `sellmeier`, expected one",
        ),
        (
            "kind = \"dielectric\"\nior = 1.5\nsellmeier = [[1, 0, 0], [0.01, 0, 0]]",
            "s.toml:3:7: materials.m.ior: found beside `sellmeier`, which says the index already",
        ),
        (
            "kind = \"dielectric\"\nsellmeier = [[1, 0, 0], [0.25, 0, 0]]",
            "s.toml:3:13: materials.m.sellmeier: has a pole at 500 nm, expected none from 380 to 730 nm",
        ),
        (
            "kind = \"dielectric\"\nsellmeier = [[-2, 0, 0], [0, 0, 0]]",
            "s.toml:3:13: materials.m.sellmeier: makes the square of the index -1 at 380 nm, expected \
             it above 0",
        ),
        (
            "kind = \"principled\"\nabbe = 30",
            "s.toml:3:8: materials.m.abbe: `abbe` is for what light passes: `transmission` is 0, or \
             all is metal",
        ),
        (
            "kind = \"principled\"\ntransmission = 1\ncauchy = [0.9, 0]",
            "s.toml:4:10: materials.m.cauchy: makes the index of refraction 0.9000 within 380 to 730 \
             nm, expected at least 1",
        ),
        (
            "kind = \"principled\"\nior = 0.5",
            "s.toml:3:7: materials.m.ior: found 0.5, expected a number of at least 1",
        ),
        (
            "kind = \"principled\"\nmetallic = 2",
            "s.toml:3:12: materials.m.metallic: found 2, expected a number from 0 to 1",
        ),
        (
            "emission = [1, -2, 3]",
            "s.toml:2:16: materials.m.emission: found -2, expected a finite number of at least 0",
        ),
        (
            "emission_strength = 2",
            "s.toml:2:21: materials.m.emission_strength: multiplies `emission`, which is not there",
        ),
        (
            "alpha_cutoff = 0.5",
            "s.toml:2:16: materials.m.alpha_cutoff: cuts `alpha`, which is not there",
        ),
    ] {
        assert_eq!(error(&format!("[materials.m]\n{line}\n")), wrong);
    }
}

#[test]
fn roughness_out_of_range_is_limited_with_a_warning() {
    let found = scene("[materials.m]\nkind = \"dielectric\"\nroughness = 1.5\n");
    assert_eq!(
        found.warnings,
        [
            "s.toml:3:13: materials.m.roughness: found 1.5, expected a number from 0 to 1; 1 is taken"
        ]
    );
    let Bsdf::Dielectric(glass) = &found.materials[0].bsdf else {
        panic!();
    };
    assert_eq!(glass.roughness.factor, 1.0);
}

#[test]
fn mixtures_that_are_none() {
    assert_eq!(
        error("[materials.m]\nkind = \"mix\"\nmaterials = [\"m\", \"x\"]\n"),
        "s.toml:3:19: materials.m.materials: no material `x`, did you mean `m`?"
    );
    assert!(
        error("[materials.m]\nkind = \"mix\"\n")
            .ends_with("materials.m: a mixture needs `materials`, the names of two")
    );
    let round = "[materials.m]\nkind = \"mix\"\nmaterials = [\"n\", \"o\"]\n[materials.o]\n\
                 [materials.n]\nkind = \"mix\"\nmaterials = [\"o\", \"m\"]\n";
    assert!(error(round).ends_with("the mixture holds itself, expected other materials"));
}

#[test]
fn images_that_are_none() {
    let folder = folder()
        .with("text.png", "this is text")
        .with("empty.png", "")
        .with(
            "short.png",
            &std::fs::read(folder().path("photo.jpg")).unwrap()[..150],
        );
    let gif = b"GIF89a\x01\x00\x01\x00\x80\x00\x00";
    let folder = folder.with("a.gif", gif);
    let mut huge = std::fs::read(folder.path("red.png")).unwrap();
    // The header's width, and its checksum.
    huge[16..20].copy_from_slice(&1_000_000u32.to_be_bytes());
    huge[20..24].copy_from_slice(&1_000_000u32.to_be_bytes());
    let crc = crc32(&huge[12..29]);
    huge[29..33].copy_from_slice(&crc.to_be_bytes());
    let folder = folder.with("huge.png", &huge);
    let mut broken = std::fs::read(folder.path("red.png")).unwrap();
    let n = broken.len();
    broken.truncate(n - 20);
    let folder = folder.with("broken.png", &broken);
    let message = |file: &str| {
        let scene = text(&format!(
            "[materials.m]\nalbedo = {{ file = \"{file}\" }}\n"
        ));
        std::fs::write(folder.path("s.toml"), scene).unwrap();
        folder.error("s.toml")
    };
    let place = "s.toml:2:19: materials.m.albedo.file: ";
    for (file, wrong) in [
        ("none.png", "none.png: no such file"),
        (
            "text.png",
            "text.png: is no image, expected PNG, JPEG, HDR or EXR",
        ),
        ("empty.png", "empty.png: is empty, expected an image"),
        (
            "a.gif",
            "a.gif: is a gif image, expected PNG, JPEG, HDR or EXR",
        ),
        (
            "huge.png",
            "huge.png: is 1000000 x 1000000, expected at most 268435456 texels, \
             such as 16384 x 16384",
        ),
    ] {
        assert_eq!(message(file), format!("{place}{wrong}"));
    }
    for file in ["short.png", "broken.png"] {
        let found = message(file);
        assert!(
            found.starts_with(place) && found.contains("cannot be decoded"),
            "{found}"
        );
    }
}

/// CRC-32 as PNG has it.
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for &byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = crc >> 1 ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
        }
    }
    !crc
}

#[test]
fn textures_out_of_range() {
    assert_eq!(
        scene("[materials.m]\nalbedo = { file = \"bright.hdr\" }\n").warnings,
        [
            "s.toml:2:19: materials.m.albedo.file: bright.hdr: holds 4 as albedo; above 1 it makes light"
        ]
    );
    // A quarter of it does not.
    let quarter = "[materials.m]\nalbedo = { file = \"bright.hdr\", factor = 0.25 }\n";
    assert_eq!(scene(quarter).warnings, Vec::<String>::new());
    assert_eq!(
        error("[materials.m]\nalbedo = { file = \"red.png\", factor = 2 }\n"),
        "s.toml:2:39: materials.m.albedo.factor: found [2.0, 2.0, 2.0], \
         expected a colour from 0 to 1"
    );
}

#[test]
fn keys_of_images_that_mean_nothing() {
    for (line, wrong) in [
        (
            "albedo = { file = \"red.png\", channel = \"r\" }",
            "a colour has no use for one channel",
        ),
        (
            "albedo = { file = \"red.png\", strength = 2 }",
            "is for normal and bump maps, expected `factor`",
        ),
        (
            "normal_map = { file = \"red.png\", factor = 2 }",
            "is for values, expected `strength`",
        ),
        (
            "normal_map = { file = \"red.png\" }\nbump_map = { file = \"red.png\" }",
            "found both `normal_map` and `bump_map`, expected one",
        ),
        (
            "albedo = { file = \"red.png\", scale = 0 }",
            "found 0, expected how often the image repeats",
        ),
        (
            "roughness = { file = \"red.png\" }",
            "of a diffuse surface: found an image, expected a number",
        ),
        (
            "albedo = { fil = \"red.png\" }",
            "unknown key `fil` in `materials.m.albedo`, did you mean `file`?",
        ),
        ("albedo = {}", "missing key `file`"),
        (
            "albedo = \"red.png\"",
            "found string \"red.png\", expected a number, a colour where one is meant, or an image { file = ... }",
        ),
    ] {
        let found = error(&format!("[materials.m]\n{line}\n"));
        assert!(found.ends_with(wrong), "{found}");
        assert!(
            found.starts_with("s.toml:2:") || found.starts_with("s.toml:3:"),
            "{found}"
        );
    }
}

/// A render does not pretend: it says what it cannot do.
#[test]
fn what_cannot_be_rendered_yet_is_named() {
    let plain = scene("[materials.m]\nalbedo = 0.5\n");
    assert_eq!(plain.unsupported(), None);
    let unworn = scene("[materials.m]\n[materials.n]\nkind = \"dielectric\"\n");
    assert_eq!(unworn.unsupported(), None);
}
