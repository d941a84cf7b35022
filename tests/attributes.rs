//! Normals and texture coordinates of shapes, from files and from the scene's own.

mod scene_folder;

use huygens::scene::{Mesh, Scene};
use scene_folder::Folder;

/// A quadrilateral over (0, 0) to (1, 1) with normals that lean outwards, as OBJ.
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                   vn -1 -1 2\nvn 1 -1 2\nvn 1 1 2\nvn -1 1 2\n\
                   f 1/1/1 2/2/2 3/3/3 4/4/4\n";

/// The same as PLY.
fn ply(uv: [&str; 2]) -> String {
    let [u, v] = uv;
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float {u}\nproperty float {v}\n\
         property float x\nproperty float y\nproperty float z\nproperty uchar red\n\
         property float nx\nproperty float ny\nproperty float nz\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n\
         0 0 0 0 0 1 -1 -1 2\n1 0 1 0 0 1 1 -1 2\n1 1 1 1 0 1 1 1 2\n0 1 0 1 0 1 -1 1 2\n\
         4 0 1 2 3\n"
    )
}

/// The same in a scene.
const INLINE: &str = "mesh = { vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], \
                      faces = [[0, 1, 2, 3]], uvs = [[0, 0], [1, 0], [1, 1], [0, 1]], \
                      normals = [[-1, -1, 2], [1, -1, 2], [1, 1, 2], [-1, 1, 2]] }\n";

/// A scene with sky and these shapes.
fn text(shapes: &str) -> String {
    format!("[sky]\nradiance = 1\n{shapes}")
}

#[track_caller]
fn scene(shapes: &str) -> Scene {
    let folder = Folder::new()
        .with("a.obj", OBJ)
        .with("a.ply", ply(["s", "t"]))
        .with("b.ply", ply(["u", "v"]))
        .with("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        .with("s.toml", text(shapes));
    folder.scene("s.toml")
}

/// A normal from its code, by the formulas.
fn normal(mesh: &Mesh, vertex: usize) -> [f64; 3] {
    let code = mesh.normals[vertex];
    let [x, y] = [code as i16, (code >> 16) as i16].map(|c| f64::from(c) / 32767.0);
    let z = 1.0 - x.abs() - y.abs();
    let (x, y) = if z < 0.0 {
        ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y))
    } else {
        (x, y)
    };
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|c| c / length)
}

#[track_caller]
fn assert_direction(found: [f64; 3], expected: [f64; 3]) {
    let length = expected.iter().map(|c| c * c).sum::<f64>().sqrt();
    for c in 0..3 {
        // 7e-5 radians for each code: what a transformation changes is coded twice.
        assert!(
            (found[c] - expected[c] / length).abs() <= 1.4e-4,
            "{found:?} {expected:?}"
        );
    }
}

#[test]
fn all_formats_say_the_same() {
    for shape in [
        "obj = \"a.obj\"",
        "ply = \"a.ply\"",
        "ply = \"b.ply\"",
        INLINE,
    ] {
        let mesh = scene(&format!("[[shapes]]\n{shape}\n")).mesh;
        assert_eq!(mesh.indices, [[0, 1, 2], [0, 2, 3]], "{shape}");
        assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(mesh.normals.len(), 4);
        assert_direction(normal(&mesh, 2), [1.0, 1.0, 2.0]);
        assert_direction(normal(&mesh, 3), [-1.0, 1.0, 2.0]);
    }
}

#[test]
fn transforms_take_normals_along() {
    let stretched =
        "transform = [{ scale = [2, 1, 1] }, { rotate = { axis = [0, 0, 1], degrees = 90 } }]";
    let mirrored = "transform = [{ scale = [-2, 1, 1] }]";
    for shape in ["obj = \"a.obj\"", INLINE] {
        let mesh = scene(&format!("[[shapes]]\n{shape}\n{stretched}\n")).mesh;
        // (1, 1, 2) becomes (1/2, 1, 2), then turns.
        assert_direction(normal(&mesh, 2), [-1.0, 0.5, 2.0]);
        let mesh = scene(&format!("[[shapes]]\n{shape}\n{mirrored}\n")).mesh;
        assert_direction(normal(&mesh, 2), [-0.5, 1.0, 2.0]);
    }
}

#[test]
fn shapes_without_pay_nothing() {
    let plain = scene("[[shapes]]\nobj = \"plain.obj\"\n").mesh;
    assert!(plain.normals.is_empty() && plain.uvs.is_empty());
    let file = "[[shapes]]\nrectangle = { corner = [0, 0, 0], edges = [[1, 0, 0], [0, 1, 0]] }\n";
    assert!(scene(file).mesh.uvs.is_empty());
    // Behind a shape that has some, nothing is stored either; before it, that there are none.
    let after = scene("[[shapes]]\nobj = \"a.obj\"\n[[shapes]]\nobj = \"plain.obj\"\n").mesh;
    assert_eq!(
        (after.vertices.len(), after.normals.len(), after.uvs.len()),
        (7, 4, 4)
    );
    let before = scene("[[shapes]]\nobj = \"plain.obj\"\n[[shapes]]\nobj = \"a.obj\"\n").mesh;
    assert_eq!((before.normals.len(), before.uvs.len()), (7, 7));
    assert_eq!(before.normals[..3], [Mesh::NO_NORMAL; 3]);
    assert!(before.uvs[..3].as_flattened().iter().all(|x| x.is_nan()));
}

/// A folder with a white image.
fn with_image() -> Folder {
    let folder = Folder::new();
    let white = image::ImageBuffer::from_pixel(1, 1, image::Rgb([255u8; 3]));
    white.save(folder.path("white.png")).unwrap();
    folder.with("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
}

const PAPER: &str = "[materials.paper]\nalbedo = { file = \"white.png\" }\n\
                     [materials.mixed]\nkind = \"mix\"\nmaterials = [\"paper\", \"paper\"]\n";

#[test]
fn rectangles_and_boxes_with_images_have_coordinates() {
    for material in ["paper", "mixed"] {
        let shapes = format!(
            "{PAPER}[sky]\nradiance = 1\n[[shapes]]\nmaterial = \"{material}\"\n\
             rectangle = {{ corner = [0, 0, 0], edges = [[1, 0, 0], [0, 1, 0]] }}\n\
             [[shapes]]\nmaterial = \"{material}\"\nbox = {{ min = [0, 0, 2], max = [1, 1, 3] }}\n"
        );
        let scene = with_image().with("s.toml", shapes).scene("s.toml");
        assert_eq!(scene.warnings, Vec::<String>::new());
        let mesh = scene.mesh;
        assert_eq!(
            (mesh.triangles(), mesh.vertices.len(), mesh.uvs.len()),
            (14, 28, 28)
        );
        // Counter-clockwise from the front in the image too: no face shows it mirrored.
        for t in &mesh.indices {
            let [a, b, c] = t.map(|v| mesh.uvs[v as usize]);
            let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert_eq!(turn, 1.0);
        }
    }
}

#[test]
fn images_without_coordinates_are_warned_about() {
    let shapes = format!(
        "{PAPER}[sky]\nradiance = 1\n[[shapes]]\nmaterial = \"paper\"\nobj = \"plain.obj\"\n"
    );
    let scene = with_image().with("s.toml", shapes).scene("s.toml");
    assert_eq!(
        scene.warnings,
        [
            "material `paper` has images, but 1 of the triangles that wear it has no texture \
          coordinates; the image's corner is taken"
        ]
    );
}

#[test]
fn inline_attributes_of_another_number() {
    let folder = |more: &str| {
        let shape = "vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0]], faces = [[0, 1, 2]]";
        let shapes = text(&format!("[[shapes]]\nmesh = {{ {shape}, {more} }}\n"));
        Folder::new().with("s.toml", shapes).error("s.toml")
    };
    assert!(
        folder("uvs = [[0, 0]]")
            .ends_with("shapes[0].mesh.uvs: has 1 uvs, expected one for each of its 3 vertices")
    );
    assert!(folder("normals = []").ends_with(
        "shapes[0].mesh.normals: has 0 normals, expected one for each of its 3 vertices"
    ));
}
