//! The generated forest is a scene, and its tree stands where copies are put.

mod scene_folder;

use huygens::throughput::forest;
use scene_folder::{Folder, TRIANGLE};

#[test]
fn a_tree_has_as_many_triangles_as_asked_and_stands_on_the_ground() {
    let mut low = f32::INFINITY;
    let mut count = 0;
    forest::tree(5000, |corners| {
        low = corners.iter().fold(low, |low, c| low.min(c[1]));
        assert!(corners.as_flattened().iter().all(|c| c.abs() < 12.0));
        count += 1;
        Ok(())
    })
    .unwrap();
    assert_eq!((count, low), (5000, 0.0));
}

#[test]
fn the_scene_of_it_is_right() {
    let text = forest::scene(400).replace("ply = \"tree.ply\"", "obj = \"a.obj\"");
    let folder = Folder::new().with("a.obj", TRIANGLE).with("s.toml", text);
    let scene = folder.scene("s.toml");
    assert_eq!(scene.instances.len(), 400);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    // 20 x 20 trees, ten units apart.
    for copy in &scene.instances {
        let [x, y, z] = copy.placement.origin;
        assert!(x.abs() <= 100.0 && y == 0.0 && z.abs() <= 100.0);
    }
}
