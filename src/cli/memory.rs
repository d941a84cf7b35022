//! `--max-memory`: what a render will need, before anything large is allocated.

use crate::cli::failure::Failure;
use crate::cli::text::bytes;
use huygens::film::{Film, Image};
use huygens::geometry::Preset;
use huygens::scene::Counts;

/// Bytes of tree nodes a triangle: 13.3 to 15.3 on meshes of 968 to 227,986 triangles.
const NODES: u64 = 16;
/// Bytes of triangle blocks a triangle: 40 where all blocks are full; 41.4 to 45.0 on the same.
const BLOCKS: u64 = 46;

/// Bytes a triangle while the tree is built, the finished tree among them: measured for one million
/// triangles, 127 to 157 with `fast` and `balanced`, 316 with `best`.
fn building(preset: Preset) -> u64 {
    match preset {
        Preset::Fast | Preset::Balanced => 160,
        Preset::Best => 320,
    }
}

/// Bytes a sphere: itself, its material, a quarter of a block, shading's copy and its share of the tree
/// over the world, whose nodes hold four blocks or more on average.
const SPHERE: u64 = 20 + 24 + 16 + 20;
/// Bytes an instance: as compiled, as kernels read it, two entries of what finds it, and its share of
/// the tree.
const INSTANCE: u64 = 104 + 128 + 8 + 64;
/// The same while that tree is built: items, boxes, and the binary tree with what is below its nodes.
const PLACING: u64 = 320;

/// What is needed at one moment, by table.
type Moment = Vec<(&'static str, u64)>;

/// What the moment needs in all.
fn all(moment: &Moment) -> u64 {
    let sizes = moment.iter().map(|(_, bytes)| bytes);
    sizes.fold(0, |a, &b| a.saturating_add(b))
}

/// What a scene and an image of `size` need while the tree is built, and while they are rendered.
/// Reading needs less than building: the tables, and at most those of one file a second time.
fn moments(counts: Counts, preset: Preset, size: (u32, u32)) -> [Moment; 2] {
    let triangles = |each: u64| counts.triangles.saturating_mul(each);
    let mesh = [
        ("vertices", counts.vertices.saturating_mul(12)),
        ("vertex indices", triangles(12)),
        ("material indices", triangles(4)),
    ];
    let pixels = u64::from(size.0) * u64::from(size.1);
    let placed = counts.spheres.saturating_add(counts.instances);
    let building = triangles(building(preset)).saturating_add(placed.saturating_mul(PLACING));
    let building = [("building the bvh", building)];
    let places = [
        ("spheres", counts.spheres.saturating_mul(SPHERE)),
        ("instances", counts.instances.saturating_mul(INSTANCE)),
        ("textures", counts.texture_bytes),
    ];
    let mesh: Moment = mesh
        .into_iter()
        .chain(places.into_iter().filter(|t| t.1 > 0))
        .collect();
    let rendering = [
        ("bvh nodes", triangles(NODES)),
        ("bvh triangles", triangles(BLOCKS)),
        ("film", pixels * Film::BYTES_PER_PIXEL as u64),
        ("image", pixels * Image::BYTES_PER_PIXEL as u64),
    ];
    [
        mesh.iter().copied().chain(building).collect(),
        mesh.into_iter().chain(rendering).collect(),
    ]
}

/// Refuses what needs more than `limit` bytes by estimate.
pub(crate) fn ensure(
    limit: u64,
    counts: Counts,
    preset: Preset,
    size: (u32, u32),
) -> Result<(), Failure> {
    let [building, rendering] = moments(counts, preset, size);
    let (when, largest) = if all(&building) > all(&rendering) {
        ("while the bvh is built", building)
    } else {
        ("while it renders", rendering)
    };
    if all(&largest) <= limit {
        return Ok(());
    }
    let tables = largest
        .iter()
        .map(|&(name, b)| format!("{name} {}", bytes(b)));
    let tables: Vec<String> = tables.collect();
    Err(Failure::Input(miette::miette!(
        help = tables.join(", "),
        "the scene needs about {} of memory {when}, more than the {} of --max-memory",
        bytes(all(&largest)),
        bytes(limit)
    )))
}

/// A number of bytes such as `800M`, `4G` or `1.5T`, in powers of 1000; `Ki`, `Mi`, `Gi`, `Ti` are
/// those of 1024, and a `B` may follow.
pub(crate) fn parse(text: &str) -> Result<u64, String> {
    let wrong = || format!("expected a size such as 800M or 4G, found {text}");
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.');
    let (number, unit) = text.split_at(end.unwrap_or(text.len()));
    let number: f64 = number.parse().map_err(|_| wrong())?;
    let unit = unit.strip_suffix('B').unwrap_or(unit);
    let (prefix, base) = match unit.strip_suffix('i') {
        Some("") => return Err(wrong()),
        Some(prefix) => (prefix, 1024f64),
        None => (unit, 1000.0),
    };
    let power = match prefix {
        "" => 0,
        "k" | "K" => 1,
        "M" => 2,
        "G" => 3,
        "T" => 4,
        _ => return Err(wrong()),
    };
    // Beyond what u64 holds the cast saturates, which is as good as no limit.
    Ok((number * base.powi(power)) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use huygens::geometry::Geometry;
    use huygens::scene::Mesh;

    #[test]
    fn sizes() {
        assert_eq!(parse("4G"), Ok(4_000_000_000));
        assert_eq!(parse("1.5MB"), Ok(1_500_000));
        assert_eq!(parse("2Ki"), Ok(2048));
        assert_eq!(parse("3GiB"), Ok(3 << 30));
        assert_eq!(parse("17"), Ok(17));
        assert_eq!(parse("99999999T"), Ok(u64::MAX));
        for wrong in ["", "G", "-1G", "4X", "4i", "4 G", "1..2M", "nan", "1e3"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_larger_moment_is_refused_with_its_tables() {
        let counts = Counts {
            vertices: 5_000_000,
            triangles: 10_000_000,
            ..Counts::default()
        };
        // 220 MB of mesh, and 160 or 320 bytes a triangle.
        for (preset, enough) in [
            (Preset::Fast, 1_820_000_000),
            (Preset::Balanced, 1_820_000_000),
            (Preset::Best, 3_420_000_000),
        ] {
            assert!(ensure(enough, counts, preset, (1920, 1080)).is_ok());
            assert!(ensure(enough - 1, counts, preset, (1920, 1080)).is_err());
        }
        let refused = |counts, size| match ensure(1_000_000, counts, Preset::Best, size) {
            Err(Failure::Input(report)) => {
                let help = report.help().map(|h| h.to_string()).unwrap_or_default();
                format!("{report}; {help}")
            }
            _ => panic!("it is the input that is too large"),
        };
        assert_eq!(
            refused(counts, (1920, 1080)),
            "the scene needs about 3.42 GB of memory while the bvh is built, more than the 1.00 MB \
             of --max-memory; vertices 60.0 MB, vertex indices 120 MB, material indices 40.0 MB, \
             building the bvh 3.20 GB"
        );
        assert_eq!(
            refused(Counts::default(), (1000, 1000)),
            "the scene needs about 84.0 MB of memory while it renders, more than the 1.00 MB of \
             --max-memory; vertices 0 B, vertex indices 0 B, material indices 0 B, bvh nodes 0 B, \
             bvh triangles 0 B, film 56.0 MB, image 28.0 MB"
        );
    }

    /// The estimate of the tree is no less than a real one, and not more than half as much again.
    #[test]
    fn the_tree_is_estimated_as_it_is_built() {
        let n = 100u32;
        let mut mesh = Mesh::default();
        let bumps = |x: u32, y: u32| ((x * 31 + y * 17) % 23) as f32 * 0.1;
        for (y, x) in (0..=n).flat_map(|y| (0..=n).map(move |x| (y, x))) {
            mesh.vertices.push([x as f32, bumps(x, y), y as f32]);
        }
        for (y, x) in (0..n).flat_map(|y| (0..n).map(move |x| (y, x))) {
            let i = y * (n + 1) + x;
            mesh.indices.push([i, i + n + 1, i + 1]);
            mesh.indices.push([i + 1, i + n + 1, i + n + 2]);
        }
        mesh.material = vec![0; mesh.triangles()];
        let built: usize = Geometry::build(&mesh).memory().iter().map(|m| m.1).sum();
        let estimate = mesh.triangles() as u64 * (NODES + BLOCKS);
        let built = built as u64;
        assert!(
            (built..=built * 3 / 2).contains(&estimate),
            "{built} {estimate}"
        );
    }
}
