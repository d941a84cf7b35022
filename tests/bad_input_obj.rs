//! What is wrong with an OBJ or MTL file is said with its line, and what is merely odd is read.

mod scene_folder;

use scene_folder::{Folder, TRIANGLE};

/// The message for an OBJ file of this text.
#[track_caller]
fn message(obj: impl AsRef<[u8]>) -> String {
    Folder::new().with("a.obj", obj).error("a.obj")
}

/// The triangles of an OBJ file of this text, and its warnings.
#[track_caller]
fn read(obj: impl AsRef<[u8]>) -> (Vec<[[f32; 3]; 3]>, Vec<String>) {
    let scene = Folder::new().with("a.obj", obj).scene("a.obj");
    let triangles = (0..scene.mesh.triangles()).map(|i| scene.mesh.corners(i));
    (triangles.collect(), scene.warnings)
}

const NO_WARNINGS: [&str; 0] = [];

#[test]
fn bad_indices() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let face = |f: &str| message(format!("# a comment\n{vertices}{f}\n"));
    assert_eq!(
        face("f 1 2 4"),
        "a.obj:5: a face has vertex index 4, expected one of the 3 vertices of the file"
    );
    assert_eq!(
        face("f 0 1 2"),
        "a.obj:5: a face has vertex index 0, expected indices from 1"
    );
    assert_eq!(
        face("f -1 -2 -4"),
        "a.obj:5: a face has vertex index -4, with only 3 vertices before it"
    );
    assert_eq!(
        face("f 1 2 x/1"),
        "a.obj:5: a face has vertex index `x/1`, expected a whole number"
    );
    assert_eq!(
        face("f 1 2 9999999999999999999999"),
        "a.obj:5: a face has vertex index `9999999999999999999999`, expected a whole number"
    );
    assert_eq!(
        face("f 1 2 -9223372036854775808"),
        "a.obj:5: a face has vertex index -9223372036854775808, with only 3 vertices before it"
    );
}

#[test]
fn vertices_that_are_not_finite() {
    for bad in ["nan", "inf", "-inf", "1e39", "0x1", "1,5"] {
        let text = format!("v 0 0 0\n\nv 1 {bad} 0 # second\nv 0 1 0\nf 1 2 3\n");
        assert_eq!(
            message(text),
            format!("a.obj:3: vertex 2 has coordinate `{bad}`, expected a finite number")
        );
    }
    assert_eq!(
        message("v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        "a.obj:1: vertex 1 has 2 coordinates, expected 3"
    );
}

#[test]
fn no_faces() {
    let expected = "a.obj: has no faces, expected at least one";
    assert_eq!(message(""), expected);
    assert_eq!(message("v 0 0 0\nv 1 0 0\nl 1 2\np 1\n"), expected);
    assert_eq!(message("v 0 0 0\nv 1 0 0\nf 1 2\n"), expected);
}

#[test]
fn utf_16() {
    assert_eq!(
        message(b"\xff\xfev\0 \x000\0"),
        "a.obj: is UTF-16 text, expected UTF-8"
    );
}

#[test]
fn missing_mtl_is_grey() {
    let obj = format!("mtllib none.mtl\nusemtl red\n{TRIANGLE}");
    let scene = Folder::new().with("a.obj", obj).scene("a.obj");
    assert_eq!(
        scene.warnings,
        ["a.obj:1: material library none.mtl: no such file; its materials are taken as grey"]
    );
    assert_eq!(scene.materials[0].name, "red");
    assert_eq!(scene.materials[0].albedo(&scene.materials), [0.5; 3]);
}

#[test]
fn material_in_no_library_is_grey() {
    let obj = format!("usemtl red\n{TRIANGLE}usemtl blue\nf 1 2 3\nusemtl unused\n");
    let (_, warnings) = read(obj);
    assert_eq!(
        warnings,
        ["a.obj: material `red` and 1 more are in no MTL file; taken as grey"]
    );
}

#[test]
fn materials_of_an_mtl() {
    let mtl = "newmtl lamp # named\nKd 0.25\nKe 1 2 3\nmap_Kd -o 1 2 3 a b.png\n\
               newmtl lead crystal\n  Kd 0.5 1.5 -0.5\n\td 0.5\nillum 7\nNs nonsense\n\
               newmtl unused\nmap_Kd c.png\n\
               newmtl odd\nKd\nKe spectral lamp.rfl\n";
    let obj = format!(
        "mtllib my lib.mtl\nusemtl lamp\n{TRIANGLE}usemtl lead crystal\nf 3 2 1\n\
         usemtl odd\nf 1 3 2\n"
    );
    let folder = Folder::new().with("a.obj", obj).with("my lib.mtl", mtl);
    let scene = folder.scene("a.obj");
    let colours: Vec<_> = scene
        .materials
        .iter()
        .map(|m| (m.name.as_str(), m.albedo(&[]), m.emission.factor))
        .collect();
    assert_eq!(
        colours,
        [
            ("lamp", [0.25; 3], [1.0, 2.0, 3.0]),
            ("lead crystal", [1.0; 3], [0.0; 3]),
            ("odd", [0.5; 3], [0.0; 3]),
        ]
    );
    assert_eq!(scene.mesh.material, [0, 1, 2]);
    assert_eq!(scene.sky, None, "it brings its own light");
    assert_eq!(
        scene.warnings,
        [
            "my lib.mtl: Kd out of its range was clamped (material `lead crystal`)",
            "my lib.mtl: Kd that is not one or three finite numbers was left out (material `odd`)",
            "my lib.mtl: Ke that is not one or three finite numbers was left out (material `odd`)",
            "my lib.mtl: Ns that is no finite number was left out (material `lead crystal`)",
            "a b.png: no such file; material `lamp` goes without its albedo",
        ]
    );
}

#[test]
fn odd_but_right() {
    let expected = read(TRIANGLE).0;
    for (why, obj) in [
        (
            "continued lines",
            "v 0 0 0\nv 1 \\\n0 0\nv 0 1 0\nf 1 \\\n 2 \\\n3\n",
        ),
        ("comments", "v 0 0 0 # a\nv 1 0 0\nv 0 1 0\nf 1 2 3 # b\n"),
        (
            "Windows line ends",
            "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
        ),
        (
            "byte order mark",
            "\u{feff}v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3",
        ),
        ("face first", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        ("relative", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n"),
        (
            "colours and weights",
            "v 0 0 0 1 1 1\nv 1 0 0 0\nv 0 1 0 1 1\nf 1 2 3\n",
        ),
        ("blanks", "\tv   0 0\t0\nv 1 0 0 \n v 0 1 0\nf  1  2 3\t\n"),
        (
            "groups",
            "o a\ng b\ns 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng c\nf 1 2 3\n",
        ),
    ] {
        assert_eq!(read(obj), (expected.clone(), Vec::new()), "{why}");
    }
    let nothing = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/7/-9 2/7 3//0\n");
    let warning = "a.obj: indices of no texture coordinates or normal: 2 left out";
    assert_eq!(nothing, (expected.clone(), vec![warning.to_owned()]));
    let latin = read(b"# caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(latin, (expected, Vec::new()));
}

#[test]
fn lines_are_not_taken_for_faces() {
    let (triangles, warnings) = read(format!("{TRIANGLE}l 1 2 3\np 1 2 3\n"));
    assert_eq!(triangles.len(), 1);
    assert_eq!(warnings, NO_WARNINGS);
}

#[test]
fn what_has_no_area_is_left_out() {
    let (triangles, warnings) = read(format!("{TRIANGLE}f 1 1 2\nf 1 2 2 1\nf 1 2\n"));
    assert_eq!(triangles.len(), 1);
    assert_eq!(
        warnings,
        [
            "a.obj: faces with fewer than three corners: 1 left out",
            "triangles of zero area: 3 left out",
        ]
    );
}

#[test]
fn concave_faces_keep_their_shape() {
    // An arrow head of area 6 (in the plane z = 0), whose fan from its first corner has area 8.
    let (triangles, _) = read("v 4 2 0\nv 0 0 0\nv 4 -2 0\nv 1 0 0\nf 1 2 3 4\n");
    let area = |[a, b, c]: [[f32; 3]; 3]| {
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    };
    let areas: Vec<f32> = triangles.into_iter().map(area).collect();
    assert_eq!(areas, [1.0, 1.0]);
}
