//! The rows of a PLY file, taken as serde-ply reads them.

use super::header::{Header, is_indices};
use crate::scene::compiled::Mesh;
use crate::scene::triangulate::triangulate;
use glam::DVec3;
use huygens_kernels::octahedral;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Most numbers that are read of a vertex.
const MOST: usize = 8;

/// What a reading of the file takes from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    Both,
    Vertices,
    Faces,
}

/// A PLY file on its way in.
pub(super) struct Reading {
    pub(super) pass: Pass,
    pub(super) vertices: Vec<[f32; 3]>,
    /// Codes, where the file has normals.
    pub(super) normals: Vec<u32>,
    /// Where the file has texture coordinates.
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Faces with fewer than three corners.
    pub(super) degenerate: usize,
    /// What is wrong, where it is not serde-ply that says so.
    pub(super) problem: Option<String>,
    /// Properties of a vertex, in the order in which they are read.
    fields: &'static [&'static str],
    /// The element and the row that are being read.
    element: String,
    row: usize,
    corners: Vec<u32>,
    cut: Vec<[u32; 3]>,
}

impl Reading {
    /// Makes room for what the header promises.
    pub(super) fn new(header: &Header) -> Self {
        Self {
            pass: Pass::Both,
            vertices: Vec::with_capacity(header.room("vertex")),
            normals: Vec::new(),
            uvs: Vec::new(),
            fields: header.fields(),
            triangles: Vec::with_capacity(header.room("face")),
            degenerate: 0,
            problem: None,
            element: String::new(),
            row: 0,
            corners: Vec::new(),
            cut: Vec::new(),
        }
    }

    /// Where the reading is.
    pub(super) fn place(&self) -> String {
        format!("{} {}", self.element, self.row)
    }

    fn fail<T, E: Error>(&mut self, what: &str) -> Result<T, E> {
        self.problem = Some(format!("{} {what}", self.place()));
        Err(E::custom(what))
    }

    /// `numbers` are those of `fields`.
    fn push_vertex<E: Error>(&mut self, numbers: [f64; MOST]) -> Result<(), E> {
        let position = [numbers[0], numbers[1], numbers[2]];
        for written in position {
            if !(written as f32).is_finite() {
                let what = format!("has coordinate {written:?}, expected a finite number");
                return self.fail(&what);
            }
        }
        if self.vertices.len() == u32::MAX as usize {
            return self.fail("is one too many, expected at most 4294967295");
        }
        self.vertices.push(position.map(|x| x as f32));
        let count = self.fields.len();
        if count >= 6 {
            let normal = [numbers[3], numbers[4], numbers[5]];
            self.normals.push(octahedral::encode(normal));
        }
        if count == 5 || count == 8 {
            let uv = [numbers[count - 2], numbers[count - 1]].map(|x| x as f32);
            let finite = uv.iter().all(|x| x.is_finite());
            self.uvs.push(if finite { uv } else { Mesh::NO_UV });
        }
        Ok(())
    }

    /// Cuts the face whose corners have been read.
    fn push_face(&mut self) {
        match self.corners[..] {
            [] | [_] | [_, _] => self.degenerate += 1,
            [a, b, c] => self.triangles.push([a, b, c]),
            _ => {
                let at = |&i: &u32| DVec3::from_array(self.vertices[i as usize].map(f64::from));
                let corners: Vec<DVec3> = self.corners.iter().map(at).collect();
                self.cut.clear();
                triangulate(&corners, &mut self.cut);
                let indices = &self.corners;
                let cut = self.cut.iter().map(|t| t.map(|i| indices[i as usize]));
                self.triangles.extend(cut);
            }
        }
    }
}

/// The file: a map from elements to their rows.
impl<'de> Visitor<'de> for &mut Reading {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("elements")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(Name(name)) = map.next_key_seed(Name::default())? {
            let what = match (name.as_str(), self.pass) {
                ("vertex", Pass::Both | Pass::Vertices) => What::Vertex,
                ("face", Pass::Both | Pass::Faces) => What::Face,
                _ => What::Other,
            };
            self.element = name;
            self.row = 0;
            map.next_value_seed(Rows(self, what))?;
        }
        Ok(())
    }
}

/// A name in the header.
#[derive(Default)]
struct Name(String);

impl<'de> DeserializeSeed<'de> for Name {
    type Value = Self;
    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Self, D::Error> {
        from.deserialize_any(self)
    }
}

impl Visitor<'_> for Name {
    type Value = Self;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name")
    }

    fn visit_bytes<E: Error>(self, name: &[u8]) -> Result<Self, E> {
        Ok(Self(String::from_utf8_lossy(name).into_owned()))
    }
}

#[derive(Clone, Copy)]
enum What {
    Vertex,
    Face,
    Other,
}

/// The rows of an element.
struct Rows<'a>(&'a mut Reading, What);

impl<'de> DeserializeSeed<'de> for Rows<'_> {
    type Value = ();
    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Rows<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("rows")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut rows: A) -> Result<(), A::Error> {
        while rows.next_element_seed(Row(self.0, self.1))?.is_some() {
            self.0.row += 1;
        }
        Ok(())
    }
}

/// One row.
struct Row<'a>(&'a mut Reading, What);

impl<'de> DeserializeSeed<'de> for Row<'_> {
    type Value = ();
    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        match self.1 {
            // As a struct of these fields it takes serde-ply's quick way, through `visit_seq`.
            What::Vertex => from.deserialize_struct("vertex", self.0.fields, self),
            _ => from.deserialize_map(self),
        }
    }
}

impl<'de> Visitor<'de> for Row<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a row")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut fields: A) -> Result<(), A::Error> {
        let mut numbers = [0.0; MOST];
        for x in &mut numbers[..self.0.fields.len()] {
            // The header says that there are so many.
            *x = fields.next_element()?.unwrap_or(f64::NAN);
        }
        self.0.push_vertex(numbers)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut row: A) -> Result<(), A::Error> {
        let Self(reading, what) = self;
        let mut numbers = [f64::NAN; MOST];
        reading.corners.clear();
        while let Some(field) = row.next_key_seed(FieldName(what, reading.fields))? {
            match field {
                Field::Number(place) => numbers[place] = row.next_value()?,
                Field::Indices => {
                    reading.corners.clear();
                    row.next_value_seed(Corners(reading))?;
                }
                Field::Other => {
                    row.next_value::<IgnoredAny>()?;
                }
            }
        }
        match what {
            What::Vertex => reading.push_vertex(numbers)?,
            What::Face => reading.push_face(),
            What::Other => {}
        }
        Ok(())
    }
}

/// What a property is to us.
enum Field {
    /// Of a vertex: its place among the fields.
    Number(usize),
    Indices,
    Other,
}

/// Told from its name without keeping that.
struct FieldName(What, &'static [&'static str]);

impl<'de> DeserializeSeed<'de> for FieldName {
    type Value = Field;
    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Field, D::Error> {
        from.deserialize_any(self)
    }
}

impl Visitor<'_> for FieldName {
    type Value = Field;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name")
    }

    fn visit_bytes<E: Error>(self, name: &[u8]) -> Result<Field, E> {
        Ok(match (self.0, name) {
            (What::Vertex, name) => {
                let place = self.1.iter().position(|field| field.as_bytes() == name);
                place.map_or(Field::Other, Field::Number)
            }
            (What::Face, name) if std::str::from_utf8(name).is_ok_and(is_indices) => Field::Indices,
            _ => Field::Other,
        })
    }
}

/// The corners of a face.
struct Corners<'a>(&'a mut Reading);

impl<'de> DeserializeSeed<'de> for Corners<'_> {
    type Value = ();
    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Corners<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("vertex indices")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut indices: A) -> Result<(), A::Error> {
        let count = self.0.vertices.len();
        while let Some(index) = indices.next_element::<i64>()? {
            match u32::try_from(index) {
                Ok(valid) if (valid as usize) < count => self.0.corners.push(valid),
                _ => {
                    return self.0.fail(&format!(
                        "has vertex index {index}, expected one of the {count} vertices, from 0"
                    ));
                }
            }
        }
        Ok(())
    }
}
