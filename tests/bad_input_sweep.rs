//! Whatever bytes a scene's files hold, the answer is a scene that keeps its promises or an error
//! of one line; never a panic.

mod scene_folder;

use huygens::scene::{self, Scene};
use proptest::prelude::*;
use scene_folder::Folder;
use std::path::{Path, PathBuf};

/// Holds a result to what is promised for any input. Returns whether it is a scene.
fn check(what: &str, result: Result<Scene, scene::SceneError>) -> bool {
    match result {
        Ok(scene) => {
            let mesh = &scene.mesh;
            let finite = mesh.vertices.iter().flatten().all(|x| x.is_finite());
            let valid = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < mesh.vertices.len());
            assert!(finite && mesh.indices.iter().all(valid), "{what}");
            let named = |&m: &u32| (m as usize) < scene.materials.len();
            assert_eq!(mesh.material.len(), mesh.indices.len(), "{what}");
            assert!(mesh.material.iter().all(named), "{what}");
            for m in &scene.materials {
                assert!(
                    m.albedo(&scene.materials)
                        .iter()
                        .all(|a| (0.0..=1.0).contains(a)),
                    "{what}"
                );
                assert!(
                    m.emission
                        .factor
                        .iter()
                        .all(|e| (0.0..=f32::MAX).contains(e)),
                    "{what}"
                );
            }
            true
        }
        Err(error) => {
            let line = error.to_string();
            assert!(
                !line.contains('\n') && !error.message().is_empty(),
                "{what}: {line}"
            );
            false
        }
    }
}

/// Files of an extension below a folder.
fn files(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, extension, found);
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
}

#[test]
fn odd_files_of_other_projects() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/odd");
    if !folder.is_dir() {
        eprintln!("SKIPPED: no {}", folder.display());
        return;
    }
    let mut found = Vec::new();
    files(&folder, "obj", &mut found);
    assert!(found.len() > 70, "{} files", found.len());
    let mut wrong: Vec<_> = found
        .iter()
        .filter(|path| !check(&path.display().to_string(), scene::load(path)))
        .map(|path| path.file_name().unwrap().to_string_lossy())
        .collect();
    wrong.sort_unstable();
    // Every other one of them can be drawn.
    let expected = [
        "box_UTF16BE.obj",                     // UTF-16
        "invalid-face-definition.obj",         // faces of one or two corners only
        "invalid-relative-texture-index.obj",  // no vertices
        "invalid-relative-vertex-index.obj",   // an index before the first vertex
        "invalid_index.obj",                   // an index past the last vertex
        "issue-140-zero-face-idx.obj",         // index 0
        "issue-356-leading-spaces-newmtl.obj", // no faces
        "line-prim.obj",                       // no faces
        "lines.obj",                           // no faces
        "number_formats.obj",                  // "3.1+e2"
        "point_cloud.obj",                     // no faces
        "points-prim.obj",                     // no faces
        "test-nan.obj",                        // NaN
        "testline.obj",                        // no faces
        "testpoints.obj",                      // no faces
    ];
    assert_eq!(wrong, expected);
}

#[test]
fn odd_ply_files_of_other_projects() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/odd/ply");
    if !folder.is_dir() {
        eprintln!("SKIPPED: no {}", folder.display());
        return;
    }
    let mut found = Vec::new();
    files(&folder, "ply", &mut found);
    assert!(found.len() >= 8, "{} files", found.len());
    let mut answers: Vec<(String, usize)> = Vec::new();
    for path in &found {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let result = scene::load(path);
        let triangles = result.as_ref().map_or(0, |s| s.mesh.triangles());
        assert_eq!(check(&name, result), triangles > 0, "{name}");
        answers.push((name, triangles));
    }
    answers.sort();
    let expected = [
        ("cube.ply", 12),
        ("cube_binary.ply", 12),
        ("cube_binary_header_with_RN_newline.ply", 12),
        ("cube_binary_starts_with_nl.ply", 12),
        ("cube_uv.ply", 12),
        ("float-color.ply", 1),
        ("issue623.ply", 0), // its header has lost the line `element face`
        ("points.ply", 0),   // no faces
    ];
    assert_eq!(answers, expected.map(|(name, n)| (name.to_owned(), n)));
}

const SCENE: &str = r#"
name = "all keys"
[camera]
origin = [0, 1, 5]
target = [0, 0, 0]
up = [0, 1, 0]
fov = 45.5
fov_axis = "smaller"
aperture = 0.25
focus = 4.5
[film]
width = 64
height = 48
filter = "blackman-harris"
[settings]
integrator = "path"
strategy = "mis"
sampler = "blue-noise"
spp = 16
max_depth = 8
roulette = "aggressive"
split = [2, 3]
seed = 1
texture_lod = "finest"
ao_distance = 1.5
bvh = "best"
[sky]
radiance = [0.5, 0.6, 0.7]
[materials.white]
albedo = 0.7
emission = [1, 2, 3]
two_sided = true
[[shapes]]
obj = "a.obj"
materials = { red = "white" }
transform = [{ scale = [1, 2, -3] }, { rotate = { axis = [0, 1, 0], degrees = 30 } }]
[[shapes]]
box = { min = [0, 0, 0], max = [1, 1, 1], inward = true }
material = "white"
transform = [[1, 0, 0, 4], [0, 1, 0, 5], [0, 0, 1, 6], [0, 0, 0, 1]]
[[shapes]]
rectangle = { corner = [0, 0, 0], edges = [[1, 0, 0], [0, 1, 0]] }
[[shapes]]
mesh = { vertices = [[0, 0, 0], [4, 0, 0], [1, 1, 0], [0, 4, 0]], faces = [[0, 1, 2, 3]] }
"#;

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1e-3 -0\nv .5 .5 1\n\
                   usemtl red\nf 1/1/1 2//2 3 4 5\nusemtl blue\nf -1 -2 -3\nl 1 2\n";

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
                   property float z\nelement face 2\nproperty list uchar int vertex_indices\n\
                   end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 2 3 1\n";

const MTL: &str = "newmtl red\nKd 0.5 0.5 0.5\nKe 1 0 0\nd 0.5\nillum 2\nmap_Kd -s 1 1 1 x.png\n\
                   newmtl blue\nKd 1 0 0\n";

/// Cuts, overwrites or repeats a piece of `text`.
fn damage(text: &str, at: f64, length: usize, by: &[u8]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    let at = (at * bytes.len() as f64) as usize;
    let end = (at + length).min(bytes.len());
    bytes.splice(at..end, by.iter().copied());
    bytes
}

#[test]
fn the_undamaged_scene_is_right() {
    let folder = Folder::new()
        .with("s.toml", SCENE)
        .with("a.obj", OBJ)
        .with("a.mtl", MTL);
    let scene = folder.scene("s.toml");
    assert_eq!(scene.mesh.triangles(), 3 + 1 + 12 + 2 + 2);
    // The opacity of `red` makes a mixture of it, of two more.
    assert_eq!(scene.materials.len(), 5);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn damaged_files(
        which in 0usize..3,
        at in 0.0f64..1.0,
        length in 0usize..12,
        by in prop_oneof![
            Just(String::new()),
            "[-0-9.eE/ \\[\\]{}=\"\\\\\n#]{1,6}",
            "\\PC{1,4}",
            "(nan|inf|-inf|1e39|-1|0|99999999999999999999)",
        ],
    ) {
        let mut content = [SCENE, OBJ, MTL].map(|text| text.as_bytes().to_vec());
        content[which] = damage([SCENE, OBJ, MTL][which], at, length, by.as_bytes());
        let [scene, obj, mtl] = content;
        let folder = Folder::new().with("s.toml", scene).with("a.obj", obj).with("a.mtl", mtl);
        for name in ["s.toml", "a.obj"] {
            check(name, scene::load(&folder.path(name)));
        }
    }

    /// Behind a header that says binary, the words of ASCII are as good as any bytes.
    #[test]
    fn damaged_ply_files(
        at in 0.0f64..1.0,
        length in 0usize..12,
        by in prop_oneof!["[-0-9.e \\n]{1,6}", "(nan|inf|1e39|-1|99999999999999999999|list|face)"],
        format in prop_oneof!["ascii", "binary_little_endian", "binary_big_endian"],
    ) {
        let bytes = damage(&PLY.replace("ascii", &format), at, length, by.as_bytes());
        let folder = Folder::new().with("a.ply", bytes);
        check("a.ply", scene::load(&folder.path("a.ply")));
        // Nor does counting fail in another way, or count less than is read: unless there are faces
        // with fewer than three corners, each of which it takes for up to two triangles too few.
        let counts = scene::Source::open(&folder.path("a.ply")).and_then(|s| s.counts());
        if let (Ok(counts), Ok(scene)) = (counts, scene::load(&folder.path("a.ply"))) {
            let thin = scene.warnings.iter().any(|w| w.contains("fewer than three corners"));
            prop_assert!(thin || counts.triangles >= scene.mesh.triangles() as u64);
            prop_assert!(counts.vertices >= scene.mesh.vertices.len() as u64);
        }
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let ply = [&b"ply\n"[..], &bytes].concat();
        let folder = Folder::new().with("a.obj", &bytes).with("s.toml", &bytes).with("a.ply", ply);
        for name in ["s.toml", "a.obj", "a.ply"] {
            check(name, scene::load(&folder.path(name)));
        }
    }
}
