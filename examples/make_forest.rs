//! Writes a forest, for measurements: a tree as binary PLY, and a scene that copies it.
//!
//! ```text
//! cargo run --release --example make_forest -- --triangles 100000 --trees 10000 -o forest
//! huygens render forest/forest.toml -o forest.png
//! ```
//!
//! What it writes is described at `huygens::throughput::forest`.

use huygens::throughput::forest;
use std::path::Path;

const USAGE: &str = "usage: make_forest --triangles N --trees N -o FOLDER";

fn main() -> std::io::Result<()> {
    let (mut triangles, mut trees, mut folder) = (None, None, None);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let value = args.next();
        let number = || value.as_ref().and_then(|n| n.parse::<u64>().ok());
        match arg.as_str() {
            "--triangles" => triangles = number(),
            "--trees" => trees = number(),
            "-o" => folder = value,
            _ => folder = None,
        }
    }
    let (Some(triangles @ 100..=1_000_000_000), Some(trees @ 1..), Some(folder)) =
        (triangles, trees, folder)
    else {
        eprintln!("{USAGE}");
        std::process::exit(2);
    };
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    std::fs::write(
        folder.join("forest.toml"),
        forest::make(folder, triangles, trees)?,
    )
}
