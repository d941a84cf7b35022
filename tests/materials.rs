//! What scene files say of materials, and what is wrong with it.

mod scene_folder;

use huygens::scene::material::{
    Bsdf, Cauchy, Channel, Material, Relief, TexelFilter, TextureUse, Textured, Wrap,
};
use huygens::scene::{Scene, texture::TexelFormat};
use image::{ImageBuffer, Luma, Rgb, Rgba};
use scene_folder::Folder;

/// A folder with images: `red.png` (2 x 2, all red), `cut.png` (2 x 1, the right half clear),
/// `grey.png` (3 x 1), `deep.png` (16 bits), `photo.jpg` and `bright.hdr` (2 x 1: 0.5 and 4).
fn folder() -> Folder {
    let folder = Folder::new();
    let red = ImageBuffer::from_pixel(2, 2, Rgb([255u8, 0, 0]));
    red.save(folder.path("red.png")).unwrap();
    let cut = ImageBuffer::from_fn(2, 1, |x, _| Rgba([9u8, 9, 9, if x == 0 { 255 } else { 0 }]));
    cut.save(folder.path("cut.png")).unwrap();
    let grey = ImageBuffer::from_fn(3, 1, |x, _| Luma([x as u8 * 100]));
    grey.save(folder.path("grey.png")).unwrap();
    let deep = ImageBuffer::from_pixel(2, 2, Luma([257u16]));
    deep.save(folder.path("deep.png")).unwrap();
    let photo = ImageBuffer::from_pixel(16, 8, Rgb([100u8, 100, 100]));
    photo.save(folder.path("photo.jpg")).unwrap();
    let bright = ImageBuffer::from_fn(2, 1, |x, _| Rgb([if x == 0 { 0.5f32 } else { 4.0 }; 3]));
    bright.save(folder.path("bright.hdr")).unwrap();
    folder
}

/// The scene with these materials, on one rectangle of material `m`.
fn text(materials: &str) -> String {
    format!(
        "{materials}\n[sky]\nradiance = 1\n[[shapes]]\nmaterial = \"m\"\n\
         rectangle = {{ corner = [0, 0, 0], edges = [[1, 0, 0], [0, 1, 0]] }}\n"
    )
}

#[track_caller]
fn scene(materials: &str) -> Scene {
    folder().with("s.toml", text(materials)).scene("s.toml")
}

#[track_caller]
fn error(materials: &str) -> String {
    folder().with("s.toml", text(materials)).error("s.toml")
}

#[track_caller]
fn material(materials: &str) -> Material {
    let scene = scene(materials);
    assert_eq!(scene.warnings, Vec::<String>::new());
    let m = scene.materials.iter().find(|m| m.name == "m");
    m.expect("material m").clone()
}

#[test]
fn plain_albedo_stays_a_diffuse_surface() {
    assert_eq!(
        material("[materials.m]\nalbedo = [0.1, 0.2, 0.3]\nemission = 2\n"),
        Material::diffuse("m", [0.1, 0.2, 0.3], [2.0; 3])
    );
    let rough = material("[materials.m]\nkind = \"diffuse\"\nalbedo = 1\nroughness = 0.5\n");
    assert!(matches!(rough.bsdf, Bsdf::Diffuse { roughness: 0.5, .. }));
}

#[test]
fn metals_by_name_and_by_number() {
    let gold = material("[materials.m]\nkind = \"conductor\"\nmetal = \"gold\"\nroughness = 0.2\n");
    let Bsdf::Conductor {
        eta,
        roughness,
        tint,
        ..
    } = gold.bsdf
    else {
        panic!("{gold:?}");
    };
    // Red light is reflected, blue is not.
    assert!(eta[0] < 0.3 && eta[2] > 1.0);
    assert_eq!((roughness, tint), (0.2.into(), [1.0; 3].into()));
    let [r, _, b] = gold.albedo(&[]);
    assert!(r > 0.9 && b < 0.5);
    let own = "[materials.m]\nkind = \"conductor\"\neta = 1\nk = [2, 3, 4]\nanisotropy = -0.5\n";
    assert!(matches!(
        material(own).bsdf,
        Bsdf::Conductor {
            eta: [1.0, 1.0, 1.0],
            k: [2.0, 3.0, 4.0],
            anisotropy: -0.5,
            ..
        }
    ));
}

#[test]
fn glass_and_the_principled_surface() {
    let glass = material(
        "[materials.m]\nkind = \"dielectric\"\nior = 1.33\nthin = true\nabbe = 55.0\n\
         transmission_tint = [0.9, 1, 1]\n",
    );
    let Bsdf::Dielectric(glass) = glass.bsdf else {
        panic!("{glass:?}");
    };
    assert_eq!(
        (glass.ior, glass.thin, glass.dispersion),
        (
            1.33,
            true,
            Some(Cauchy::from_abbe(f64::from(1.33f32), 55.0))
        )
    );
    assert_eq!(glass.transmission_tint.factor, [0.9, 1.0, 1.0]);
    let m = material(
        "[materials.m]\nkind = \"principled\"\nbase_color = [1, 0, 0]\nmetallic = 1\n\
         clearcoat = 0.5\nsheen_color = 0.25\nemission = 1\nemission_strength = 3\n",
    );
    let Bsdf::Principled(p) = m.bsdf else {
        panic!("{m:?}");
    };
    assert_eq!((p.metallic.factor, p.clearcoat.factor), (1.0, 0.5));
    assert_eq!(p.sheen_color.factor, [0.25; 3]);
    assert_eq!(m.emission.factor, [3.0; 3]);
}

#[test]
fn compensation_is_on_unless_switched_off() {
    for kind in [
        "kind = \"conductor\"\nmetal = \"iron\"",
        "kind = \"dielectric\"",
        "kind = \"principled\"",
    ] {
        assert!(material(&format!("[materials.m]\n{kind}\n")).compensation);
        let off = format!("[materials.m]\n{kind}\ncompensation = false\n");
        assert!(!material(&off).compensation);
    }
    assert_eq!(
        error("[materials.m]\ncompensation = false\n"),
        "s.toml:2:16: materials.m.compensation: `compensation` is for materials of kind \
         `conductor`, `dielectric`, `principled`, this one is `diffuse`"
    );
}

#[test]
fn mixtures_name_their_parts() {
    let scene = scene(
        "[materials.a]\nalbedo = 0\n[materials.m]\nkind = \"mix\"\nmaterials = [\"z\", \"a\"]\n\
         amount = 0.25\n[materials.z]\nalbedo = 1\n",
    );
    let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["a", "m", "z"]);
    assert_eq!(
        scene.materials[1].bsdf,
        Bsdf::Mix {
            first: 2,
            second: 0,
            amount: 0.25.into()
        }
    );
    assert_eq!(scene.materials[1].albedo(&scene.materials), [0.75; 3]);
}

#[test]
fn images_are_read_as_they_are_meant() {
    let scene = scene(
        "[materials.m]\nkind = \"principled\"\n\
         base_color = { file = \"red.png\", factor = [0.5, 1, 1] }\n\
         roughness = { file = \"grey.png\", wrap = [\"mirror\", \"clamp\"], filter = \"nearest\" }\n\
         metallic = { file = \"red.png\", channel = \"g\" }\n\
         alpha = { file = \"cut.png\" }\nalpha_cutoff = 0.25\n\
         emission = { file = \"bright.hdr\", factor = 10 }\n\
         bump_map = { file = \"deep.png\", strength = 0.01 }\n",
    );
    assert_eq!(scene.warnings, Vec::<String>::new());
    let m = &scene.materials[0];
    let Bsdf::Principled(p) = &m.bsdf else {
        panic!("{m:?}");
    };
    let texture = |t: &TextureUse| &scene.textures[t.texture as usize];
    let colour = p.base_color.texture.unwrap();
    assert_eq!(p.base_color.factor, [0.5, 1.0, 1.0]);
    assert_eq!(colour.channel, Channel::Colour);
    assert!(texture(&colour).srgb);
    assert_eq!(texture(&colour).mean(), [1.0, 0.0, 0.0]);
    let roughness = p.roughness.texture.unwrap();
    assert_eq!(roughness.wrap, [Wrap::Mirror, Wrap::Clamp]);
    assert_eq!(roughness.filter, TexelFilter::Nearest);
    assert_eq!(roughness.channel, Channel::Red);
    assert_eq!(texture(&roughness).format, TexelFormat::Grey8);
    assert_eq!(texture(&roughness).size(), [3, 1]);
    assert!(!texture(&roughness).srgb);
    // As a number it is not stored with a curve: the file is there once for each way.
    let metallic = p.metallic.texture.unwrap();
    assert_ne!(metallic.texture, colour.texture);
    assert_eq!(metallic.channel, Channel::Green);
    let mask = m.alpha.unwrap();
    assert_eq!(
        (mask.cutoff, mask.opacity.texture.unwrap().channel),
        (Some(0.25), Channel::Alpha)
    );
    let emission = m.emission.texture.unwrap();
    assert_eq!(m.emission.factor, [10.0; 3]);
    assert_eq!(texture(&emission).format, TexelFormat::Rgb32);
    assert_eq!(texture(&emission).mean(), [2.25; 3]);
    let bump = m.normal_map.unwrap();
    assert_eq!((bump.kind, bump.strength), (Relief::Bump, 0.01));
    assert_eq!(texture(&bump.texture).format, TexelFormat::Grey32);
    assert_eq!(texture(&bump.texture).mean(), [257.0 / 65535.0; 3]);
    assert_eq!(scene.textures.len(), 6);
}

#[test]
fn a_file_is_there_once_however_often_it_is_named() {
    let scene = scene(
        "[materials.m]\nalbedo = { file = \"red.png\" }\n\
         emission = { file = \"./red.png\", rotate = 90 }\n\
         [materials.n]\nalbedo = { file = \"red.png\", scale = [2, 3], offset = [0.5, 0] }\n",
    );
    let use_of = |i: usize| match scene.materials[i].bsdf {
        Bsdf::Diffuse {
            reflectance:
                Textured {
                    texture: Some(texture),
                    ..
                },
            ..
        } => texture,
        _ => panic!(),
    };
    assert_eq!(use_of(0).texture, use_of(1).texture);
    assert_eq!(use_of(0).uv, TextureUse::IDENTITY);
    assert_eq!(use_of(1).uv, [[2.0, 0.0, 0.5], [0.0, 3.0, 0.0]]);
    let turned = scene.materials[0].emission.texture.unwrap();
    assert_eq!(turned.uv, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]);
}

#[test]
fn jpegs_are_decoded() {
    let scene =
        scene("[materials.m]\nalbedo = { file = \"photo.jpg\", color_space = \"linear\" }\n");
    let texture = &scene.textures[0];
    assert_eq!((texture.size(), texture.srgb), ([16, 8], false));
    // JPEG is off by a few of its 255 steps.
    assert!((texture.mean()[1] - 100.0 / 255.0).abs() <= 3.0 / 255.0);
}

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
            "s.toml:3:8: materials.m.abbe: makes the index of refraction -1.1709609 at 730 nm, \
             expected it above 0 from 380 to 730 nm",
        ),
        (
            "kind = \"dielectric\"\ncauchy = [1, -0.2]",
            "s.toml:3:10: materials.m.cauchy: makes the index of refraction -0.3850416 at 380 nm, \
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
            "s.toml:2:8: materials.m.abbe: `abbe` is for materials of kind `dielectric`, this one is \
             `diffuse`",
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
