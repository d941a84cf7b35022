//! Meshes that make builders slow, trees deep and stacks overflow.
//!
//! The sizes are such that anything quadratic would take minutes.

mod tracing;

use huygens::geometry::{Geometry, Preset};
use huygens::scene::Mesh;
use huygens_kernels::bvh::MAX_DEPTH;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::{Random, RaySet, oracle, random_soup, soup};

fn rays() -> RaySet {
    let mut random = Random(23);
    let mut rays = RaySet::default();
    for _ in 0..60 {
        let (origin, target) = (random.point().map(|p| 3.0 * p), random.point());
        rays.push(origin, std::array::from_fn(|a| target[a] - origin[a]));
    }
    rays.push([0.25, 0.25, -1.0], [0.0, 0.0, 1.0]);
    rays
}

fn assert_sound(name: &str, mesh: &Mesh) {
    for preset in [Preset::Fast, Preset::Balanced, Preset::Best] {
        let geometry = Geometry::build_with(mesh, preset);
        let name = format!("{name}, {preset:?}");
        assert!(
            geometry.depth() <= MAX_DEPTH,
            "{name}: depth {}",
            geometry.depth()
        );
        // Cut triangles are in several leaves.
        let (found, all) = (geometry.triangles(), mesh.triangles());
        assert!(
            found == all || (found > all && preset == Preset::Best),
            "{name}: {found}"
        );
        let rays = rays();
        for (i, &hit) in rays.closest(&geometry).iter().enumerate() {
            if let Err(why) = oracle::check(mesh, &rays, i, hit) {
                panic!("{name}: {why}");
            }
        }
    }
}

const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]];

#[test]
fn identical() {
    let mesh = soup(&[TRIANGLE; 20_000]);
    assert_sound("identical", &mesh);
    let hit = rays().closest(&Geometry::build(&mesh))[60];
    assert_eq!(hit.primitive, 0, "of equally near ones the first");
}

#[test]
fn points_at_one_place_and_along_lines() {
    assert_sound("one point", &soup(&[[[0.5; 3]; 3]; 20_000]));
    for axis in 0..3 {
        let line: Vec<_> = (0..20_000)
            .map(|i| {
                let mut p = [0.25; 3];
                p[axis] = i as f32 / 20_000.0;
                [p; 3]
            })
            .collect();
        assert_sound("line of points", &soup(&line));
    }
    let diagonal: Vec<_> = (0..20_000).map(|i| [[i as f32 / 20_000.0; 3]; 3]).collect();
    assert_sound("diagonal of points", &soup(&diagonal));
}

#[test]
fn around_one_centre() {
    // Equal centres, growing sizes: every union is as large as the larger of the two.
    let nested: Vec<_> = (0..20_000)
        .map(|i| {
            let s = (i + 1) as f32 / 20_000.0;
            [[-s, -s, -s], [s, s, -s], [s, -s, s]]
        })
        .collect();
    assert_sound("nested", &soup(&nested));
    let reversed: Vec<_> = nested.into_iter().rev().collect();
    assert_sound("nested, largest first", &soup(&reversed));
}

#[test]
fn from_one_corner() {
    // Boxes that share a corner and grow: each union again equals the larger box, and centres lie
    // in the order of the sizes, so that neighbours chain up one after the other.
    let growing: Vec<_> = (0..20_000)
        .map(|i| {
            let s = (i + 1) as f32 / 20_000.0;
            [[0.0; 3], [s, s, 0.0], [s, 0.0, s]]
        })
        .collect();
    assert_sound("growing", &soup(&growing));
    // And exponentially, over the whole range of f32.
    let doubling: Vec<_> = (0..2000)
        .map(|i| {
            let s = 2f32.powf(f32::from(i as i16) * 0.1 - 120.0);
            [[0.0; 3], [s, s, 0.0], [s, 0.0, s]]
        })
        .collect();
    assert_sound("doubling", &soup(&doubling));
}

#[test]
fn so_large_that_areas_overflow() {
    let mesh = tracing::moved(random_soup(3000, 6), 1e30, [0.0; 3]);
    assert_sound("huge", &mesh);
    let mut mixed = random_soup(3000, 7);
    mixed.vertices[17] = [3e38, -3e38, 3e38];
    assert_sound("one huge triangle", &mixed);
}

#[test]
fn none_one_and_a_few() {
    let none = Geometry::build(&Mesh::default());
    assert!(none.bounds().is_none() && none.nodes() == 0 && none.triangles() == 0);
    let rays = rays();
    assert!(
        rays.closest(&none)
            .iter()
            .all(|h| h.primitive == NO_PRIMITIVE)
    );
    assert!(rays.occluded(&none).iter().all(|o| !o));
    for n in 1..40 {
        assert_sound("a few", &random_soup(n, n as u64));
    }
}

#[test]
fn not_finite() {
    let mut mesh = random_soup(500, 10);
    mesh.vertices[0] = [f32::NAN, 0.0, 0.0];
    mesh.vertices[4] = [0.0, f32::INFINITY, 0.0];
    mesh.vertices[300] = [0.0, 0.0, f32::NEG_INFINITY];
    let geometry = Geometry::build(&mesh);
    assert_eq!(geometry.triangles(), 497);
    assert!(
        geometry
            .bounds()
            .unwrap()
            .iter()
            .flatten()
            .all(|b| b.is_finite())
    );
    let rays = rays();
    for (i, &hit) in rays.closest(&geometry).iter().enumerate() {
        assert!(![0, 1, 100].contains(&hit.primitive), "ray {i}");
        oracle::check(&mesh, &rays, i, hit).unwrap();
    }
}
