//! Wavefront MTL, and its common extension for physically based materials (S. Cozzi et al., "MTL PBR
//! extension", 2015: `Pr`, `Pm`, `Ps`, `Pc`, `Pcr`, `norm`): what each statement says (`said`, `map`),
//! which surface that is (`surface`), and warnings for what would change the picture but is not
//! supported or had to be guessed.

mod map;
mod said;
mod surface;

use super::Imported;
use super::statements::text;
use crate::scene::error::io_message;
use crate::scene::material::{Bsdf, Material};
use said::Said;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// Reflectance of a surface that nothing describes.
const GREY: [f32; 3] = [0.5; 3];

/// A fallback that changes the picture, with the keyword. One warning for each kind and file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fallback {
    BlackKd,
    MapOptions,
    LeftOut(&'static str),
    NoFile(&'static str),
    Clamped(&'static str),
    NoColour(&'static str),
    NoNumber(&'static str),
}

impl Fallback {
    fn text(self) -> String {
        match self {
            Self::BlackKd => "map_Kd with a Kd of 0 would be black; 1 is taken".to_owned(),
            Self::MapOptions => "options of maps other than -s, -o, -clamp, -bm and -imfchan are \
                                 not supported; left out"
                .to_owned(),
            Self::LeftOut(keyword) => format!("{keyword} is not supported; left out"),
            Self::NoFile(keyword) => format!("{keyword} without a file was left out"),
            Self::Clamped(keyword) => format!("{keyword} out of its range was clamped"),
            Self::NoColour(keyword) => {
                format!("{keyword} that is not one or three finite numbers was left out")
            }
            Self::NoNumber(keyword) => format!("{keyword} that is no finite number was left out"),
        }
    }
}

/// Materials of the MTL files that one OBJ file names.
#[derive(Debug, Default)]
struct Library {
    /// By name: the file, and what it says.
    said: HashMap<String, (PathBuf, Said)>,
}

/// A material of which nothing but the name is known.
pub(in crate::scene) fn grey(name: &str) -> Material {
    Material::diffuse(name, GREY, [0.0; 3])
}

impl Library {
    /// Adds the materials of the file at `path`; where a name was known, the later one holds.
    fn read(&mut self, path: &Path) -> Result<(), std::io::Error> {
        let bytes = std::fs::read(path)?;
        for (name, said) in Said::read(&text(&bytes))? {
            self.said.insert(name, (path.to_owned(), said));
        }
        Ok(())
    }
}

/// For each file and kind of fallback, the names of materials that ask for it.
type Notes = BTreeMap<(String, Fallback), Vec<String>>;

/// One line for each.
fn warnings(notes: &Notes) -> impl Iterator<Item = String> {
    notes.iter().map(|((file, kind), names)| {
        let what = kind.text();
        let first = &names[0];
        match names.len() {
            1 => format!("{file}: {what} (material `{first}`)"),
            n => format!("{file}: {what} (material `{first}` and {} more)", n - 1),
        }
    })
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
    let mut notes = Notes::new();
    let mut parts = Vec::new();
    for name in used {
        let Some((file, said)) = library.said.get(name) else {
            if !name.is_empty() {
                unknown.push(name);
            }
            imported.materials.push(grey(name));
            continue;
        };
        let mut made = surface::make(said, name, file, &mut imported.textures);
        if let (Bsdf::Mix { first, second, .. }, Some(own)) = (&mut made.material.bsdf, made.parts)
        {
            *first += (used.len() + parts.len()) as u32;
            *second += (used.len() + parts.len()) as u32;
            parts.extend(own);
        }
        imported.materials.push(made.material);
        made.notes.sort_unstable();
        made.notes.dedup();
        for note in made.notes {
            let key = (file.display().to_string(), note);
            notes.entry(key).or_default().push(name.clone());
        }
    }
    imported.materials.extend(parts);
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
    imported.warnings.extend(warnings(&notes));
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
