//! What a PLY file says that it holds, and whether that is a mesh.

use super::super::Counts;
use super::describe;
use crate::scene::error::SceneError;
use serde_ply::{
    ElementDef, PlyFormat, PlyHeader, PlyProperty, PlyReader, PropertyType, ScalarType,
};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// No header is longer than this. Without a bound, a file of another kind would be read whole in
/// search of its end.
const LONGEST: u64 = 1 << 20;

/// What may be read of vertices, the most first.
const FIELDS: [&[&str]; 7] = [
    &["x", "y", "z", "nx", "ny", "nz", "u", "v"],
    &["x", "y", "z", "nx", "ny", "nz", "s", "t"],
    &["x", "y", "z", "nx", "ny", "nz", "texture_u", "texture_v"],
    &["x", "y", "z", "nx", "ny", "nz"],
    &["x", "y", "z", "u", "v"],
    &["x", "y", "z", "s", "t"],
    &["x", "y", "z", "texture_u", "texture_v"],
];

/// The header of a mesh.
pub(super) struct Header {
    path: PathBuf,
    header: PlyHeader,
    /// Bytes of the file behind the header.
    body: u64,
}

impl Header {
    /// Reads and checks the header of the file at `path`.
    pub(super) fn read(path: &Path) -> Result<Self, SceneError> {
        let io = |e: std::io::Error| SceneError::io(path, &e);
        let wrong = |message: &str| Err(SceneError::file(path, message));
        let file = File::open(path).map_err(io)?;
        let size = file.metadata().map_err(io)?.len();
        let mut start = Vec::new();
        let mut reader = BufReader::new(file).take(LONGEST);
        // Line by line: what follows the header may be anything.
        let found = loop {
            let line = start.len();
            let mut end = |byte| std::io::BufRead::read_until(&mut reader, byte, &mut start);
            if end(b'\n').map_err(io)? == 0 {
                break false;
            }
            let line = &start[line..];
            if start.len() == line.len() && line.trim_ascii() != b"ply" {
                return wrong("is not a PLY file, expected `ply` in its first line");
            }
            if line.ends_with(b"\n") && line.trim_ascii() == b"end_header" {
                break true;
            }
        };
        if !found {
            return wrong("not a valid PLY header: no end, expected a line `end_header`");
        }
        let body = size.saturating_sub(start.len() as u64);
        let reader = PlyReader::from_reader(&start[..]).map_err(|e| describe(path, &e.0))?;
        let header = Self {
            path: path.to_owned(),
            header: reader.header().clone(),
            body,
        };
        header.check()?;
        Ok(header)
    }

    pub(super) fn format(&self) -> PlyFormat {
        self.header.format
    }

    fn check(&self) -> Result<(), SceneError> {
        let wrong = |message: &str| Err(SceneError::file(&self.path, message));
        for name in ["vertex", "face"] {
            let named = self.header.elem_defs.iter().filter(|e| e.name == name);
            if named.count() > 1 {
                return wrong(&format!("has two elements `{name}`, expected one"));
            }
        }
        if self.rows("face") == 0 {
            return wrong("has no faces, expected at least one");
        }
        let vertex = self.header.get_element("vertex");
        for name in ["x", "y", "z"] {
            match vertex.and_then(|v| v.get_property(name)) {
                Some(p) if matches!(p.property_type, PropertyType::Scalar(_)) => {}
                Some(_) => {
                    return wrong(&format!(
                        "vertex property `{name}` is a list, expected a number"
                    ));
                }
                None => {
                    return wrong(&format!(
                        "has no vertex property `{name}`, expected x, y and z"
                    ));
                }
            }
        }
        let Some(indices) = self.indices() else {
            return wrong(
                "has no face property `vertex_indices`, expected the corners of each face",
            );
        };
        match indices.property_type {
            PropertyType::List { data_type, .. } if is_whole(data_type) => Ok(()),
            _ => wrong(&format!(
                "face property `{}` is not a list of whole numbers, expected vertex indices",
                indices.name
            )),
        }
    }

    /// The numbers that are read of a vertex, in this order: x, y, z, then the normal, if it has one,
    /// then texture coordinates, if it has any, by one of their usual names.
    pub(super) fn fields(&self) -> &'static [&'static str] {
        let vertex = self.header.get_element("vertex");
        let scalar = |name: &&str| {
            let property = vertex.and_then(|v| v.get_property(name));
            property.is_some_and(|p| matches!(p.property_type, PropertyType::Scalar(_)))
        };
        let whole = |fields: &&[&str]| fields.iter().all(scalar);
        // All of them begin with x, y and z, which are there.
        FIELDS.into_iter().find(whole).unwrap_or(&["x", "y", "z"])
    }

    fn rows(&self, element: &str) -> usize {
        self.header.get_element(element).map_or(0, |e| e.count)
    }

    /// The property that holds the corners of faces.
    fn indices(&self) -> Option<&PlyProperty> {
        let face = self.header.get_element("face")?;
        face.properties.iter().find(|p| is_indices(&p.name))
    }

    pub(super) fn faces_come_first(&self) -> bool {
        let place = |name| self.header.elem_defs.iter().position(|e| e.name == name);
        place("face") < place("vertex")
    }

    /// Vertices and triangles of the file: exact where it is whole and no list stands in it but the
    /// faces' corners, otherwise an upper bound. Faces with fewer than three corners are not
    /// foreseen: each lowers the number of triangles by up to two.
    pub(super) fn counts(&self) -> Result<Counts, SceneError> {
        let faces = self.rows("face") as u64;
        // What the rows hold apart from corners, in bytes or, in ASCII, in words.
        let least = |e: &ElementDef| row(self.format(), e).saturating_mul(e.count as u64);
        let fixed = self.header.elem_defs.iter().map(least);
        let fixed = fixed.fold(0, u64::saturating_add);
        let (whole, corner) = match (self.format(), self.indices().map(|p| &p.property_type)) {
            (PlyFormat::Ascii, _) => (self.words()?, 1),
            (_, Some(PropertyType::List { data_type, .. })) => (self.body, size(*data_type)),
            _ => (self.body, 1),
        };
        let corners = whole.saturating_sub(fixed) / corner;
        // A file that ends early is refused when it is read.
        let fits = |rows: u64, row: u64| rows.min(whole / row.max(1));
        Ok(Counts {
            vertices: self
                .header
                .get_element("vertex")
                .map_or(0, |v| fits(v.count as u64, row(self.format(), v))),
            triangles: corners.saturating_sub(faces.saturating_mul(2)),
        })
    }

    /// Words of an ASCII file behind the header.
    fn words(&self) -> Result<u64, SceneError> {
        let io = |e: std::io::Error| SceneError::io(&self.path, &e);
        let mut file = File::open(&self.path).map_err(io)?;
        let start = file.metadata().map_err(io)?.len().saturating_sub(self.body);
        std::io::Seek::seek(&mut file, std::io::SeekFrom::Start(start)).map_err(io)?;
        let mut buffer = vec![0; 1 << 18];
        let (mut words, mut inside) = (0, false);
        loop {
            let read = file.read(&mut buffer).map_err(io)?;
            if read == 0 {
                return Ok(words);
            }
            for byte in &buffer[..read] {
                let blank = byte.is_ascii_whitespace();
                words += u64::from(!blank && !inside);
                inside = !blank;
            }
        }
    }

    /// Rows of `element` for which room is made before they are read: as many as the header says,
    /// unless the file is too small for them.
    pub(super) fn room(&self, element: &str) -> usize {
        let Some(e) = self.header.get_element(element) else {
            return 0;
        };
        // A word of ASCII takes a blank too.
        let least = row(self.format(), e).max(1);
        (e.count as u64).min(self.body / least) as usize
    }
}

/// Whether a face's property of that name holds its corners. Both names are in use.
pub(super) fn is_indices(name: &str) -> bool {
    name == "vertex_indices" || name == "vertex_index"
}

fn is_whole(t: ScalarType) -> bool {
    !matches!(t, ScalarType::F32 | ScalarType::F64)
}

fn size(t: ScalarType) -> u64 {
    match t {
        ScalarType::I8 | ScalarType::U8 => 1,
        ScalarType::I16 | ScalarType::U16 => 2,
        ScalarType::I32 | ScalarType::U32 | ScalarType::F32 => 4,
        ScalarType::F64 => 8,
    }
}

/// Bytes, or words of ASCII, of a row whose lists are empty.
fn row(format: PlyFormat, element: &ElementDef) -> u64 {
    let of = |p: &PlyProperty| match (format, &p.property_type) {
        (PlyFormat::Ascii, _) => 1,
        (_, PropertyType::Scalar(t)) => size(*t),
        (_, PropertyType::List { count_type, .. }) => size(*count_type),
    };
    element.properties.iter().map(of).sum()
}
