//! What is wrong with a PLY file is said with the vertex or face, and what is merely odd is read.

mod scene_folder;

use scene_folder::Folder;

const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
                      property float z\nelement face 2\n\
                      property list uchar int vertex_indices\nend_header\n";
const VERTICES: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

/// The message for a PLY file of this text.
#[track_caller]
fn message(ply: impl AsRef<[u8]>) -> String {
    Folder::new().with("a.ply", ply).error("a.ply")
}

/// The triangles of a PLY file of this text, and its warnings.
#[track_caller]
fn read(ply: impl AsRef<[u8]>) -> (Vec<[[f32; 3]; 3]>, Vec<String>) {
    let scene = Folder::new().with("a.ply", ply).scene("a.ply");
    let triangles = (0..scene.mesh.triangles()).map(|i| scene.mesh.corners(i));
    (triangles.collect(), scene.warnings)
}

/// Two triangles as a file in binary, little or big endian.
fn binary(big: bool) -> Vec<u8> {
    let kind = if big { "big" } else { "little" };
    let mut file = HEADER
        .replace("ascii", &format!("binary_{kind}_endian"))
        .into_bytes();
    let mut put = |bytes: [u8; 4]| {
        let ordered = if big {
            bytes
        } else {
            [3, 2, 1, 0].map(|i| bytes[i])
        };
        file.extend(ordered);
    };
    for v in [
        [0.0f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ] {
        v.iter().for_each(|x| put(x.to_be_bytes()));
    }
    for t in [[0i32, 1, 2], [0, 2, 3]] {
        file.push(3);
        for i in t {
            let bytes = i.to_be_bytes();
            file.extend(if big {
                bytes
            } else {
                [3, 2, 1, 0].map(|i| bytes[i])
            });
        }
    }
    file
}

#[test]
fn the_three_encodings_hold_the_same() {
    let ascii = read(format!("{HEADER}{VERTICES}3 0 1 2\n3 0 2 3\n"));
    assert_eq!(ascii.0.len(), 2);
    assert_eq!(ascii.0[1], [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(read(binary(false)), ascii);
    assert_eq!(read(binary(true)), ascii);
}

#[test]
fn bad_indices() {
    let face = |face: &str| message(format!("{HEADER}{VERTICES}3 0 1 2\n{face}\n"));
    assert_eq!(
        face("3 0 1 4"),
        "a.ply: face 1 has vertex index 4, expected one of the 4 vertices, from 0"
    );
    assert_eq!(
        face("3 -1 1 2"),
        "a.ply: face 1 has vertex index -1, expected one of the 4 vertices, from 0"
    );
    assert_eq!(
        face("3 0 1 x"),
        "a.ply: face 1: failed to parse i32 from ASCII"
    );
    let mut file = binary(false);
    let end = file.len();
    file[end - 4..].copy_from_slice(&77u32.to_le_bytes());
    assert_eq!(
        message(file),
        "a.ply: face 1 has vertex index 77, expected one of the 4 vertices, from 0"
    );
}

#[test]
fn vertices_that_are_not_finite() {
    for (bad, shown) in [("nan", "NaN"), ("-inf", "-inf"), ("1e39", "inf")] {
        let text = format!("{HEADER}0 0 0\n1 {bad} 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
        assert_eq!(
            message(text),
            format!("a.ply: vertex 1 has coordinate {shown}, expected a finite number")
        );
    }
    let mut file = binary(true);
    let at = HEADER.len() + "binary_big_endian".len() - "ascii".len() + 12;
    file[at..at + 4].copy_from_slice(&f32::NAN.to_be_bytes());
    assert_eq!(
        message(file),
        "a.ply: vertex 1 has coordinate NaN, expected a finite number"
    );
    let double = HEADER.replace("float x", "double x");
    assert_eq!(
        message(format!(
            "{double}0 0 0\n1 0 0\n1e39 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"
        )),
        "a.ply: vertex 2 has coordinate 1e39, expected a finite number"
    );
}

#[test]
fn cut_off_anywhere_it_is_refused() {
    for whole in [
        format!("{HEADER}{VERTICES}3 0 1 2\n3 0 2 3").into_bytes(),
        binary(false),
        binary(true),
    ] {
        for end in 0..whole.len() {
            let message = message(&whole[..end]);
            assert!(message.starts_with("a.ply: "), "{end}: {message}");
        }
    }
    let file = binary(false);
    let end = file.len();
    assert_eq!(
        message(&file[..end - 1]),
        "a.ply: ends early: face 1 is not whole"
    );
    assert_eq!(
        message(&file[..end - 27]),
        "a.ply: ends early: vertex 3 is not whole"
    );
    assert_eq!(
        message(format!("{HEADER}{VERTICES}3 0 1 2\n")),
        "a.ply: ends early: face 1 is not whole"
    );
}

#[test]
fn no_faces() {
    let expected = "a.ply: has no faces, expected at least one";
    assert_eq!(
        message(HEADER.replace("face 2", "face 0") + VERTICES),
        expected
    );
    let points = HEADER.replace(
        "element face 2\nproperty list uchar int vertex_indices\n",
        "",
    );
    assert_eq!(message(points + VERTICES), expected);
    assert_eq!(message(format!("{HEADER}{VERTICES}2 0 1\n1 2\n")), expected);
}

#[test]
fn headers_that_are_wrong() {
    for (why, ply, expected) in [
        (
            "another kind of file",
            "solid cube\n".to_owned(),
            "is not a PLY file, expected `ply` in its first line",
        ),
        (
            "no end",
            HEADER.replace("end_header", "end"),
            "not a valid PLY header: no end, expected a line `end_header`",
        ),
        (
            "format",
            HEADER.replace("ascii", "morse"),
            "not a valid PLY header: unknown format: morse",
        ),
        (
            "count",
            HEADER.replace("vertex 4", "vertex -4"),
            "not a valid PLY header: invalid element count: -4",
        ),
        (
            "type",
            HEADER.replace("float x", "real x"),
            "not a valid PLY header: unknown scalar type: real",
        ),
        (
            "no z",
            HEADER.replace("float z", "float w"),
            "has no vertex property `z`, expected x, y and z",
        ),
        (
            "a list for a coordinate",
            HEADER.replace("float y", "list uchar float y"),
            "vertex property `y` is a list, expected a number",
        ),
        (
            "no corners",
            HEADER.replace("vertex_indices", "corners"),
            "has no face property `vertex_indices`, expected the corners of each face",
        ),
        (
            "corners that are fractions",
            HEADER.replace("uchar int", "uchar float"),
            "face property `vertex_indices` is not a list of whole numbers, expected vertex indices",
        ),
        (
            "twice",
            HEADER.replace(
                "end_header",
                "element vertex 4\nproperty float x\nend_header",
            ),
            "has two elements `vertex`, expected one",
        ),
    ] {
        let message = message(ply + VERTICES);
        assert_eq!(message, format!("a.ply: {expected}"), "{why}");
    }
}

/// Counts that no memory could hold are not believed.
#[test]
fn a_header_that_promises_too_much() {
    let many = HEADER.replace("vertex 4", "vertex 18446744073709551615");
    assert_eq!(
        message(many.clone() + "0 0 0\n"),
        "a.ply: ends early: vertex 1 is not whole"
    );
    let binary = many.replace("ascii", "binary_little_endian");
    assert_eq!(message(binary), "a.ply: ends early: vertex 0 is not whole");
    let list = HEADER.replace("uchar int", "uint int");
    assert_eq!(
        message(format!("{list}{VERTICES}4294967295 0 1 2\n")),
        "a.ply: ends early: face 0 is not whole"
    );
}

#[test]
fn odd_but_right() {
    let expected = read(format!("{HEADER}{VERTICES}3 0 1 2\n3 0 2 3\n")).0;
    let faces = "3 0 1 2\n3 0 2 3\n";
    for (why, ply) in [
        (
            "no last line end",
            format!("{HEADER}{VERTICES}3 0 1 2\n3 0 2 3"),
        ),
        (
            "Windows line ends",
            format!("{HEADER}{VERTICES}{faces}").replace('\n', "\r\n"),
        ),
        (
            "comments",
            HEADER.replace("element", "comment element\nobj_info x\nelement") + VERTICES + faces,
        ),
        (
            "the other name",
            HEADER.replace("vertex_indices", "vertex_index") + VERTICES + faces,
        ),
        (
            "a quad",
            HEADER.replace("face 2", "face 1") + VERTICES + "4 0 1 2 3\n",
        ),
        (
            "an unused vertex",
            HEADER.replace("vertex 4", "vertex 5") + VERTICES + "9 9 9\n" + faces,
        ),
        (
            "other types, properties and elements",
            "ply\nformat ascii 1.0\nelement camera 1\nproperty list uchar float view\n\
             element vertex 4\nproperty uchar red\nproperty double z\nproperty short y\n\
             property int x\nelement face 2\nproperty list uchar float texcoord\n\
             property list ushort uint vertex_indices\nproperty uchar flags\n\
             element edge 1\nproperty int v\nend_header\n2 0 1\n9 0 0 0\n9 0 0 1\n9 0 1 1\n\
             9 0 1 0\n1 0.5 3 0 1 2 7\n0 3 0 2 3 7\n5\n"
                .to_owned(),
        ),
        (
            "faces first",
            "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n\
             element vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n\
             4 0 1 2 3\n"
                .to_owned()
                + VERTICES,
        ),
    ] {
        assert_eq!(read(ply), (expected.clone(), Vec::new()), "{why}");
    }
}

#[test]
fn what_has_no_area_is_left_out() {
    let header = HEADER.replace("face 2", "face 3");
    let (triangles, warnings) = read(format!("{header}{VERTICES}3 0 1 2\n3 0 0 2\n2 1 2\n"));
    assert_eq!(triangles.len(), 1);
    assert_eq!(
        warnings,
        [
            "a.ply: faces with fewer than three corners: 1 left out",
            "triangles of zero area: 1 left out",
        ]
    );
}

#[test]
fn concave_faces_keep_their_shape() {
    // An arrow head of area 6 (in the plane z = 0), whose fan from its first corner has area 8.
    let header = HEADER.replace("face 2", "face 1");
    let (triangles, _) = read(header + "4 2 0\n0 0 0\n4 -2 0\n1 0 0\n4 0 1 2 3\n");
    let area = |[a, b, c]: [[f32; 3]; 3]| {
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    };
    let areas: Vec<f32> = triangles.into_iter().map(area).collect();
    assert_eq!(areas, [1.0, 1.0]);
}

#[test]
fn in_a_scene_it_is_a_shape() {
    let scene = "[materials.red]\nalbedo = [1, 0, 0]\n[[shapes]]\nply = \"a.ply\"\n\
                 material = \"red\"\n[[shapes]]\nply = \"a.ply\"\n\
                 transform = [{ translate = [0, 0, 5] }]\n[sky]\nradiance = 1\n";
    let folder = Folder::new()
        .with("s.toml", scene)
        .with("a.ply", binary(true));
    let scene = folder.scene("s.toml");
    assert_eq!(scene.mesh.triangles(), 4);
    assert_eq!(scene.mesh.material, [0, 0, 1, 1]);
    assert_eq!(scene.materials[1].albedo(&[]), [0.5; 3]);
    assert_eq!(scene.mesh.corners(3)[1], [1.0, 1.0, 5.0]);

    let renamed = "[materials.red]\n[[shapes]]\nply = \"a.ply\"\nmaterials = { a = \"red\" }\n";
    let folder = folder.with("r.toml", renamed);
    assert_eq!(
        folder.error("r.toml"),
        "r.toml:4:15: shapes[0].materials.a: `materials` renames those of an `obj`, expected \
         `material`"
    );
    let missing = folder.with("m.toml", "[[shapes]]\nply = \"none.ply\"\n");
    assert_eq!(
        missing.error("m.toml"),
        "m.toml:2:7: shapes[0].ply: none.ply: no such file"
    );
}
