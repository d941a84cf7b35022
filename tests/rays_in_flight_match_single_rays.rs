//! However many rays are under way together, each gets the answer it gets alone, bit for bit.

mod tracing;

use huygens::geometry::Geometry;
use huygens::scene::Mesh;
#[cfg(target_arch = "x86_64")]
use huygens_kernels::avx512;
use huygens_kernels::bvh::Bvh;
use huygens_kernels::few::{Few, Triangle};
use huygens_kernels::lanes::padded;
use huygens_kernels::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use huygens_kernels::{few, flight, many, packet, traverse};
use tracing::{Random, RaySet, bumpy_sphere, cube, moved, random_soup, soup};

/// Hits and occlusion as bits, every column that is not unspecified.
type Answers = Vec<(u32, u32, u32, u32, u32)>;

fn answers(
    rays: &RaySet,
    closest: impl Fn(Rays, Hits),
    occluded: impl Fn(Segments, &mut [u32]),
) -> Answers {
    let n = rays.len();
    let column = |rows: &[[f32; 3]], a: usize| rows.iter().map(|r| r[a]).collect::<Vec<f32>>();
    let origin: [Vec<f32>; 3] = std::array::from_fn(|a| column(&rays.origin, a));
    let direction: [Vec<f32>; 3] = std::array::from_fn(|a| column(&rays.direction, a));
    let (mut primitive, mut occlusion) = (vec![0; padded(n)], vec![0; padded(n)]);
    let [mut t, mut u, mut v] = [(); 3].map(|()| vec![0.0; padded(n)]);
    let (origin, direction) = (
        origin.each_ref().map(Vec::as_slice),
        direction.each_ref().map(Vec::as_slice),
    );
    closest(
        Rays {
            len: n,
            origin,
            direction,
            leaves: &rays.leaves,
        },
        Hits {
            primitive: &mut primitive,
            t: &mut t,
            u: &mut u,
            v: &mut v,
        },
    );
    occluded(
        Segments {
            len: n,
            origin,
            direction,
            t_max: &rays.t_max,
            leaves: &rays.leaves,
            reaches: &rays.reaches,
        },
        &mut occlusion,
    );
    let row = |i: usize| match primitive[i] {
        NO_PRIMITIVE => (NO_PRIMITIVE, 0, 0, 0, occlusion[i]),
        p => (
            p,
            t[i].to_bits(),
            u[i].to_bits(),
            v[i].to_bits(),
            occlusion[i],
        ),
    };
    (0..n).map(row).collect()
}

fn alone(bvh: Bvh, rays: &RaySet) -> Answers {
    answers(
        rays,
        |r, h| traverse::closest(bvh, r, h),
        |s, o| traverse::occluded(bvh, s, o),
    )
}

fn together<const N: usize>(bvh: Bvh, rays: &RaySet) -> Answers {
    answers(
        rays,
        |r, h| flight::closest::<N>(bvh, r, h),
        |s, o| flight::occluded::<N>(bvh, s, o),
    )
}

/// None where the processor has no AVX-512.
fn by_avx512(bvh: Bvh, rays: &RaySet) -> Option<Answers> {
    #[cfg(target_arch = "x86_64")]
    if avx512::available() {
        return Some(answers(
            rays,
            |r, h| avx512::closest(bvh, r, h),
            |s, o| avx512::occluded(bvh, s, o),
        ));
    }
    eprintln!("SKIPPED: no AVX-512 here");
    let _ = (bvh, rays);
    None
}

/// By packets of the width that this processor has, and by the narrow ones that all have.
fn packets(bvh: Bvh, rays: &RaySet) -> Answers {
    let by = |closest: fn(Bvh, Rays, Hits)| {
        answers(
            rays,
            |r, h| closest(bvh, r, h),
            |s, o| traverse::occluded(bvh, s, o),
        )
    };
    let found = by(packet::closest);
    assert!(found == by(packet::closest_by_eights), "by eights");
    found
}

fn random_rays(triangles: usize, n: usize) -> RaySet {
    let mut random = Random(51);
    let mut rays = RaySet::default();
    for i in 0..n {
        rays.push(random.point().map(|p| 1.2 * p), random.point());
        rays.t_max[i] = 3.0 * random.unit();
        rays.leaves[i] = random.below(triangles) as u32;
        rays.reaches[i] = random.below(triangles) as u32;
        // Some rays that are none, anywhere among the others.
        if i % 11 == 3 {
            rays.direction[i] = [f32::NAN, 1.0, 0.0];
        }
    }
    rays
}

#[test]
fn on_meshes_of_all_kinds() {
    for mesh in [cube(), random_soup(5000, 21), bumpy_sphere(4, 0.1)] {
        let geometry = Geometry::build(&mesh);
        let bvh = geometry.bvh();
        let rays = random_rays(mesh.triangles(), 3000);
        let expected = alone(bvh, &rays);
        assert!(expected.iter().filter(|e| e.0 != NO_PRIMITIVE).count() > 800);
        assert!(expected == together::<1>(bvh, &rays));
        assert!(expected == together::<8>(bvh, &rays));
        assert!(expected == together::<32>(bvh, &rays));
        assert!(expected == together::<64>(bvh, &rays));
        assert!(expected == packets(bvh, &rays));
        if let Some(found) = by_avx512(bvh, &rays) {
            assert!(expected == found);
        }
    }
}

#[test]
fn of_any_length_and_along_axes() {
    let mesh = cube();
    let geometry = Geometry::build(&mesh);
    let bvh = geometry.bvh();
    let mut random = Random(52);
    let mut rays = RaySet::default();
    for i in 0..4000 {
        // Often exactly along an axis or a diagonal of the cube, at its edges and corners.
        let coarse = |x: f32| (2.0 * x).round() * 0.5;
        let origin = random.point().map(|p| coarse(1.6 * p));
        let length = 10f32.powi(i % 83 - 44);
        let direction = random.point().map(|p| length * coarse(p));
        rays.push(origin, direction.map(|d| if i % 2 == 0 { -d } else { d }));
        rays.t_max[i as usize] = 2.0 / length;
    }
    let expected = alone(bvh, &rays);
    assert!(expected.iter().filter(|e| e.0 != NO_PRIMITIVE).count() > 800);
    assert!(expected.iter().filter(|e| e.4 == 1).count() > 400);
    assert!(expected == together::<32>(bvh, &rays));
    assert!(expected == packets(bvh, &rays));
    if let Some(found) = by_avx512(bvh, &rays) {
        for (i, (expected, found)) in expected.iter().zip(&found).enumerate() {
            let ray = (rays.origin[i], rays.direction[i], rays.t_max[i]);
            assert_eq!(expected, found, "{ray:?}");
        }
    }
}

/// Triangles in the planes of a lattice of eighths, many of them through the origin: boxes without a
/// thickness.
fn flat_triangles(n: usize) -> Mesh {
    let mut random = Random(54);
    let mut place = || {
        let mut eighth = || (8.0 * random.signed()).round() / 8.0;
        let corner = [eighth(), eighth(), eighth()];
        let axis = random.below(3);
        let mut corners = [corner; 3];
        corners[1][(axis + 1) % 3] += 0.25;
        corners[2][(axis + 2) % 3] += 0.25;
        corners
    };
    soup(&(0..n).map(|_| place()).collect::<Vec<_>>())
}

#[test]
fn in_planes_and_almost_along_axes() {
    // Components whose reciprocals are limited, and those just above, of either sign.
    let small = [0.0, 1e-45, 1e-38, 1e-25, 5.4e-20, 5.5e-20, 1e-12, 1e-7, 0.3];
    for scale in [1e-6, 1.0, 1e6, 1e15] {
        let mesh = moved(flat_triangles(3000), scale, [0.0; 3]);
        let geometry = Geometry::build(&mesh);
        let mut random = Random(55);
        let mut rays = RaySet::default();
        for i in 0..6000 {
            let main = random.below(3);
            let origin = random.point().map(|p| scale * (8.0 * p).round() / 8.0);
            let mut direction = [(); 3].map(|()| small[random.below(small.len())]);
            direction[main] = 1.0;
            let mut sign = || if random.unit() < 0.5 { -1.0 } else { 1.0 };
            rays.push(origin, direction.map(|d: f32| d * sign()));
            rays.t_max[i] = 0.5 * scale;
        }
        let expected = alone(geometry.bvh(), &rays);
        let met = expected.iter().filter(|e| e.0 != NO_PRIMITIVE).count();
        assert!(met > 2000, "{met} at scale {scale}");
        assert!(expected == together::<32>(geometry.bvh(), &rays));
        let Some(found) = by_avx512(geometry.bvh(), &rays) else {
            continue;
        };
        for (i, (expected, found)) in expected.iter().zip(&found).enumerate() {
            let ray = (rays.origin[i], rays.direction[i], rays.t_max[i]);
            assert_eq!(expected, found, "{ray:?}");
        }
    }
}

#[test]
fn for_any_number_of_rays() {
    let mesh = random_soup(300, 22);
    let geometry = Geometry::build(&mesh);
    for n in (0..70).chain([127, 128, 129]) {
        let rays = random_rays(mesh.triangles(), n);
        let bvh = geometry.bvh();
        let expected = alone(bvh, &rays);
        assert!(expected == together::<32>(bvh, &rays), "{n} rays");
        if let Some(found) = by_avx512(bvh, &rays) {
            assert!(expected == found, "{n} rays");
        }
        let rays = truncated(bundles(mesh.triangles(), n.div_ceil(20), 0.01), n);
        assert!(
            alone(bvh, &rays) == packets(bvh, &rays),
            "{n} rays in packets"
        );
    }
}

/// The first `n` rays.
fn truncated(mut rays: RaySet, n: usize) -> RaySet {
    rays.origin.truncate(n);
    rays.direction.truncate(n);
    rays
}

/// Rays in bundles of 40, each about one direction: `width` wide, from within `width` of a point.
fn bundles(triangles: usize, bundles: usize, width: f32) -> RaySet {
    let mut random = Random(52);
    let mut rays = RaySet::default();
    for _ in 0..bundles {
        let (at, towards) = (random.point().map(|p| 1.2 * p), random.point());
        // Of any length: also one whose distances f32 cannot hold in its unit.
        let length = 10f32.powf(40.0 * random.signed()).clamp(1e-36, 1e36);
        let pinhole = random.unit() < 0.5;
        for _ in 0..40 {
            let (a, b) = (random.point(), random.point());
            let spread = if pinhole { 0.0 } else { width };
            rays.push(
                std::array::from_fn(|k| at[k] + spread * a[k]),
                std::array::from_fn(|k| length * (towards[k] + width * b[k])),
            );
            *rays.leaves.last_mut().unwrap() = random.below(triangles) as u32;
        }
    }
    rays
}

#[test]
fn in_packets_of_rays_that_go_the_same_way() {
    for mesh in [cube(), random_soup(5000, 21), bumpy_sphere(4, 0.1)] {
        let geometry = Geometry::build(&mesh);
        for width in [0.0, 1e-6, 1e-3, 0.03, 0.2] {
            let rays = bundles(mesh.triangles(), 400, width);
            let expected = alone(geometry.bvh(), &rays);
            assert!(expected.iter().filter(|e| e.0 != NO_PRIMITIVE).count() > 800);
            assert!(expected == packets(geometry.bvh(), &rays), "width {width}");
        }
    }
}

#[test]
fn in_packets_where_triangles_tie() {
    // Every triangle three times, and rays at vertices and along edges, where more than one is met
    // at one distance.
    let mut sphere = bumpy_sphere(3, 0.1);
    let thrice = sphere.indices.repeat(3);
    sphere.material = vec![0; thrice.len()];
    sphere.indices = thrice;
    let geometry = Geometry::build(&sphere);
    let mut random = Random(53);
    let mut rays = RaySet::default();
    for _ in 0..500 {
        let corners = sphere.corners(random.below(sphere.triangles()));
        let origin = random.point().map(|p| 0.2 * p);
        for i in 0..24 {
            let s = if i % 3 == 0 { 0.0 } else { random.unit() };
            let to = |k: usize| corners[0][k] + s * (corners[1][k] - corners[0][k]);
            rays.push(origin, std::array::from_fn(|k| to(k) - origin[k]));
        }
    }
    let expected = alone(geometry.bvh(), &rays);
    assert!(
        expected.iter().all(|e| e.0 < 1280),
        "the first of three, always"
    );
    assert!(expected == packets(geometry.bvh(), &rays));
}

/// All triangles, as the kernel for few of them takes them.
fn all(mesh: &Mesh) -> Vec<Triangle> {
    (0..mesh.triangles())
        .map(|i| Triangle {
            primitive: i as u32,
            corners: mesh.indices[i].map(|v| u8::try_from(v).expect("few vertices")),
        })
        .collect()
}

#[test]
fn without_a_tree() {
    // The tree may cull a triangle seen edge-on whose computed distance is before its own box; none
    // of these rays meets one.
    let small = (1..20).map(|n| random_soup(n, n as u64));
    for mesh in [cube(), random_soup(80, 23), bumpy_sphere(1, 0.1)]
        .into_iter()
        .chain(small)
    {
        let geometry = Geometry::build(&mesh);
        let triangles = all(&mesh);
        let few = Few {
            vertices: &mesh.vertices,
            triangles: &triangles,
        };
        for n in [0, 1, 7, 8, 127, 128, 129, 3000] {
            let rays = random_rays(mesh.triangles(), n);
            let found = answers(
                &rays,
                |r, h| few::closest(few, r, h),
                |s, o| few::occluded(few, s, o),
            );
            let expected = alone(geometry.bvh(), &rays);
            assert!(found == expected, "{n} rays");
            // By AVX-512 where there is any.
            let found = answers(
                &rays,
                |r, h| many::closest_of_few(few, r, h),
                |s, o| many::occluded_by_few(few, s, o),
            );
            assert!(found == expected, "{n} rays, {} form", many::form());
        }
    }
}

#[test]
fn without_a_tree_at_edges_and_along_axes() {
    // Every ray through a lattice on which the cube's edges and corners lie: most are in doubt.
    let mesh = cube();
    let geometry = Geometry::build(&mesh);
    let few = Few {
        vertices: &mesh.vertices,
        triangles: &all(&mesh),
    };
    let mut random = Random(56);
    let mut rays = RaySet::default();
    for i in 0..4000 {
        let coarse = |x: f32| (2.0 * x).round() * 0.5;
        let origin = random.point().map(|p| coarse(1.6 * p));
        let length = 10f32.powi(i % 83 - 44);
        rays.push(origin, random.point().map(|p| length * coarse(p)));
        rays.t_max[i as usize] = 2.0 / length;
        rays.leaves[i as usize] = random.below(24) as u32;
    }
    let expected = alone(geometry.bvh(), &rays);
    assert!(expected.iter().filter(|e| e.0 != NO_PRIMITIVE).count() > 800);
    let portable = answers(
        &rays,
        |r, h| few::closest(few, r, h),
        |s, o| few::occluded(few, s, o),
    );
    let fastest = answers(
        &rays,
        |r, h| many::closest_of_few(few, r, h),
        |s, o| many::occluded_by_few(few, s, o),
    );
    for i in 0..rays.len() {
        let ray = (rays.origin[i], rays.direction[i], rays.t_max[i]);
        assert_eq!(portable[i], fastest[i], "{ray:?}, {} form", many::form());
        assert_eq!(portable[i], expected[i], "{ray:?}");
    }
}

#[test]
fn in_an_empty_scene() {
    let geometry = Geometry::default();
    let rays = random_rays(1, 100);
    let hits = together::<32>(geometry.bvh(), &rays);
    assert!(hits.iter().all(|h| *h == (NO_PRIMITIVE, 0, 0, 0, 0)));
    assert!(hits == alone(geometry.bvh(), &rays));
    assert!(hits == packets(geometry.bvh(), &rays));
}
