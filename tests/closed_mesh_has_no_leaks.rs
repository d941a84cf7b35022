//! Watertight: from inside a closed mesh every ray hits it, also one aimed at an edge or a vertex.
//!
//! Ten million rays, which take a few seconds:
//!
//!     cargo test --release --test closed_mesh_has_no_leaks -- --ignored

mod tracing;

use huygens::geometry::{Geometry, Preset};
use huygens::scene::Mesh;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::{Random, RaySet, bumpy_sphere, cube, moved};

/// Rays from points near `centre`: a third at random, a third at vertices, a third at edges.
fn from_inside(mesh: &Mesh, centre: [f32; 3], spread: f32, n: usize) -> RaySet {
    rays_of_seed(5, mesh, centre, spread, n)
}

fn rays_of_seed(seed: u64, mesh: &Mesh, centre: [f32; 3], spread: f32, n: usize) -> RaySet {
    let mut random = Random(seed);
    let mut rays = RaySet::default();
    for i in 0..n {
        let jitter = random.point();
        let origin: [f32; 3] = std::array::from_fn(|a| centre[a] + spread * jitter[a]);
        let corners = mesh.corners(random.below(mesh.triangles()));
        let target = match i % 3 {
            0 => {
                let d = random.point();
                std::array::from_fn(|a| origin[a] + d[a])
            }
            1 => corners[0],
            _ => {
                let s = random.unit();
                std::array::from_fn(|a| corners[0][a] + s * (corners[1][a] - corners[0][a]))
            }
        };
        rays.push(origin, std::array::from_fn(|a| target[a] - origin[a]));
    }
    rays
}

fn assert_no_escape(name: &str, mesh: &Mesh, rays: &RaySet) {
    for preset in [Preset::Balanced, Preset::Best] {
        let geometry = Geometry::build_with(mesh, preset);
        let escaped: Vec<usize> = (0..rays.len())
            .zip(rays.closest(&geometry))
            .filter(|(_, hit)| hit.primitive == NO_PRIMITIVE)
            .map(|(i, _)| i)
            .collect();
        if let Some(&i) = escaped.first() {
            panic!(
                "{name}, {preset:?}: {} of {} rays escape; the first is {i}: {:?} along {:?}",
                escaped.len(),
                rays.len(),
                rays.origin[i],
                rays.direction[i]
            );
        }
        let open = rays.occluded(&geometry).iter().filter(|o| !**o).count();
        assert_eq!(
            open, 0,
            "{name}, {preset:?}: rays that hit something are not occluded"
        );
    }
}

#[test]
fn of_a_bumpy_sphere() {
    let sphere = bumpy_sphere(5, 0.04);
    assert_no_escape(
        "unit",
        &sphere,
        &from_inside(&sphere, [0.0; 3], 0.3, 300_000),
    );
}

#[test]
fn of_a_sphere_of_any_size_and_anywhere() {
    for scale in [1e-6, 1e-3, 1e3, 1e6] {
        let sphere = moved(bumpy_sphere(3, 0.05), scale, [0.0; 3]);
        let rays = from_inside(&sphere, [0.0; 3], 0.3 * scale, 30_000);
        assert_no_escape(&format!("scale {scale}"), &sphere, &rays);
    }
    for offset in [[10.0, -20.0, 5.0], [1000.0, 0.0, 300.0], [1e5, 1e5, -1e5]] {
        let sphere = moved(bumpy_sphere(3, 0.05), 1.0, offset);
        let rays = from_inside(&sphere, offset, 0.3, 30_000);
        assert_no_escape(&format!("offset {offset:?}"), &sphere, &rays);
    }
}

#[test]
fn of_a_cube_along_lattice_directions() {
    // Here rays meet edges, diagonals and corners exactly, and boxes are flat.
    let mut rays = RaySet::default();
    let lattice = [-2.0, -1.0, -0.5, -0.0, 0.0, 0.25, 1.0, 2.0];
    for x in lattice {
        for y in lattice {
            for z in lattice {
                if x != 0.0 || y != 0.0 || z != 0.0 {
                    for origin in [[0.0; 3], [0.5, 0.5, 0.5], [-0.75, 0.25, -0.0]] {
                        rays.push(origin, [x, y, z]);
                    }
                }
            }
        }
    }
    assert_no_escape("cube", &cube(), &rays);
}

#[test]
fn of_a_stretched_sphere() {
    // Needles: one axis is 1000 times shorter than the others.
    let mut sphere = bumpy_sphere(4, 0.02);
    for p in &mut sphere.vertices {
        p[1] *= 1e-3;
    }
    let mut rays = from_inside(&sphere, [0.0; 3], 0.3, 30_000);
    for origin in &mut rays.origin {
        origin[1] *= 1e-3;
    }
    assert_no_escape("flat", &sphere, &rays);
}

#[test]
#[ignore = "ten million rays: some seconds in a release build, a minute in others"]
fn of_ten_million_rays() {
    // A hundred sets of rays: spheres from 1,280 to 81,920 triangles, near the origin and far off.
    let n = 100_002;
    for (k, offset) in [0.0, 30.0].into_iter().enumerate() {
        for level in 3..=6 {
            let sphere = moved(bumpy_sphere(level, 0.04), 1.0, [offset; 3]);
            let geometry = Geometry::build(&sphere);
            for set in 0..13 {
                let seed = (100 * k + 13 * level as usize + set) as u64;
                let rays = rays_of_seed(seed, &sphere, [offset; 3], 0.3, n);
                let hits = rays.closest(&geometry);
                let escaped = hits.iter().filter(|h| h.primitive == NO_PRIMITIVE).count();
                let open = rays.occluded(&geometry).iter().filter(|o| !**o).count();
                assert_eq!((escaped, open), (0, 0), "level {level}, seed {seed}");
            }
        }
    }
}
