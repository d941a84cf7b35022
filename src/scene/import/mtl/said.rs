//! The statements of an MTL file, material by material.

use super::Fallback;
use super::map::Map;
use crate::scene::import::statements::{split, statements};
use std::collections::BTreeMap;

/// What an MTL file says of one material.
#[derive(Clone, Debug, Default)]
pub(super) struct Said {
    /// `Kd`, `Ks`, `Ke` and `Tf`, by their names in small letters, limited to their range.
    pub(super) colours: BTreeMap<&'static str, [f32; 3]>,
    /// Other numbers, limited to their range.
    pub(super) numbers: BTreeMap<&'static str, f32>,
    pub(super) maps: BTreeMap<&'static str, Map>,
    /// What had to be left out or guessed.
    pub(super) notes: Vec<Fallback>,
}

/// Colours and their largest value.
const COLOURS: [(&str, &str, f32); 4] = [
    ("kd", "Kd", 1.0),
    ("ks", "Ks", 1.0),
    ("ke", "Ke", f32::MAX),
    ("tf", "Tf", 1.0),
];

/// Numbers and their range.
const NUMBERS: [(&str, &str, f32, f32); 11] = [
    ("ns", "Ns", 0.0, f32::MAX),
    ("ni", "Ni", f32::MIN_POSITIVE, f32::MAX),
    ("d", "d", 0.0, 1.0),
    ("tr", "Tr", 0.0, 1.0),
    ("illum", "illum", 0.0, 10.0),
    ("pr", "Pr", 0.0, 1.0),
    ("pm", "Pm", 0.0, 1.0),
    ("ps", "Ps", 0.0, 1.0),
    ("pc", "Pc", 0.0, 1.0),
    ("pcr", "Pcr", 0.0, 1.0),
    ("aniso", "aniso", -1.0, 1.0),
];

/// Texture statements that are followed: several names for one.
const MAPS: [(&str, &str); 13] = [
    ("map_kd", "map_kd"),
    ("map_ks", "map_ks"),
    ("map_ke", "map_ke"),
    ("map_d", "map_d"),
    ("map_opacity", "map_d"),
    ("map_pr", "map_pr"),
    ("map_pm", "map_pm"),
    ("map_bump", "bump"),
    ("bump", "bump"),
    ("norm", "norm"),
    ("map_kn", "norm"),
    ("map_norm", "norm"),
    ("map_normal", "norm"),
];

/// What a keyword's name begins with on its way through tobj.
const HANDED_OVER: &str = "statement-";

/// Those that would change the picture and are not.
const LEFT_OUT: [&str; 6] = ["map_ns", "map_ps", "map_pc", "disp", "map_disp", "refl"];

impl Said {
    /// The materials of an MTL file in their order.
    ///
    /// tobj gathers each material's statements. Keywords that it knows it would parse too, and give
    /// up the whole file at the first value that is wrong; so each is handed over under a name that
    /// it does not know, and which values are wrong is said here, one by one.
    pub(super) fn read(text: &str) -> std::io::Result<Vec<(String, Self)>> {
        let mut plain = String::new();
        let mut names: Vec<String> = Vec::new();
        for (_, statement) in statements(text) {
            let (keyword, rest) = split(&statement);
            if keyword == "newmtl" {
                plain += &format!("newmtl {}\n", names.len());
                names.push(rest.to_owned());
            } else if !names.is_empty() {
                plain += &format!("{HANDED_OVER}{} {rest}\n", keyword.to_ascii_lowercase());
            }
        }
        let (read, _) = tobj::load_mtl_buf(&mut plain.as_bytes()).map_err(std::io::Error::other)?;
        let said = read.into_iter().map(|material| {
            let mut said = Self::default();
            for (keyword, rest) in &material.unknown_param {
                if let Some(keyword) = keyword.strip_prefix(HANDED_OVER) {
                    said.statement(keyword, rest);
                }
            }
            said
        });
        Ok(names.into_iter().zip(said).collect())
    }

    fn statement(&mut self, keyword: &str, rest: &str) {
        if let Some(&(key, written, largest)) = COLOURS.iter().find(|c| c.0 == keyword) {
            match colour(rest) {
                Some(found) => {
                    let limited = found.map(|x| x.clamp(0.0, largest));
                    if limited != found {
                        self.notes.push(Fallback::Clamped(written));
                    }
                    self.colours.insert(key, limited);
                }
                None => self.notes.push(Fallback::NoColour(written)),
            }
        } else if let Some(&(key, written, low, high)) = NUMBERS.iter().find(|n| n.0 == keyword) {
            match number(rest) {
                Some(found) => {
                    if !(low..=high).contains(&found) {
                        self.notes.push(Fallback::Clamped(written));
                    }
                    self.numbers.insert(key, found.clamp(low, high));
                }
                None => self.notes.push(Fallback::NoNumber(written)),
            }
        } else if let Some(&(_, key)) = MAPS.iter().find(|m| m.0 == keyword) {
            match Map::parse(rest) {
                Some(map) => {
                    if map.more {
                        self.notes.push(Fallback::MapOptions);
                    }
                    self.maps.insert(key, map);
                }
                None => self.notes.push(Fallback::NoFile(key)),
            }
        } else if let Some(left_out) = LEFT_OUT.into_iter().find(|l| *l == keyword) {
            self.notes.push(Fallback::LeftOut(left_out));
        }
    }

    pub(super) fn number(&self, key: &str) -> Option<f32> {
        self.numbers.get(key).copied()
    }

    pub(super) fn colour(&self, key: &str) -> Option<[f32; 3]> {
        self.colours.get(key).copied()
    }
}

/// The last number: `d -halo 0.5` has an option first.
fn number(rest: &str) -> Option<f32> {
    let word = rest.split_ascii_whitespace().last()?;
    word.parse().ok().filter(|x: &f32| x.is_finite())
}

/// `r g b`, or `r` for all three.
fn colour(rest: &str) -> Option<[f32; 3]> {
    let mut parts = [0.0; 3];
    let mut count = 0;
    for word in rest.split_ascii_whitespace().take(3) {
        parts[count] = word.parse().ok().filter(|x: &f32| x.is_finite())?;
        count += 1;
    }
    match count {
        1 => Some([parts[0]; 3]),
        3 => Some(parts),
        _ => None,
    }
}
