//! Wavefront MTL: what a Lambertian material takes of it, `Kd` and `Ke`, and warnings for what
//! would change the picture but is not supported.

use super::Imported;
use super::statements::{split, statements, text};
use crate::scene::error::io_message;
use crate::scene::material::Material;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// Reflectance of a surface that nothing describes.
const GREY: f32 = 0.5;

/// A fallback that changes the picture. One warning for each kind and file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fallback {
    Texture,
    EmissionTexture,
    OpacityTexture,
    Bump,
    Transparency,
    Specular,
    ClampedReflectance,
    ClampedEmission,
    NoColour,
}

impl Fallback {
    fn text(self) -> &'static str {
        match self {
            Self::Texture => "textures (map_Kd) are not supported; Kd is used",
            Self::EmissionTexture => "emission textures (map_Ke) are not supported; Ke is used",
            Self::OpacityTexture => "opacity textures (map_d) are not supported; taken as opaque",
            Self::Bump => "bump and normal maps are not supported; left out",
            Self::Transparency => "transparency (d, Tr) is not supported; taken as opaque",
            Self::Specular => {
                "mirrors and glass (illum 3 to 9) are not supported; taken as diffuse"
            }
            Self::ClampedReflectance => "Kd outside 0 to 1 was clamped",
            Self::ClampedEmission => "negative Ke was clamped to 0",
            Self::NoColour => "Kd or Ke that is not one or three finite numbers was left out",
        }
    }
}

/// Materials of the MTL files that one OBJ file names.
#[derive(Debug, Default)]
pub(super) struct Library {
    materials: HashMap<String, Material>,
    /// For each file and kind: the names of materials that ask for it.
    notes: BTreeMap<(String, Fallback), Vec<String>>,
}

/// A material of which nothing but the name is known.
pub(in crate::scene) fn grey(name: &str) -> Material {
    Material::diffuse(name, [GREY; 3], [0.0; 3])
}

impl Library {
    /// Adds the materials of the file at `path`; where a name was known, the later one holds.
    pub(super) fn read(&mut self, path: &Path) -> Result<(), std::io::Error> {
        let bytes = std::fs::read(path)?;
        let file = path.display().to_string();
        // tobj takes the colours; it stops at a line that it cannot read, and panics at a colour
        // of fewer than three numbers, so it is given only what is used, in its plainest form.
        let mut plain = String::new();
        let mut names: Vec<String> = Vec::new();
        for (_, statement) in statements(&text(&bytes)) {
            let (keyword, rest) = split(&statement);
            if keyword == "newmtl" {
                plain += &format!("newmtl {}\n", names.len());
                names.push(rest.to_owned());
                continue;
            }
            let Some(name) = names.last() else { continue };
            let mut note = |kind| {
                let key = (file.clone(), kind);
                self.notes.entry(key).or_default().push(name.clone());
            };
            let value = || number(rest);
            match keyword {
                "Kd" | "Ke" => match colour(rest) {
                    Some(colour) => {
                        let [r, g, b] = limit(keyword, colour, &mut note);
                        plain += &format!("{keyword} {r} {g} {b}\n");
                    }
                    None => note(Fallback::NoColour),
                },
                "map_Kd" => note(Fallback::Texture),
                "map_Ke" => note(Fallback::EmissionTexture),
                "map_d" => note(Fallback::OpacityTexture),
                "map_Bump" | "map_bump" | "bump" | "norm" | "map_Kn" => note(Fallback::Bump),
                "d" if value().is_some_and(|d| d < 1.0) => note(Fallback::Transparency),
                "Tr" if value().is_some_and(|t| t > 0.0) => note(Fallback::Transparency),
                "illum" if value().is_some_and(|i| (3.0..=9.0).contains(&i)) => {
                    note(Fallback::Specular);
                }
                _ => {}
            }
        }
        let (read, _) = tobj::load_mtl_buf(&mut plain.as_bytes()).map_err(std::io::Error::other)?;
        for (name, from) in names.iter().zip(read) {
            let reflectance = from.diffuse.unwrap_or([GREY; 3]);
            let emission = from.emissive.unwrap_or_default();
            let material = Material::diffuse(name, reflectance, emission);
            self.materials.insert(name.clone(), material);
        }
        Ok(())
    }

    /// The material of that name.
    pub(super) fn material(&self, name: &str) -> Option<Material> {
        self.materials.get(name).cloned()
    }

    /// One line for each file and kind of fallback that a material in use asks for.
    pub(super) fn warnings(&self, used: impl Fn(&str) -> bool) -> Vec<String> {
        let line = |((file, kind), names): (&(String, Fallback), &Vec<String>)| {
            let mut of: Vec<&String> = names.iter().filter(|n| used(n)).collect();
            of.dedup();
            let what = kind.text();
            match of[..] {
                [] => None,
                [one] => Some(format!("{file}: {what} (material `{one}`)")),
                [first, ..] => Some(format!(
                    "{file}: {what} (material `{first}` and {} more)",
                    of.len() - 1
                )),
            }
        };
        self.notes.iter().filter_map(line).collect()
    }
}

/// Gives `imported` one material for each name that the OBJ file at `path` uses, from the MTL files
/// that its lines name; grey where none describes it.
pub(super) fn materials(
    path: &Path,
    libraries: &[(usize, String)],
    used: &[String],
    imported: &mut Imported,
) {
    let mut library = Library::default();
    let mut complete = true;
    for (line, written) in libraries {
        for file in library_files(path, written) {
            if let Err(e) = library.read(&file) {
                complete = false;
                imported.warnings.push(format!(
                    "{}:{line}: material library {}: {}; its materials are taken as grey",
                    path.display(),
                    file.display(),
                    io_message(&e),
                ));
            }
        }
    }
    let mut unknown = Vec::new();
    for name in used {
        let material = library.material(name);
        if material.is_none() && !name.is_empty() {
            unknown.push(name);
        }
        let material = material.unwrap_or_else(|| grey(name));
        imported.materials.push(material);
    }
    // Of a missing library no name can be found: that was warned about already.
    if let (true, [first, more @ ..]) = (complete, &unknown[..]) {
        let names = match more.len() {
            0 => format!("material `{first}` is"),
            n => format!("material `{first}` and {n} more are"),
        };
        let file = path.display();
        imported
            .warnings
            .push(format!("{file}: {names} in no MTL file; taken as grey"));
    }
    let used = |name: &str| used.iter().any(|n| n == name);
    imported.warnings.extend(library.warnings(used));
}

/// A name may hold blanks, and a line may hold several names: the whole of it comes first.
fn library_files(obj: &Path, written: &str) -> Vec<PathBuf> {
    let folder = obj.parent().unwrap_or(Path::new(""));
    let locate = |name: &str| {
        let direct = folder.join(name);
        let unixlike = folder.join(name.replace('\\', "/"));
        if !direct.exists() && unixlike.exists() {
            unixlike
        } else {
            direct
        }
    };
    let whole = locate(written);
    let words: Vec<PathBuf> = written.split_ascii_whitespace().map(locate).collect();
    if !whole.exists() && words.len() > 1 && words.iter().any(|w| w.exists()) {
        words
    } else {
        vec![whole]
    }
}

fn number(rest: &str) -> Option<f32> {
    // `d -halo 0.5` has an option first.
    rest.split_ascii_whitespace().last()?.parse().ok()
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

/// Into the range that a material promises.
fn limit(keyword: &str, colour: [f32; 3], note: &mut impl FnMut(Fallback)) -> [f32; 3] {
    let (largest, kind) = match keyword {
        "Kd" => (1.0, Fallback::ClampedReflectance),
        _ => (f32::MAX, Fallback::ClampedEmission),
    };
    let limited = colour.map(|x| x.clamp(0.0, largest));
    if limited != colour {
        note(kind);
    }
    limited
}
