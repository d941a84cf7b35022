//! What stands behind the middle of the Cornell box' back wall, where no ray comes: what leaves the box
//! does so on the other side.

use huygens::scene::{Instance, Material, Mesh, Motion, Object, Placement, Scene, Sphere};
use huygens::settings::LightSelection;

const BEHIND: [f32; 3] = [278.0, 273.0, 1000.0];

fn triangle(mesh: &mut Mesh, material: u32, at: [f32; 3]) {
    let first = mesh.vertices.len() as u32;
    let [x, y, z] = at;
    mesh.vertices
        .extend([[x, y, z], [x + 1.0, y, z], [x, y + 1.0, z]]);
    mesh.indices.push([first, first + 1, first + 2]);
    mesh.material.push(material);
}

fn paint_of_its_own(scene: &mut Scene) -> u32 {
    scene
        .materials
        .push(Material::diffuse("hidden", [0.5; 3], [0.0; 3]));
    scene.materials.len() as u32 - 1
}

/// A triangle of plain paint. Returns its material.
pub(crate) fn hidden(scene: &mut Scene) -> usize {
    let material = paint_of_its_own(scene);
    triangle(&mut scene.mesh, material, BEHIND);
    material as usize
}

pub(crate) fn ball(scene: &mut Scene) {
    let material = paint_of_its_own(scene);
    scene.spheres.push(Sphere {
        centre: BEHIND,
        radius: 1.0,
        material,
    });
}

pub(crate) fn copy(scene: &mut Scene) {
    let material = paint_of_its_own(scene);
    let mut mesh = Mesh::default();
    triangle(&mut mesh, material, [0.0; 3]);
    scene.objects.push(Object {
        name: "hidden".to_owned(),
        mesh,
    });
    let at = glam::DVec3::from_array(BEHIND.map(f64::from));
    let placement = Placement::new(&glam::DAffine3::from_translation(at));
    scene.instances.push(Instance {
        object: scene.objects.len() as u32 - 1,
        placement: placement.expect("nothing is scaled"),
        material: None,
        motion: None,
    });
}

pub(crate) fn moving_copy(scene: &mut Scene) {
    copy(scene);
    let last = scene.instances.last_mut().expect("just placed");
    last.motion = Some(Motion {
        travel: [1.0, 0.0, 0.0],
        axis: [0.0, 1.0, 0.0],
        turns: 0.0,
    });
}

pub(crate) fn along_a_tree(scene: &mut Scene) {
    hidden(scene);
    scene.settings.light_selection = LightSelection::Tree;
}
