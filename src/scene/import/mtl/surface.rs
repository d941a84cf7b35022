//! From what an MTL file says to a material.
//!
//! * `Pr`, `Pm`, `Ps` or `Pc`, or a map of one: principled, with `Kd` as its base colour.
//! * `illum` 4, 6, 7 and 9: glass of index `Ni`, tinted by `Tf`.
//! * `Ks` above 0 where `illum` is 2 or more or not said: without `Kd`, a metal that reflects `Ks`;
//!   else a principled dielectric whose reflection `Ks` multiplies. Its roughness follows the
//!   exponent of Blinn and Phong, `alpha = sqrt(2 / (Ns + 2))` (B. Walter et al., "Microfacet Models
//!   for Refraction through Rough Surfaces", EGSR 2007, 5.2); mirrors (`illum` 3, 5 and 8) are smooth.
//! * All else is diffuse.
//!
//! `d` below 1 lets so much pass: a mixture with a pane of index 1, which nothing reflects on.
//! `map_d` cuts holes.

use super::map::Map;
use super::said::Said;
use super::{Fallback, GREY};
use crate::scene::material::{
    Alpha, Bsdf, Channel, Dielectric, Material, NormalMap, Principled, Relief, TextureUse, Textured,
};
use crate::scene::texture::{Request, beside};
use std::path::Path;

/// A material, and its two parts if it is a mixture: [`Bsdf::Mix`] then counts from these.
pub(super) struct Made {
    pub(super) material: Material,
    pub(super) parts: Option<[Material; 2]>,
    pub(super) notes: Vec<Fallback>,
}

struct Maker<'a> {
    said: &'a Said,
    mtl: &'a Path,
    textures: &'a mut Vec<Request>,
    notes: Vec<Fallback>,
}

/// The material `name` of the file `mtl`; the textures that it reads go into `textures`.
pub(super) fn make(said: &Said, name: &str, mtl: &Path, textures: &mut Vec<Request>) -> Made {
    let mut maker = Maker {
        said,
        mtl,
        textures,
        notes: said.notes.clone(),
    };
    let base = maker.base();
    let bsdf = maker.bsdf(base);
    let normal_map = maker.relief();
    let alpha = maker.alpha();
    let emission = maker.emission();
    let notes = maker.notes;
    let plain = |name: String, bsdf: Bsdf| Material {
        bsdf,
        normal_map,
        ..Material::diffuse(name, [0.0; 3], [0.0; 3])
    };
    let opacity = said.number("d");
    let opacity = opacity.or_else(|| Some(1.0 - said.number("tr")?));
    let opacity = opacity.filter(|_| alpha.is_none() && !is_glass(said));
    let mut made = plain(name.to_owned(), bsdf);
    let mut parts = None;
    if let Some(opacity @ 0.0..1.0) = opacity {
        let nothing = Dielectric {
            ior: 1.0,
            thin: true,
            ..Dielectric::default()
        };
        let clear = Material {
            bsdf: Bsdf::Dielectric(Box::new(nothing)),
            ..Material::diffuse(format!("{name} (clear)"), [0.0; 3], [0.0; 3])
        };
        let solid = Material {
            name: format!("{name} (solid)"),
            ..made.clone()
        };
        made.normal_map = None;
        made.bsdf = Bsdf::Mix {
            first: 0,
            second: 1,
            amount: opacity.into(),
        };
        parts = Some([clear, solid]);
    }
    Made {
        material: Material {
            emission,
            alpha,
            ..made
        },
        parts,
        notes,
    }
}

fn is_glass(said: &Said) -> bool {
    let illum = said.number("illum").map(|i| i as u32);
    matches!(illum, Some(4 | 6 | 7 | 9)) && !is_principled(said)
}

fn is_principled(said: &Said) -> bool {
    let number = |key| said.number(key).is_some();
    let map = |key| said.maps.contains_key(key);
    ["pr", "pm", "ps", "pc"].into_iter().any(number) || ["map_pr", "map_pm"].into_iter().any(map)
}

impl Maker<'_> {
    /// `Kd` and `map_Kd`.
    fn base(&mut self) -> Textured<[f32; 3]> {
        let texture = self.map("map_kd", true, Channel::Colour);
        let mut factor = self.said.colour("kd");
        if factor == Some([0.0; 3]) && texture.is_some() {
            self.notes.push(Fallback::BlackKd);
            factor = None;
        }
        let default = if texture.is_some() { [1.0; 3] } else { GREY };
        Textured {
            factor: factor.unwrap_or(default),
            texture,
        }
    }

    fn bsdf(&mut self, base: Textured<[f32; 3]>) -> Bsdf {
        let said = self.said;
        let illum = said.number("illum").map(|i| i as u32);
        let ior = said.number("ni");
        if is_principled(said) {
            let transmission = matches!(illum, Some(4 | 6 | 7 | 9));
            return Bsdf::Principled(Box::new(Principled {
                base_color: base,
                metallic: self.number("pm", "map_pm", 0.0),
                roughness: self.number("pr", "map_pr", 0.5),
                ior: ior.filter(|&n| n >= 1.0).unwrap_or(1.5),
                transmission: f32::from(u8::from(transmission)).into(),
                clearcoat: said.number("pc").unwrap_or(0.0).into(),
                clearcoat_roughness: said.number("pcr").unwrap_or(0.0).into(),
                sheen_color: [said.number("ps").unwrap_or(0.0); 3].into(),
                sheen_roughness: 0.5.into(),
                ..Principled::default()
            }));
        }
        if is_glass(said) {
            return Bsdf::Dielectric(Box::new(Dielectric {
                ior: ior.unwrap_or(1.5),
                transmission_tint: said.colour("tf").unwrap_or([1.0; 3]).into(),
                ..Dielectric::default()
            }));
        }
        let shiny = illum.is_none_or(|i| i >= 2);
        let specular = Textured {
            factor: said.colour("ks").unwrap_or([0.0; 3]),
            texture: None,
        };
        if !shiny || specular.factor == [0.0; 3] {
            return Bsdf::Diffuse {
                reflectance: base,
                roughness: 0.0,
            };
        }
        let texture = self.map("map_ks", true, Channel::Colour);
        let specular = Textured {
            texture,
            ..specular
        };
        let mirror = matches!(illum, Some(3 | 5 | 8));
        // alpha = roughness^2.
        let alpha = (2.0 / (said.number("ns").unwrap_or(0.0) + 2.0)).sqrt();
        let roughness = if mirror { 0.0 } else { alpha.sqrt() };
        let metal = base.factor == [0.0; 3] && base.texture.is_none();
        Bsdf::Principled(Box::new(Principled {
            base_color: if metal { specular } else { base },
            metallic: f32::from(u8::from(metal)).into(),
            roughness: roughness.into(),
            ior: ior.filter(|&n| n > 1.0).unwrap_or(1.5),
            specular_color: if metal { [1.0; 3].into() } else { specular },
            ..Principled::default()
        }))
    }

    fn number(&mut self, key: &str, map: &'static str, default: f32) -> Textured<f32> {
        let texture = self.map(map, false, Channel::Red);
        let default = if texture.is_some() { 1.0 } else { default };
        Textured {
            factor: self.said.number(key).unwrap_or(default),
            texture,
        }
    }

    fn emission(&mut self) -> Textured<[f32; 3]> {
        let texture = self.map("map_ke", true, Channel::Colour);
        let factor = self.said.colour("ke").unwrap_or([0.0; 3]);
        let without = texture.is_some() && factor == [0.0; 3];
        Textured {
            factor: if without { [1.0; 3] } else { factor },
            texture,
        }
    }

    /// `map_d`: where it is the file of `map_Kd`, that file's opacity is meant.
    fn alpha(&mut self) -> Option<Alpha> {
        let file = |key| self.said.maps.get(key).map(|m: &Map| &m.file);
        let same = file("map_d") == file("map_kd");
        let channel = if same { Channel::Alpha } else { Channel::Red };
        let texture = self.map("map_d", false, channel)?;
        Some(Alpha {
            opacity: Textured {
                factor: 1.0,
                texture: Some(texture),
            },
            cutoff: Some(0.5),
        })
    }

    fn relief(&mut self) -> Option<NormalMap> {
        let normals = self.map("norm", false, Channel::Colour);
        let (texture, kind) = match normals {
            Some(texture) => (texture, Relief::Normals),
            None => (self.map("bump", false, Channel::Red)?, Relief::Bump),
        };
        let multiplier = |m: &Map| m.multiplier;
        let strength = match kind {
            Relief::Normals => 1.0,
            Relief::Bump => self.said.maps.get("bump").map_or(1.0, multiplier),
        };
        Some(NormalMap {
            texture,
            kind,
            strength,
        })
    }

    /// The texture that a statement names.
    fn map(&mut self, key: &str, srgb: bool, channel: Channel) -> Option<TextureUse> {
        let map = self.said.maps.get(key)?;
        let request = Request {
            path: beside(self.mtl, &map.file),
            srgb,
        };
        let known = self.textures.iter().position(|r| *r == request);
        let place = known.unwrap_or_else(|| {
            self.textures.push(request);
            self.textures.len() - 1
        });
        Some(map.texture(place as u32, channel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(statements: &str) -> Made {
        let all = Said::read(&format!("newmtl m\n{statements}\n")).unwrap();
        make(&all[0].1, "m", Path::new("a.mtl"), &mut Vec::new())
    }

    fn principled(statements: &str) -> Principled {
        match made(statements).material.bsdf {
            Bsdf::Principled(p) => *p,
            other => panic!("{statements}: {other:?}"),
        }
    }

    #[test]
    fn without_highlights_it_is_diffuse() {
        for statements in [
            "Kd 1 .5 0",
            "Kd 1 .5 0\nKs 1 1 1\nillum 1\nNs 100",
            "Kd 1 .5 0\nKs 0 0 0\nillum 2",
            "illum 0\nKd 1 .5 0\nKs .5 .5 .5",
        ] {
            let found = made(statements).material;
            assert_eq!(found, Material::diffuse("m", [1.0, 0.5, 0.0], [0.0; 3]));
        }
        assert_eq!(made("").material, Material::diffuse("m", GREY, [0.0; 3]));
        let lamp = made("Kd 0\nKe 4 5 6").material;
        assert_eq!(lamp, Material::diffuse("m", [0.0; 3], [4.0, 5.0, 6.0]));
    }

    #[test]
    fn highlights_make_it_principled() {
        let shiny = principled("Kd .2 .3 .4\nKs .5 .5 .5\nNs 30\nillum 2\nNi 1.4");
        assert_eq!(shiny.base_color.factor, [0.2, 0.3, 0.4]);
        assert_eq!(shiny.specular_color.factor, [0.5; 3]);
        assert_eq!((shiny.metallic.factor, shiny.ior), (0.0, 1.4));
        // alpha = sqrt(2 / 32) = 1/4.
        assert_eq!(shiny.roughness.factor, 0.5);
        let mirror = principled("Kd 0 0 0\nKs .9 .8 .7\nillum 3\nNs 10\nNi 1");
        assert_eq!(mirror.base_color.factor, [0.9, 0.8, 0.7]);
        assert_eq!(
            (mirror.metallic.factor, mirror.roughness.factor),
            (1.0, 0.0)
        );
        assert_eq!(mirror.ior, 1.5);
    }

    #[test]
    fn glass_has_an_index_and_a_tint() {
        let Bsdf::Dielectric(glass) = made("Kd 0 0 0\nillum 7\nNi 1.33\nTf .9 1 1\nd 0.1")
            .material
            .bsdf
        else {
            panic!("no glass");
        };
        assert_eq!(
            (glass.ior, glass.transmission_tint.factor),
            (1.33, [0.9, 1.0, 1.0])
        );
        assert!(!glass.thin);
    }

    #[test]
    fn the_extension_for_physically_based_materials() {
        let p = principled("Kd .5 .5 .5\nPr .3\nPm 1\nPc .25\nPcr .1\nPs .75\nillum 1\nKs 1 1 1");
        assert_eq!((p.roughness.factor, p.metallic.factor), (0.3, 1.0));
        assert_eq!(
            (p.clearcoat.factor, p.clearcoat_roughness.factor),
            (0.25, 0.1)
        );
        assert_eq!(p.sheen_color.factor, [0.75; 3]);
        let mapped = principled("map_Pr rough.png\nmap_Pm -imfchan b metal.png\nillum 4");
        assert_eq!(mapped.roughness.factor, 1.0);
        assert_eq!(mapped.roughness.texture.unwrap().channel, Channel::Red);
        assert_eq!(mapped.metallic.texture.unwrap().channel, Channel::Blue);
        assert_eq!(mapped.transmission.factor, 1.0);
    }

    #[test]
    fn thin_air_is_mixed_in() {
        for statements in [
            "Kd 1 1 1\nd 0.25",
            "Kd 1 1 1\nTr 0.75\nKe 2 2 2\nnorm n.png",
        ] {
            let Made {
                material, parts, ..
            } = made(statements);
            let [clear, solid] = parts.expect("two parts");
            let Bsdf::Mix {
                first: 0,
                second: 1,
                amount,
            } = material.bsdf
            else {
                panic!("{:?}", material.bsdf);
            };
            assert_eq!(amount.factor, 0.25);
            assert!(matches!(&clear.bsdf, Bsdf::Dielectric(d) if d.thin && d.ior == 1.0));
            assert!(matches!(solid.bsdf, Bsdf::Diffuse { .. }));
            assert_eq!(solid.normal_map.is_some(), statements.contains("norm"));
            assert!(material.normal_map.is_none());
            assert_eq!(material.emits(), statements.contains("Ke"));
        }
        assert!(made("d 1").parts.is_none());
    }

    #[test]
    fn maps_vary_what_they_should() {
        let mut textures = Vec::new();
        let text = "newmtl m\nKd 0 0 0\nmap_Kd -s 2 2 2 a b.png\nmap_d a b.png\nKe 0 0 0\n\
                    map_Ke glow.png\nmap_Bump -bm 0.5 bump.png\ndisp d.png\n";
        let all = Said::read(text).unwrap();
        let Made {
            material, notes, ..
        } = make(&all[0].1, "m", Path::new("in/a.mtl"), &mut textures);
        let paths: Vec<_> = textures.iter().map(|t| t.path.to_str().unwrap()).collect();
        let expected = ["in/a b.png", "in/bump.png", "in/a b.png", "in/glow.png"];
        assert_eq!(paths, expected);
        assert_eq!(
            textures.iter().map(|t| t.srgb).collect::<Vec<_>>(),
            [true, false, false, true]
        );
        let Bsdf::Diffuse { reflectance, .. } = material.bsdf else {
            panic!();
        };
        // Black times the map would be black.
        assert_eq!(reflectance.factor, [1.0; 3]);
        assert_eq!(reflectance.texture.unwrap().uv[0][0], 2.0);
        let mask = material.alpha.unwrap();
        assert_eq!(mask.opacity.texture.unwrap().channel, Channel::Alpha);
        assert_eq!(material.emission.factor, [1.0; 3]);
        let bump = material.normal_map.unwrap();
        assert_eq!((bump.kind, bump.strength), (Relief::Bump, 0.5));
        assert_eq!(notes, [Fallback::LeftOut("disp"), Fallback::BlackKd]);
    }
}
