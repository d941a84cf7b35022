//! Placing a shape: a 4x4 matrix, or a list of steps applied in the order written.

use super::degrees;
use super::values::{Finite, OneOrThree};
use glam::{DAffine3, DMat3, DVec3};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor, value};
use std::fmt;

/// A transformation as the file says it.
#[derive(Clone, Debug)]
pub(super) enum Transform {
    /// Rows of a matrix that multiplies column vectors.
    Matrix([[Finite; 4]; 4]),
    /// One after another.
    Steps(Vec<Step>),
}

/// One step: exactly one of the three.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Step {
    scale: Option<OneOrThree<Finite>>,
    rotate: Option<Rotation>,
    translate: Option<[Finite; 3]>,
}

/// A right-handed rotation about an axis through the origin.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rotation {
    axis: [Finite; 3],
    degrees: Finite,
}

pub(super) fn vector(v: [Finite; 3]) -> DVec3 {
    DVec3::from_array(v.map(|x| x.0))
}

/// The affine map of a 4x4 matrix whose last row says that it is one.
pub(super) fn affine(rows: &[[Finite; 4]; 4]) -> Result<DAffine3, String> {
    let last = rows[3].map(|x| x.0);
    if last != [0.0, 0.0, 0.0, 1.0] {
        return Err(format!(
            "the last row is {last:?}, expected [0, 0, 0, 1]: a matrix multiplies column vectors"
        ));
    }
    let column = |i: usize| DVec3::new(rows[0][i].0, rows[1][i].0, rows[2][i].0);
    let linear = DMat3::from_cols(column(0), column(1), column(2));
    Ok(DAffine3::from_mat3_translation(linear, column(3)))
}

/// Whether rounding alone could account for the whole determinant.
///
/// By Hadamard, |det| is at most the product of the columns' lengths, and so is each of its six
/// terms; each carries at most 4 roundings, the sum 5 more.
pub(super) fn is_singular(m: &DMat3) -> bool {
    let largest = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let det = m.determinant();
    !det.is_finite() || det.abs() <= 6.0 * 9.0 * f64::EPSILON * largest
}

impl Transform {
    /// The map from the shape's space to the world's.
    pub(super) fn compile(&self) -> Result<DAffine3, String> {
        let map = match self {
            Self::Matrix(rows) => affine(rows)?,
            Self::Steps(steps) => {
                let mut map = DAffine3::IDENTITY;
                for step in steps {
                    map = step.compile()? * map;
                }
                map
            }
        };
        if is_singular(&map.matrix3) {
            return Err("the matrix is singular: it flattens the shape".to_owned());
        }
        Ok(map)
    }
}

impl Step {
    fn compile(&self) -> Result<DAffine3, String> {
        match (&self.scale, &self.rotate, &self.translate) {
            (Some(scale), None, None) => Ok(DAffine3::from_scale(vector(scale.0))),
            (None, Some(rotate), None) => rotate.compile(),
            (None, None, Some(by)) => Ok(DAffine3::from_translation(vector(*by))),
            _ => Err("a step takes exactly one of `scale`, `rotate` or `translate`".to_owned()),
        }
    }
}

impl Rotation {
    /// Rodrigues' formula, column by column.
    fn compile(self) -> Result<DAffine3, String> {
        let axis = vector(self.axis);
        // Scaled first, so that the square of a tiny or huge axis neither vanishes nor overflows.
        let Some(k) = (axis / axis.abs().max_element()).try_normalize() else {
            return Err("the axis of a rotation has no direction".to_owned());
        };
        let (sin, cos) = degrees::sin_cos(self.degrees.0);
        let turn = |v: DVec3| v * cos + k.cross(v) * sin + k * (k.dot(v) * (1.0 - cos));
        let linear = DMat3::from_cols(turn(DVec3::X), turn(DVec3::Y), turn(DVec3::Z));
        Ok(DAffine3::from_mat3(linear))
    }
}

/// An element of the list: a row or a step.
enum Item {
    Row([Finite; 4]),
    Step(Step),
}

impl<'de> Deserialize<'de> for Item {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Read;
        impl<'de> Visitor<'de> for Read {
            type Value = Item;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a row of four numbers or a step such as { translate = [1, 2, 3] }")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Item, A::Error> {
                let row = value::SeqAccessDeserializer::new(seq);
                Ok(Item::Row(<[Finite; 4]>::deserialize(row)?))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Item, A::Error> {
                let step = value::MapAccessDeserializer::new(map);
                Ok(Item::Step(Step::deserialize(step)?))
            }
        }
        from.deserialize_any(Read)
    }
}

impl<'de> Deserialize<'de> for Transform {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let items = Vec::<Item>::deserialize(from)?;
        let mut rows = Vec::new();
        let mut steps = Vec::new();
        for item in items {
            match item {
                Item::Row(row) => rows.push(row),
                Item::Step(step) => steps.push(step),
            }
        }
        if rows.is_empty() {
            return Ok(Self::Steps(steps));
        }
        let rows = <[[Finite; 4]; 4]>::try_from(rows).ok();
        match (rows, steps.is_empty()) {
            (Some(rows), true) => Ok(Self::Matrix(rows)),
            _ => Err(D::Error::custom("expected four rows, or a list of steps")),
        }
    }
}
