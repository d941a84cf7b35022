//! Wavefront OBJ: polygons and material names, read by tobj behind a scan that finds lines.

use super::Imported;
use super::mtl;
use super::scan::{Scanned, bad_vertex, scan, text};
use crate::scene::error::{SceneError, io_message};
use crate::scene::triangulate::triangulate;
use glam::DVec3;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Loads the OBJ file at `path` and the MTL files that it names.
///
/// # Errors
/// A file that is missing or has no faces, an index of no vertex, a coordinate that is no finite
/// number: with the line.
pub(in crate::scene) fn load(path: &Path) -> Result<Imported, SceneError> {
    let bytes = std::fs::read(path).map_err(|e| SceneError::io(path, &e))?;
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(SceneError::file(path, "is UTF-16 text, expected UTF-8"));
    }
    let text = text(&bytes);
    let scanned = scan(path, &text)?;
    if scanned.faces == 0 {
        return Err(SceneError::file(
            path,
            "has no faces, expected at least one",
        ));
    }
    let mut imported = Imported::default();
    materials(path, &scanned, &mut imported);
    polygons(path, &text, &scanned, &mut imported)?;
    leftovers(path, &scanned, &mut imported.warnings);
    Ok(imported)
}

/// One material for each name that the file uses; grey where no MTL file describes it.
fn materials(path: &Path, scanned: &Scanned, imported: &mut Imported) {
    let mut library = mtl::Library::default();
    let mut complete = true;
    for (line, written) in &scanned.libraries {
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
    for name in &scanned.names {
        let material = library.material(name);
        if material.is_none() && !name.is_empty() {
            unknown.push(name);
        }
        let material = material.unwrap_or_else(|| mtl::grey(name));
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
    let used = |name: &str| scanned.names.iter().any(|n| n == name);
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

/// Positions and triangles through tobj.
fn polygons(
    path: &Path,
    text: &str,
    scanned: &Scanned,
    imported: &mut Imported,
) -> Result<(), SceneError> {
    let options = tobj::LoadOptions {
        single_index: true,
        ..tobj::LoadOptions::default()
    };
    let numbered = |_: &Path| {
        let named = |i: usize| tobj::Material {
            name: i.to_string(),
            ..tobj::Material::default()
        };
        let all: Vec<_> = (0..scanned.names.len()).map(named).collect();
        let index: HashMap<_, _> = (0..all.len()).map(|i| (i.to_string(), i)).collect();
        let index = index.into_iter().collect();
        Ok((all, index))
    };
    let bad = |fallback: String| match bad_vertex(text) {
        Some((line, message)) => SceneError::line(path, line, message),
        None => SceneError::file(path, fallback),
    };
    let (models, _) = tobj::load_obj_buf(&mut scanned.plain.as_bytes(), &options, numbered)
        .map_err(|e| bad(e.to_string()))?;
    let mut corners = Vec::new();
    let mut cut = Vec::new();
    for model in models {
        let mesh = model.mesh;
        let base = imported.vertices.len();
        let positions = mesh.positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]]);
        imported.vertices.extend(positions);
        if u32::try_from(imported.vertices.len()).is_err() {
            return Err(SceneError::file(path, "has more than 4294967295 vertices"));
        }
        if mesh.positions.iter().any(|x| !x.is_finite()) {
            return Err(bad("a vertex is not finite".to_owned()));
        }
        let mut rest = mesh.indices.as_slice();
        let mut arities = mesh.face_arities.iter();
        while !rest.is_empty() {
            // tobj gives no arities where all faces are triangles.
            let arity = arities.next().map_or(3, |&n| n as usize);
            let (face, after) = rest.split_at(arity);
            rest = after;
            corners.clear();
            corners.extend(
                face.iter().map(|&v| {
                    DVec3::from_array(imported.vertices[base + v as usize].map(f64::from))
                }),
            );
            cut.clear();
            triangulate(&corners, &mut cut);
            let world = |t: &[u32; 3]| t.map(|i| base as u32 + face[i as usize]);
            imported.triangles.extend(cut.iter().map(world));
        }
        let material = mesh.material_id.unwrap_or(0) as u32;
        imported.material.resize(imported.triangles.len(), material);
    }
    Ok(())
}

fn leftovers(path: &Path, scanned: &Scanned, warnings: &mut Vec<String>) {
    let file = path.display();
    if scanned.degenerate > 0 {
        warnings.push(format!(
            "{file}: faces with fewer than three corners: {} left out",
            scanned.degenerate
        ));
    }
    if scanned.free_form {
        warnings.push(format!(
            "{file}: curves and surfaces of higher order are not supported; left out"
        ));
    }
}
