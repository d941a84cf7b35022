//! What the tests of ray casting share: meshes, ray sets, and a small generator of numbers.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test binary includes this module and uses its own part"
)]

pub mod meshes;
pub mod oracle;
pub mod worlds;

use huygens::geometry::Geometry;
use huygens::scene::Mesh;
use huygens_kernels::lanes::padded;
use huygens_kernels::rays::{Hits, NO_PRIMITIVE, Rays, Segments};

/// SplitMix64 (G. Steele et al., 2014).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 32) as u32
    }

    /// In `[0, 1)`.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }

    /// In `[-1, 1)`.
    pub fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }

    pub fn point(&mut self) -> [f32; 3] {
        std::array::from_fn(|_| self.signed())
    }

    pub fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.bits()) * n as u64) >> 32) as usize
    }
}

pub fn mesh(vertices: Vec<[f32; 3]>, indices: Vec<[u32; 3]>) -> Mesh {
    let material = vec![0; indices.len()];
    Mesh {
        vertices,
        indices,
        material,
        ..Mesh::default()
    }
}

/// Triangles that share no vertices.
pub fn soup(triangles: &[[[f32; 3]; 3]]) -> Mesh {
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    mesh(triangles.concat(), indices.collect())
}

/// `n` triangles of very different sizes in the unit cube.
pub fn random_soup(n: usize, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let triangles: Vec<_> = (0..n)
        .map(|_| {
            let (at, size) = (random.point(), 0.7 * random.unit().powi(4));
            [(); 3].map(|()| {
                let p = random.point();
                std::array::from_fn(|a| at[a] + size * p[a])
            })
        })
        .collect();
    soup(&triangles)
}

/// A closed cube from -1 to 1, twelve triangles.
pub fn cube() -> Mesh {
    let vertices = (0..8).map(|i| [0, 1, 2].map(|a| if i >> a & 1 == 0 { -1.0 } else { 1.0 }));
    let quads = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let indices = quads
        .iter()
        .flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
    mesh(vertices.collect(), indices.collect())
}

/// A closed sphere, an icosahedron cut `level` times, whose vertices are moved in and out by up to
/// `bump` of the radius.
pub fn bumpy_sphere(level: u32, bump: f32) -> Mesh {
    let g = 0.5 * (1.0 + 5f32.sqrt());
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        vertices.push([a, b, 0.0]);
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        vertices.push([0.0, a, b]);
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        vertices.push([b, 0.0, a]);
    }
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..level {
        let mut middle = std::collections::HashMap::new();
        let mut split = |a: u32, b: u32, vertices: &mut Vec<[f32; 3]>| {
            *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q) = (vertices[a as usize], vertices[b as usize]);
                vertices.push(std::array::from_fn(|k| p[k] + q[k]));
                vertices.len() as u32 - 1
            })
        };
        let mut finer = Vec::with_capacity(4 * faces.len());
        for [a, b, c] in faces {
            let ab = split(a, b, &mut vertices);
            let bc = split(b, c, &mut vertices);
            let ca = split(c, a, &mut vertices);
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        for p in &mut vertices {
            let length = p.iter().map(|e| e * e).sum::<f32>().sqrt();
            *p = p.map(|e| e / length);
        }
        faces = finer;
    }
    let mut random = Random(99);
    for p in &mut vertices {
        let radius = 1.0 + bump * random.signed();
        *p = p.map(|e| e * radius);
    }
    mesh(vertices, faces)
}

/// Moves every vertex to `scale * p + offset`, in f32.
pub fn moved(mut mesh: Mesh, scale: f32, offset: [f32; 3]) -> Mesh {
    for p in &mut mesh.vertices {
        *p = std::array::from_fn(|a| scale * p[a] + offset[a]);
    }
    mesh
}

/// A closest hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub primitive: u32,
    pub t: f32,
    pub u: f32,
    pub v: f32,
}

/// Rays as rows; the kernels want columns.
#[derive(Clone, Debug, Default)]
pub struct RaySet {
    pub origin: Vec<[f32; 3]>,
    pub direction: Vec<[f32; 3]>,
    pub t_max: Vec<f32>,
    pub leaves: Vec<u32>,
    pub reaches: Vec<u32>,
}

impl RaySet {
    pub fn push(&mut self, origin: [f32; 3], direction: [f32; 3]) {
        self.origin.push(origin);
        self.direction.push(direction);
        self.t_max.push(f32::INFINITY);
        self.leaves.push(NO_PRIMITIVE);
        self.reaches.push(NO_PRIMITIVE);
    }

    pub fn len(&self) -> usize {
        self.origin.len()
    }

    fn column(&self, rows: &[[f32; 3]], axis: usize) -> Vec<f32> {
        // What lies in the padding must not matter: NaN would spread if it did.
        let mut column: Vec<f32> = rows.iter().map(|r| r[axis]).collect();
        column.resize(padded(rows.len()), f32::NAN);
        column
    }

    fn padded<T: Copy>(values: &[T], fill: T) -> Vec<T> {
        let mut values = values.to_vec();
        values.resize(padded(values.len()), fill);
        values
    }

    pub fn closest(&self, geometry: &Geometry) -> Vec<Hit> {
        let mut all = Vec::new();
        self.each(|rays, hits| geometry.closest(rays, hits), &mut all);
        all
    }

    /// Closest hits by a kernel.
    pub fn each(&self, kernel: impl FnOnce(Rays, Hits), out: &mut Vec<Hit>) {
        let n = padded(self.len());
        let origin: [Vec<f32>; 3] = std::array::from_fn(|a| self.column(&self.origin, a));
        let direction: [Vec<f32>; 3] = std::array::from_fn(|a| self.column(&self.direction, a));
        let leaves = Self::padded(&self.leaves, 0);
        let (mut primitive, mut t) = (vec![0xdead_beef; n], vec![-7.0; n]);
        let (mut u, mut v) = (vec![-7.0; n], vec![-7.0; n]);
        kernel(
            Rays {
                len: self.len(),
                origin: origin.each_ref().map(Vec::as_slice),
                direction: direction.each_ref().map(Vec::as_slice),
                leaves: &leaves,
            },
            Hits {
                primitive: &mut primitive,
                t: &mut t,
                u: &mut u,
                v: &mut v,
            },
        );
        out.extend((0..self.len()).map(|i| Hit {
            primitive: primitive[i],
            t: t[i],
            u: u[i],
            v: v[i],
        }));
    }

    pub fn occluded(&self, geometry: &Geometry) -> Vec<bool> {
        let mut all = Vec::new();
        self.each_segment(|segments, out| geometry.occluded(segments, out), &mut all);
        all
    }

    /// Occlusion by a kernel.
    pub fn each_segment(&self, kernel: impl FnOnce(Segments, &mut [u32]), all: &mut Vec<bool>) {
        let origin: [Vec<f32>; 3] = std::array::from_fn(|a| self.column(&self.origin, a));
        let direction: [Vec<f32>; 3] = std::array::from_fn(|a| self.column(&self.direction, a));
        let leaves = Self::padded(&self.leaves, 0);
        let reaches = Self::padded(&self.reaches, 0);
        let t_max = Self::padded(&self.t_max, f32::NAN);
        let mut out = vec![7; padded(self.len())];
        kernel(
            Segments {
                len: self.len(),
                origin: origin.each_ref().map(Vec::as_slice),
                direction: direction.each_ref().map(Vec::as_slice),
                t_max: &t_max,
                leaves: &leaves,
                reaches: &reaches,
            },
            &mut out,
        );
        out.truncate(self.len());
        assert!(out.iter().all(|&o| o <= 1), "occlusion is 0 or 1");
        all.extend(out.into_iter().map(|o| o == 1));
    }
}
