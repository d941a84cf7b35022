//! The rays of a path tracer, by kind, as columns.

use crate::meshes::Random;
use huygens::scene::Mesh;
use huygens_kernels::lanes::padded;
use huygens_kernels::rays::{Hits, NO_PRIMITIVE, Rays, Segments};

/// Rays in columns.
#[derive(Default)]
pub(crate) struct RayBuffer {
    origin: [Vec<f32>; 3],
    direction: [Vec<f32>; 3],
    t_max: Vec<f32>,
    leaves: Vec<u32>,
    nobody: Vec<u32>,
}

impl RayBuffer {
    /// Number of rays.
    pub(crate) fn len(&self) -> usize {
        self.leaves.len()
    }

    fn push(&mut self, origin: [f32; 3], direction: [f32; 3], t_max: f32, leaves: u32) {
        for a in 0..3 {
            self.origin[a].push(origin[a]);
            self.direction[a].push(direction[a]);
        }
        self.t_max.push(t_max);
        self.leaves.push(leaves);
        self.nobody.push(NO_PRIMITIVE);
    }

    fn row(&self, i: usize) -> ([f32; 3], [f32; 3]) {
        let at = |c: &[Vec<f32>; 3]| std::array::from_fn(|a| c[a][i]);
        (at(&self.origin), at(&self.direction))
    }

    /// `n` rays from `i` on.
    pub(crate) fn rays(&self, i: usize, n: usize) -> Rays<'_> {
        Rays {
            len: n,
            origin: self.origin.each_ref().map(|c| &c[i..]),
            direction: self.direction.each_ref().map(|c| &c[i..]),
            leaves: &self.leaves[i..],
        }
    }

    /// `n` segments from `i` on.
    pub(crate) fn segments(&self, i: usize, n: usize) -> Segments<'_> {
        Segments {
            len: n,
            origin: self.origin.each_ref().map(|c| &c[i..]),
            direction: self.direction.each_ref().map(|c| &c[i..]),
            t_max: &self.t_max[i..],
            leaves: &self.leaves[i..],
            reaches: &self.nobody[i..],
        }
    }
}

/// Where answers go.
pub(crate) struct Answers {
    primitive: Vec<u32>,
    t: Vec<f32>,
    u: Vec<f32>,
    v: Vec<f32>,
}

impl Answers {
    /// Room for `n`.
    pub(crate) fn new(n: usize) -> Self {
        let column = || vec![0.0; padded(n)];
        Self {
            primitive: vec![0; padded(n)],
            t: column(),
            u: column(),
            v: column(),
        }
    }

    /// Columns for `n` hits from `i` on.
    pub(crate) fn hits(&mut self, i: usize, n: usize) -> Hits<'_> {
        let end = i + n;
        Hits {
            primitive: &mut self.primitive[i..end],
            t: &mut self.t[i..end],
            u: &mut self.u[i..end],
            v: &mut self.v[i..end],
        }
    }

    /// A column for `n` answers from `i` on.
    pub(crate) fn occluded(&mut self, i: usize, n: usize) -> &mut [u32] {
        &mut self.primitive[i..i + n]
    }
}

fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i]);
    [x, y, z]
}

fn normalize(a: [f32; 3]) -> [f32; 3] {
    let length = a.iter().map(|e| e * e).sum::<f32>().sqrt();
    a.map(|e| e / length)
}

/// Lowest and highest corner.
fn bounds(mesh: &Mesh) -> [[f32; 3]; 2] {
    let fold = |pick: fn(f32, f32) -> f32, from: f32| {
        mesh.vertices
            .iter()
            .fold([from; 3], |m, p| std::array::from_fn(|a| pick(m[a], p[a])))
    };
    [fold(f32::min, f32::MAX), fold(f32::max, f32::MIN)]
}

/// `side * side` jittered camera rays in tiles of 4 by 4 pixels, from inside the mesh's box, at a
/// tenth of its length from one end, along it.
pub(crate) fn camera(mesh: &Mesh, side: usize) -> RayBuffer {
    let [low, high] = bounds(mesh);
    let long = (0..3).fold(0, |l, a| {
        if high[a] - low[a] > high[l] - low[l] {
            a
        } else {
            l
        }
    });
    let mut eye: [f32; 3] = std::array::from_fn(|a| 0.42 * low[a] + 0.58 * high[a]);
    eye[long] = 0.93 * low[long] + 0.07 * high[long];
    let target: [f32; 3] = std::array::from_fn(|a| 0.55 * low[a] + 0.45 * high[a]);
    let forward = normalize(sub(target, eye));
    let right = normalize(cross(forward, [0.03, 1.0, 0.02]));
    let up = cross(right, forward);
    let mut rays = RayBuffer::default();
    let mut random = Random(7);
    for i in 0..side * side {
        let (tile, within) = (i / 16, i % 16);
        let (x, y) = (
            tile % (side / 4) * 4 + within % 4,
            tile / (side / 4) * 4 + within / 4,
        );
        let mut at = |p: usize| 1.4 * ((p as f32 + random.unit()) / side as f32 - 0.5);
        let (sx, sy) = (at(x), at(y));
        let d = std::array::from_fn(|a| forward[a] + sx * right[a] - sy * up[a]);
        rays.push(eye, normalize(d), f32::INFINITY, NO_PRIMITIVE);
    }
    rays
}

/// The point hit, and the normal on the side that the ray came from.
fn surface(mesh: &Mesh, rays: &RayBuffer, hits: &Answers, i: usize) -> ([f32; 3], [f32; 3]) {
    let (_, d) = rays.row(i);
    let [a, b, c] = mesh.corners(hits.primitive[i] as usize);
    let n = normalize(cross(sub(b, a), sub(c, a)));
    let facing = (0..3).map(|k| n[k] * d[k]).sum::<f32>() <= 0.0;
    let (u, v) = (hits.u[i], hits.v[i]);
    let p = std::array::from_fn(|k| (1.0 - u - v) * a[k] + u * b[k] + v * c[k]);
    (p, if facing { n } else { n.map(|e| -e) })
}

/// A cosine-distributed ray from each hit.
pub(crate) fn diffuse(mesh: &Mesh, rays: &RayBuffer, hits: &Answers, seed: u64) -> RayBuffer {
    let mut random = Random(0x1234_5678 + seed);
    let mut out = RayBuffer::default();
    for i in 0..rays.len() {
        if hits.primitive[i] == NO_PRIMITIVE {
            continue;
        }
        let (p, n) = surface(mesh, rays, hits, i);
        let (z, turn) = (
            2.0 * random.unit() - 1.0,
            std::f32::consts::TAU * random.unit(),
        );
        let r = (1.0 - z * z).sqrt();
        // A point of the sphere that touches the surface: Lambert's cosine law.
        let ball = [r * turn.cos(), r * turn.sin(), z];
        let d = std::array::from_fn(|k| n[k] + 0.9999 * ball[k]);
        out.push(p, normalize(d), f32::INFINITY, hits.primitive[i]);
    }
    out
}

/// A ray from each hit to a point on a square light below the top of the mesh's box.
pub(crate) fn shadow(mesh: &Mesh, rays: &RayBuffer, hits: &Answers, seed: u64) -> RayBuffer {
    let [low, high] = bounds(mesh);
    let mut random = Random(0x9876_5432 + seed);
    let mut out = RayBuffer::default();
    for i in 0..rays.len() {
        if hits.primitive[i] == NO_PRIMITIVE {
            continue;
        }
        let (p, n) = surface(mesh, rays, hits, i);
        let mut light: [f32; 3] =
            std::array::from_fn(|a| low[a] + (high[a] - low[a]) * (0.35 + 0.3 * random.unit()));
        light[1] = high[1] - 0.02 * (high[1] - low[1]);
        let d = sub(light, p);
        if (0..3).map(|k| n[k] * d[k]).sum::<f32>() > 0.0 {
            out.push(p, d, 0.9999, hits.primitive[i]);
        }
    }
    out
}
