//! Images on surfaces: the wave beside the reference, and beside itself without images.

mod common;
mod scene_folder;

use common::agreement::{assert_images_agree, of_images};
use common::picture::{independent, render};
use huygens::scene::Scene;
use huygens::settings::{Integrator, Settings, Strategy, TextureLod};
use image::{ImageBuffer, Rgb};
use scene_folder::Folder;

/// A corner of a floor and a wall under a lamp and a sky, both wearing `m`, seen from a metre away:
/// no texel is smaller than a footprint, so that the reference, which knows no mip levels, sees the
/// same image.
fn corner(material: &str) -> Scene {
    let walls = "[[shapes]]\nmaterial = \"m\"\n\
         rectangle = { corner = [0, 0, 1], edges = [[1.2, 0, 0], [0, 0, -1]] }\n\
         [[shapes]]\nmaterial = \"m\"\n\
         rectangle = { corner = [0, 0, 0], edges = [[1.2, 0, 0], [0, 1, 0]] }\n";
    room(material, walls)
}

/// Shapes under a lamp and a sky, with materials of their own.
fn room(material: &str, shapes: &str) -> Scene {
    let folder = Folder::new();
    let colours = ImageBuffer::from_fn(3, 2, |x, y| {
        Rgb([[200u8, 40, 90], [30, 180, 60], [90, 70, 220]][((x + y) % 3) as usize])
    });
    colours.save(folder.path("colours.png")).unwrap();
    // Slopes to all sides, some of them steep.
    let normals = ImageBuffer::from_fn(2, 2, |x, y| {
        Rgb([80 + 110 * x as u8, 60 + 120 * y as u8, 220])
    });
    normals.save(folder.path("normals.png")).unwrap();
    let heights = ImageBuffer::from_fn(4, 4, |x, y| image::Luma([(x * 50 + (y % 2) * 90) as u8]));
    heights.save(folder.path("heights.png")).unwrap();
    let text = format!(
        "[camera]\norigin = [0.6, 0.9, 1.6]\ntarget = [0.5, 0.2, 0]\nfov = 40\n\
         [film]\nwidth = 8\nheight = 8\nfilter = \"box\"\n\
         [sky]\nradiance = 0.5\n[materials.m]\n{material}\n\
         [materials.lamp]\nalbedo = 0\nemission = 6\n\
         [[shapes]]\nmaterial = \"lamp\"\n\
         rectangle = {{ corner = [0.3, 1.2, 0.8], edges = [[0, 0, -0.5], [0.5, 0, 0]] }}\n{shapes}"
    );
    folder.with("s.toml", text).scene("s.toml")
}

#[test]
fn albedos() {
    assert_images_agree(&corner(
        "albedo = { file = \"colours.png\", scale = [2, 1], rotate = 30, offset = [0.1, 0.3], \
         wrap = [\"mirror\", \"repeat\"], factor = [0.9, 0.8, 1] }",
    ));
}

/// Nowhere so smooth that light sampled alone is found too rarely to tell.
#[test]
fn roughness_metal_and_glass_of_a_principled_surface() {
    assert_images_agree(&corner(
        "kind = \"principled\"\nbase_color = { file = \"colours.png\" }\n\
         metallic = { file = \"colours.png\", channel = \"g\", scale = 0.5 }\n\
         roughness = { file = \"normals.png\", channel = \"g\", wrap = \"mirror\" }\n\
         transmission = { file = \"normals.png\", factor = 0.7 }\nthin = true",
    ));
}

#[test]
fn shares_of_mixtures() {
    assert_images_agree(&corner(
        "kind = \"mix\"\nmaterials = [\"red\", \"rough\"]\n\
         amount = { file = \"normals.png\", scale = 2, channel = \"g\" }\n\
         [materials.red]\nalbedo = [0.9, 0.1, 0.1]\n[materials.rough]\nalbedo = 0.6\nroughness = 0.8",
    ));
}

/// A tent with smooth normals, stretched, and once mirrored.
#[test]
fn copies() {
    let tent = "[[objects.tent.shapes]]\nmaterial = \"m\"\n\
         mesh = { vertices = [[0, 0, 0], [1, 0, 0], [1, 0.5, -0.6], [0, 0.5, -0.6]], \
         faces = [[0, 1, 2], [0, 2, 3]], uvs = [[0, 0], [1, 0], [0.8, 1], [0, 1]], \
         normals = [[-0.3, 1, 0.8], [0.3, 1, 0.8], [0.2, 1, 0.4], [-0.2, 1, 0.4]] }\n\
         [[instances]]\nobject = \"tent\"\ntransform = [{ scale = [0.6, 1.4, 1] }]\n\
         [[instances]]\nobject = \"tent\"\ntransform = [{ scale = [-0.5, 1, 0.9] }, \
         { rotate = { axis = [0, 0, 1], degrees = 15 } }, { translate = [1.2, 0, 0.1] }]\n";
    assert_images_agree(&room(
        "albedo = { file = \"colours.png\" }\n\
         normal_map = { file = \"normals.png\", strength = 0.4 }",
        tent,
    ));
    assert_images_agree(&room(
        "albedo = 0.8\nbump_map = { file = \"heights.png\", strength = 0.06 }\n\
         alpha = { file = \"heights.png\", channel = \"r\" }\nalpha_cutoff = 0.2",
        tent,
    ));
}

#[test]
fn spheres() {
    let ball =
        "[[shapes]]\nmaterial = \"m\"\nsphere = { center = [0.55, 0.35, 0.1], radius = 0.45 }\n";
    assert_images_agree(&room(
        "albedo = { file = \"colours.png\", scale = [2, 1] }\n\
         normal_map = { file = \"normals.png\", strength = 0.3, scale = [2, 1] }",
        ball,
    ));
    assert_images_agree(&room(
        "albedo = 0.8\nbump_map = { file = \"heights.png\", strength = 0.05, scale = 2 }",
        ball,
    ));
}

/// Their coordinates turn with them, and are mirrored with them.
#[test]
fn spheres_that_were_turned() {
    let ball = "[[shapes]]\nmaterial = \"m\"\nsphere = { center = [0, 0, 0], radius = 0.45 }\n\
         transform = [{ scale = [-1, 1, 1] }, { rotate = { axis = [1, 0.3, -0.5], degrees = 70 } }, \
         { translate = [0.55, 0.35, 0.1] }]\n";
    let material = "albedo = { file = \"colours.png\", scale = [2, 1] }\n\
         normal_map = { file = \"normals.png\", strength = 0.3, scale = [2, 1] }";
    let turned = room(material, ball);
    assert_images_agree(&turned);
    let mut upright = turned.clone();
    upright.spheres[0].turn = huygens::scene::Sphere::UPRIGHT;
    let seen = |scene| render(scene, &of_images(Strategy::Mis)).0.mean;
    assert_ne!(seen(&turned), seen(&upright));
}

#[test]
fn normal_maps() {
    assert_images_agree(&corner(
        "albedo = 0.7\nnormal_map = { file = \"normals.png\", scale = 1.5, strength = 0.8 }",
    ));
}

#[test]
fn bump_maps() {
    assert_images_agree(&corner(
        "albedo = { file = \"colours.png\" }\n\
         bump_map = { file = \"heights.png\", scale = 0.7, rotate = 70, strength = 0.12 }",
    ));
}

/// The four cards of `wall`, each in a quarter of an image, or each of a material of its own.
fn cards(kind: &str, varied: &str, plain: [&str; 4]) -> [Scene; 2] {
    let folder = Folder::new();
    let texels = [
        [255u8, 0, 51],
        [102, 204, 153],
        [153, 102, 255],
        [51, 51, 102],
    ];
    let image = ImageBuffer::from_fn(2, 2, |x, y| Rgb(texels[(x + 2 * (1 - y)) as usize]));
    image.save(folder.path("i.png")).unwrap();
    let scene = |materials: String, worn: [&str; 4]| {
        let card = |k: usize| {
            let (x, y) = ((k % 2) as f64, (k / 2) as f64);
            let (u, v) = (0.25 + 0.5 * x, 0.25 + 0.5 * y);
            format!(
                "[[shapes]]\nmaterial = \"{}\"\nmesh = {{ vertices = [[{x}, {y}, 0], [{}, {y}, 0.2], \
                 [{}, {}, 0]], faces = [[0, 1, 2]], uvs = [[{u}, {v}], [{}, {v}], [{u}, {}]] }}\n",
                worn[k],
                x + 0.9,
                x + 0.4,
                y + 0.8,
                u + 0.1,
                v + 0.1,
            )
        };
        let cards: String = (0..4).map(card).collect();
        let text = format!(
            "[camera]\norigin = [1, 0.9, 2.4]\ntarget = [1, 0.8, 0]\n\
             [film]\nwidth = 24\nheight = 20\n[sky]\nradiance = 0.5\n\
             [[lights]]\npoint = {{ position = [0.5, 2, 2] }}\nintensity = 4\n{materials}{cards}"
        );
        folder.scene_of(&text)
    };
    let line = |name: &str, keys: &str| format!("[materials.{name}]\nkind = \"{kind}\"\n{keys}\n");
    let names = ["a", "b", "c", "d"];
    let each: String = names
        .iter()
        .zip(plain)
        .map(|(n, keys)| line(n, keys))
        .collect();
    [scene(line("m", varied), ["m"; 4]), scene(each, names)]
}

/// An image of one texel a card is a material a card, bit for bit, whatever the BSDF. Linear bytes
/// are shares of 255, which are written as such.
#[track_caller]
fn assert_same_bits(kind: &str, varied: &str, plain: [&str; 4]) {
    let base = Settings {
        spp: 16,
        ..Settings::default()
    };
    let [varied, plain] = cards(kind, varied, plain).map(|scene| {
        assert_eq!(scene.warnings, Vec::<String>::new());
        let bits = |p: &[f32; 3]| p.map(f32::to_bits);
        render(&scene, &base)
            .0
            .mean
            .iter()
            .map(bits)
            .collect::<Vec<_>>()
    });
    assert!(varied == plain, "{kind}: images and numbers differ");
}

#[test]
fn every_parameter_of_the_principled_surface() {
    let image = |key: &str, more: &str| {
        format!(
            "{key} = {{ file = \"i.png\", filter = \"nearest\", color_space = \"linear\"{more} }}\n"
        )
    };
    let varied = image("base_color", "")
        + &image("metallic", ", channel = \"g\"")
        + &image("roughness", ", channel = \"b\"")
        + &image("transmission", ", factor = 0.5")
        + &image("sheen_color", ", factor = 0.5")
        + &image("clearcoat", "")
        + &image("specular", ", channel = \"b\"");
    // Transmission is nowhere 0 and metal nowhere whole: all are drawn by the kernel for surfaces that
    // light passes.
    let plain = [
        [1.0, 0.0, 0.2],
        [0.4, 0.8, 0.6],
        [0.6, 0.4, 1.0],
        [0.2, 0.2, 0.4],
    ];
    let plain = plain.map(|[r, g, b]: [f64; 3]| {
        let half = |x: f64| f64::from(x as f32 * 0.5);
        format!(
            "base_color = [{r}, {g}, {b}]\nmetallic = {g}\nroughness = {b}\ntransmission = {}\n\
             sheen_color = [{}, {}, {}]\nclearcoat = {r}\nspecular = {b}",
            half(r),
            half(r),
            half(g),
            half(b)
        )
    });
    assert_same_bits("principled", &varied, plain.each_ref().map(String::as_str));
}

#[test]
fn metal_and_glass() {
    let image =
        "{ file = \"i.png\", filter = \"nearest\", color_space = \"linear\", channel = \"b\" }";
    let rough = ["0.2", "0.6", "1", "0.4"].map(|b| format!("roughness = {b}\n"));
    let gold = rough.each_ref().map(|r| format!("metal = \"gold\"\n{r}"));
    let varied = format!("metal = \"gold\"\nroughness = {image}\n");
    assert_same_bits("conductor", &varied, gold.each_ref().map(String::as_str));
    let varied = format!("ior = 1.4\nroughness = {image}\n");
    let glass = rough.each_ref().map(|r| format!("ior = 1.4\n{r}"));
    assert_same_bits("dielectric", &varied, glass.each_ref().map(String::as_str));
}

/// A board of 1024 by 1024 squares, black and white, from so far away that a pixel holds some hundred
/// of them: with mip levels every sample of the middle pixels is grey, without them each is black or
/// white. `nearest` reads without, and so does whoever asks for the finest level.
#[test]
fn what_is_far_away_is_read_through_mip_levels() {
    let board = |filter: &str, integrator: Integrator, texture_lod| {
        let folder = Folder::new();
        let image =
            ImageBuffer::from_fn(1024, 1024, |x, y| image::Luma([255 * ((x + y) % 2) as u8]));
        image.save(folder.path("board.png")).unwrap();
        let text = format!(
            "[camera]\norigin = [0.5, 0.5, 40]\ntarget = [0.5, 0.5, 0]\nfov = 40\n\
             [film]\nwidth = 256\nheight = 256\nfilter = \"box\"\n[sky]\nradiance = 1\n\
             [materials.m]\nalbedo = {{ file = \"board.png\", color_space = \"linear\", \
             filter = \"{filter}\" }}\n[[shapes]]\nmaterial = \"m\"\n\
             rectangle = {{ corner = [0, 0, 0], edges = [[1, 0, 0], [0, 1, 0]] }}\n"
        );
        let mut scene = folder.scene_of(&text);
        // The camera's pixels, of which only the middle ones are rendered.
        let extent = scene.camera.projection.extent_mut().expect("a pinhole");
        extent.half_width /= 128.0;
        extent.half_height /= 128.0;
        (scene.film.width, scene.film.height) = (2, 2);
        let settings = Settings {
            integrator,
            texture_lod,
            // Drawn by the cosine, and without roulette, each sample is the albedo.
            strategy: Strategy::Cosine,
            spp: 256,
            max_depth: Some(1),
            roulette: false,
            ..independent()
        };
        let image = render(&scene, &settings).0;
        (image.mean[0][0], image.variance[0][0] * 256.0)
    };
    for integrator in [Integrator::Path, Integrator::Albedo] {
        let (mean, variance) = board("linear", integrator, TextureLod::Footprint);
        // Bytes of 127 or 128, all samples alike but for their rounding.
        assert!(
            (mean - 0.5).abs() < 0.003 && variance < 1e-4,
            "{mean} {variance}"
        );
        let (mean, variance) = board("nearest", integrator, TextureLod::Footprint);
        assert!(
            (mean - 0.5).abs() < 0.2 && variance > 0.2,
            "{mean} {variance}"
        );
        let (mean, variance) = board("linear", integrator, TextureLod::Finest);
        // A mixture of the four squares around: (1 - x y) / 2 with x and y uniform over -1..1. Its variance
        // is (1/3)^2 / 4 = 1/36; of 256 samples the mean scatters by 0.0104 and, with a kurtosis of (9/5)^2,
        // the variance by sqrt((3.24 - 1) / 256) = 9.4% of itself. Five of each.
        let scatter = (36.0 * variance - 1.0).abs();
        assert!(
            (mean - 0.5).abs() < 0.052 && scatter < 0.47,
            "{mean} {variance}"
        );
    }
}
