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
pub(super) struct Rotation {
    axis: [Finite; 3],
    degrees: Finite,
}

impl Rotation {
    /// Its axis, a unit vector, and its angle in degrees.
    pub(super) fn axis(&self) -> Result<(DVec3, f64), String> {
        let axis = direction(vector(self.axis)).ok_or("the axis is zero, expected a direction")?;
        Ok((axis, self.degrees.0))
    }
}

pub(super) fn vector(v: [Finite; 3]) -> DVec3 {
    DVec3::from_array(v.map(|x| x.0))
}

/// The unit vector along `v`, if it has a direction.
pub(super) fn direction(v: DVec3) -> Option<DVec3> {
    // Scaled first, so that the squares of tiny or huge components neither vanish nor overflow.
    (v / v.abs().max_element()).try_normalize()
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
            return Err("the transformation is singular: it flattens the shape".to_owned());
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
        let Some(k) = direction(vector(self.axis)) else {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a transformation, written as in a scene file, takes (1, 2, 3).
    fn placed(text: &str) -> [f64; 3] {
        #[derive(Deserialize)]
        struct Table {
            t: Transform,
        }
        let table: Table = toml::from_str(&format!("t = {text}")).unwrap();
        let map = table.t.compile().unwrap();
        map.transform_point3(DVec3::new(1.0, 2.0, 3.0)).to_array()
    }

    #[test]
    fn steps_apply_in_the_order_written() {
        assert_eq!(placed("[]"), [1.0, 2.0, 3.0]);
        let (scale, shift) = ("{ scale = [2, 3, 4] }", "{ translate = [10, 20, 30] }");
        assert_eq!(placed(&format!("[{scale}, {shift}]")), [12.0, 26.0, 42.0]);
        assert_eq!(placed(&format!("[{shift}, {scale}]")), [22.0, 66.0, 132.0]);
    }

    #[test]
    fn rotation_is_right_handed_and_exact_at_quarter_turns() {
        let turn = |axis: &str| {
            placed(&format!(
                "[{{ rotate = {{ axis = {axis}, degrees = 90 }} }}]"
            ))
        };
        assert_eq!(turn("[1, 0, 0]"), [1.0, -3.0, 2.0]);
        assert_eq!(turn("[0, 7, 0]"), [3.0, 2.0, -1.0]);
        assert_eq!(turn("[0, 0, 1e-200]"), [-2.0, 1.0, 3.0]);
    }

    #[test]
    fn matrices_are_rows_that_multiply_column_vectors() {
        let text = "[[1, 0, 0, 5], [0, 0, -1, 6], [0, 1, 0, 7], [0, 0, 0, 1]]";
        assert_eq!(placed(text), [6.0, 3.0, 9.0]);
    }

    #[test]
    fn small_is_not_singular() {
        assert_eq!(
            placed("[{ scale = 1e-30 }, { scale = 1e30 }]").map(f64::round),
            [1.0, 2.0, 3.0]
        );
    }
}
