//! What is wrong with a scene file is said in one line: place, what was found, what was expected.

mod scene_folder;

use scene_folder::{Folder, TRIANGLE};

/// The message for a scene of this text, without the folder's name.
#[track_caller]
fn message(scene: &str) -> String {
    Folder::new().with("s.toml", scene).error("s.toml")
}

/// The warnings of a scene of this text.
#[track_caller]
fn warnings(scene: &str) -> Vec<String> {
    Folder::new().with("s.toml", scene).scene("s.toml").warnings
}

#[test]
fn missing_file() {
    let folder = Folder::new();
    assert_eq!(folder.error("none.toml"), "none.toml: no such file");
    assert_eq!(folder.error("none.obj"), "none.obj: no such file");
}

#[test]
fn unknown_kind_of_file() {
    assert_eq!(
        Folder::new().with("s.blend", "").error("s.blend"),
        "s.blend: expected a scene: a `.toml`, an `.obj` or a `.ply` file"
    );
}

#[test]
fn folder_in_place_of_a_file() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("s.toml")).unwrap();
    assert_eq!(
        folder.error("s.toml"),
        "s.toml: is a folder, expected a file"
    );
}

#[test]
fn text_that_is_not_utf_8() {
    let folder = Folder::new().with("s.toml", b"name = \"\xff\"");
    assert_eq!(folder.error("s.toml"), "s.toml: not valid UTF-8 text");
}

#[test]
fn broken_toml() {
    assert_eq!(
        message("name = \"x\"\n[film]\nwidth = = 3\n"),
        "s.toml:3:9: not valid TOML: extra `=`, expected nothing"
    );
    assert_eq!(
        message("[film]\nwidth = 3\nwidth = 4\n"),
        "s.toml:3:1: not valid TOML: duplicate key"
    );
    assert_eq!(
        message(&format!("a = {}", "[".repeat(100_000))),
        "s.toml:1:85: not valid TOML: cannot recurse further; max recursion depth met"
    );
}

#[test]
fn unknown_key_with_a_suggestion() {
    assert_eq!(
        message("[film]\nwidht = 640\n"),
        "s.toml:2:1: unknown key `widht` in `film`, did you mean `width`?"
    );
    assert_eq!(
        message("[[shapes]]\nbox = { min = [0, 0, 0], max = [1, 1, 1], inwrd = true }\n"),
        "s.toml:2:43: unknown key `inwrd` in `shapes[0].box`, did you mean `inward`?"
    );
    assert_eq!(
        message("flim = 3\n"),
        "s.toml:1:1: unknown key `flim`, did you mean `film`?"
    );
}

#[test]
fn unknown_key_like_no_other() {
    assert_eq!(
        message("[film]\nwavelength = 0.1\n"),
        "s.toml:2:1: unknown key `wavelength` in `film`, \
         expected `width`, `height` or `filter`"
    );
}

#[test]
fn unknown_value_with_a_suggestion() {
    assert_eq!(
        message("[film]\nfilter = \"gausian\"\n"),
        "s.toml:2:10: film.filter: unknown value `gausian`, did you mean `gaussian`?"
    );
}

#[test]
fn missing_key() {
    assert_eq!(
        message("[sky]\n"),
        "s.toml:1:1: sky: expected exactly one of `radiance`, `map` and `sun`"
    );
}

#[test]
fn zero_size_film() {
    assert_eq!(
        message("[film]\nwidth = 0\n"),
        "s.toml:2:9: film.width: found 0, \
         expected a whole number from 1 to 65535"
    );
    assert_eq!(
        message("[film]\nheight = 65536\n"),
        "s.toml:2:10: film.height: found 65536, \
         expected a whole number from 1 to 65535"
    );
}

#[test]
fn negative_spp() {
    assert_eq!(
        message("[settings]\nspp = -4\n"),
        "s.toml:2:7: settings.spp: found -4, \
         expected a whole number from 1 to 4294967295"
    );
}

#[test]
fn wrong_type() {
    assert_eq!(
        message("[film]\nwidth = \"wide\"\n"),
        "s.toml:2:9: film.width: found string \"wide\", \
         expected a whole number from 1 to 65535"
    );
    assert_eq!(
        message("[camera]\norigin = [1, 2]\n"),
        "s.toml:2:10: camera.origin: found an array of length 2, expected an array of length 3"
    );
    assert_eq!(
        message("sky = 3\n"),
        "s.toml:1:7: sky: found integer `3`, \
         expected a table such as { radiance = 1 }"
    );
}

#[test]
fn numbers_that_are_not_finite() {
    assert_eq!(
        message("[camera]\norigin = [0, nan, 0]\ntarget = [0, 0, 1]\n"),
        "s.toml:2:14: camera.origin: found NaN, \
         expected a finite number"
    );
    // Finite in the file, but not in the kernels' 32 bits.
    assert_eq!(
        message("[materials.a]\nemission = [1, 2, 1e39]\n"),
        "s.toml:2:19: materials.a.emission: \
         found 1e39, expected a finite number of at least 0"
    );
}

#[test]
fn albedo_above_one_and_negative_emission() {
    assert_eq!(
        message("[materials.a]\nalbedo = [0.5, 1.5, 0.5]\n"),
        "s.toml:2:16: materials.a.albedo: found 1.5, \
         expected a number from 0 to 1"
    );
    assert_eq!(
        message("[materials.a]\nemission = -1\n"),
        "s.toml:2:12: materials.a.emission: found -1, \
         expected a finite number of at least 0"
    );
}

#[test]
fn camera_along_its_up_vector() {
    assert_eq!(
        message("[camera]\norigin = [0, 5, 0]\ntarget = [0, 0, 0]\nup = [0, 2, 0]\n"),
        "s.toml:4:6: camera.up: the camera looks along its up vector [0.0, 2.0, 0.0], expected another"
    );
    // Parallel but for the rounding of decimals.
    assert_eq!(
        message("[camera]\norigin = [0, 0, 0]\ntarget = [0.1, 0.2, 0.3]\nup = [0.7, 1.4, 2.1]\n"),
        "s.toml:4:6: camera.up: the camera looks along its up vector [0.7, 1.4, 2.1], \
         expected another"
    );
}

#[test]
fn camera_of_no_direction() {
    assert_eq!(
        message("[camera]\norigin = [1, 2, 3]\ntarget = [1, 2, 3]\n"),
        "s.toml:3:10: camera.target: target and origin are the same point, expected two"
    );
    assert_eq!(
        message("[camera]\ntarget = [1, 2, 3]\n"),
        "s.toml:1:1: camera: expected either `origin` and `target` (and `up`) or `matrix`"
    );
    assert_eq!(
        message("[camera]\nfov = 180\n"),
        "s.toml:2:7: camera.fov: found 180, \
         expected an angle above 0 and below 180 degrees"
    );
}

#[test]
fn camera_matrix() {
    let matrix = |rows: &str| message(&format!("[camera]\nmatrix = [{rows}]\n"));
    assert_eq!(
        matrix("[1,0,0,0],[0,1,0,0],[0,0,0,0],[0,0,0,1]"),
        "s.toml:2:10: camera.matrix: the camera's matrix is singular"
    );
    assert_eq!(
        matrix("[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]"),
        "s.toml:2:10: camera.matrix: the camera's matrix mirrors, \
         expected right, up and back columns"
    );
    assert_eq!(
        matrix("[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,6,7,1]"),
        "s.toml:2:10: camera.matrix: the last row is [5.0, 6.0, 7.0, 1.0], \
         expected [0, 0, 0, 1]: a matrix multiplies column vectors"
    );
}

#[test]
fn transform_that_flattens() {
    let shape = "[[shapes]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\ntransform = ";
    assert_eq!(
        message(&format!("{shape}[{{ scale = [1, 0, 1] }}]\n")),
        "s.toml:3:13: shapes[0].transform: the transformation is singular: it flattens the shape"
    );
    // Rows that depend on each other, but whose determinant in f64 is 1e-16 and not 0.
    assert_eq!(
        message(&format!(
            "{shape}[[0.1,0.2,0.3,0],[0.4,0.5,0.6,0],[0.7,0.8,0.9,0],[0,0,0,1]]\n"
        )),
        "s.toml:3:13: shapes[0].transform: the transformation is singular: it flattens the shape"
    );
    assert_eq!(
        message(&format!(
            "{shape}[{{ scale = 2, translate = [1, 2, 3] }}]\n"
        )),
        "s.toml:3:13: shapes[0].transform: \
         a step takes exactly one of `scale`, `rotate` or `translate`"
    );
    assert_eq!(
        message(&format!(
            "{shape}[{{ scale = 1e30 }}, {{ scale = 1e30 }}]\n"
        )),
        "s.toml:1:1: shapes[0]: a vertex lies beyond the range of 32-bit floats"
    );
}

#[test]
fn shape_of_no_kind_or_of_two() {
    let expected = "s.toml:1:1: shapes[0]: expected exactly one of `obj`, `ply`, `rectangle`, `box`, `mesh` \
         or `sphere`";
    assert_eq!(message("[[shapes]]\n"), expected);
    let two = "[[shapes]]\nobj = \"a.obj\"\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n";
    assert_eq!(message(two), expected);
}

#[test]
fn inline_mesh_with_a_bad_index() {
    assert_eq!(
        message("[[shapes]]\n[shapes.mesh]\nvertices = [[0, 0, 0]]\nfaces = [[0, 1, 2]]\n"),
        "s.toml:4:10: shapes[0].mesh.faces: a face has vertex index 1, \
         expected one of the 1 vertices, from 0"
    );
}

#[test]
fn a_light_without_area() {
    assert_eq!(
        message(
            "[materials.lamp]\nemission = 5\n[[shapes]]\nmaterial = \"lamp\"\n\
             rectangle = { corner = [0, 0, 0], edges = [[1, 0, 0], [2, 0, 0]] }\n"
        ),
        "s.toml:3:1: shapes[0]: a rectangle without area, expected edges in two directions"
    );
    assert_eq!(
        message(
            "[materials.lamp]\nemission = 5\n[[shapes]]\nmaterial = \"lamp\"\n\
             sphere = { center = [0, 0, 0], radius = 0 }\n"
        ),
        "s.toml:5:41: shapes[0].sphere.radius: found 0, expected a finite number above 0"
    );
}

#[test]
fn unknown_material() {
    assert_eq!(
        message(
            "[materials.white]\n[[shapes]]\nmaterial = \"whit\"\n\
             box = { min = [0, 0, 0], max = [1, 1, 1] }\n"
        ),
        "s.toml:3:12: shapes[0].material: no material `whit`, did you mean `white`?"
    );
}

#[test]
fn file_that_a_scene_names_is_missing() {
    assert_eq!(
        message("[[shapes]]\nobj = \"models/a.obj\"\n"),
        "s.toml:2:7: shapes[0].obj: models/a.obj: no such file"
    );
}

#[test]
fn material_that_the_obj_does_not_have() {
    let scene = "[materials.x]\n[[shapes]]\nobj = \"a.obj\"\nmaterials = { sead = \"x\" }\n";
    let folder = Folder::new()
        .with("s.toml", scene)
        .with("a.obj", format!("usemtl seat\n{TRIANGLE}"));
    assert_eq!(
        folder.error("s.toml"),
        "s.toml:4:15: shapes[0].materials.sead: a.obj has no material `sead`, \
         did you mean `seat`?"
    );
}

#[test]
fn no_light_warns() {
    assert_eq!(
        warnings("[[shapes]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n"),
        ["no light: neither a sky nor a surface emits, so the image will be black"]
    );
    // Nobody is lit where light plays no part.
    let quick = "[settings]\nintegrator = \"normals\"\n\
                 [[shapes]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n";
    assert_eq!(warnings(quick), [""; 0]);
}

#[test]
fn no_shapes_warns() {
    assert_eq!(
        warnings("[sky]\nradiance = 1\n"),
        ["no shapes: the camera sees nothing but the sky"]
    );
}

#[test]
fn the_report_shows_the_place() {
    let folder = Folder::new().with("s.toml", "[film]\nwidht = 640\n");
    let error = huygens::scene::load(&folder.path("s.toml")).unwrap_err();
    let mut report = String::new();
    miette::NarratableReportHandler::new()
        .render_report(&mut report, &error)
        .unwrap();
    assert!(report.contains("widht = 640"), "{report}");
    assert_eq!(error.line_number(), Some(2));
}
