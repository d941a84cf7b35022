//! Loading in steps: what is read, how often, and that threads make no difference.

mod scene_folder;

use huygens::scene::{Counts, Source};
use image::{ImageBuffer, Luma, Rgb};
use scene_folder::{Folder, TRIANGLE};
use std::sync::atomic::AtomicU64;

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                   property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
                   end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// Two files, one of them three times; a box.
const SCENE: &str = r#"
[materials.red]
[[shapes]]
obj = "a.obj"
transform = [{ translate = [0, 0, 1] }]
[[shapes]]
ply = "b.ply"
material = "red"
[[shapes]]
obj = "a.obj"
materials = { blue = "red" }
[[shapes]]
obj = "a.obj"
transform = [{ scale = [-1, 1, 1] }]
[[shapes]]
box = { min = [0, 0, 0], max = [1, 1, 1] }
[sky]
radiance = 1
"#;

fn folder() -> Folder {
    let obj = format!("{TRIANGLE}usemtl blue\nf 3 2 1\nf 1 1 1\n");
    Folder::new()
        .with("s.toml", SCENE)
        .with("a.obj", obj)
        .with("b.ply", PLY)
}

#[test]
fn each_file_is_read_once() {
    let folder = folder();
    let source = Source::open(&folder.path("s.toml")).unwrap();
    let size = |name| std::fs::metadata(folder.path(name)).unwrap().len();
    assert_eq!(source.bytes(), size("a.obj") + size("b.ply"));
    let all = source.bytes();
    let read = AtomicU64::new(0);
    source.parse(&read).unwrap();
    assert_eq!(read.into_inner(), all);
}

#[test]
fn what_is_counted_is_what_comes() {
    let source = Source::open(&folder().path("s.toml"));
    // The folder is gone; the scene knows it only when it looks at the files again.
    assert!(source.unwrap().counts().is_err());
    let folder = folder();
    let source = Source::open(&folder.path("s.toml")).unwrap();
    let counts = source.counts().unwrap();
    let scene = source.parse(&AtomicU64::new(0)).unwrap().compile().unwrap();
    // Of each a.obj, one triangle of three has no area.
    assert_eq!(scene.mesh.triangles(), 3 * 2 + 1 + 12);
    assert_eq!(
        counts,
        Counts {
            vertices: scene.mesh.vertices.len() as u64,
            triangles: scene.mesh.triangles() as u64 + 3,
            ..Counts::default()
        }
    );
    assert_eq!(scene.mesh.material[..7], [1, 2, 0, 1, 0, 1, 2]);
    // A mirror turns triangles over.
    assert_eq!(
        scene.mesh.corners(5),
        [[0.0; 3], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    );
}

#[test]
fn threads_make_no_difference() {
    let folder = folder();
    let load = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let scene = pool.build().unwrap().install(|| folder.scene("s.toml"));
        (scene.hash, scene.warnings)
    };
    assert_eq!(load(1), load(2));
    assert_eq!(load(1), load(3));
    // Of two files that are wrong, the one that is named first is reported.
    let broken = folder.with("a.obj", "f 1 2 3\n").with("b.ply", "ply\n");
    let error = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| broken.error("s.toml"))
    };
    for threads in 1..4 {
        assert_eq!(
            error(threads),
            "a.obj:1: a face has vertex index 3, expected one of the 0 vertices of the file"
        );
    }
}

/// What can be known to be wrong without the geometry is said before that is read.
#[test]
fn mistakes_of_the_scene_come_before_those_of_its_files() {
    let folder = folder().with("a.obj", "f 1 2 3\n");
    for (wrong, expected) in [
        (
            "material = \"read\"",
            "no material `read`, did you mean `red`?",
        ),
        (
            "transform = [{ scale = [1, 1, 0] }]",
            "the transformation is singular",
        ),
        (
            "box = { min = [0, 0, 0], max = [1, 1, 1] }",
            "expected exactly one of `obj`",
        ),
    ] {
        let scene = format!("[materials.red]\n[[shapes]]\nobj = \"a.obj\"\n{wrong}\n");
        std::fs::write(folder.path("t.toml"), scene).unwrap();
        let error = folder.error("t.toml");
        assert!(error.contains(expected), "{error}");
    }
}

/// Of what MTL files name too, each file once.
#[test]
fn bytes_of_textures_of_mtl_files_are_foreseen() {
    let folder = Folder::new()
        .with("a.obj", format!("mtllib a.mtl\nusemtl  wood \n{TRIANGLE}"))
        .with(
            "b.obj",
            format!("mtllib a.mtl\nusemtl wood\n{TRIANGLE}usemtl tin\nf 1 2 3\n"),
        )
        .with(
            "a.mtl",
            "newmtl wood\nmap_Kd colours.png\nnewmtl tin\nKd 0.5 0.5 0.5\nmap_Pr grey.png\n\
             newmtl unused\nmap_Kd other.png\n",
        );
    let colours = ImageBuffer::from_fn(64, 64, |x, y| Rgb([x as u8, y as u8, 7]));
    for name in ["colours.png", "other.png", "own.png"] {
        colours.save(folder.path(name)).unwrap();
    }
    let grey = ImageBuffer::from_fn(31, 5, |x, _| Luma([x as u8]));
    grey.save(folder.path("grey.png")).unwrap();
    let scene = folder.scene_of(
        "[sky]\nradiance = 1\n[materials.m]\nalbedo = { file = \"own.png\" }\n\
         [[shapes]]\nobj = \"a.obj\"\n[[shapes]]\nobj = \"b.obj\"\n[[shapes]]\nmaterial = \"m\"\n\
         rectangle = { corner = [0, 0, 0], edges = [[1, 0, 0], [0, 1, 0]] }\n",
    );
    let source = Source::open(&folder.path("s.toml")).unwrap();
    let foreseen = source.counts().unwrap().texture_bytes;
    let there: usize = scene.textures.iter().map(|t| t.bytes()).sum();
    assert_eq!(scene.textures.len(), 3);
    assert_eq!(foreseen, there as u64);
}

/// What `--max-memory` counts of textures is what is there.
#[test]
fn bytes_of_textures_are_foreseen() {
    let folder = Folder::new();
    let colours = ImageBuffer::from_fn(257, 130, |x, y| Rgb([x as u8, y as u8, 7]));
    colours.save(folder.path("colours.png")).unwrap();
    colours.save(folder.path("photo.jpg")).unwrap();
    let grey = ImageBuffer::from_fn(31, 5, |x, _| Luma([x as u8]));
    grey.save(folder.path("grey.png")).unwrap();
    let deep = ImageBuffer::from_pixel(3, 2, Luma([257u16]));
    deep.save(folder.path("deep.png")).unwrap();
    let bright = ImageBuffer::from_pixel(5, 9, Rgb([4.0f32; 3]));
    bright.save(folder.path("bright.hdr")).unwrap();
    for file in [
        "colours.png",
        "photo.jpg",
        "grey.png",
        "deep.png",
        "bright.hdr",
    ] {
        for key in ["albedo", "bump_map"] {
            let text = format!(
                "[sky]\nradiance = 1\n[materials.m]\n{key} = {{ file = \"{file}\" }}\n[[shapes]]\n\
                 material = \"m\"\nrectangle = {{ corner = [0, 0, 0], edges = [[1, 0, 0], [0, 1, 0]] }}\n"
            );
            let scene = folder.scene_of(&text);
            let source = Source::open(&folder.path("s.toml")).unwrap();
            let foreseen = source.counts().unwrap().texture_bytes;
            let there: usize = scene.textures.iter().map(|t| t.bytes()).sum();
            assert_eq!(foreseen, there as u64, "{file} as {key}");
        }
    }
}
