//! The meshes by name, each with a camera and a light.

use crate::meshes::{self, Sculptor};
use crate::sphere;
use glam::{Vec3, vec3};
use huygens::scene::{self, Extent, Mesh, Projection, Scene};
use std::path::{Path, PathBuf};

/// What is measured: a mesh, where it is seen from and where its light is.
#[derive(Debug)]
pub(crate) struct Subject {
    pub(crate) name: &'static str,
    pub(crate) mesh: Mesh,
    pub(crate) camera: Camera,
    /// A parallelogram, not part of the mesh: a corner and two edges.
    pub(crate) light: [Vec3; 3],
}

/// A square image of the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    pub(crate) eye: Vec3,
    pub(crate) forward: Vec3,
    /// From the middle of the image at distance 1 to its right and top edge.
    pub(crate) right: Vec3,
    pub(crate) up: Vec3,
}

impl Camera {
    /// From `eye` to `target`, `half` the image's half size at distance 1.
    fn look(eye: Vec3, target: Vec3, half: f32) -> Self {
        let forward = (target - eye).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        Self {
            eye,
            forward,
            right: half * right,
            up: half * right.cross(forward),
        }
    }

    /// The scene's own camera, over the shorter side of its image.
    fn of(camera: &scene::Camera) -> Self {
        let Projection::Perspective { extent, .. } = camera.projection else {
            unreachable!("the scenes of this bench have perspective cameras");
        };
        let Extent {
            half_width,
            half_height,
        } = extent;
        let half = half_width.min(half_height);
        Self {
            eye: camera.origin.into(),
            forward: camera.forward.into(),
            right: half * Vec3::from_array(camera.right),
            up: half * Vec3::from_array(camera.up),
        }
    }
}

/// All names, in the order in which they are measured.
pub(crate) const NAMES: [&str; 8] = [
    "bedroom", "sponza", "truck", "hall", "clutter", "sticks", "ico1m", "ico5m",
];

/// The short run's.
pub(crate) const QUICK: [&str; 4] = ["bedroom", "hall", "clutter", "ico1m"];

/// Makes or loads a mesh. `data` is the folder of meshes that do not ship with the project.
///
/// # Errors
/// Where a file is missing or wrong; the mesh is then to be skipped, loudly.
pub(crate) fn make(name: &str, data: &Path) -> Result<Subject, String> {
    // Half the image's size at distance 1, for 50, 55 and 70 degrees.
    let (half_50, half_55, half_70) = (0.466, 0.521, 0.7);
    let hall = |name, mesh| Subject {
        name,
        mesh,
        camera: Camera::look(vec3(-17.5, 2.2, -1.0), vec3(5.0, 3.0, 1.0), half_70),
        light: [vec3(-6.0, 11.5, -5.0), 12.0 * Vec3::X, 10.0 * Vec3::Z],
    };
    let sphere = |name, sculptor: Sculptor| Subject {
        name,
        mesh: sculptor.0,
        camera: Camera::look(sphere::EYE, Vec3::ZERO, half_50),
        light: [vec3(-1.0, 3.5, -1.0), 2.0 * Vec3::X, 2.0 * Vec3::Z],
    };
    Ok(match name {
        "bedroom" => {
            let scene = load(Path::new("scenes/bedroom.toml"))?;
            let camera = Camera::of(&scene.camera);
            interior("bedroom", scene, camera)
        }
        "sponza" => {
            let scene = load(&data.join("obj/sponza-dabrovic/sponza.obj"))?;
            // Its publishers' camera; half the size of an image of 96.7 degrees across at 16:9.
            let (eye, target) = (vec3(2.25, 8.24, -0.05), vec3(3.15, 7.8, -0.05));
            interior("sponza", scene, Camera::look(eye, target, 0.63))
        }
        "truck" => {
            let scene = load(&data.join("obj/furniture/peterbilt/peterbilt.obj"))?;
            on_the_ground("truck", scene)
        }
        "hall" => hall("hall", meshes::hall()),
        "clutter" => hall("clutter", meshes::clutter()),
        "sticks" => Subject {
            name: "sticks",
            mesh: meshes::sticks(),
            camera: Camera::look(vec3(2.2, 1.0, 2.2), Vec3::ZERO, half_55),
            light: [vec3(-1.0, 2.4, -1.0), 2.0 * Vec3::X, 2.0 * Vec3::Z],
        },
        "ico1m" => {
            let mut ico = Sculptor(sphere::displaced(8));
            ico.quad(vec3(-20.0, -2.0, -20.0), 40.0 * Vec3::X, 40.0 * Vec3::Z);
            sphere("ico1m", ico)
        }
        "ico5m" => {
            let mut ico = Sculptor(sphere::displaced(9));
            ico.room(Vec3::splat(-4.0), Vec3::splat(4.0));
            sphere("ico5m", ico)
        }
        _ => {
            let names = NAMES.join(", ");
            return Err(format!("no mesh is called `{name}`, expected of {names}"));
        }
    })
}

fn load(path: &Path) -> Result<Scene, String> {
    if !path.is_file() {
        return Err(format!("{} is not there", PathBuf::from(path).display()));
    }
    scene::load(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn bounds(mesh: &Mesh) -> (Vec3, Vec3) {
    let vertices = mesh.vertices.iter().map(|&v| Vec3::from_array(v));
    vertices.fold((Vec3::MAX, Vec3::MIN), |(l, h), v| (l.min(v), h.max(v)))
}

/// A light over the middle half of the scene, a twentieth of its height below its top.
fn interior(name: &'static str, scene: Scene, camera: Camera) -> Subject {
    let (low, high) = bounds(&scene.mesh);
    let size = high - low;
    let corner = low + size * vec3(0.25, 0.95, 0.25);
    Subject {
        name,
        mesh: scene.mesh,
        camera,
        light: [corner, 0.5 * size.x * Vec3::X, 0.5 * size.z * Vec3::Z],
    }
}

/// An object on a floor, the light half as high again as it is.
fn on_the_ground(name: &'static str, scene: Scene) -> Subject {
    let (low, high) = bounds(&scene.mesh);
    let (size, camera) = (high - low, Camera::of(&scene.camera));
    let mut sculptor = Sculptor(scene.mesh);
    let span = 8.0 * size.max_element();
    let corner = vec3(
        0.5 * (low.x + high.x - span),
        low.y,
        0.5 * (low.z + high.z - span),
    );
    sculptor.quad(corner, span * Vec3::X, span * Vec3::Z);
    let corner = low + size * vec3(0.25, 1.5, 0.25);
    Subject {
        name,
        mesh: sculptor.0,
        camera,
        light: [corner, 0.5 * size.x * Vec3::X, 0.5 * size.z * Vec3::Z],
    }
}
