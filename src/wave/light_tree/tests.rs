//! Does the tree hold every light, and rule none out that shines?

use super::*;
use crate::scene::{FilmSpec, Filter, Light, Material, Projection, Spot};
use huygens_kernels::lanes::Ux;
use huygens_kernels::vec3::Vec3x;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

fn unit(rng: &mut Pcg64) -> f64 {
    f64::from(rng.next_u32()) / f64::from(u32::MAX)
}

fn point(rng: &mut Pcg64, size: f64) -> [f32; 3] {
    std::array::from_fn(|_| (size * (2.0 * unit(rng) - 1.0)) as f32)
}

/// Triangles of two materials, one of which shines to both sides, and points and spots.
fn scene(triangles: usize, points: usize, rng: &mut Pcg64) -> Scene {
    let mut mesh = Mesh::default();
    for i in 0..triangles {
        let at = point(rng, 5.0);
        for _ in 0..3 {
            let off = point(rng, 0.3);
            mesh.vertices.push(std::array::from_fn(|c| at[c] + off[c]));
        }
        let first = 3 * i as u32;
        mesh.indices.push([first, first + 1, first + 2]);
        mesh.material.push((i % 5 == 0).into());
    }
    let material = |two_sided| Material {
        two_sided,
        ..Material::diffuse("lamp", [0.0; 3], [1.0, 2.0, 3.0])
    };
    let light = |k: usize, rng: &mut Pcg64| {
        let axis = DVec3::from_array(point(rng, 1.0).map(f64::from)).normalize();
        let dark = 1.8 * unit(rng) - 0.9;
        let spot = Spot {
            axis: axis.as_vec3().to_array(),
            dark: dark as f32,
            full: (dark + 0.1 * unit(rng)) as f32,
        };
        let kind = LightKind::Point {
            position: point(rng, 5.0),
            intensity: [1.0; 3],
            spot: k.is_multiple_of(2).then_some(spot),
        };
        let name = String::new();
        Light { name, kind }
    };
    Scene {
        name: String::new(),
        hash: [0; 32],
        camera: crate::scene::Camera {
            origin: [0.0; 3],
            forward: [0.0, 0.0, -1.0],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 1.0, 0.0],
            projection: Projection::Panorama,
        },
        film: FilmSpec {
            width: 1,
            height: 1,
            filter: Filter::Box,
        },
        mesh,
        materials: vec![material(false), material(true)],
        textures: Vec::new(),
        spheres: Vec::new(),
        objects: Vec::new(),
        instances: Vec::new(),
        sky: None,
        lights: (0..points).map(|k| light(k, rng)).collect(),
        media: Vec::new(),
        camera_motion: None,
        fog: None,
        settings: crate::settings::Settings::default(),
        warnings: Vec::new(),
    }
}

/// Where a trail leads.
fn follow(tree: &LightTree, mut trail: u32) -> u32 {
    let mut at = 0;
    loop {
        let child = tree.nodes[at].child;
        if child & LEAF != 0 {
            return child & !LEAF;
        }
        at = (child + (trail & 1)) as usize;
        trail >>= 1;
    }
}

/// The luminance of what a triangle's material emits.
fn emitted(scene: &Scene) -> impl Fn(usize) -> f64 {
    |i| {
        luminance(
            scene.materials[scene.mesh.material[i] as usize]
                .emission
                .factor,
        )
    }
}

#[test]
fn every_light_has_a_leaf_and_a_trail_that_leads_to_it() {
    let mut rng = Pcg64::new(1, 1);
    for (triangles, points) in [(1, 0), (0, 1), (2, 3), (500, 30)] {
        let scene = scene(triangles, points, &mut rng);
        let tree = LightTree::new(&scene, emitted(&scene));
        let lights = triangles + points;
        assert_eq!(tree.nodes.len(), 2 * lights - 1);
        let mut sources = tree.source.clone();
        sources.sort_unstable();
        let expected = (0..triangles as u32).chain((0..points as u32).map(|k| PUNCTUAL | k));
        assert_eq!(sources, expected.collect::<Vec<_>>());
        for (light, &trail) in tree.trail.iter().enumerate() {
            assert_eq!(follow(&tree, trail), light as u32);
        }
        for (triangle, &light) in tree.of_triangle.iter().enumerate() {
            assert_eq!(tree.source[light as usize], triangle as u32);
        }
    }
}

#[test]
fn lights_at_one_place_are_halved_until_they_stand_alone() {
    let mut rng = Pcg64::new(2, 1);
    let mut scene = scene(0, 1000, &mut rng);
    for light in &mut scene.lights {
        if let LightKind::Point { position, .. } = &mut light.kind {
            *position = [1.0, 2.0, 3.0];
        }
    }
    let tree = LightTree::new(&scene, emitted(&scene));
    assert!(tree.trail.iter().all(|&t| t < 1 << 10), "ten levels");
}

/// Whatever a light sends to a point, the tree can draw it there: no node on its way says that
/// nothing of it shines.
#[test]
fn no_light_that_shines_on_a_point_is_ruled_out() {
    let mut rng = Pcg64::new(3, 1);
    let (triangles, points) = (200, 40);
    let scene = scene(triangles, points, &mut rng);
    let mut tree = LightTree::new(&scene, emitted(&scene));
    tree.selection = 1.0;
    let kernel = tree.view();
    let mut shining = 0;
    for _ in 0..200 {
        let at = point(&mut rng, 8.0);
        let p = DVec3::from_array(at.map(f64::from));
        let mut sum = 0.0;
        for triangle in 0..triangles {
            let said = kernel.probability(Vec3x::splat(at), Ux::splat(triangle as u32));
            let said = f64::from(said.as_array()[0]);
            sum += said;
            let [a, b, c] = scene
                .mesh
                .corners(triangle)
                .map(|v| DVec3::from_array(v.map(f64::from)));
            let front = (b - a).cross(c - a).dot(p - a) > 0.0;
            if front || scene.mesh.material[triangle] == 1 {
                shining += 1;
                assert!(said > 0.0, "triangle {triangle} at {at:?}");
            }
        }
        assert!(sum <= 1.0 + 1e-5, "probabilities of a part sum to {sum}");
        // Spots have no way to be found: what is asked of them is that their nodes shine.
        for (k, light) in scene.lights.iter().enumerate() {
            let LightKind::Point {
                position,
                spot: Some(spot),
                ..
            } = light.kind
            else {
                continue;
            };
            let to = p - DVec3::from_array(position.map(f64::from));
            let axis = DVec3::from_array(spot.axis.map(f64::from));
            if to.normalize().dot(axis) <= f64::from(spot.dark) {
                continue;
            }
            let source = PUNCTUAL | k as u32;
            let light = tree
                .source
                .iter()
                .position(|&s| s == source)
                .expect("is there");
            let (mut node, mut trail) = (0, tree.trail[light]);
            loop {
                let importance = kernel.importance(Ux::splat(node), Vec3x::splat(at));
                assert!(importance.as_array()[0] > 0.0, "spot {k} at {at:?}");
                let child = tree.nodes[node as usize].child;
                if child & LEAF != 0 {
                    break;
                }
                node = child + (trail & 1);
                trail >>= 1;
            }
            shining += 1;
        }
    }
    assert!(shining > 10_000, "the test has tested {shining}");
}
