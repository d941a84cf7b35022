//! Spheres, objects and instances in scene files: what they mean, and what is refused.

mod scene_folder;

use huygens::scene::Source;
use scene_folder::{Folder, TRIANGLE};

fn message(text: &str) -> String {
    let folder = Folder::new().with("a.obj", TRIANGLE).with("s.toml", text);
    folder.error("s.toml")
}

const OBJECT: &str = "[[objects.leaf.shapes]]\nobj = \"a.obj\"\n";

#[test]
fn objects_are_held_once_and_copied_where_instances_say() {
    let text = format!(
        "[materials.red]\n[[shapes]]\nobj = \"a.obj\"\n{OBJECT}[[objects.unused.shapes]]\n\
         box = {{ min = [0, 0, 0], max = [1, 1, 1] }}\n\
         [[instances]]\nobject = \"leaf\"\ntransform = [{{ scale = [2, 1, 1] }}, {{ translate = [0, 0, 7] }}]\n\
         [[instances]]\nobject = \"leaf\"\nmaterial = \"red\"\nscatter = {{ count = 3, corner = [0, 0, 0], edges = [[1, 0, 0], [0, 0, 1]] }}\n"
    );
    let folder = Folder::new().with("a.obj", TRIANGLE).with("s.toml", text);
    let source = Source::open(&folder.path("s.toml")).unwrap();
    let counts = source.counts().unwrap();
    assert_eq!(
        (counts.triangles, counts.vertices, counts.instances),
        (14, 14, 4)
    );
    let scene = folder.scene("s.toml");
    assert_eq!(scene.mesh.triangles(), 1);
    assert_eq!(
        (scene.stored_triangles(), scene.placed_triangles()),
        (14, 5)
    );
    let [first, rest @ ..] = &scene.instances[..] else {
        panic!("no instances");
    };
    assert_eq!(scene.objects[first.object as usize].name, "leaf");
    let at = |x, y, z| {
        first
            .placement
            .map()
            .transform_point3([x, y, z].into())
            .to_array()
    };
    assert_eq!(at(1.0, 2.0, 3.0), [2.0, 2.0, 10.0]);
    assert_eq!(first.material, None);
    assert_eq!(rest.len(), 3);
    let red = scene
        .materials
        .iter()
        .position(|m| m.name == "red")
        .unwrap();
    for copy in rest {
        assert_eq!(copy.material, Some(red as u32));
        let [x, y, z] = copy.placement.origin;
        assert!((0.0..1.0).contains(&x) && y == 0.0 && (0.0..1.0).contains(&z));
    }
    // The camera frames copies too.
    let [low, high] = scene.bounds().unwrap();
    assert!(low.z <= 0.0 && high.z == 7.0);
}

#[test]
fn spheres_are_placed_turned_and_evenly_scaled() {
    let folder = Folder::new().with(
        "s.toml",
        "[[shapes]]\nsphere = { center = [1, 0, 0], radius = 0.5 }\n\
         transform = [{ scale = [2, -2, 2] }, { rotate = { axis = [1, 2, 3], degrees = 360 } }, { translate = [0, 3, 0] }]\n",
    );
    let scene = folder.scene("s.toml");
    assert_eq!(scene.spheres.len(), 1);
    assert_eq!(scene.spheres[0].centre, [2.0, 3.0, 0.0]);
    assert_eq!(scene.spheres[0].radius, 1.0);
    assert!(scene.mesh.indices.is_empty());
    assert_eq!(
        scene.materials[scene.spheres[0].material as usize].name,
        "default"
    );
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let sphere = |rest: &str| message(&format!("[[shapes]]\nsphere = {rest}\n"));
    let uneven = "{ center = [0, 0, 0], radius = 1 }\ntransform = [{ scale = [1, 1, 2] }]";
    assert_eq!(
        sphere(uneven),
        "s.toml:1:1: shapes[0]: a sphere can be scaled, but not differently along different axes"
    );
    let flat = sphere("{ center = [0, 0, 0], radius = 0 }");
    assert!(
        flat.starts_with("s.toml:2:41: shapes[0].sphere.radius: found 0, expected "),
        "{flat}"
    );
    let huge = "{ center = [0, 0, 0], radius = 1e30 }\ntransform = [{ scale = 1e30 }]";
    assert_eq!(
        sphere(huge),
        "s.toml:1:1: shapes[0]: the sphere lies beyond the range of 32-bit floats"
    );

    let instance = |rest: &str| message(&format!("{OBJECT}[[instances]]\n{rest}\n"));
    assert_eq!(
        instance("object = \"leav\""),
        "s.toml:4:10: instances[0].object: no object `leav`, did you mean `leaf`?"
    );
    assert_eq!(
        instance("object = \"leaf\"\nmaterial = \"x\""),
        "s.toml:5:12: instances[0].material: no material `x`, expected none"
    );
    assert_eq!(
        instance("object = \"leaf\"\ntransform = [{ scale = [1, 0, 1] }]"),
        "s.toml:5:13: instances[0].transform: the transformation is singular: it flattens the shape"
    );
    let tiny = instance("object = \"leaf\"\ntransform = [{ scale = 1e-30 }]");
    assert!(
        tiny.starts_with("s.toml:3:1: instances[0]: an instance is scaled by 1.000e-30, expected "),
        "{tiny}"
    );
    let edges = "corner = [0, 0, 0], edges = [[1, 0, 0], [0, 0, 1]]";
    assert_eq!(
        instance(&format!(
            "object = \"leaf\"\nscatter = {{ count = 2, scale = [2, 1], {edges} }}"
        )),
        "s.toml:3:1: instances[0]: scatter: scale: found [2, 1], expected the smaller first"
    );
    assert_eq!(
        instance(&format!(
            "object = \"leaf\"\nscatter = {{ count = 67108865, {edges} }}"
        )),
        "s.toml:3:1: instances[0]: the scene has 67108865 instances, expected at most 67108864"
    );
    assert_eq!(
        message("[objects.o]\nshapes = []\n[[instances]]\nobject = \"o\"\n"),
        "s.toml:4:10: instances[0].object: object `o` has no shapes"
    );
    assert_eq!(
        message("[[objects.o.shapes]]\nsphere = { center = [0, 0, 0], radius = 1 }\n"),
        "s.toml:1:1: objects.o.shapes[0]: an object holds triangles, expected the sphere among \
         `shapes`"
    );
    assert_eq!(
        message(&format!(
            "[materials.lamp]\nemission = 1\n{OBJECT}material = \"lamp\"\n[[instances]]\nobject = \"leaf\"\n"
        )),
        "s.toml:7:10: instances[0].object: material `lamp` of object `leaf` emits, which instances \
         cannot yet, expected the light among `shapes`"
    );
    // 110 triangles 40 million times is more than can be numbered.
    let fan: Vec<String> = (0..112).map(|i| i.to_string()).collect();
    let corners: Vec<String> = (0..112).map(|i| format!("[{i}, {}, 0]", i * i)).collect();
    let many = message(&format!(
        "[[objects.o.shapes]]\nmesh = {{ vertices = [{}], faces = [[{}]] }}\n[[instances]]\n\
         object = \"o\"\nscatter = {{ count = 40000000, {edges} }}\n",
        corners.join(", "),
        fan.join(", ")
    ));
    assert_eq!(
        many,
        "s.toml:4:10: instances[0].object: the scene has 4400000000 triangles and spheres, those of \
         instances counted as often as they are copied, expected at most 4294967294"
    );
}
