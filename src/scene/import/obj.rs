//! Wavefront OBJ: polygons and material names.
//!
//! The file is read in pieces, a few at a time: they are understood in parallel (`piece.rs`) and
//! appended in order, so the result does not depend on how many threads there are, and of the text
//! no more is held than those pieces.

use super::attributes::{Corners, NONE, weld};
use super::piece::{Cut, Piece};
use super::statements::{Pieces, text};
use super::{Counted, Counts, Imported, Request, mtl};
use crate::scene::error::SceneError;
use crate::scene::triangulate::triangulate;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::AtomicU64;

/// Bytes of a piece: enough to keep a core busy for milliseconds, few enough to stay in its cache
/// together with what is made of it.
const PIECE: usize = 1 << 20;

/// Loads the OBJ file at `path` and the MTL files that it names; `read` grows by the bytes read.
///
/// # Errors
/// A file that is missing or has no faces, an index of no vertex, a coordinate that is no finite
/// number: with the line.
pub(super) fn load(path: &Path, read: &AtomicU64) -> Result<Imported, SceneError> {
    load_by(path, read, PIECE)
}

/// The same in pieces of `size` bytes.
fn load_by(path: &Path, read: &AtomicU64, size: usize) -> Result<Imported, SceneError> {
    let mut reading = Reading::default();
    batches(path, read, size, |pieces| reading.append(path, pieces))?;
    if reading.largest.0 > reading.vertices.len() as u64 {
        let (index, line) = reading.largest;
        let count = reading.vertices.len();
        let message = format!(
            "a face has vertex index {index}, expected one of the {count} vertices of the file"
        );
        return Err(SceneError::line(path, line, message));
    }
    if reading.triangles.is_empty() {
        let message = "has no faces, expected at least one";
        return Err(SceneError::file(path, message));
    }
    Ok(reading.finish(path))
}

/// Counts vertices and triangles without keeping anything, and lists the textures that its materials
/// read. What is wrong with the file is left for [`load`] to say.
pub(super) fn count(path: &Path) -> Result<(Counts, Vec<Request>), SceneError> {
    let mut all = Look::default();
    batches(path, &AtomicU64::new(0), PIECE, |pieces| {
        let looks: Vec<Look> = pieces.par_iter().map(|piece| Look::at(piece)).collect();
        looks.into_iter().for_each(|look| all.append(look));
        Ok(())
    })?;
    all.names.sort_unstable();
    all.names.dedup();
    let mut imported = Imported::default();
    mtl::materials(path, &all.libraries, &all.names, &mut imported);
    Ok((all.counts, imported.wanted().cloned().collect()))
}

/// What a quick look through a piece finds.
#[derive(Debug, Default)]
struct Look {
    counts: Counts,
    /// Of materials.
    names: Vec<String>,
    /// `mtllib`: what it says. Lines are not counted.
    libraries: Vec<(usize, String)>,
}

impl Look {
    fn at(bytes: &[u8]) -> Self {
        let mut look = Self::default();
        for line in bytes.split(|&b| b == b'\n') {
            match line.trim_ascii_start() {
                [b'v', b' ' | b'\t', ..] => look.counts.vertices += 1,
                [b'f', b' ' | b'\t', rest @ ..] => {
                    let words = rest.split(u8::is_ascii_whitespace);
                    let corners = words.filter(|word| !word.is_empty()).count();
                    look.counts.triangles += corners.saturating_sub(2) as u64;
                }
                line => {
                    let rest = |keyword: &str| {
                        let rest = line.strip_prefix(keyword.as_bytes())?;
                        let apart = rest.first().is_some_and(u8::is_ascii_whitespace);
                        apart.then(|| text(rest.trim_ascii()).into_owned())
                    };
                    look.names.extend(rest("usemtl"));
                    look.libraries.extend(rest("mtllib").map(|name| (0, name)));
                }
            }
        }
        look
    }

    fn append(&mut self, mut other: Self) {
        self.counts = self.counts + other.counts;
        self.names.append(&mut other.names);
        self.libraries.append(&mut other.libraries);
    }
}

/// Hands the file's pieces to `each`, a few at a time.
fn batches(
    path: &Path,
    read: &AtomicU64,
    size: usize,
    mut each: impl FnMut(Vec<Vec<u8>>) -> Result<(), SceneError>,
) -> Result<(), SceneError> {
    let file = std::fs::File::open(path).map_err(|e| SceneError::io(path, &e))?;
    let mut pieces = Pieces::new(Counted { reader: file, read }, size);
    let at_once = 2 * rayon::current_num_threads();
    let mut first = true;
    loop {
        let mut batch = Vec::with_capacity(at_once);
        while batch.len() < at_once {
            match pieces.next().map_err(|e| SceneError::io(path, &e))? {
                Some(piece) => batch.push(piece),
                None => break,
            }
        }
        let Some(start) = batch.first() else {
            return Ok(());
        };
        if first && (start.starts_with(b"\xff\xfe") || start.starts_with(b"\xfe\xff")) {
            return Err(SceneError::file(path, "is UTF-16 text, expected UTF-8"));
        }
        first = false;
        each(batch)?;
    }
}

/// An OBJ file on its way in.
#[derive(Debug, Default)]
struct Reading {
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    corners: Corners,
    material: Vec<u32>,
    /// Names of materials in the order of their first face; faces before any `usemtl` have the
    /// empty name.
    names: Vec<String>,
    numbers: HashMap<String, u32>,
    /// What `usemtl` said last.
    current: String,
    libraries: Vec<(usize, String)>,
    lines: usize,
    largest: (u64, usize),
    late: Vec<(usize, Vec<u32>, Vec<[u32; 2]>)>,
    degenerate: usize,
    free_form: bool,
}

impl Reading {
    fn append(&mut self, path: &Path, batch: Vec<Vec<u8>>) -> Result<(), SceneError> {
        let read = |bytes: Vec<u8>| {
            let lines = bytes.iter().filter(|&&b| b == b'\n').count();
            (lines, Piece::read(&text(&bytes)))
        };
        let pieces: Vec<(usize, Piece)> = batch.into_par_iter().map(read).collect();
        let mut before = Vec::with_capacity(pieces.len());
        for (_, piece) in &pieces {
            let corners = &mut self.corners;
            before.push([
                self.vertices.len(),
                corners.uvs.len(),
                corners.normals.len(),
            ]);
            self.vertices.extend_from_slice(&piece.vertices);
            corners.uvs.extend_from_slice(&piece.uvs);
            corners.normals.extend_from_slice(&piece.normals);
        }
        if u32::try_from(self.vertices.len()).is_err() {
            return Err(SceneError::file(path, "has more than 4294967295 vertices"));
        }
        let known = &self.vertices;
        let cuts: Vec<Cut> = pieces
            .par_iter()
            .zip(&before)
            .map(|((_, piece), &before)| piece.cut(known, before))
            .collect();
        for (((lines, piece), cut), before) in pieces.into_iter().zip(cuts).zip(before) {
            // The faces of a piece stand before what ended its reading.
            if let Some(problem) = cut.problem.as_ref().or(piece.problem.as_ref()) {
                let line = self.lines + problem.line;
                return Err(SceneError::line(path, line, problem.message(before[0])));
            }
            self.take(lines, piece, cut);
        }
        Ok(())
    }

    fn take(&mut self, lines: usize, piece: Piece, cut: Cut) {
        let base = self.triangles.len();
        self.triangles.extend_from_slice(&cut.triangles);
        let tables = [&mut self.corners.uv, &mut self.corners.normal];
        for (table, carried) in tables.into_iter().zip(&cut.carried) {
            if !carried.is_empty() {
                table.resize(base, [NONE; 3]);
                table.extend_from_slice(carried);
            }
        }
        let names = piece.materials.into_iter().map(|(_, name)| Some(name));
        for (&end, name) in cut.ends.iter().zip(names.chain([None])) {
            // Names that no face uses are passed over.
            if base + end > self.material.len() {
                let number = self.number();
                self.material.resize(base + end, number);
            }
            self.current = name.unwrap_or_else(|| std::mem::take(&mut self.current));
        }
        if cut.largest.0 > self.largest.0 {
            self.largest = (cut.largest.0, self.lines + cut.largest.1);
        }
        let late = cut
            .late
            .into_iter()
            .map(|(at, corners, carried)| (base + at, corners, carried));
        self.late.extend(late);
        let libraries = piece.libraries.into_iter();
        self.libraries
            .extend(libraries.map(|(line, text)| (self.lines + line, text)));
        self.degenerate += cut.degenerate;
        self.free_form |= piece.free_form;
        self.lines += lines;
    }

    /// Number of the current material.
    fn number(&mut self) -> u32 {
        if let Some(&number) = self.numbers.get(&self.current) {
            return number;
        }
        let number = self.names.len() as u32;
        self.names.push(self.current.clone());
        self.numbers.insert(self.current.clone(), number);
        number
    }

    /// All indices are valid now.
    fn finish(mut self, path: &Path) -> Imported {
        let mut cut = Vec::new();
        for (at, indices, carried) in std::mem::take(&mut self.late) {
            let corner = |&i: &u32| DVec3::from_array(self.vertices[i as usize].map(f64::from));
            let corners: Vec<DVec3> = indices.iter().map(corner).collect();
            cut.clear();
            triangulate(&corners, &mut cut);
            for (hole, t) in self.triangles[at..].iter_mut().zip(&cut) {
                *hole = t.map(|i| indices[i as usize]);
            }
            let tables = [&mut self.corners.uv, &mut self.corners.normal];
            for (which, table) in tables.into_iter().enumerate() {
                if !carried.is_empty() {
                    for (hole, t) in table[at..].iter_mut().zip(&cut) {
                        *hole = t.map(|i| carried[i as usize][which]);
                    }
                }
            }
        }
        let mut imported = Imported {
            vertices: self.vertices,
            triangles: self.triangles,
            material: self.material,
            ..Imported::default()
        };
        mtl::materials(path, &self.libraries, &self.names, &mut imported);
        let file = path.display();
        if self.degenerate > 0 {
            imported.warnings.push(format!(
                "{file}: faces with fewer than three corners: {} left out",
                self.degenerate
            ));
        }
        if self.free_form {
            imported.warnings.push(format!(
                "{file}: curves and surfaces of higher order are not supported; left out"
            ));
        }
        let wrong = weld(&mut imported, self.corners);
        if wrong > 0 {
            imported.warnings.push(format!(
                "{file}: indices of no texture coordinates or normal: {wrong} left out"
            ));
        }
        imported.drop_unused_vertices();
        imported
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the size of the pieces, and with any number of threads, the answer is the same.
    fn by_all_sizes(text: &str) -> Result<Imported, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, text).unwrap();
        let load = |size, threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let read = AtomicU64::new(0);
            let loaded = pool
                .build()
                .unwrap()
                .install(|| load_by(&path, &read, size));
            loaded.map_err(|e| format!("{:?} {}", e.line_number(), e.message()))
        };
        let whole = load(text.len() + 1, 1);
        for size in 1..text.len() {
            let parts = load(size, 1 + size % 3);
            assert_eq!(
                format!("{parts:?}"),
                format!("{whole:?}"),
                "pieces of {size}"
            );
        }
        whole
    }

    #[test]
    fn pieces_make_no_difference() {
        // A concave quadrilateral before its vertices, relative indices, and materials between.
        let imported = by_all_sizes(
            "f 1 2 3 4\nv 4 2 0\nv 0 0 0\nusemtl red\nv 4 -2 0\nv 1 0 0\nf -1 -2 -3 -4\n\
             usemtl none\nusemtl blue\nf 1 2 3\nusemtl red\nv 9 9 9\nf -2 -3 -4\nf 1 2\n",
        )
        .unwrap();
        assert_eq!(imported.vertices.len(), 4);
        assert_eq!(imported.material, [0, 0, 1, 1, 2, 1]);
        let names: Vec<&str> = imported.materials.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["", "red", "blue"]);
        // Both quadrilaterals are one arrow head, cut from its notch to its tip.
        for t in &imported.triangles[..4] {
            assert!(t.contains(&1) && t.contains(&3), "{t:?}");
        }
    }

    #[test]
    fn pieces_make_no_difference_to_what_corners_carry() {
        // A late pentagon, then relative indices, a corner without, and one of nothing.
        let imported = by_all_sizes(
            "f 1/1/1 2/2/1 3/3/2 4/4/1 5/5/1\nv 0 0 0\nv 2 0 0\nvt 0 0\nvn 0 0 9\nv 2 2 0\n\
             v 1 3 0\nv 0 2 0\nvt 1 0\nvt 1 1\nvn 0 1 1\nvt .5 1.5\nvt 0 1\n\
             f -5/-5/-1 -4/-4/-2 -3/-3/-1\nf 1/1 2/2 3/3\nf 1//1 2//9 3//2\nf 1 2 5\n",
        )
        .unwrap();
        assert_eq!(imported.triangles.len(), 7);
        assert_eq!(imported.uvs.len(), imported.vertices.len());
        assert_eq!(imported.normals.len(), imported.vertices.len());
        // (u, v) are half of (x, y) wherever there are any.
        for (uv, at) in imported.uvs.iter().zip(&imported.vertices) {
            assert!(
                uv[0].is_nan() || *uv == [at[0] / 2.0, at[1] / 2.0],
                "{uv:?} {at:?}"
            );
        }
        let has = |t: usize| {
            let of = imported.triangles[t].map(|v| v as usize);
            let smooth = of.iter().all(|&v| imported.normals[v] != 0x8000_8000);
            (of.iter().all(|&v| imported.uvs[v][0].is_finite()), smooth)
        };
        // The pentagon's triangles without corner 3 have the face's own normal: they are flat.
        let smooth = (0..3).filter(|&t| has(t).1).count();
        assert!((1..3).contains(&smooth));
        assert!((0..3).all(|t| has(t).0));
        assert_eq!(
            (3..7).map(has).collect::<Vec<_>>(),
            [(true, true), (true, false), (false, false), (false, false)]
        );
        assert_eq!(imported.warnings.len(), 1);
        assert!(
            imported.warnings[0]
                .ends_with("indices of no texture coordinates or normal: 1 left out")
        );
    }

    #[test]
    fn pieces_make_no_difference_to_errors() {
        for (text, expected) in [
            (
                "v 0 0 0\nv 1 0 0\nf 1 2 -1\nf 1 2 -3\nv x\n",
                "Some(4) a face has vertex index -3, with only 2 vertices before it",
            ),
            (
                "v 0 0 0\nv 1 0 0\n# a\nv 0 nan 0\nf 0 1 2\n",
                "Some(4) vertex 3 has coordinate `nan`, expected a finite number",
            ),
            (
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\nf 1 2 5\nf 1 2 5\n",
                "Some(5) a face has vertex index 5, expected one of the 3 vertices of the file",
            ),
        ] {
            assert_eq!(by_all_sizes(text).unwrap_err(), expected);
        }
    }
}
