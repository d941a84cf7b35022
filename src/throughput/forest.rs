//! A forest of instances: a tree, and the scene that copies it.
//!
//! The tree stands on the origin, ten units high: a trunk of a dozen triangles under leaves, a
//! triangle each, that hang in a crown. The same numbers give the same files, byte for byte, for one
//! platform's `sin` and `cos`.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Sides of the trunk, two triangles each.
const SIDES: u64 = 6;

/// The scene file of a forest of so many trees, 100 square units each. It names `tree.ply`.
#[must_use]
pub fn scene(trees: u64) -> String {
    let half = 5.0 * (trees as f64).sqrt();
    let edge = 2.0 * half;
    format!(
        "# A forest of {trees} copies of one tree.\n\
         name = \"Forest\"\n\n\
         [camera]\norigin = [0, {eye}, {from}]\ntarget = [0, 0, {towards}]\nfov = 50\n\n\
         [film]\nwidth = 1280\nheight = 720\n\n\
         [settings]\nspp = 16\n\n\
         [sky]\nradiance = [1.0, 1.3, 1.7]\nnadir = 0.4\n\n\
         [materials.leaves]\nalbedo = [0.15, 0.4, 0.08]\n\n\
         [materials.soil]\nalbedo = [0.3, 0.22, 0.15]\n\n\
         [[shapes]]\nmaterial = \"soil\"\n\
         rectangle = {{ corner = [-{half}, 0, -{half}], edges = [[0, 0, {edge}], [{edge}, 0, 0]] }}\n\n\
         [[objects.tree.shapes]]\nply = \"tree.ply\"\nmaterial = \"leaves\"\n\n\
         [[instances]]\nobject = \"tree\"\n\
         scatter = {{ count = {trees}, corner = [-{half}, 0, -{half}], edges = [[{edge}, 0, 0], \
         [0, 0, {edge}]], scale = [0.6, 1.2] }}\n",
        eye = 25.0 + 0.01 * half,
        from = half,
        towards = 0.7 * half,
    )
}

/// Writes the tree, of so many triangles, into `folder`, and returns [`scene`].
///
/// # Errors
/// If the folder cannot be written.
///
/// # Panics
/// As [`tree`].
pub fn make(folder: &Path, triangles: u64, trees: u64) -> io::Result<String> {
    let mut out = BufWriter::new(File::create(folder.join("tree.ply"))?);
    write_tree(triangles, &mut out)?;
    out.flush()?;
    Ok(scene(trees))
}

/// SplitMix64 (G. Steele et al., 2014), as numbers in [0, 1).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in the unit ball.
    fn in_ball(&mut self) -> [f64; 3] {
        loop {
            let p = [(); 3].map(|()| 2.0 * self.unit() - 1.0);
            if p.iter().map(|c| c * c).sum::<f64>() <= 1.0 {
                return p;
            }
        }
    }
}

/// Calls `put` with the corners of each of the tree's triangles, 12 or more: the trunk, then the leaves.
///
/// # Errors
/// What `put` says.
///
/// # Panics
/// On fewer than 12 triangles.
pub fn tree(
    triangles: u64,
    mut put: impl FnMut([[f32; 3]; 3]) -> io::Result<()>,
) -> io::Result<()> {
    let ring = |side: u64, height: f64, radius: f64| {
        let angle = (side % SIDES) as f64 * std::f64::consts::TAU / SIDES as f64;
        [radius * angle.sin(), height, radius * angle.cos()].map(|c| c as f32)
    };
    for side in 0..SIDES {
        let low = [ring(side, 0.0, 0.4), ring(side + 1, 0.0, 0.4)];
        let high = [ring(side, 6.0, 0.1), ring(side + 1, 6.0, 0.1)];
        put([low[0], low[1], high[1]])?;
        put([low[0], high[1], high[0]])?;
    }
    assert!(triangles >= 2 * SIDES, "a trunk is {} triangles", 2 * SIDES);
    let leaves = triangles - 2 * SIDES;
    // As many as there are, together they cover the crown about twice.
    let size = 10.0 / (leaves as f64).sqrt();
    let mut random = Random(1);
    for _ in 0..leaves {
        let [x, y, z] = random.in_ball();
        let at = [2.5 * x, 6.5 + 3.5 * y, 2.5 * z];
        let corner = [(); 3].map(|()| random.in_ball());
        put(corner.map(|c| std::array::from_fn(|k| (at[k] + size * c[k]) as f32)))?;
    }
    Ok(())
}

/// Writes the tree, of so many triangles (12 or more), as binary PLY.
///
/// # Errors
/// What the writer says.
///
/// # Panics
/// As [`tree`].
pub fn write_tree(triangles: u64, out: &mut impl Write) -> io::Result<()> {
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n\
         property float y\nproperty float z\nelement face {triangles}\n\
         property list uchar uint vertex_indices\nend_header\n",
        3 * triangles
    )?;
    tree(triangles, |corners| {
        let mut numbers = corners.as_flattened().iter();
        numbers.try_for_each(|x| out.write_all(&x.to_le_bytes()))
    })?;
    for i in 0..triangles as u32 {
        out.write_all(&[3])?;
        (0..3).try_for_each(|k| out.write_all(&(3 * i + k).to_le_bytes()))?;
    }
    Ok(())
}
