//! A million triangles under a sky.

use std::io::{self, Write};
use std::path::Path;

/// Writes a triangle mesh as binary PLY.
fn write_ply(path: &Path, vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> io::Result<()> {
    let mut to = io::BufWriter::new(std::fs::File::create(path)?);
    write!(
        to,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n\
         property float y\nproperty float z\nelement face {}\n\
         property list uchar uint vertex_indices\nend_header\n",
        vertices.len(),
        triangles.len()
    )?;
    for v in vertices.as_flattened() {
        to.write_all(&v.to_le_bytes())?;
    }
    for t in triangles {
        to.write_all(&[3])?;
        for i in t {
            to.write_all(&i.to_le_bytes())?;
        }
    }
    to.flush()
}

/// Hills: a grid of 708 by 708 squares whose heights are waves of ever shorter length.
pub(super) fn make(folder: &Path) -> io::Result<String> {
    const SQUARES: u32 = 708;
    let height = |x: f64, z: f64| -> f64 {
        let wave = |octave: i32| {
            let (size, turn) = (0.5f64.powi(octave), f64::from(octave) * 1.3);
            let (c, s) = (turn.cos(), turn.sin());
            size * ((c * x + s * z) / size * 1.7 + turn).sin()
                * ((c * z - s * x) / size * 2.1).sin()
        };
        (0..8).map(wave).sum()
    };
    let side = SQUARES + 1;
    let place = |i: u32| f64::from(i) / f64::from(SQUARES) * 12.0 - 6.0;
    let corner = |i: u32| {
        let (x, z) = (place(i % side), place(i / side));
        [x as f32, height(x, z) as f32, z as f32]
    };
    let vertices: Vec<[f32; 3]> = (0..side * side).map(corner).collect();
    let square = |i: u32| {
        let a = i / SQUARES * side + i % SQUARES;
        [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]]
    };
    let triangles: Vec<[u32; 3]> = (0..SQUARES * SQUARES).flat_map(square).collect();
    write_ply(&folder.join("mesh.ply"), &vertices, &triangles)?;
    Ok("name = \"mesh\"\n\
        [camera]\norigin = [0, 4, 9]\ntarget = [0, -0.5, 0]\nfov = 45\n\
        [sky]\nradiance = [0.9, 1.0, 1.2]\nnadir = 0.4\n\
        [[shapes]]\nply = \"mesh.ply\"\n"
        .to_owned())
}
