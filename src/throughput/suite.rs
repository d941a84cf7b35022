//! The standard scenes: shipped, or made here. To add one, add a row to [`SUITE`].

mod interior;
mod mesh;

use super::forest;
use std::io;
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
pub const SUITE: [Standard; 5] = [
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
        make: mesh::make,
    },
    Standard {
        name: "interior",
        about: "a room of 6,000 triangles, 64 materials of five kinds and 12 lamps",
        size: [256, 192],
        spp: 16,
        max_depth: 8,
        make: interior::make,
    },
    Standard {
        name: "forest",
        about: "a tree of 20,000 triangles and 2,000 copies of it under a sky",
        size: [256, 144],
        spp: 16,
        max_depth: 6,
        make: |folder| forest::make(folder, 20_000, 2_000),
    },
    Standard {
        name: "metal",
        about: "spheres of glass, metal, lacquer and velvet",
        size: [320, 180],
        spp: 32,
        max_depth: 16,
        make: |_| Ok(include_str!("../../scenes/glass-and-metal.toml").to_owned()),
    },
];

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
            let of = (
                scene.mesh.triangles(),
                scene.instances.len(),
                scene.spheres.len(),
            );
            match standard.name {
                "mesh" => assert_eq!(of.0, 2 * 708 * 708),
                "forest" => assert_eq!((of.1, scene.objects[0].mesh.triangles()), (2000, 20_000)),
                "metal" => assert!(of.2 >= 9, "{of:?}"),
                "interior" => assert_eq!(scene.materials.len(), 64),
                _ => {}
            }
        }
    }
}
