//! Interpolated normals: the wave beside the reference.

mod common;

use common::picture::{by_reference, by_wave, independent};
use common::scenes::{Builder, camera_along_z};
use common::statistics::same;
use huygens::scene::{Scene, Sky};
use huygens::settings::{Settings, Strategy};
use huygens_kernels::octahedral;

/// A coarse globe under a sky that is bright above, with a lamp to one side.
fn globe() -> Scene {
    let mut b = Builder::new();
    let paint = b.material([0.7, 0.6, 0.5], [0.0; 3]);
    let lamp = b.material([0.0; 3], [8.0; 3]);
    b.quad(
        lamp,
        [
            [3.0, 2.0, -2.0],
            [3.0, 2.0, -4.0],
            [3.0, -1.0, -4.0],
            [3.0, -1.0, -2.0],
        ],
    );
    let mut scene = b.scene(camera_along_z([0.0; 3], -1.0, 0.4), 8, 8);
    let first = scene.mesh.vertices.len();
    let (rings, segments) = (5u32, 8u32);
    let no_normal = octahedral::NONE;
    scene.mesh.normals = vec![no_normal; first];
    for ring in 0..=rings {
        for segment in 0..segments {
            let theta = f64::from(ring) / f64::from(rings) * std::f64::consts::PI;
            let phi = f64::from(segment) / f64::from(segments) * std::f64::consts::TAU;
            let n = [
                theta.sin() * phi.cos(),
                theta.cos(),
                theta.sin() * phi.sin(),
            ];
            scene.mesh.normals.push(octahedral::encode(n));
            let [x, y, z] = n.map(|c| c as f32);
            scene.mesh.vertices.push([x, y, z - 4.0]);
        }
    }
    let at = |ring: u32, segment: u32| first as u32 + ring * segments + segment % segments;
    for ring in 0..rings {
        for segment in 0..segments {
            let [a, b] = [at(ring, segment), at(ring, segment + 1)];
            let [c, d] = [at(ring + 1, segment), at(ring + 1, segment + 1)];
            let mut add = |triangle: [u32; 3]| {
                scene.mesh.indices.push(triangle);
                scene.mesh.material.push(paint);
            };
            if ring > 0 {
                add([a, b, d]);
            }
            if ring < rings - 1 {
                add([a, d, c]);
            }
        }
    }
    scene.sky = Some(Sky::Gradient {
        zenith: [1.0; 3],
        nadir: [0.2; 3],
    });
    scene
}

#[test]
fn a_smooth_globe_looks_the_same_to_wave_and_reference() {
    let scene = globe();
    let settings = |strategy, spp| Settings {
        strategy,
        spp,
        max_depth: Some(3),
        ..independent()
    };
    let truth = by_reference(&scene, &settings(Strategy::Cosine, 1024));
    for strategy in [Strategy::Cosine, Strategy::Light, Strategy::Mis] {
        let seen = by_wave(&scene, &settings(strategy, 1024));
        // Three pictures at 1e-5 together.
        if let Err(what) = same(&seen, &truth, 1e-5 / 3.0) {
            panic!("{strategy:?}: {what}");
        }
    }
}
