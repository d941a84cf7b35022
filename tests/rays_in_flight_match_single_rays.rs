//! However many rays are under way together, each gets the answer it gets alone, bit for bit.

mod tracing;

use huygens::geometry::Geometry;
use huygens::scene::Mesh;
use huygens_kernels::bvh::Bvh;
use huygens_kernels::few::Triangle;
use huygens_kernels::lanes::padded;
use huygens_kernels::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use huygens_kernels::{few, flight, traverse};
use tracing::{Random, RaySet, bumpy_sphere, cube, random_soup};

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
    }
}

#[test]
fn for_any_number_of_rays() {
    let mesh = random_soup(300, 22);
    let geometry = Geometry::build(&mesh);
    for n in (0..70).chain([127, 128, 129]) {
        let rays = random_rays(mesh.triangles(), n);
        let bvh = geometry.bvh();
        assert!(alone(bvh, &rays) == together::<32>(bvh, &rays), "{n} rays");
    }
}

/// All triangles, as the kernel for few of them takes them.
fn all(mesh: &Mesh) -> Vec<Triangle> {
    (0..mesh.triangles())
        .map(|i| Triangle {
            primitive: i as u32,
            corners: mesh.corners(i),
        })
        .collect()
}

#[test]
fn without_a_tree() {
    // The tree may cull a triangle seen edge-on whose computed distance is before its own box; none
    // of these rays meets one.
    let small = (1..20).map(|n| random_soup(n, n as u64));
    for mesh in [cube(), random_soup(90, 23), bumpy_sphere(1, 0.1)]
        .into_iter()
        .chain(small)
    {
        let geometry = Geometry::build(&mesh);
        let triangles = all(&mesh);
        for n in [0, 1, 7, 8, 127, 128, 129, 3000] {
            let rays = random_rays(mesh.triangles(), n);
            let found = answers(
                &rays,
                |r, h| few::closest(&triangles, r, h),
                |s, o| few::occluded(&triangles, s, o),
            );
            assert!(found == alone(geometry.bvh(), &rays), "{n} rays");
        }
    }
}

#[test]
fn in_an_empty_scene() {
    let geometry = Geometry::default();
    let rays = random_rays(1, 100);
    let hits = together::<32>(geometry.bvh(), &rays);
    assert!(hits.iter().all(|h| *h == (NO_PRIMITIVE, 0, 0, 0, 0)));
    assert!(hits == alone(geometry.bvh(), &rays));
}
