//! What scene files say of materials.

mod material_folder;
mod scene_folder;

use huygens::scene::material::{
    Bsdf, Cauchy, Channel, Material, Relief, TexelFilter, TextureUse, Textured, Wrap,
};
use huygens::scene::texture::TexelFormat;
use material_folder::{error, material, scene};

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
