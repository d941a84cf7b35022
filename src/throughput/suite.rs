//! The standard scenes: shipped, or made here. To add one, add a row to [`SUITE`].

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

/// A scene of the suite.
#[derive(Clone, Copy, Debug)]
pub struct Standard {
    /// Its name.
    pub name: &'static str,
    /// What it stands for.
    pub about: &'static str,
    /// The image's size, samples a pixel and largest depth of a run: about a processor second.
    pub size: [u32; 2],
    /// Samples a pixel.
    pub spp: u32,
    /// Largest number of scattering events.
    pub max_depth: u32,
    /// Writes the files that it needs into a folder and returns the text of its scene file.
    pub make: fn(&Path) -> io::Result<String>,
}

/// All of them.
pub const SUITE: [Standard; 3] = [
    Standard {
        name: "box",
        about: "diffuse box of 36 triangles, in the first-level cache",
        size: [256, 256],
        spp: 32,
        max_depth: 8,
        make: |_| Ok(include_str!("../../scenes/cornell-box.toml").to_owned()),
    },
    Standard {
        name: "mesh",
        about: "a million triangles under a sky",
        size: [256, 256],
        spp: 24,
        max_depth: 6,
        make: mesh,
    },
    Standard {
        name: "interior",
        about: "a room of 6,000 triangles, 64 materials and 12 lamps",
        size: [256, 192],
        spp: 16,
        max_depth: 8,
        make: |_| Ok(interior()),
    },
];

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
fn mesh(folder: &Path) -> io::Result<String> {
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

/// A closed room with lamps under its ceiling and turned boxes on its floor.
fn interior() -> String {
    const BOXES: u32 = 500;
    // Numerical Recipes' linear congruential generator: the same scene everywhere.
    let mut state = 7u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let mut text = String::from(
        "name = \"interior\"\n\
         [camera]\norigin = [-8.5, 3, -5.5]\ntarget = [3, 1, 2]\nfov = 70\n\
         [materials.wall]\nalbedo = [0.75, 0.72, 0.68]\n\
         [materials.lamp]\nalbedo = 0.5\nemission = [18, 16, 12]\n",
    );
    let mut add = |line: String| {
        let _ = writeln!(text, "{line}");
    };
    for m in 0..62 {
        let [r, g, b] = [0; 3].map(|_| 0.15 + 0.7 * random());
        add(format!(
            "[materials.m{m}]\nalbedo = [{r:.3}, {g:.3}, {b:.3}]"
        ));
    }
    add("[[shapes]]\nmaterial = \"wall\"\n\
         box = { min = [-10, 0, -7], max = [10, 5, 7], inward = true }"
        .to_owned());
    for lamp in 0..12 {
        let (x, z) = (
            f64::from(lamp % 4) * 5.0 - 8.0,
            f64::from(lamp / 4) * 4.5 - 5.0,
        );
        add(format!(
            "[[shapes]]\nmaterial = \"lamp\"\n\
             rectangle = {{ corner = [{x}, 4.9, {z}], edges = [[1, 0, 0], [0, 0, 0.5]] }}"
        ));
    }
    for i in 0..BOXES {
        let (x, z) = (random() * 18.0 - 9.0, random() * 12.0 - 6.0);
        let [a, b, c] = [0; 3].map(|_| 0.05 + 0.3 * random() * random());
        let height = 0.1 + 1.8 * random() * random();
        let turn = random() * 90.0;
        add(format!(
            "[[shapes]]\nmaterial = \"m{}\"\n\
             box = {{ min = [{:.3}, 0.001, {:.3}], max = [{a:.3}, {height:.3}, {b:.3}] }}\n\
             transform = [{{ rotate = {{ axis = [{:.3}, 1, 0], degrees = {turn:.2} }} }}, \
             {{ translate = [{x:.3}, {:.3}, {z:.3}] }}]",
            i % 62,
            -a,
            -b,
            0.2 * random(),
            0.2 + c * 3.0
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_loads_without_a_warning_and_with_light() {
        for standard in &SUITE {
            let folder = tempfile::tempdir().expect("a folder");
            let text = (standard.make)(folder.path()).expect("written");
            let file = folder.path().join("scene.toml");
            std::fs::write(&file, text).expect("written");
            let scene = crate::scene::load(&file).expect(standard.name);
            assert_eq!(scene.warnings, [""; 0], "{}", standard.name);
            let lit = scene.sky.is_some() || scene.materials.iter().any(|m| m.emits());
            assert!(lit && scene.mesh.triangles() > 0, "{}", standard.name);
            if standard.name == "mesh" {
                assert_eq!(scene.mesh.triangles(), 2 * 708 * 708);
            }
        }
    }
}
