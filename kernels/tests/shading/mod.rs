//! Vectors in f64 and triangles with attributes.
#![allow(dead_code)] // each test binary uses its own part

use crate::common::Source;
use huygens_kernels::interpolate::{Attributes, Interpolated};
use huygens_kernels::lanes::{Fx, Ux};
use huygens_kernels::octahedral;
use huygens_kernels::tables::Triangles;
use huygens_kernels::vec3::Vec3x;

/// Half a unit in the last place of 1: one rounding.
pub(crate) const ROUNDING: f64 = 1.0 / 16_777_216.0;

pub(crate) type V = [f64; 3];

pub(crate) fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: V, b: V) -> V {
    std::array::from_fn(|c| a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3])
}

/// `a + s b`.
pub(crate) fn plus(a: V, s: f64, b: V) -> V {
    std::array::from_fn(|c| a[c] + s * b[c])
}

pub(crate) fn unit(a: V) -> V {
    a.map(|c| c / dot(a, a).sqrt())
}

pub(crate) fn wide(v: [f32; 3]) -> V {
    v.map(f64::from)
}

/// A unit vector in every lane, and that vector.
pub(crate) fn splat(v: V) -> (Vec3x, V) {
    let v = unit(v).map(|c| c as f32);
    (Vec3x::splat(v), wide(v))
}

pub(crate) fn direction(source: &mut Source) -> V {
    wide(source.direction())
}

/// One triangle with attributes at its corners.
pub(crate) struct Patch {
    pub(crate) vertices: [[f32; 3]; 3],
    pub(crate) normals: Vec<u32>,
    pub(crate) uvs: Vec<[f32; 2]>,
}

impl Patch {
    pub(crate) fn random(source: &mut Source, scale: f32) -> Self {
        let vertices = std::array::from_fn(|_| source.direction().map(|c| c * scale));
        Self {
            vertices,
            normals: (0..3)
                .map(|_| octahedral::encode(direction(source)))
                .collect(),
            uvs: (0..3).map(|_| [source.unit(), source.unit()]).collect(),
        }
    }

    pub(crate) fn at(&self, u: f32, v: f32) -> Interpolated {
        let triangles = Triangles {
            vertices: &self.vertices,
            indices: &[[0, 1, 2]],
            material: &[0],
            others: None,
        };
        let attributes = Attributes {
            normals: &self.normals,
            uvs: &self.uvs,
        };
        Interpolated::at(
            &triangles,
            &attributes,
            Ux::splat(0),
            Fx::splat(u),
            Fx::splat(v),
        )
    }

    pub(crate) fn edges(&self) -> [V; 2] {
        let [a, b, c] = self.vertices.map(wide);
        [plus(b, -1.0, a), plus(c, -1.0, a)]
    }

    pub(crate) fn flat(&self) -> V {
        let [e1, e2] = self.edges();
        unit(cross(e1, e2))
    }
}
