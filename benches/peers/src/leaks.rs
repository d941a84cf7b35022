//! Rays from inside a closed mesh: each has to meet it.

use crate::embree::{Device, Quality, Scene, Single};
use crate::ours::Ours;
use crate::queue::{Closest, Found, Queue};
use crate::random::Random;
use crate::sphere;
use crate::table::Table;
use glam::Vec3;
use huygens::geometry::Preset;
use huygens::scene::Mesh;
use huygens_kernels::rays::NO_PRIMITIVE;

/// Rays a queue.
const QUEUE: usize = 1 << 18;

/// Where rays are aimed.
#[derive(Clone, Copy, Debug)]
enum Aim {
    Anywhere,
    Vertex,
    Edge,
}

/// `n` rays from within a fifth of the radius about the middle.
fn rays(mesh: &Mesh, aim: Aim, n: usize, random: &mut Random) -> Queue {
    let mut queue = Queue::with_capacity(n);
    for _ in 0..n {
        let origin = random.point(Vec3::splat(-0.1), Vec3::splat(0.1));
        let [a, b, _] = mesh
            .corners(random.below(mesh.triangles()))
            .map(Vec3::from_array);
        let direction = match aim {
            Aim::Anywhere => random.direction(),
            Aim::Vertex => a - origin,
            Aim::Edge => a + random.unit() * (b - a) - origin,
        };
        queue.push(origin, direction, f32::INFINITY, NO_PRIMITIVE);
    }
    queue.finish()
}

fn escapes(tracer: &dyn Closest, rays: &Queue) -> usize {
    let mut found = Found::new(rays.len());
    tracer.closest(rays, &mut found);
    let hits = &found.primitive[..rays.len()];
    hits.iter().filter(|&&p| p == NO_PRIMITIVE).count()
}

/// Rays of each kind that escape from a sphere of `20 * 4^level` triangles, of `n` a kind.
///
/// # Errors
/// If Embree fails to build.
pub(crate) fn table(level: u32, n: usize, threads: usize) -> Result<Table, String> {
    let mesh = sphere::displaced(level);
    let device = Device::new(threads)?;
    let scene = |robust| Scene::prepare(&device, &mesh, Quality::Medium, robust)?.commit();
    let (plain, robust, ours) = (
        scene(false)?,
        scene(true)?,
        Ours::build(&mesh, Preset::default()),
    );
    let (plain, robust) = (Single(&plain), Single(&robust));
    let tracers: [(&str, &dyn Closest); 3] = [
        ("Huygens", &ours),
        ("Embree robust", &robust),
        ("Embree default", &plain),
    ];
    let aims = [Aim::Anywhere, Aim::Vertex, Aim::Edge];
    let mut counts = [[0; 3]; 3];
    for (a, &aim) in aims.iter().enumerate() {
        let mut random = Random(5);
        for start in (0..n).step_by(QUEUE) {
            let rays = rays(&mesh, aim, QUEUE.min(n - start), &mut random);
            for (t, (_, tracer)) in tracers.iter().enumerate() {
                counts[t][a] += escapes(*tracer, &rays);
            }
        }
    }
    let mut table = Table::new(&["escapes", "at random", "at vertices", "at edges"]);
    for ((name, _), counts) in tracers.iter().zip(counts) {
        let counts = counts.iter().map(ToString::to_string);
        table.row([(*name).to_owned()].into_iter().chain(counts).collect());
    }
    Ok(table)
}
