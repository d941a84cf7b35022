//! What the presets cost to build and bring to rays.
//!
//!     cargo bench --bench trees [-- MESH|SCENE...]
//!
//! For each mesh and preset: the build's wall-clock time with one and with two threads, the tree's
//! size and expected cost, and the rate of rays after the first and the second diffuse bounce, in
//! millions a second of this thread's CPU time. Presets alternate within a round, and each gets the
//! median of its rounds. A name that is no mesh's is taken for a scene file.

#[path = "../../tests/tracing/mod.rs"]
mod tracing;

use huygens::geometry::{Geometry, Preset};
use huygens::scene::Mesh;
use huygens_kernels::rays::NO_PRIMITIVE;
use tracing::{Random, RaySet, bumpy_sphere, meshes};

const PRESETS: [(&str, Preset); 3] = [
    ("fast", Preset::Fast),
    ("balanced", Preset::Balanced),
    ("best", Preset::Best),
];
/// Times that each preset builds and traces.
const ROUNDS: usize = 5;
/// Rays of each kind.
const RAYS: usize = 1 << 16;

fn mesh(name: &str) -> Mesh {
    match name {
        "clutter" => meshes::clutter(10_000),
        "sticks" => meshes::sticks(300_000),
        "sphere" => bumpy_sphere(8, 0.002),
        file => {
            let scene = huygens::scene::load(std::path::Path::new(file));
            scene.expect("a scene that loads").mesh
        }
    }
}

fn main() {
    // cargo passes `--bench`; what is left are names.
    let mut names: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    if names.is_empty() {
        let all = [
            "clutter",
            "sticks",
            "sphere",
            "scenes/bedroom.toml",
            "scenes/cornell-box.toml",
        ];
        names.extend(all.map(str::to_owned));
    }
    for name in names {
        measure(&name, &mesh(&name));
    }
}

fn measure(name: &str, mesh: &Mesh) {
    let n = mesh.triangles() as f64;
    println!("{name}: {n} triangles");
    let pools = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("threads start")
    });
    let mut rows = [(); PRESETS.len()].map(|()| [const { Vec::new() }; 4]);
    let mut built: Vec<Geometry> = Vec::new();
    for round in 0..ROUNDS {
        for (preset, row) in rows.iter_mut().enumerate() {
            for (pool, times) in pools.iter().zip(row.iter_mut()) {
                let start = if std::env::var("CPU").is_ok() {
                    cpu(libc::CLOCK_PROCESS_CPUTIME_ID)
                } else {
                    cpu(libc::CLOCK_MONOTONIC)
                };
                let geometry = pool.install(|| Geometry::build_with(mesh, PRESETS[preset].1));
                times.push(
                    n / (if std::env::var("CPU").is_ok() {
                        cpu(libc::CLOCK_PROCESS_CPUTIME_ID)
                    } else {
                        cpu(libc::CLOCK_MONOTONIC)
                    } - start)
                        * 1e-6,
                );
                if round == 0 && built.len() == preset {
                    built.push(geometry);
                }
            }
        }
    }
    let bounces = bounces(mesh, &built[0]);
    for _ in 0..ROUNDS {
        for (geometry, row) in built.iter().zip(rows.iter_mut()) {
            for (rays, rates) in bounces.iter().zip(&mut row[2..]) {
                rates.push(rate(geometry, rays));
            }
        }
    }
    println!("  preset    SAH    refs/tri  B/tri  Mtris/s, 1 and 2 threads   Mrays/s b1     b2");
    for (i, row) in rows.iter_mut().enumerate() {
        let bytes: usize = built[i].memory().iter().map(|(_, bytes)| bytes).sum();
        let [one, two, b1, b2] = row.each_mut().map(|values| median(values));
        println!(
            "  {:9}{:7.2}{:9.3}{:8.1}{one:12.2}{two:8.2}{b1:20.2}{b2:8.2}",
            PRESETS[i].0,
            built[i].sah_cost(),
            built[i].triangles() as f64 / n,
            bytes as f64 / n,
        );
    }
}

/// Rays after the first and the second diffuse bounce of paths that begin in the middle.
fn bounces(mesh: &Mesh, geometry: &Geometry) -> [RaySet; 2] {
    let mut random = Random(3);
    let [low, high] = geometry.bounds().expect("something to hit");
    let mut rays = RaySet::default();
    for _ in 0..2 * RAYS {
        // A little off the centre, which a mesh may use.
        let origin = std::array::from_fn(|a| low[a] + (high[a] - low[a]) * [0.43, 0.54, 0.47][a]);
        rays.push(origin, direction(&mut random));
    }
    [(); 2].map(|()| {
        let hits = rays.closest(geometry);
        let mut next = RaySet::default();
        for (i, hit) in hits.iter().enumerate() {
            if hit.primitive == NO_PRIMITIVE || next.len() == RAYS {
                continue;
            }
            let [a, b, c] = mesh.corners(hit.primitive as usize);
            let (p, q) = (sub(b, a), sub(c, a));
            let n: [f32; 3] = std::array::from_fn(|k| {
                p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3]
            });
            let length = dot(n, n).sqrt();
            let side = if dot(n, rays.direction[i]) > 0.0 {
                -1.0
            } else {
                1.0
            };
            // A uniform unit vector added to the normal: cosine distributed.
            let d = direction(&mut random);
            let d = std::array::from_fn(|k| d[k] + side * n[k] / length);
            let origin = std::array::from_fn(|k| a[k] + hit.u * p[k] + hit.v * q[k]);
            next.push(origin, d);
            *next.leaves.last_mut().expect("just pushed") = hit.primitive;
        }
        rays = next.clone();
        next
    })
}

fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Uniform over the sphere.
fn direction(random: &mut Random) -> [f32; 3] {
    loop {
        let d = random.point();
        let length = dot(d, d).sqrt();
        if length > 0.0 && length <= 1.0 {
            return d.map(|e| e / length);
        }
    }
}

/// Millions of rays a CPU second.
fn rate(geometry: &Geometry, rays: &RaySet) -> f64 {
    let start = cpu(libc::CLOCK_THREAD_CPUTIME_ID);
    std::hint::black_box(rays.closest(geometry));
    rays.len() as f64 / (cpu(libc::CLOCK_THREAD_CPUTIME_ID) - start) * 1e-6
}

fn cpu(clock: libc::clockid_t) -> f64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: `time` is a valid place for the answer.
    unsafe { libc::clock_gettime(clock, &raw mut time) };
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
