//! Where surfaces are there: the question that a traversal asks about each hit in scenes of which
//! some material has an opacity.
//!
//! * *Masks*: a surface is there where its opacity is at least the cutoff.
//! * *Partial opacity*: it is there with the probability of its opacity, drawn for each ray and
//!   triangle (E. Enderton et al., "Stochastic Transparency", I3D 2010): what a ray finds is then an
//!   unbiased estimate of what it would find through all layers. The draw is a hash of the ray's name
//!   (pixel, sample, and which ray of the path it is), the seed and the triangle's number: the same
//!   whatever the order of the traversal, and independent of all others of the path.
//!
//! Opacity is read from the whole image, whatever the distance.

use crate::interpolate::Attributes;
use crate::levels::Filter;
use crate::others::Home;
use crate::tables::Triangles;
use crate::texture::{NO_TEXTURE, Textures};

/// How much of a material is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opacity {
    /// Opacity, or what texels are multiplied with.
    pub factor: f32,
    /// Index of the texture use, or [`NO_TEXTURE`].
    pub texture: u32,
    /// What a mask's opacity is compared with; NaN for partial opacity.
    pub cutoff: f32,
}

impl Opacity {
    /// All of it.
    pub const WHOLE: Self = Self {
        factor: 1.0,
        texture: NO_TEXTURE,
        cutoff: 0.0,
    };
}

/// The opacities of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Opacities<'a> {
    /// By material.
    pub of: &'a [Opacity],
    /// What they read.
    pub textures: Textures<'a>,
    /// Where hits are.
    pub coordinates: Coordinates<'a>,
    /// The render's seed.
    pub seed: u32,
}

/// What is there for some rays; `name` gives that of each by its place: pixel, sample and a word that
/// no other ray of the sample's path has.
#[derive(Clone, Copy, Debug)]
pub struct There<'a, N> {
    /// The opacities.
    pub opacities: &'a Opacities<'a>,
    /// The rays' names.
    pub name: N,
}

impl<N: Fn(usize) -> [u32; 3]> Filter for There<'_, N> {
    const ASKS: bool = true;

    #[inline]
    fn accepts(&self, ray: usize, primitive: u32, u: f32, v: f32) -> bool {
        let all = self.opacities;
        let row = &all.of[all.coordinates.triangles.material_of(primitive) as usize];
        if *row == Opacity::WHOLE {
            return true;
        }
        let alpha = all.at(row, primitive, u, v);
        if row.cutoff.is_nan() {
            let name = (self.name)(ray);
            number(name, all.seed, all.layer(primitive, u)) < alpha
        } else {
            alpha >= row.cutoff
        }
    }
}

impl Opacities<'_> {
    /// What tells the surfaces that a ray may pass apart: of a triangle its number; of a sphere, which is
    /// passed twice, also where.
    fn layer(&self, primitive: u32, u: f32) -> u32 {
        let others = self.coordinates.triangles.others.as_ref();
        match others.filter(|others| others.is_sphere(primitive)) {
            Some(_) => primitive ^ scattered(u.to_bits()),
            None => primitive,
        }
    }

    /// The opacity at a point of a triangle that wears the material of `row`.
    fn at(&self, row: &Opacity, primitive: u32, u: f32, v: f32) -> f32 {
        if row.texture == NO_TEXTURE {
            return row.factor;
        }
        let uv = self.coordinates.at(primitive, u, v);
        row.factor * self.textures.number(row.texture, uv)
    }
}

/// Where single hits are in texture coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Coordinates<'a> {
    /// Triangles.
    pub triangles: Triangles<'a>,
    /// What their vertices carry.
    pub attributes: Attributes<'a>,
}

impl Coordinates<'_> {
    /// (u, v) of a hit as `interpolate` has it; 0 where a corner has none.
    #[must_use]
    pub fn at(&self, primitive: u32, u: f32, v: f32) -> [f32; 2] {
        let own = self.triangles.indices.get(primitive as usize);
        let (corners, uvs) = match (own, &self.triangles.others) {
            (Some(corners), _) => (corners, self.attributes.uvs),
            (None, Some(others)) => match others.home(primitive) {
                Home::Object(object, i) => (&object.indices[i], object.attributes.uvs),
                Home::Sphere(i) => return others.coordinates_on_sphere(i, u, v),
            },
            (None, None) => return [0.0; 2],
        };
        let [a, b, c] = corners.map(|v| uvs.get(v as usize).copied());
        let (Some(a), Some(b), Some(c)) = (a, b, c) else {
            return [0.0; 2];
        };
        let mixed = [0, 1].map(|i| {
            let (d1, d2) = (b[i] - a[i], c[i] - a[i]);
            d2.mul_add(v, d1.mul_add(u, a[i]))
        });
        // One without coordinates is NaN and makes all of it so.
        if mixed.iter().all(|x| x.is_finite()) {
            mixed
        } else {
            [0.0; 2]
        }
    }
}

/// A number in `[0, 1)` for a ray and a triangle.
fn number(name: [u32; 3], seed: u32, primitive: u32) -> f32 {
    let [pixel, sample, which] = name;
    let words = [pixel, sample, which, scattered(seed) ^ scattered(primitive)];
    // The upper 24 bits.
    (pcg4d(words) >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// `rng::scatter` of one word.
fn scattered(word: u32) -> u32 {
    let h = (word ^ (word >> 16)).wrapping_mul(0x85eb_ca6b);
    let h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// The first word of `rng::pcg4d`, in one lane.
fn pcg4d(v: [u32; 4]) -> u32 {
    let mut v = v.map(|e| e.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mix = |v: &mut [u32; 4]| {
        for [to, a, b] in [[0, 1, 3], [1, 2, 0], [2, 0, 1], [3, 1, 2]] {
            v[to] = v[to].wrapping_add(v[a].wrapping_mul(v[b]));
        }
    };
    mix(&mut v);
    v.iter_mut().for_each(|e| *e ^= *e >> 16);
    mix(&mut v);
    v[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Ux;
    use crate::rng;

    #[test]
    fn hashes_are_those_of_the_lanes() {
        for v in [[0; 4], [1, 2, 3, 4], [u32::MAX, 7, 1 << 31, 99]] {
            let lanes = rng::pcg4d(v.map(Ux::splat))[0].to_array();
            assert_eq!(pcg4d(v), lanes[0]);
            assert_eq!(scattered(v[2]), rng::scatter(Ux::splat(v[2])).to_array()[0]);
        }
    }

    /// Pairs of draws of one ray, or of one path, on two triangles are independent: the counts of the
    /// four outcomes at opacity 0.3 pass a chi-square test at 1e-6.
    #[test]
    fn draws_of_a_ray_are_independent() {
        type Pair = fn(u32) -> [f32; 2];
        let pairs: [(&str, Pair); 4] = [
            ("neighbours", |i| {
                [5, 6].map(|p| number([i % 97, i / 97, !0], 3, p))
            }),
            ("far apart", |i| {
                [5, 5 + (1 << 24)].map(|p| number([i % 97, i / 97, !0], 3, p))
            }),
            ("rays of a path", |i| {
                [!0, !1].map(|w| number([i % 97, i / 97, w], 3, 5))
            }),
            ("samples", |i| [0, 1].map(|s| number([i, s, !0], 3, 5))),
        ];
        for (what, pair) in pairs {
            let n = 100_000;
            let mut counts = [0.0f64; 4];
            for i in 0..n {
                let [a, b] = pair(i).map(|u| usize::from(u < 0.3));
                counts[2 * a + b] += 1.0;
            }
            let expected = [0.49, 0.21, 0.21, 0.09].map(|p| p * f64::from(n));
            let chi2: f64 = counts
                .iter()
                .zip(expected)
                .map(|(c, e)| (c - e).powi(2) / e)
                .sum();
            // The quantile of three degrees of freedom at 1 - 1e-6.
            assert!(chi2 < 30.66, "{what}: {counts:?}");
        }
    }
}
