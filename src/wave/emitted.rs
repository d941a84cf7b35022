//! How much each triangle emits where images vary emission: what lights are chosen by.
//!
//! The luminance of a triangle is the mean over 64 points of it, evenly spread, of which each reads the
//! image over its share of the triangle; opacity is left out. To that comes 2^-10 of the greatest
//! value that the image may take: whatever those points miss, no triangle that shines anywhere goes
//! without a chance.

use super::tables::luminance;
use crate::scene::{Material, Scene, Texture};
use huygens_kernels::lanes::{Fx, LANES, Ux};
use huygens_kernels::texture::{TextureUse, Textures};
use rayon::prelude::*;

/// Points to a side of the square that is mapped onto a triangle.
const SIDE: usize = 8;
/// What the greatest value of an image counts beside the mean.
const LEAST: f64 = 1.0 / 1024.0;

/// The luminance of the radiance that each triangle emits, in the mean; empty where that of its
/// material holds.
pub(super) fn by_triangle(scene: &Scene) -> Vec<f64> {
    let emission = scene
        .materials
        .iter()
        .map(|m| m.emission.texture.filter(|_| m.emits()));
    let emission: Vec<Option<TextureUse>> = emission.collect();
    let varies = |&m: &u32| emission[m as usize].is_some();
    if !scene.mesh.material.iter().any(varies) {
        return Vec::new();
    }
    let textures: Vec<_> = scene.textures.iter().map(Texture::view).collect();
    let triangle = |i: usize| {
        let m = scene.mesh.material[i] as usize;
        let factor = scene.materials[m].emission.factor;
        let Some(read) = emission[m] else {
            return luminance(factor);
        };
        let greatest = f64::from(scene.textures[read.texture as usize].range[1].max(0.0));
        let all = Textures {
            textures: &textures,
            uses: &[read],
        };
        let mean = mean(&all, coordinates(scene, i));
        let product = |c: usize| f64::from(factor[c]) * mean[c];
        let seen = 0.2126 * product(0) + 0.7152 * product(1) + 0.0722 * product(2);
        seen + LEAST * greatest * luminance(factor)
    };
    (0..scene.mesh.triangles())
        .into_par_iter()
        .map(triangle)
        .collect()
}

/// What the luminance of a sphere is of that of the material that it wears, in the mean over the image as it
/// lies on the map; see the head of this file for what is added.
pub(super) fn share_of_sphere(scene: &Scene, m: &Material) -> f64 {
    let Some(read) = m.emission.texture.filter(|_| m.emits()) else {
        return 1.0;
    };
    let range = scene.textures[read.texture as usize].range;
    let whole = luminance(m.emission.factor);
    let seen = luminance(m.emission.mean(&scene.textures)) / whole;
    seen + LEAST * f64::from(range[1].max(0.0))
}

/// (u, v) of a triangle's corners; 0 where one has none.
fn coordinates(scene: &Scene, i: usize) -> [[f32; 2]; 3] {
    let uv = |v: u32| scene.mesh.uvs.get(v as usize).copied();
    let [a, b, c] = scene.mesh.indices[i].map(uv);
    match (a, b, c) {
        (Some(a), Some(b), Some(c)) if [a, b, c].as_flattened().iter().all(|x| x.is_finite()) => {
            [a, b, c]
        }
        _ => [[0.0; 2]; 3],
    }
}

/// The mean of texture use 0 over the triangle with these corners.
fn mean(textures: &Textures, [a, b, c]: [[f32; 2]; 3]) -> [f64; 3] {
    let edge = |p: [f32; 2]| [p[0] - a[0], p[1] - a[1]];
    let (e1, e2) = (edge(b), edge(c));
    let area = 0.5 * (e1[0] * e2[1] - e1[1] * e2[0]).abs();
    let width = Fx::splat((area / (SIDE * SIDE) as f32).sqrt());
    let mut sum = [0.0; 3];
    for row in 0..SIDE {
        let middle = |k: usize| (k as f32 + 0.5) / SIDE as f32;
        let root = middle(row).sqrt();
        const { assert!(SIDE == LANES) };
        let u = Fx::splat(1.0 - root);
        let v = Fx::new(std::array::from_fn(|lane| middle(lane) * root));
        let uv = [0, 1].map(|i| {
            let along = Fx::splat(e1[i]).mul_add(u, Fx::splat(a[i]));
            Fx::splat(e2[i]).mul_add(v, along)
        });
        let value = textures.sample(Ux::splat(0), uv, width);
        for (sum, value) in sum.iter_mut().zip([value.x, value.y, value.z]) {
            let each = value.to_array().map(f64::from);
            *sum += each.iter().sum::<f64>() / (SIDE * SIDE) as f64;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use huygens_kernels::texture::{Channel, MipLevel, TexelFilter, TexelFormat, Wrap};

    /// An image that is black on its left and 3 on its right.
    fn half(uvs: [[f32; 2]; 3]) -> f64 {
        let words: Vec<u32> = [0.0f32, 3.0, 1.5].map(f32::to_bits).to_vec();
        let levels = [([2, 1], 0), ([1, 1], 2)].map(|(size, first)| MipLevel { size, first });
        let texture = huygens_kernels::texture::Texture {
            words: &words,
            format: TexelFormat::Grey32,
            srgb: false,
            levels: &levels,
        };
        let read = TextureUse {
            texture: 0,
            channel: Channel::Red,
            uv: TextureUse::IDENTITY,
            wrap: [Wrap::Clamp; 2],
            filter: TexelFilter::Nearest,
        };
        let textures = Textures {
            textures: &[texture],
            uses: &[read],
        };
        mean(&textures, uvs)[0]
    }

    #[test]
    fn means_are_those_of_what_triangles_cover() {
        assert_eq!(half([[0.0, 0.0], [0.4, 0.0], [0.0, 1.0]]), 0.0);
        assert_eq!(half([[0.6, 0.0], [1.0, 0.0], [0.6, 1.0]]), 3.0);
        // Of half the square three quarters lie left of the middle.
        let whole = half([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        // 64 points, each of which may lie on the wrong side of a line through 8 of them.
        assert!((whole - 0.75).abs() <= 3.0 * 8.0 / 64.0, "{whole}");
    }
}
