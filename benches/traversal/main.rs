//! Rays a second of the traversal kernels, single ray and many in flight, by mesh and by kind of
//! ray.
//!
//!     cargo bench --bench traversal [-- MESH...]
//!
//! Every variant sees the same rays, in batches of the size a wave has; variants alternate, and
//! each gets the median of its rounds in seconds of this thread's CPU time, so that what else the
//! machine does matters little. Figures are millions of rays a CPU second, then ratios to the
//! single-ray form.

mod meshes;
mod rays;

use huygens::geometry::Geometry;
use huygens::scene::Mesh;
use huygens_kernels::few::{Few, Triangle};
use huygens_kernels::{few, flight, many, packet, traverse};
use rays::{Answers, RayBuffer};

/// Rays in a call.
const BATCH: usize = 2048;
/// Times that each variant is timed.
const ROUNDS: usize = 3;

fn main() {
    // cargo passes `--bench`; what is left are names.
    let asked: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    for (name, make) in meshes::ALL {
        if asked.is_empty() || asked.iter().any(|a| a == name) {
            measure(name, &make());
        }
    }
}

fn measure(name: &str, mesh: &Mesh) {
    let start = cpu_seconds(libc::CLOCK_MONOTONIC);
    let geometry = Geometry::build(mesh);
    let built = cpu_seconds(libc::CLOCK_MONOTONIC) - start;
    let n = mesh.triangles() as f64;
    let bytes: usize = geometry.memory().iter().map(|(_, bytes)| bytes).sum();
    println!(
        "{name}: {n} triangles, built in {built:.3} s ({:.2} Mtris/s), {:.1} bytes a triangle, depth {}, SAH {:.2}, {:.2} triangles a block",
        n / built * 1e-6,
        bytes as f64 / n,
        geometry.depth(),
        geometry.sah_cost(),
        geometry.triangles() as f64 / geometry.blocks() as f64,
    );
    let camera = rays::camera(mesh, 256, 1.0);
    // 16 samples a pixel, some of the pixels of an image of 1024 by 1024.
    let spp16 = rays::camera(mesh, 256, 16.0);
    let b1 = rays::diffuse(mesh, &camera, &trace(&geometry, &camera), 1);
    let b2 = rays::diffuse(mesh, &b1, &trace(&geometry, &b1), 2);
    let sh1 = rays::shadow(mesh, &camera, &trace(&geometry, &camera), 3);
    let bvh = geometry.bvh();
    let corner = |v: u32| u8::try_from(v).ok();
    let triangle = |i: usize| {
        let [a, b, c] = mesh.indices[i].map(corner);
        Some(Triangle {
            primitive: i as u32,
            corners: [a?, b?, c?],
        })
    };
    // None if a vertex is not one of the few that the kernel takes.
    let triangles: Option<Vec<Triangle>> = (0..mesh.triangles()).map(triangle).collect();
    let mut closest: Vec<(&str, Box<Run>)> = vec![
        (
            "one",
            Box::new(|r, a, i, n| traverse::closest(bvh, r.rays(i, n), a.hits(i, n))),
        ),
        (
            "8",
            Box::new(|r, a, i, n| flight::closest::<8>(bvh, r.rays(i, n), a.hits(i, n))),
        ),
        (
            "32",
            Box::new(|r, a, i, n| flight::closest::<32>(bvh, r.rays(i, n), a.hits(i, n))),
        ),
        (
            "many",
            Box::new(|r, a, i, n| many::closest(bvh, r.rays(i, n), a.hits(i, n))),
        ),
        (
            "packet",
            Box::new(|r, a, i, n| packet::closest(bvh, r.rays(i, n), a.hits(i, n))),
        ),
    ];
    let mut occluded: Vec<(&str, Box<Run>)> = vec![
        (
            "one",
            Box::new(|r, a, i, n| traverse::occluded(bvh, r.segments(i, n), a.occluded(i, n))),
        ),
        (
            "8",
            Box::new(|r, a, i, n| flight::occluded::<8>(bvh, r.segments(i, n), a.occluded(i, n))),
        ),
        (
            "32",
            Box::new(|r, a, i, n| flight::occluded::<32>(bvh, r.segments(i, n), a.occluded(i, n))),
        ),
        (
            "many",
            Box::new(|r, a, i, n| many::occluded(bvh, r.segments(i, n), a.occluded(i, n))),
        ),
    ];
    if let Some(triangles) = &triangles {
        let all = Few {
            vertices: &mesh.vertices,
            triangles,
        };
        closest.push((
            "few",
            Box::new(move |r, a, i, n| few::closest(all, r.rays(i, n), a.hits(i, n))),
        ));
        occluded.push((
            "few",
            Box::new(move |r, a, i, n| few::occluded(all, r.segments(i, n), a.occluded(i, n))),
        ));
    }
    for (kind, set) in [
        ("camera", &camera),
        ("16 spp", &spp16),
        ("b1", &b1),
        ("b2", &b2),
    ] {
        report(kind, set, &closest);
    }
    report("sh1", &sh1, &occluded);
}

/// A kernel over some of the rays.
type Run<'a> = dyn Fn(&RayBuffer, &mut Answers, usize, usize) + 'a;

fn trace(geometry: &Geometry, rays: &RayBuffer) -> Answers {
    let mut answers = Answers::new(rays.len());
    traverse::closest(
        geometry.bvh(),
        rays.rays(0, rays.len()),
        answers.hits(0, rays.len()),
    );
    answers
}

fn report(kind: &str, rays: &RayBuffer, variants: &[(&str, Box<Run>)]) {
    let mut answers = Answers::new(rays.len());
    // Small sets are repeated until a round takes long enough to time.
    let repeats = (1 << 17) / rays.len().max(1) + 1;
    let mut seconds = vec![Vec::new(); variants.len()];
    for round in 0..=ROUNDS {
        for (variant, (_, run)) in variants.iter().enumerate() {
            let start = cpu_seconds(libc::CLOCK_THREAD_CPUTIME_ID);
            for _ in 0..repeats {
                for i in (0..rays.len()).step_by(BATCH) {
                    run(rays, &mut answers, i, BATCH.min(rays.len() - i));
                }
            }
            // The first round warms up.
            if round > 0 {
                seconds[variant].push(cpu_seconds(libc::CLOCK_THREAD_CPUTIME_ID) - start);
            }
        }
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let medians: Vec<f64> = seconds.iter_mut().map(median).collect();
    let total = (rays.len() * repeats) as f64 * 1e-6;
    print!("  {kind:<7}{:>8}", rays.len());
    for ((name, _), seconds) in variants.iter().zip(&medians) {
        let ratio = medians[0] / seconds;
        print!("   {name}: {:.2} ({ratio:.2})", total / seconds);
    }
    println!();
}

/// Seconds on one of the system's clocks.
fn cpu_seconds(clock: libc::clockid_t) -> f64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: `time` is a valid place to write to; the call touches nothing else.
    let status = unsafe { libc::clock_gettime(clock, &raw mut time) };
    assert_eq!(status, 0, "this system has no such clock");
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}
