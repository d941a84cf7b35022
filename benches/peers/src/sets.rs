//! The sets of rays that a path tracer asks: from the camera, from the first and the second
//! diffuse bounce, and to the light from where the first bounce arrived.
//!
//! A set is filled by going over the hits before it again, with other numbers, until it is full;
//! so all sets have the same length although some rays leave the scene.

use crate::catalogue::{Camera, Subject};
use crate::queue::{Closest, Found, Queue};
use crate::random::Random;
use glam::Vec3;
use huygens::scene::Mesh;
use huygens_kernels::rays::NO_PRIMITIVE;

/// Rays of a kind.
#[derive(Debug)]
pub(crate) struct Set {
    /// What is timed.
    pub(crate) queue: Queue,
    /// Others of the same kind, which bring a tracer's tree into the caches.
    pub(crate) warm_up: Queue,
}

/// The sets of one mesh.
#[derive(Debug)]
pub(crate) struct Sets {
    /// Camera rays, in squares of four by four pixels.
    pub(crate) camera: Set,
    /// Cosine-weighted, from what the camera sees.
    pub(crate) b1: Set,
    /// Cosine-weighted, from what `b1` meets.
    pub(crate) b2: Set,
    /// From what `b1` meets to points on the light.
    pub(crate) sh1: Set,
}

impl Sets {
    /// Sets of `n` rays and `warm_up` others, multiples of 16; hits are found by `tracer`.
    ///
    /// # Errors
    /// If the camera sees nothing, or nothing that it sees faces the light.
    pub(crate) fn make(
        subject: &Subject,
        tracer: &impl Closest,
        n: usize,
        warm_up: usize,
    ) -> Result<Self, String> {
        let set = |rays: &dyn Fn(usize, u64) -> Result<Queue, String>, seed| {
            Ok::<_, String>(Set {
                queue: rays(n, seed)?,
                warm_up: rays(warm_up, seed + 1000)?,
            })
        };
        let meet = |rays: &Queue| {
            let mut found = Found::new(rays.len());
            tracer.closest(rays, &mut found);
            Surfaces::new(&subject.mesh, rays, &found)
        };
        let camera = set(&|n, seed| Ok(camera(&subject.camera, n, seed)), 7)?;
        let seen = meet(&camera.queue);
        let b1 = set(&|n, seed| seen.bounce(n, seed), 11)?;
        let after = meet(&b1.queue);
        let b2 = set(&|n, seed| after.bounce(n, seed), 22)?;
        let sh1 = set(&|n, seed| after.shadow(subject.light, n, seed), 33)?;
        Ok(Self {
            camera,
            b1,
            b2,
            sh1,
        })
    }
}

/// `n` rays through a square image, a square of 16 pixels after the other: the order in which
/// packets of 16 are most coherent.
fn camera(camera: &Camera, n: usize, seed: u64) -> Queue {
    let across = ((n as f64 / 16.0).sqrt().ceil() as usize).max(1);
    let pixel = 2.0 / (4 * across) as f32;
    let mut random = Random(seed);
    let mut queue = Queue::with_capacity(n);
    queue.coherent = true;
    for i in 0..n {
        let (square, within) = (i / 16, i % 16);
        let column = 4 * (square % across) + within % 4;
        let row = 4 * (square / across) + within / 4;
        let x = (column as f32 + random.unit()).mul_add(pixel, -1.0);
        let y = (row as f32 + random.unit()).mul_add(-pixel, 1.0);
        let direction = (camera.forward + x * camera.right + y * camera.up).normalize();
        queue.push(camera.eye, direction, f32::INFINITY, NO_PRIMITIVE);
    }
    queue.finish()
}

/// What rays met: points a little off the surface, with the normal there.
struct Surfaces(Vec<(Vec3, Vec3, u32)>);

impl Surfaces {
    /// Points lie off their surface by 256 roundings of the scene's largest coordinate: more than
    /// any triangle test here loses, so that no ray meets the triangle that it leaves, whether or
    /// not the tracer is told which that is.
    fn new(mesh: &Mesh, rays: &Queue, found: &Found) -> Self {
        let largest = mesh.vertices.iter().flatten();
        let largest = largest.fold(0f32, |m, c| m.max(c.abs()));
        let offset = f64::from(largest) * 256.0 / f64::from(1 << 24);
        let met = (0..rays.len()).filter(|&i| found.primitive[i] != NO_PRIMITIVE);
        let surface = |i: usize| {
            let primitive = found.primitive[i];
            let [a, b, c] = mesh
                .corners(primitive as usize)
                .map(|p| Vec3::from_array(p).as_dvec3());
            let normal = (b - a).cross(c - a).normalize();
            let towards = rays.direction(i).as_dvec3().dot(normal);
            let normal = if towards > 0.0 { -normal } else { normal };
            let (u, v) = (f64::from(found.u[i]), f64::from(found.v[i]));
            let point = a + u * (b - a) + v * (c - a) + offset * normal;
            (point.as_vec3(), normal.as_vec3(), primitive)
        };
        Self(met.map(surface).collect())
    }

    /// Goes over the surfaces until `n` rays are made; `ray` may decline.
    fn fill(
        &self,
        n: usize,
        mut ray: impl FnMut(Vec3, Vec3) -> Option<(Vec3, f32)>,
    ) -> Result<Queue, String> {
        let mut queue = Queue::with_capacity(n);
        while queue.len() < n {
            let before = queue.len();
            for &(point, normal, primitive) in &self.0 {
                if let Some((direction, t_max)) = ray(point, normal)
                    && queue.len() < n
                {
                    queue.push(point, direction, t_max, primitive);
                }
            }
            if queue.len() == before {
                return Err("no rays to trace: the camera or the light sees nothing".to_owned());
            }
        }
        Ok(queue.finish())
    }

    fn bounce(&self, n: usize, seed: u64) -> Result<Queue, String> {
        let mut random = Random(seed);
        self.fill(n, |_, normal| Some((random.cosine(normal), f32::INFINITY)))
    }

    fn shadow(&self, light: [Vec3; 3], n: usize, seed: u64) -> Result<Queue, String> {
        let mut random = Random(seed);
        self.fill(n, |point, normal| {
            let target = light[0] + random.unit() * light[1] + random.unit() * light[2];
            let (direction, length) = (target - point).normalize_and_length();
            (direction.dot(normal) > 0.0).then_some((direction, length))
        })
    }
}
