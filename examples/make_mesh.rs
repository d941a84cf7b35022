//! Writes large procedural meshes as binary PLY, for measurements, without ever holding the mesh:
//!
//! ```text
//! cargo run --release --example make_mesh -- icosphere --triangles 10000000 -o big.ply
//! ```
//!
//! `icosphere` is an icosahedron whose faces are cut into `n^2` triangles each, pushed out to the
//! unit sphere and displaced along the normal by eight octaves of waves: rough, closed, without seams
//! (vertices on edges of the icosahedron are shared), facing outwards. `n` is the smallest that
//! gives as many triangles as asked for, `20 n^2`; the mesh has `10 n^2 + 2` vertices. The same
//! number gives the same file, byte for byte, for one platform's `sin`.
//!
//! With `--obj` it is written as text, to measure that too.

use std::fs::File;
use std::io::{BufWriter, Write};

const USAGE: &str = "usage: make_mesh icosphere --triangles N -o FILE.ply [--obj]";

fn main() -> std::io::Result<()> {
    let (mut wanted, mut path, mut obj, mut kind) = (None, None, false, None);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--triangles" => wanted = args.next().and_then(|n| n.parse::<u64>().ok()),
            "-o" => path = args.next(),
            "--obj" => obj = true,
            "icosphere" => kind = Some(arg),
            _ => kind = None,
        }
    }
    let (Some(wanted @ 1..=4_000_000_000), Some(path), Some(_)) = (wanted, path, kind) else {
        eprintln!("{USAGE}");
        std::process::exit(2);
    };
    let n = (wanted as f64 / 20.0).sqrt().ceil() as u64;
    let mut out = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let sphere = Icosphere { n };
    if obj {
        sphere.vertices(|[x, y, z]| writeln!(out, "v {x} {y} {z}"))?;
        sphere.triangles(|t| {
            let [a, b, c] = t.map(|i| i + 1);
            writeln!(out, "f {a} {b} {c}")
        })?;
    } else {
        let (vertices, faces) = (10 * n * n + 2, 20 * n * n);
        write!(
            out,
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\n\
             property float y\nproperty float z\nelement face {faces}\n\
             property list uchar uint vertex_indices\nend_header\n"
        )?;
        sphere.vertices(|v| v.iter().try_for_each(|x| out.write_all(&x.to_le_bytes())))?;
        sphere.triangles(|t| {
            out.write_all(&[3])?;
            t.iter().try_for_each(|i| out.write_all(&i.to_le_bytes()))
        })?;
    }
    out.flush()
}

/// Corners: two poles, and two rings of five.
const CORNERS: usize = 12;

/// Faces of the icosahedron, counter-clockwise from outside.
fn faces() -> [[usize; 3]; 20] {
    std::array::from_fn(|f| {
        let (i, upper, lower) = (f % 5, |i: usize| 1 + i % 5, |i: usize| 6 + i % 5);
        match f / 5 {
            0 => [0, upper(i), upper(i + 1)],
            1 => [upper(i), lower(i), upper(i + 1)],
            2 => [upper(i + 1), lower(i), lower(i + 1)],
            _ => [11, lower(i + 1), lower(i)],
        }
    })
}

/// Edges of the icosahedron, each with its lower corner first.
fn edges() -> Vec<[usize; 2]> {
    let mut edges: Vec<[usize; 2]> = faces()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

pub(crate) struct Icosphere {
    /// Triangles along an edge of the icosahedron.
    pub(crate) n: u64,
}

impl Icosphere {
    /// All vertices: the corners, then those inside edges, then those inside faces.
    pub(crate) fn vertices(
        &self,
        mut put: impl FnMut([f32; 3]) -> std::io::Result<()>,
    ) -> std::io::Result<()> {
        let n = self.n;
        let corner = corners();
        // A point is always the sum of the same products in the same order, whatever it is part of.
        let mut point = |weights: &[(usize, u64)]| {
            let mut p = [0.0; 3];
            for &(c, w) in weights {
                (0..3).for_each(|axis| p[axis] += corner[c][axis] * w as f64);
            }
            put(displaced(p))
        };
        (0..CORNERS).try_for_each(|c| point(&[(c, n)]))?;
        for [a, b] in edges() {
            (1..n).try_for_each(|i| point(&[(a, n - i), (b, i)]))?;
        }
        for [a, b, c] in faces() {
            for row in 1..n {
                (1..row).try_for_each(|i| point(&[(a, n - row), (b, row - i), (c, i)]))?;
            }
        }
        Ok(())
    }

    /// All triangles, face by face and row by row.
    pub(crate) fn triangles(
        &self,
        mut put: impl FnMut([u32; 3]) -> std::io::Result<()>,
    ) -> std::io::Result<()> {
        let edges = edges();
        for face in 0..20 {
            // Row r of a face has r + 1 vertices; row 0 is its first corner.
            let at = |row: u64, i: u64| self.index(&edges, face, row, i) as u32;
            for row in 0..self.n {
                for i in 0..=row {
                    put([at(row, i), at(row + 1, i), at(row + 1, i + 1)])?;
                    if i < row {
                        put([at(row, i), at(row + 1, i + 1), at(row, i + 1)])?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Number of the vertex at place `i` of row `row` of a face.
    fn index(&self, edges: &[[usize; 2]], face: usize, row: u64, i: u64) -> u64 {
        let n = self.n;
        let [a, b, c] = faces()[face];
        let on_edge = |from: usize, to: usize, step: u64| {
            let key = [from.min(to), from.max(to)];
            let edge = edges.iter().position(|e| *e == key).expect("an edge") as u64;
            let step = if from < to { step } else { n - step };
            CORNERS as u64 + edge * (n - 1) + step - 1
        };
        match (row, i) {
            (0, _) => a as u64,
            (r, 0) if r == n => b as u64,
            (r, i) if r == n && i == n => c as u64,
            (r, 0) => on_edge(a, b, r),
            (r, i) if i == r => on_edge(a, c, r),
            (r, i) if r == n => on_edge(b, c, i),
            (r, i) => {
                // Rows 2 to n - 1 of a face have 1, 2, ... vertices inside.
                let inside = (n - 1) * n.saturating_sub(2) / 2;
                let before = (r - 2) * (r - 1) / 2;
                CORNERS as u64 + 30 * (n - 1) + face as u64 * inside + before + i - 1
            }
        }
    }
}

/// The corners of an icosahedron on the unit sphere, poles on the y axis.
fn corners() -> [[f64; 3]; CORNERS] {
    let ring = |i: usize, y: f64, turn: f64| {
        let angle = (i as f64 + turn) * std::f64::consts::TAU / 5.0;
        let radius = 2.0 / 5f64.sqrt();
        [radius * angle.sin(), y, radius * angle.cos()]
    };
    let height = 1.0 / 5f64.sqrt();
    std::array::from_fn(|c| match c {
        0 => [0.0, 1.0, 0.0],
        1..6 => ring(c - 1, height, 0.0),
        6..11 => ring(c - 6, -height, 0.5),
        _ => [0.0, -1.0, 0.0],
    })
}

/// Onto the sphere, and out or in by waves of ever shorter length.
fn displaced(p: [f64; 3]) -> [f32; 3] {
    let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = p.map(|x| x / length);
    let (mut radius, mut height, mut frequency) = (1.0, 0.1, 3.0);
    for octave in 0..8 {
        let shift = f64::from(octave) * 1.7;
        let wave = (frequency * x + shift).sin()
            * (frequency * y + 2.0 * shift).sin()
            * (frequency * z + 3.0 * shift).sin();
        radius += height * wave;
        height *= 0.55;
        frequency *= 2.3;
    }
    [x, y, z].map(|x| (x * radius) as f32)
}
