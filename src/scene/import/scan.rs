//! A first pass over an OBJ file, for what tobj cannot say or do.
//!
//! tobj 4 reports no line numbers, takes polylines (`l`) for faces, stops at comments behind a
//! statement, at continued lines and at text that is not UTF-8, forgets the names of materials
//! whose MTL file is missing, and refuses faces that come before their vertices. So this pass
//! resolves and checks the indices of faces, and writes the statements that matter here (vertex
//! positions, faces, materials by number) in the plain form that tobj reads at full speed.

use crate::scene::error::SceneError;
use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

/// What an OBJ file holds, in tobj's plainest dialect.
#[derive(Debug, Default)]
pub(super) struct Scanned {
    /// A `mtllib` line, all `v` lines, then `usemtl NUMBER` and `f` lines with indices from 1.
    pub(super) plain: String,
    /// Names of MTL files as written, with their lines.
    pub(super) libraries: Vec<(usize, String)>,
    /// Names of materials in the order of their first face; `usemtl` numbers index this. Faces
    /// before any `usemtl` have the empty name.
    pub(super) names: Vec<String>,
    /// Faces with at least three corners.
    pub(super) faces: usize,
    /// Faces with fewer than three corners, which were left out.
    pub(super) degenerate: usize,
    /// Whether there are curves or surfaces of higher order, which were left out.
    pub(super) free_form: bool,
}

/// Text of a file, whatever bytes it holds: only ASCII carries meaning in OBJ and MTL, and names
/// that are not UTF-8 are told apart well enough by what replaces them.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// Statements with the number of their first line: continued lines joined, comments cut off.
pub(super) fn statements(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let mut whole = Cow::Borrowed(line.trim_end());
        while let Some(head) = whole.strip_suffix('\\') {
            let Some((_, next)) = lines.next() else {
                whole = Cow::Owned(head.to_owned());
                break;
            };
            whole = Cow::Owned(format!("{head} {}", next.trim_end()));
        }
        // A '#' starts a comment where a word could start: names may hold one inside.
        let cut = whole
            .match_indices('#')
            .find(|&(at, _)| at == 0 || whole.as_bytes()[at - 1].is_ascii_whitespace())
            .map(|(at, _)| at);
        if let Some(cut) = cut {
            whole = match whole {
                Cow::Borrowed(s) => Cow::Borrowed(&s[..cut]),
                Cow::Owned(s) => Cow::Owned(s[..cut].to_owned()),
            };
        }
        Some((number + 1, whole))
    })
}

/// A statement's keyword and the rest of it.
pub(super) fn split(statement: &str) -> (&str, &str) {
    let trimmed = statement.trim();
    trimmed
        .split_once(|c: char| c.is_ascii_whitespace())
        .map_or((trimmed, ""), |(word, rest)| (word, rest.trim()))
}

/// Scans the text of the OBJ file at `path`.
pub(super) fn scan(path: &Path, text: &str) -> Result<Scanned, SceneError> {
    let mut found = Scanned::default();
    let mut vertices = String::with_capacity(text.len() + 16);
    vertices.push_str("mtllib materials\n");
    let mut faces = String::with_capacity(text.len() / 2);
    let mut numbers = std::collections::HashMap::new();
    let mut material = String::new();
    // Whether the faces to come need a `usemtl`: names that no face uses are passed over.
    let mut changed = true;
    let mut count = 0usize;
    let mut largest = (0usize, 0usize);
    let mut corners = Vec::new();
    for (line, statement) in statements(text) {
        let (keyword, rest) = split(&statement);
        match keyword {
            "v" => {
                count += 1;
                vertices.push('v');
                // x, y, z. A fourth number is a weight that polygons do not use; six hold a colour.
                for word in rest.split_ascii_whitespace().take(3) {
                    vertices.push(' ');
                    vertices.push_str(word);
                }
                vertices.push('\n');
            }
            "f" | "fo" => {
                corners.clear();
                for word in rest.split_ascii_whitespace() {
                    let index =
                        resolve(word, count).map_err(|e| SceneError::line(path, line, e))?;
                    corners.push(index);
                    if index > largest.0 {
                        largest = (index, line);
                    }
                }
                if corners.len() < 3 {
                    found.degenerate += 1;
                    continue;
                }
                found.faces += 1;
                if std::mem::take(&mut changed) {
                    let next = found.names.len();
                    let number = *numbers.entry(material.clone()).or_insert(next);
                    if number == next {
                        found.names.push(material.clone());
                    }
                    let _ = writeln!(faces, "usemtl {number}");
                }
                faces.push('f');
                for index in &corners {
                    let _ = write!(faces, " {index}");
                }
                faces.push('\n');
            }
            "usemtl" => {
                rest.clone_into(&mut material);
                changed = true;
            }
            "mtllib" => found.libraries.push((line, rest.to_owned())),
            "surf" | "curv" | "curv2" | "cstype" => found.free_form = true,
            // Texture coordinates, normals, groups, smoothing, points, lines, and what is unknown.
            _ => {}
        }
    }
    if largest.0 > count {
        let (index, line) = largest;
        return Err(SceneError::line(path, line, beyond(index, count)));
    }
    found.plain = vertices + &faces;
    Ok(found)
}

fn beyond(index: impl std::fmt::Display, count: usize) -> String {
    format!("a face has vertex index {index}, expected one of the {count} vertices of the file")
}

/// The vertex index (from 1) of a face's corner such as `7`, `7/1/2`, `7//2` or `-1/-1`, with
/// `count` vertices so far.
fn resolve(word: &str, count: usize) -> Result<usize, String> {
    let vertex = word.split_once('/').map_or(word, |(v, _)| v);
    let index: i64 = vertex
        .parse()
        .map_err(|_| format!("a face has vertex index `{word}`, expected a whole number"))?;
    match index {
        0 => Err("a face has vertex index 0, expected indices from 1".to_owned()),
        1.. => Ok(index as usize),
        _ => usize::try_from(count as i64 + index)
            .map(|i| i + 1)
            .map_err(|_| {
                format!("a face has vertex index {index}, with only {count} vertices before it")
            }),
    }
}

/// The first vertex that cannot be drawn, as line and message.
pub(super) fn bad_vertex(text: &str) -> Option<(usize, String)> {
    let mut count = 0usize;
    statements(text).find_map(|(line, statement)| {
        let (keyword, rest) = split(&statement);
        if keyword != "v" {
            return None;
        }
        count += 1;
        let words: Vec<&str> = rest.split_ascii_whitespace().take(3).collect();
        if words.len() < 3 {
            let found = words.len();
            return Some((
                line,
                format!("vertex {count} has {found} coordinates, expected 3"),
            ));
        }
        words.iter().find_map(|word| match word.parse::<f32>() {
            Ok(x) if x.is_finite() => None,
            _ => Some((
                line,
                format!("vertex {count} has coordinate `{word}`, expected a finite number"),
            )),
        })
    })
}
