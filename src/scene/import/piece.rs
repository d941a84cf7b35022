//! A piece of an OBJ file: its statements as numbers, as far as they can be understood without the
//! pieces before it. Pieces are read in parallel and put together in order (`obj.rs`).
//!
//! Why not tobj: for a mesh of ten million triangles it holds 96 bytes a face and a hash map of all
//! vertices besides the text, which alone is several times the finished tables; it has no line
//! numbers; and of the many statements of OBJ only seven matter here.

use super::attributes::NONE;
use super::statements::{split, statements};
use crate::scene::triangulate::triangulate;
use glam::DVec3;
use huygens_kernels::octahedral;

/// What a piece says.
#[derive(Debug, Default)]
pub(super) struct Piece {
    pub(super) vertices: Vec<[f32; 3]>,
    /// `vt`; NaN for what is no two finite numbers.
    pub(super) uvs: Vec<[f32; 2]>,
    /// `vn` as codes.
    pub(super) normals: Vec<u32>,
    corners: Vec<Corner>,
    /// Of as many corners, texture coordinates and normals; empty where no corner has any.
    carried: Vec<[Carried; 2]>,
    faces: Vec<Face>,
    /// `usemtl`: the number of faces before it, and the name.
    pub(super) materials: Vec<(usize, String)>,
    /// `mtllib`: line and text.
    pub(super) libraries: Vec<(usize, String)>,
    /// Whether there are curves or surfaces of higher order, which are left out.
    pub(super) free_form: bool,
    /// What ended the reading early.
    pub(super) problem: Option<Problem>,
}

/// A vertex index, from 0.
#[derive(Clone, Copy, Debug)]
enum Corner {
    /// In the file.
    Absolute(u64),
    /// From the first vertex of the piece on; below 0, it lies in a piece before. With what is
    /// written in the file.
    Relative(i64, i64),
}

/// The index of texture coordinates or of a normal.
#[derive(Clone, Copy, Debug)]
enum Carried {
    None,
    Absolute(u32),
    /// From the first one of the piece on.
    Relative(i32),
}

#[derive(Clone, Copy, Debug)]
struct Face {
    line: usize,
    /// Where its corners end.
    end: usize,
}

/// What is wrong, and in which line of the piece.
#[derive(Debug)]
pub(super) struct Problem {
    pub(super) line: usize,
    /// For a vertex: its index in the piece.
    vertex: Option<usize>,
    what: String,
}

impl Problem {
    /// In words; `before` vertices precede the piece.
    pub(super) fn message(&self, before: usize) -> String {
        match self.vertex {
            Some(i) => format!("vertex {} has {}", before + i + 1, self.what),
            None => format!("a face has vertex index {}", self.what),
        }
    }
}

/// The faces of a piece, cut into triangles.
#[derive(Debug, Default)]
pub(super) struct Cut {
    pub(super) triangles: Vec<[u32; 3]>,
    /// Texture coordinates and normals of as many triangles' corners; empty where none has any.
    pub(super) carried: [Vec<[u32; 3]>; 2],
    /// Number of triangles before each `usemtl`, and of all.
    pub(super) ends: Vec<usize>,
    /// Faces with fewer than three corners, which are left out.
    pub(super) degenerate: usize,
    /// The largest index, from 1, and the line of its first use.
    pub(super) largest: (u64, usize),
    /// Polygons that could not be cut because not all of their vertices are read yet: where their
    /// triangles begin, their corners, and what these carry.
    pub(super) late: Vec<(usize, Vec<u32>, Vec<[u32; 2]>)>,
    pub(super) problem: Option<Problem>,
}

impl Piece {
    /// Reads the text of a piece.
    pub(super) fn read(text: &str) -> Self {
        let mut piece = Self::default();
        for (line, statement) in statements(text) {
            let (keyword, rest) = split(&statement);
            let read = match keyword {
                "v" => piece.vertex(rest),
                "vt" => {
                    let uv = finite(rest).unwrap_or([f32::NAN; 2]);
                    piece.uvs.push(uv);
                    Ok(())
                }
                "vn" => {
                    let normal = finite(rest).map(|n: [f32; 3]| n.map(f64::from));
                    let code = normal.map_or(octahedral::NONE, octahedral::encode);
                    piece.normals.push(code);
                    Ok(())
                }
                "f" | "fo" => piece.face(line, rest),
                "usemtl" => {
                    piece.materials.push((piece.faces.len(), rest.to_owned()));
                    Ok(())
                }
                "mtllib" => {
                    piece.libraries.push((line, rest.to_owned()));
                    Ok(())
                }
                "surf" | "curv" | "curv2" | "cstype" => {
                    piece.free_form = true;
                    Ok(())
                }
                // Groups, smoothing, points, lines, the unknown.
                _ => Ok(()),
            };
            if let Err((vertex, what)) = read {
                piece.problem = Some(Problem { line, vertex, what });
                break;
            }
        }
        piece
    }

    /// x, y, z. A fourth number is a weight that polygons do not use; six hold a colour.
    fn vertex(&mut self, rest: &str) -> Result<(), (Option<usize>, String)> {
        let index = Some(self.vertices.len());
        let mut vertex = [0.0; 3];
        let mut words = rest.split_ascii_whitespace();
        for found in 0..3 {
            let Some(word) = words.next() else {
                return Err((index, format!("{found} coordinates, expected 3")));
            };
            match word.parse::<f32>() {
                Ok(x) if x.is_finite() => vertex[found] = x,
                _ => {
                    let what = format!("coordinate `{word}`, expected a finite number");
                    return Err((index, what));
                }
            }
        }
        self.vertices.push(vertex);
        Ok(())
    }

    /// Corners such as `7`, `7/1/2`, `7//2` or `-1/-1`.
    fn face(&mut self, line: usize, rest: &str) -> Result<(), (Option<usize>, String)> {
        for word in rest.split_ascii_whitespace() {
            let (vertex, carried) = word.split_once('/').unwrap_or((word, ""));
            let corner = match vertex.parse::<i64>() {
                Ok(index @ 1..) => Corner::Absolute(index as u64 - 1),
                Ok(0) => return Err((None, "0, expected indices from 1".to_owned())),
                Ok(index) => Corner::Relative(self.vertices.len() as i64 + index, index),
                Err(_) => return Err((None, format!("`{word}`, expected a whole number"))),
            };
            if !carried.is_empty() {
                let (uv, normal) = carried.split_once('/').unwrap_or((carried, ""));
                let uv = Carried::read(uv, self.uvs.len());
                let normal = Carried::read(normal, self.normals.len());
                self.carried.resize(self.corners.len(), [Carried::None; 2]);
                self.carried.push([uv, normal]);
            }
            self.corners.push(corner);
        }
        let end = self.corners.len();
        self.faces.push(Face { line, end });
        Ok(())
    }

    /// Cuts the faces into triangles. `vertices` are those read so far, `before` how many of them,
    /// and how many texture coordinates and normals, precede the piece.
    pub(super) fn cut(&self, vertices: &[[f32; 3]], before: [usize; 3]) -> Cut {
        let [before, before_uvs, before_normals] = before;
        let mut out = Cut::default();
        out.triangles.reserve(self.faces.len());
        let mut names = self.materials.iter().map(|&(face, _)| face).peekable();
        let mut start = 0;
        let (mut indices, mut corners, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        let mut carried: Vec<[u32; 2]> = Vec::new();
        for (number, face) in self.faces.iter().enumerate() {
            while names.next_if_eq(&number).is_some() {
                out.ends.push(out.triangles.len());
            }
            indices.clear();
            for &corner in &self.corners[start..face.end] {
                let index = match corner {
                    Corner::Absolute(index) => index,
                    Corner::Relative(local, written) => {
                        let Some(index) = before.checked_add_signed(local as isize) else {
                            let seen = before as i64 + local - written;
                            out.problem = Some(Problem {
                                line: face.line,
                                vertex: None,
                                what: format!("{written}, with only {seen} vertices before it"),
                            });
                            return out;
                        };
                        index as u64
                    }
                };
                if index >= out.largest.0 {
                    out.largest = (index + 1, face.line);
                }
                // One beyond is refused in the end, whatever stands in its place until then.
                indices.push(u32::try_from(index).unwrap_or(u32::MAX));
            }
            carried.clear();
            if !self.carried.is_empty() {
                let of = |corner| self.carried.get(corner).unwrap_or(&[Carried::None; 2]);
                let all = (start..face.end).map(of);
                let all = all.map(|[uv, n]| [uv.index(before_uvs), n.index(before_normals)]);
                carried.extend(all);
            }
            start = face.end;
            match indices[..] {
                [] | [_] | [_, _] => out.degenerate += 1,
                [a, b, c] => {
                    out.triangles.push([a, b, c]);
                    out.carry(&carried, [0, 1, 2]);
                }
                _ => {
                    corners.clear();
                    let known = indices.iter().map_while(|&i| vertices.get(i as usize));
                    corners.extend(known.map(|v| DVec3::from_array(v.map(f64::from))));
                    if corners.len() < indices.len() {
                        let late = (out.triangles.len(), indices.clone(), carried.clone());
                        out.late.push(late);
                        let holes = indices.len() - 2;
                        out.triangles.resize(out.triangles.len() + holes, [0; 3]);
                        for _ in 0..holes {
                            out.carry(&carried, [0, 1, 2]);
                        }
                        continue;
                    }
                    triangles.clear();
                    triangulate(&corners, &mut triangles);
                    let cut = triangles.iter().map(|t| t.map(|i| indices[i as usize]));
                    out.triangles.extend(cut);
                    for &t in &triangles {
                        out.carry(&carried, t);
                    }
                }
            }
        }
        out.ends
            .resize(self.materials.len() + 1, out.triangles.len());
        out
    }
}

impl Cut {
    /// What three corners of a face carry, of those that it has.
    fn carry(&mut self, carried: &[[u32; 2]], corners: [u32; 3]) {
        if !carried.is_empty() {
            for (which, table) in self.carried.iter_mut().enumerate() {
                table.push(corners.map(|i| carried[i as usize][which]));
            }
        }
    }
}

impl Carried {
    /// `7` or `-1`; `before` stand before it in the piece. What cannot be read is not there: it is
    /// only how a surface looks.
    fn read(word: &str, before: usize) -> Self {
        match word.parse::<i64>() {
            Ok(index @ 1..) => u32::try_from(index - 1).map_or(Self::None, Self::Absolute),
            Ok(index) if index < 0 => {
                i32::try_from(before as i64 + index).map_or(Self::None, Self::Relative)
            }
            _ => Self::None,
        }
    }

    /// Index in the file; `before` precede the piece.
    fn index(self, before: usize) -> u32 {
        match self {
            Self::None => NONE,
            Self::Absolute(index) => index,
            Self::Relative(local) => {
                let index = before.checked_add_signed(local as isize);
                index.and_then(|i| u32::try_from(i).ok()).unwrap_or(NONE)
            }
        }
    }
}

/// The first `N` words as finite numbers.
fn finite<const N: usize>(rest: &str) -> Option<[f32; N]> {
    let mut words = rest.split_ascii_whitespace();
    let mut numbers = [0.0; N];
    for x in &mut numbers {
        *x = words.next()?.parse().ok().filter(|x: &f32| x.is_finite())?;
    }
    Some(numbers)
}
