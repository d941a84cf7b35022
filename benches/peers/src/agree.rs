//! Whether two tracers meet the same triangles at the same distances, and if not, who is right: the
//! judge intersects the triangles in question in f64.

use crate::queue::{Found, Queue};
use glam::{DVec3, Vec3};
use huygens::scene::Mesh;
use huygens_kernels::rays::NO_PRIMITIVE;

/// Two answers count as the same where they lie this many roundings apart, each of the size of an
/// f32 rounding of the largest number that the ray has to do with. A triangle test makes about ten
/// on each of three corners (subtraction, shear, edge function), so no sound one is further off.
const ROUNDINGS: f64 = 32.0;
const ULP: f64 = 1.0 / (1 << 24) as f64;

/// What became of a ray in two tracers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// The same triangle, or none.
    Same,
    /// Different ones, which rounding explains: equally near, or passed at an edge.
    Rounding,
    /// The first tracer missed the nearest triangle, or met what is not there.
    FirstWrong,
    /// The second did.
    SecondWrong,
}

/// How many rays had which verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Agreement {
    /// The same triangle, or none.
    pub(crate) same: usize,
    /// Different triangles, equally near or passed at an edge, but for rounding.
    pub(crate) rounding: usize,
    /// One of the two missed the nearest triangle or met what is not there: the first, the second.
    pub(crate) wrong: [usize; 2],
    /// A triangle's distance was further off than [`ROUNDINGS`]: the first's, the second's.
    pub(crate) distance: [usize; 2],
}

impl Agreement {
    /// Judges the answers of two tracers to `rays`.
    pub(crate) fn judge(mesh: &Mesh, rays: &Queue, first: &Found, second: &Found) -> Self {
        let mut counts = Self::default();
        for i in 0..rays.len() {
            let (origin, direction) = (rays.origin(i), rays.direction(i));
            let look = |found: &Found| {
                let primitive = found.primitive[i];
                let met = primitive != NO_PRIMITIVE;
                met.then(|| exact(mesh, origin, direction, primitive))
            };
            let exact = [look(first), look(second)];
            for (k, found) in [first, second].into_iter().enumerate() {
                let off = |x: &Exact| (f64::from(found.t[i]) - x.t).abs() > x.t_error;
                counts.distance[k] += usize::from(exact[k].as_ref().is_some_and(off));
            }
            *match verdict(exact) {
                Verdict::Same => &mut counts.same,
                Verdict::Rounding => &mut counts.rounding,
                Verdict::FirstWrong => &mut counts.wrong[0],
                Verdict::SecondWrong => &mut counts.wrong[1],
            } += 1;
        }
        counts
    }
}

/// What f64 says of a ray and a triangle.
struct Exact {
    primitive: u32,
    t: f64,
    /// How far `t` moves by rounding, seen along the ray: grazing rays suffer most.
    t_error: f64,
    /// Whether the ray passes inside.
    inside: bool,
    /// Whether it passes an edge so closely that rounding decides.
    at_edge: bool,
}

fn exact(mesh: &Mesh, origin: Vec3, direction: Vec3, primitive: u32) -> Exact {
    let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
    let corners = mesh
        .corners(primitive as usize)
        .map(|p| Vec3::from_array(p).as_dvec3() - o);
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize();
    let cos = normal.dot(d);
    let t = normal.dot(a) / cos;
    let largest = corners.iter().chain([&o]);
    let scale = largest.fold(0f64, |m, v| m.max(v.abs().max_element()));
    let error = ROUNDINGS * ULP * scale;
    // Signed distances of the ray's line from the three edges' lines.
    let distances = [(a, b), (b, c), (c, a)].map(|(p, q)| {
        let across = (q - p).cross(d);
        across.try_normalize().map_or(0.0, |n: DVec3| n.dot(p))
    });
    Exact {
        primitive,
        t,
        t_error: error / cos.abs(),
        inside: distances.iter().all(|&x| x >= 0.0) || distances.iter().all(|&x| x <= 0.0),
        at_edge: distances.iter().any(|x| x.abs() <= error),
    }
}

/// Of what the first and the second tracer claim to have met.
fn verdict(claims: [Option<Exact>; 2]) -> Verdict {
    // Whoever claims `x` is wrong if the ray passes it by; else the other is, for missing it.
    let nearer = |x: &Exact, claimant_wrong, other_wrong| {
        if x.at_edge {
            Verdict::Rounding
        } else if x.inside {
            other_wrong
        } else {
            claimant_wrong
        }
    };
    let (wrong_1, wrong_2) = (Verdict::FirstWrong, Verdict::SecondWrong);
    match claims {
        [None, None] => Verdict::Same,
        [Some(x), None] => nearer(&x, wrong_1, wrong_2),
        [None, Some(y)] => nearer(&y, wrong_2, wrong_1),
        [Some(x), Some(y)] if x.primitive == y.primitive => Verdict::Same,
        [Some(x), Some(y)] if (x.t - y.t).abs() <= x.t_error + y.t_error => Verdict::Rounding,
        [Some(x), Some(y)] if x.t < y.t => nearer(&x, wrong_1, wrong_2),
        [Some(_), Some(y)] => nearer(&y, wrong_2, wrong_1),
    }
}

/// Rays that the first calls blocked and the second free, and the other way round.
pub(crate) fn differences(n: usize, first: &[u32], second: &[u32]) -> (usize, usize) {
    let pairs = || first[..n].iter().zip(&second[..n]);
    (
        pairs().filter(|(a, b)| a > b).count(),
        pairs().filter(|(a, b)| a < b).count(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles 0 and 1 make a square at z = 1; 2 is the same square's half at z = 2.
    fn squares() -> Mesh {
        let corner = |x: f32, y: f32, z: f32| [x, y, z];
        Mesh {
            vertices: vec![
                corner(0.0, 0.0, 1.0),
                corner(1.0, 0.0, 1.0),
                corner(1.0, 1.0, 1.0),
                corner(0.0, 1.0, 1.0),
                corner(0.0, 0.0, 2.0),
                corner(1.0, 0.0, 2.0),
                corner(1.0, 1.0, 2.0),
            ],
            indices: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6]],
            material: vec![0; 3],
            ..Mesh::default()
        }
    }

    /// Judges a ray along z through `(x, y)`.
    fn judge(x: f32, y: f32, first: (u32, f32), second: (u32, f32)) -> Agreement {
        let mut queue = Queue::with_capacity(1);
        queue.push(Vec3::new(x, y, 0.0), Vec3::Z, f32::INFINITY, NO_PRIMITIVE);
        let found = |(primitive, t)| {
            let mut found = Found::new(1);
            (found.primitive[0], found.t[0]) = (primitive, t);
            found
        };
        Agreement::judge(&squares(), &queue.finish(), &found(first), &found(second))
    }

    #[test]
    fn the_judge_tells_rounding_from_errors() {
        const MISS: (u32, f32) = (NO_PRIMITIVE, 0.0);
        let none = Agreement::default();
        let same = Agreement { same: 1, ..none };
        let rounding = Agreement {
            rounding: 1,
            ..none
        };
        let [first, second] = [[1, 0], [0, 1]].map(|wrong| Agreement { wrong, ..none });
        // Well inside triangle 0.
        assert_eq!(judge(0.7, 0.2, (0, 1.0), (0, 1.0)), same);
        assert_eq!(judge(0.7, 0.2, (2, 2.0), (0, 1.0)), first);
        assert_eq!(judge(0.7, 0.2, (0, 1.0), MISS), second);
        assert_eq!(judge(0.7, 0.2, MISS, MISS), same);
        // It is not triangle 1 that lies there.
        assert_eq!(judge(0.7, 0.2, (1, 1.0), (2, 2.0)), first);
        // Across the diagonal, and off the square's border.
        assert_eq!(judge(0.5, 0.5, (0, 1.0), (1, 1.0)), rounding);
        assert_eq!(judge(0.5, -1e-7, (0, 1.0), MISS), rounding);
        assert_eq!(judge(0.5, -1e-3, (0, 1.0), MISS), first);
        // The right triangle at the wrong distance.
        let distance = [0, 1];
        let off = Agreement { distance, ..same };
        assert_eq!(judge(0.7, 0.2, (0, 1.0), (0, 1.001)), off);
    }
}
