//! PLY (G. Turk, "The PLY Polygon File Format", 1994), ASCII and binary, through serde-ply.
//!
//! serde-ply hands over the elements row by row, in the file's order, and this module is the other
//! side of that: it puts each row where it belongs as it comes, so that nothing is held but the
//! finished tables.

mod header;
mod rows;

use super::{Counted, Counts, Imported, mtl};
use crate::scene::error::SceneError;
use header::Header;
use rows::{Pass, Reading};
use serde::Deserializer;
use serde_ply::{PlyFormat, PlyReader};
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;
use std::sync::atomic::AtomicU64;

/// Bytes read at once.
const BUFFER: usize = 1 << 18;

/// Loads the PLY file at `path`; `read` grows by the bytes read.
///
/// # Errors
/// A file that is missing, ends early or has no faces, a header that is wrong or describes no mesh,
/// an index of no vertex, a coordinate that is no finite number: with the number of the vertex or
/// face, from 0.
pub(super) fn load(path: &Path, read: &AtomicU64) -> Result<Imported, SceneError> {
    let header = Header::read(path)?;
    let wrong = |message| SceneError::file(path, message);
    let mut reading = Reading::new(&header);
    // Faces can only be cut when all vertices are known: where they come first, they have to wait
    // for a second reading.
    reading.pass = if header.faces_come_first() {
        Pass::Vertices
    } else {
        Pass::Both
    };
    pass(path, &header, &mut reading, read)?;
    if reading.pass == Pass::Vertices {
        reading.pass = Pass::Faces;
        pass(path, &header, &mut reading, &AtomicU64::new(0))?;
    }
    let mut imported = Imported {
        vertices: reading.vertices,
        triangles: reading.triangles,
        normals: reading.normals,
        uvs: reading.uvs,
        ..Imported::default()
    };
    if imported.triangles.is_empty() {
        let message = "has no faces, expected at least one";
        return Err(wrong(message.to_owned()));
    }
    if reading.degenerate > 0 {
        imported.warnings.push(format!(
            "{}: faces with fewer than three corners: {} left out",
            path.display(),
            reading.degenerate
        ));
    }
    imported.material = vec![0; imported.triangles.len()];
    imported.materials.push(mtl::grey(""));
    imported.drop_unused_vertices();
    Ok(imported)
}

/// Counts vertices and triangles by the header and the size of the file.
pub(super) fn count(path: &Path) -> Result<Counts, SceneError> {
    Header::read(path)?.counts()
}

/// One reading of the whole file.
fn pass(
    path: &Path,
    header: &Header,
    reading: &mut Reading,
    read: &AtomicU64,
) -> Result<(), SceneError> {
    let file = File::open(path).map_err(|e| SceneError::io(path, &e))?;
    let reader = BufReader::with_capacity(BUFFER, Counted { reader: file, read });
    // serde-ply takes a number for cut off if nothing stands behind it.
    let end: &[u8] = match header.format() {
        PlyFormat::Ascii => b"\n",
        _ => b"",
    };
    let mut ply = PlyReader::from_reader(reader.chain(end)).map_err(|e| describe(path, &e.0))?;
    match ply.deserialize_map(&mut *reading) {
        Ok(()) => Ok(()),
        Err(_) if reading.problem.is_some() => {
            let problem = reading.problem.take().unwrap_or_default();
            Err(SceneError::file(path, problem))
        }
        Err(e) if e.0.kind() == io::ErrorKind::UnexpectedEof => {
            let message = format!("ends early: {} is not whole", reading.place());
            Err(SceneError::file(path, message))
        }
        Err(e) if e.0.kind() == io::ErrorKind::InvalidData => {
            let message = format!("{}: {}", reading.place(), lower(&e.0.to_string()));
            Err(SceneError::file(path, message))
        }
        Err(e) => Err(SceneError::io(path, &e.0)),
    }
}

/// What serde-ply says about a header or a value.
fn describe(path: &Path, error: &io::Error) -> SceneError {
    match error.kind() {
        io::ErrorKind::InvalidData | io::ErrorKind::UnexpectedEof => {
            let message = format!("not a valid PLY header: {}", lower(&error.to_string()));
            SceneError::file(path, message)
        }
        _ => SceneError::io(path, error),
    }
}

fn lower(message: &str) -> String {
    let mut letters = message.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_lowercase().chain(letters).collect()
    })
}
