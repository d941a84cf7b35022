//! The scenes that ship load without a warning, and a bare OBJ is framed and lit.

use huygens::scene::{self, Scene};
use std::path::Path;

fn load(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name);
    let scene = scene::load(&path).expect(name);
    assert_eq!(scene.warnings, Vec::<String>::new(), "{name}");
    keeps_its_promises(&scene);
    scene
}

/// What the documentation of `Scene`'s tables says of them.
fn keeps_its_promises(scene: &Scene) {
    let mesh = &scene.mesh;
    assert_eq!(mesh.material.len(), mesh.triangles());
    assert!(mesh.vertices.iter().flatten().all(|x| x.is_finite()));
    for (triangle, &material) in mesh.indices.iter().zip(&mesh.material) {
        assert!(triangle.iter().all(|&v| (v as usize) < mesh.vertices.len()));
        assert!((material as usize) < scene.materials.len());
    }
    for material in &scene.materials {
        assert!(material.albedo.iter().all(|a| (0.0..=1.0).contains(a)));
        let emission = material.emission;
        assert!(emission.iter().all(|&e| e >= 0.0 && e.is_finite()));
    }
    let c = &scene.camera;
    let axes = [c.right, c.up, c.forward].map(|v| glam::DVec3::from_array(v.map(f64::from)));
    for (i, a) in axes.iter().enumerate() {
        for (j, b) in axes.iter().enumerate() {
            // Each component was rounded once to f32: 3 products of numbers of at most 1.
            let off = (a.dot(*b) - f64::from(u8::from(i == j))).abs();
            assert!(off <= 3.0 * f64::from(f32::EPSILON), "axes {i} and {j}");
        }
    }
    assert!(
        axes[0].cross(axes[1]).dot(axes[2]) < 0.0,
        "right, up, forward is left-handed"
    );
}

/// Twice a triangle's area times its unit normal.
fn area_vector(scene: &Scene, i: usize) -> glam::DVec3 {
    let [a, b, c] = scene
        .mesh
        .corners(i)
        .map(|v| glam::DVec3::from_array(v.map(f64::from)));
    (b - a).cross(c - a)
}

#[test]
fn cornell_box_is_the_measured_one() {
    let scene = load("cornell-box.toml");
    assert_eq!((scene.film.width, scene.film.height), (512, 512));
    assert_eq!(scene.mesh.triangles(), 12 + 2 + 2 + 2 + 20);
    assert_eq!(scene.camera.right, [-1.0, 0.0, 0.0]);
    // The film of the data page: half of 0.025 at focal length 0.035, to the angle's 6 digits.
    assert!((scene.camera.half_width - 0.0125 / 0.035).abs() < 1e-6);
    let light = scene.materials.iter().position(|m| m.emits()).unwrap();
    let emitting = (0..scene.mesh.triangles())
        .filter(|&i| scene.mesh.material[i] as usize == light)
        .map(|i| area_vector(&scene, i))
        .sum::<glam::DVec3>();
    assert_eq!((0.5 * emitting).to_array(), [0.0, -13650.0, 0.0]);
    assert_eq!(scene.sky, None);
}

#[test]
fn furnace_is_closed_and_faces_inwards() {
    let scene = load("furnace.toml");
    assert_eq!(scene.mesh.triangles(), 12);
    for i in 0..12 {
        let corner = glam::DVec3::from_array(scene.mesh.corners(i)[0].map(f64::from));
        assert!(area_vector(&scene, i).dot(corner) < 0.0);
    }
    let edges: std::collections::HashSet<_> = scene
        .mesh
        .indices
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .collect();
    assert_eq!(edges.len(), 36, "every edge once in each direction");
    assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
}
