//! Spheres and instances are met where brute force in f64 says that they are, by rays of both
//! queries, and a world of triangles alone answers the same by both kernels.

mod tracing;

use huygens::geometry::{Geometry, Preset};
use huygens::scene::{Instance, Object, Scene};
use huygens_kernels::levels::Filter;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::worlds::{Truth, empty, mixed, placement, truths};
use tracing::{Hit, Random, RaySet, bumpy_sphere, cube, oracle, random_soup};

/// Half a unit in the last place of 1.
const U: f64 = 1.0 / 16_777_216.0;

fn random_rays(n: usize, seed: u64) -> RaySet {
    let mut random = Random(1000 + seed);
    let mut rays = RaySet::default();
    for _ in 0..n {
        rays.push(random.point(), random.point());
    }
    rays
}

/// Checks closest hits, and occlusion up to just before and just behind them, wherever the truth is
/// clear: no edge, and no other hit, is within the rounding. Returns how many rays those were.
fn check(scene: &Scene, rays: &RaySet) -> usize {
    let geometry = Geometry::of(scene, Preset::Balanced);
    let hits = rays.closest(&geometry);
    let mut segments = rays.clone();
    let mut expected = Vec::new();
    let mut clear = 0;
    for i in 0..rays.len() {
        // 64 roundings of what is subtracted: transformation, shear and products are 30.
        let bound = |t: &Truth| 64.0 * U * t.error;
        let mut near: Vec<Truth> = truths(scene, rays.origin[i], rays.direction[i])
            .into_iter()
            .filter(|t| t.margin > -1e-3 && t.t > -bound(t) && t.t.is_finite())
            .collect();
        near.sort_by(|a, b| a.t.total_cmp(&b.t));
        let hit = hits[i];
        let (clearly, occluded_behind) = match near.first() {
            None => (hit.primitive == NO_PRIMITIVE, false),
            Some(first) => {
                let apart = near
                    .get(1)
                    .is_none_or(|second| second.t - bound(second) > first.t + bound(first));
                if first.margin < 1e-3 || first.t < bound(first) || !apart {
                    segments.t_max[i] = 0.0;
                    expected.push(false);
                    continue;
                }
                let off = (f64::from(hit.t) - first.t).abs();
                assert!(
                    hit.primitive == first.primitive && off <= bound(first),
                    "ray {i}: {hit:?}, the truth is {first:?}"
                );
                // Every other ray ends before what it hits.
                let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
                segments.t_max[i] = (first.t + 2.0 * sign * bound(first)) as f32;
                (true, i % 2 == 0)
            }
        };
        assert!(clearly, "ray {i}: {hit:?} where there is nothing");
        clear += 1;
        expected.push(occluded_behind);
    }
    for (i, occluded) in segments.occluded(&geometry).into_iter().enumerate() {
        assert_eq!(
            occluded, expected[i],
            "segment {i} up to {}",
            segments.t_max[i]
        );
    }
    clear
}

#[test]
fn spheres_and_instances_among_triangles() {
    for seed in 1..=3 {
        let scene = mixed(30, 100, seed);
        let clear = check(&scene, &random_rays(2000, seed));
        assert!(clear > 1600, "seed {seed}: only {clear} rays are clear");
    }
}

#[test]
fn spheres_alone_and_instances_alone() {
    let mut spheres = mixed(0, 300, 4);
    spheres.mesh = Default::default();
    assert!(check(&spheres, &random_rays(2000, 4)) > 1800);
    let mut copies = mixed(40, 0, 5);
    copies.mesh = Default::default();
    assert!(check(&copies, &random_rays(1000, 5)) > 700);
}

#[test]
fn at_any_scale() {
    for scale in [1e-6f32, 1e-3, 1e3, 1e6] {
        let mut scene = mixed(20, 50, 6);
        scene.mesh = tracing::moved(scene.mesh, scale, [0.0; 3]);
        for sphere in &mut scene.spheres {
            sphere.centre = sphere.centre.map(|c| c * scale);
            sphere.radius *= scale;
        }
        for instance in &mut scene.instances {
            let mut map = instance.placement.map();
            map.matrix3 *= f64::from(scale);
            map.translation *= f64::from(scale);
            instance.placement = placement(&map);
        }
        let mut rays = random_rays(500, 6);
        for origin in &mut rays.origin {
            *origin = origin.map(|c| c * scale);
        }
        let clear = check(&scene, &rays);
        assert!(clear > 350, "scale {scale}: only {clear} rays are clear");
    }
}

/// A map that f32 does exactly, so that a copy is met like the triangles that it stands for.
fn quarter_turn(at: [f64; 3]) -> glam::DAffine3 {
    let linear =
        glam::DMat3::from_cols_array_2d(&[[0.0, 0.5, 0.0], [0.0, 0.0, 2.0], [1.0, 0.0, 0.0]]);
    glam::DAffine3::from_mat3_translation(linear, glam::DVec3::from_array(at))
}

#[test]
fn a_copy_that_loses_nothing_is_met_like_its_triangles() {
    // Vertices, translations and origins on a coarse grid: every difference is exact.
    let grid = |c: f32| (c * 1024.0).round() / 1024.0;
    let mut object = random_soup(300, 9);
    for vertex in &mut object.vertices {
        *vertex = vertex.map(grid);
    }
    let map = quarter_turn([0.25, -0.5, 0.125]);
    let mut scene = empty();
    let mut flat = object.clone();
    for vertex in &mut flat.vertices {
        let p = glam::DVec3::from_array(vertex.map(f64::from));
        *vertex = map.transform_point3(p).as_vec3().to_array();
    }
    scene.objects = vec![Object {
        name: "soup".into(),
        mesh: object,
    }];
    scene.instances = vec![Instance {
        object: 0,
        placement: placement(&map),
        material: None,
        motion: None,
    }];
    let mut rays = random_rays(2000, 10);
    for origin in &mut rays.origin {
        *origin = origin.map(grid);
    }
    let hits = rays.closest(&Geometry::of(&scene, Preset::Balanced));
    let mut met = 0;
    for (i, &hit) in hits.iter().enumerate() {
        // The oracle of plain triangles judges, with nothing allowed for the transformation. It is
        // told the distance along the ray, which is the same on both sides.
        if let Err(why) = oracle::check(&flat, &rays, i, hit) {
            panic!("{why}");
        }
        met += usize::from(hit.primitive != NO_PRIMITIVE);
    }
    assert!(met > 500);
}

#[test]
fn a_closed_copy_has_no_leaks() {
    let mut random = Random(11);
    let mesh = bumpy_sphere(4, 0.04);
    for size in [1e-4, 1.0, 1e4] {
        let mut scene = empty();
        scene.objects = vec![Object {
            name: "ball".into(),
            mesh: mesh.clone(),
        }];
        let map = tracing::worlds::any_map(&mut random, size);
        scene.instances = vec![Instance {
            object: 0,
            placement: placement(&map),
            material: None,
            motion: None,
        }];
        let geometry = Geometry::of(&scene, Preset::Balanced);
        // From inside, at random, at vertices and at edges.
        let mut rays = RaySet::default();
        let to_world = |p: [f32; 3]| {
            let p = glam::DVec3::from_array(p.map(f64::from));
            map.transform_point3(p).as_vec3().to_array()
        };
        for i in 0..60_000 {
            let origin = to_world(random.point().map(|c| 0.3 * c));
            let corners = mesh.corners(random.below(mesh.triangles()));
            let target = match i % 3 {
                0 => random.point(),
                1 => corners[0],
                _ => {
                    let s = random.unit();
                    std::array::from_fn(|a| corners[0][a] + s * (corners[1][a] - corners[0][a]))
                }
            };
            let target = to_world(target);
            rays.push(origin, std::array::from_fn(|a| target[a] - origin[a]));
        }
        let escaped = rays.closest(&geometry);
        let escaped = escaped.iter().filter(|h| h.primitive == NO_PRIMITIVE);
        assert_eq!(escaped.count(), 0, "size {size}");
        assert!(rays.occluded(&geometry).iter().all(|o| *o), "size {size}");
    }
}

/// Asks, so that rays take the way of two levels, and has everything there.
struct All;

impl Filter for All {
    const ASKS: bool = true;
    fn accepts(&self, _: usize, _: u32, _: f32, _: f32) -> bool {
        true
    }
}

#[test]
fn triangles_alone_are_met_alike_by_both_kernels() {
    for mesh in [cube(), random_soup(3000, 12), bumpy_sphere(4, 0.05)] {
        let geometry = Geometry::build(&mesh);
        let mut rays = random_rays(3000, 13);
        let plain = rays.closest(&geometry);
        let mut by_levels = Vec::new();
        rays.each(
            |rays, hits| geometry.closest_among(&All, None, rays, hits),
            &mut by_levels,
        );
        for (i, (a, b)) in plain.iter().zip(&by_levels).enumerate() {
            assert_eq!(a.primitive, b.primitive, "ray {i}");
            if a.primitive != NO_PRIMITIVE {
                assert_eq!(a, b, "ray {i}");
            }
        }
        rays.leaves = plain.iter().map(|h| h.primitive).collect();
        rays.t_max.fill(0.7);
        let mut occluded = Vec::new();
        rays.each_segment(
            |segments, out| geometry.occluded_among(&All, None, segments, out),
            &mut occluded,
        );
        assert_eq!(rays.occluded(&geometry), occluded);
    }
}

/// Holes: checks of barycentric space, and every seventh triangle as a whole.
struct Checks;

impl Filter for Checks {
    const ASKS: bool = true;
    fn accepts(&self, _: usize, primitive: u32, u: f32, v: f32) -> bool {
        let check = (4.0 * u) as u32 + (4.0 * v) as u32;
        !primitive.is_multiple_of(7) && check.is_multiple_of(2)
    }
}

#[test]
fn masked_triangles_are_met_where_they_are_not_holes() {
    let mesh = random_soup(800, 14);
    let geometry = Geometry::build(&mesh);
    let mut rays = random_rays(1500, 15);
    let mut random = Random(16);
    for leaves in &mut rays.leaves {
        *leaves = random.below(800) as u32;
    }
    let mut hits: Vec<Hit> = Vec::new();
    rays.each(
        |rays, hits| geometry.closest_among(&Checks, None, rays, hits),
        &mut hits,
    );
    let mut scene = empty();
    scene.mesh = mesh;
    let (mut through, mut clear) = (0, 0);
    let mut segments = rays.clone();
    let mut expected = Vec::new();
    for i in 0..rays.len() {
        let bound = |t: &Truth| 64.0 * U * t.error;
        let mut near: Vec<(Truth, Option<bool>)> =
            truths(&scene, rays.origin[i], rays.direction[i])
                .into_iter()
                .filter(|t| t.margin > -1e-3 && t.t > -bound(t) && t.t.is_finite())
                .filter(|t| t.primitive != rays.leaves[i])
                .map(|t| (t, solid(&scene, &rays, i, t.primitive)))
                .collect();
        near.sort_by(|a, b| a.0.t.total_cmp(&b.0.t));
        // Up to the first that counts for certain, everything must be clear.
        let first = near.iter().position(|(_, solid)| *solid != Some(false));
        let until = &near[..first.map_or(near.len(), |f| (f + 2).min(near.len()))];
        let sure = until
            .iter()
            .all(|(t, solid)| t.margin > 1e-3 && t.t > bound(t) && solid.is_some())
            && until
                .windows(2)
                .all(|w| w[1].0.t - bound(&w[1].0) > w[0].0.t + bound(&w[0].0));
        if !sure {
            segments.t_max[i] = 0.0;
            expected.push(false);
            continue;
        }
        clear += 1;
        let primitive = first.map_or(NO_PRIMITIVE, |f| near[f].0.primitive);
        assert_eq!(hits[i].primitive, primitive, "ray {i}: {near:?}");
        through += usize::from(first != Some(0) && !near.is_empty());
        // Just before it there is nothing but holes; just behind it there is something.
        if let Some((t, _)) = first.map(|f| near[f]) {
            let behind = i % 2 == 0;
            let sign = if behind { 2.0 } else { -2.0 };
            segments.t_max[i] = (t.t + sign * bound(&t)) as f32;
            expected.push(behind);
        } else {
            expected.push(false);
        }
    }
    assert!(
        clear > 1000 && through > 300,
        "{clear} clear, {through} through holes"
    );
    let mut occluded = Vec::new();
    segments.each_segment(
        |segments, out| geometry.occluded_among(&Checks, None, segments, out),
        &mut occluded,
    );
    assert_eq!(occluded, expected);
}

/// Whether the hit of ray `i` on a triangle counts, if that is not within the rounding.
fn solid(scene: &Scene, rays: &RaySet, i: usize, primitive: u32) -> Option<bool> {
    let v = |a: [f32; 3]| glam::DVec3::from_array(a.map(f64::from));
    let [a, b, c] = scene.mesh.corners(primitive as usize).map(v);
    let (o, d) = (v(rays.origin[i]), v(rays.direction[i]));
    let (e, f) = (b - a, c - a);
    let det = -d.dot(e.cross(f));
    let q = (o - a).cross(d);
    let (u, w) = (f.dot(q) / det, -e.dot(q) / det);
    // Weights carry the roundings of products of lengths over the area seen: next to a line
    // between checks, or seen too flat, nothing is claimed.
    let reach = (o - a).length() + e.length() + f.length();
    let error = 64.0 * U * reach * (e.length() + f.length()) * d.length() / det.abs();
    let near = |x: f64| (4.0 * x - (4.0 * x).round()).abs() <= 4.0 * error;
    if primitive.is_multiple_of(7) {
        return Some(false);
    }
    (!near(u) && !near(w) && error < 0.1).then(|| Checks.accepts(0, primitive, u as f32, w as f32))
}
