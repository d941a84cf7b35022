//! Rays through worlds of two levels answer the same, bit for bit, by every form of the walk, whatever
//! they are known to meet.

mod tracing;

use huygens::geometry::{Geometry, Preset};
use huygens::scene::material::Alpha;
use huygens::scene::{Material, Motion};
use huygens_kernels::levels::{self, Everything, Filter};
use huygens_kernels::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use tracing::worlds::mixed;
use tracing::{Hit, Random, RaySet};

/// Checks of barycentric space that are not there for every other ray.
struct Holes;

impl Filter for Holes {
    const ASKS: bool = true;
    fn accepts(&self, ray: usize, primitive: u32, u: f32, v: f32) -> bool {
        let check = (4.0 * u) as usize + (4.0 * v) as usize + ray;
        !primitive.is_multiple_of(7) && check.is_multiple_of(2)
    }
}

/// What a walk is asked: rays, what they are known to meet, and when they live.
struct Question {
    rays: RaySet,
    known: Vec<Hit>,
    times: Vec<f32>,
}

impl Question {
    /// Rays of any length, some along axes, half of which meet something already.
    fn random(n: usize, names: usize, seed: u64) -> Self {
        let mut random = Random(seed);
        let (mut rays, mut known) = (RaySet::default(), Vec::new());
        for i in 0..n {
            rays.push(random.point(), random.point());
            let length = 10f32.powf(if i % 5 == 0 {
                37.0 * random.signed()
            } else {
                0.0
            });
            rays.direction[i] = rays.direction[i].map(|d| d * length);
            if i % 7 == 0 {
                rays.direction[i][i % 3] = if i % 2 == 0 { 0.0 } else { -0.0 };
            }
            let end = (1.5 * random.unit() / length).min(f32::MAX);
            rays.t_max[i] = if i % 4 == 0 { f32::INFINITY } else { end };
            (rays.leaves[i], rays.reaches[i]) =
                (random.below(names) as u32, random.below(names) as u32);
            known.push(Hit {
                primitive: if i % 2 == 0 { NO_PRIMITIVE } else { 0 },
                t: end,
                u: random.unit(),
                v: 0.25,
            });
        }
        rays.direction[0] = [f32::NAN, 1.0, 0.0];
        rays.direction[1] = [0.0; 3];
        let times = (0..n).map(|_| random.unit()).collect();
        Self { rays, known, times }
    }

    fn closest(
        &self,
        kernel: impl FnOnce(Option<&[f32]>, Rays, Hits),
        moves: bool,
    ) -> Vec<[u32; 4]> {
        let mut out = Vec::new();
        let known = |rays: Rays, hits: Hits| {
            for (i, hit) in self.known.iter().enumerate() {
                hits.primitive[i] = hit.primitive;
                (hits.t[i], hits.u[i], hits.v[i]) = (hit.t, hit.u, hit.v);
            }
            kernel(moves.then_some(&self.times), rays, hits);
        };
        self.rays.each(known, &mut out);
        let bits = |h: Hit| [h.primitive, h.t.to_bits(), h.u.to_bits(), h.v.to_bits()];
        out.into_iter().map(bits).collect()
    }

    fn occluded(
        &self,
        kernel: impl FnOnce(Option<&[f32]>, Segments, &mut [u32]),
        moves: bool,
    ) -> Vec<bool> {
        let mut all = Vec::new();
        let known = |segments: Segments, out: &mut [u32]| {
            (0..self.rays.len()).for_each(|i| out[i] = u32::from(i % 9 == 0));
            kernel(moves.then_some(&self.times), segments, out);
        };
        self.rays.each_segment(known, &mut all);
        all
    }

    /// Asks both forms and returns how many rays met something else than what they were known to.
    fn ask(&self, world: &levels::World, filter: &impl Filter, moves: bool) -> usize {
        let fast = self.closest(|t, r, h| levels::nearer(world, filter, t, r, h), moves);
        let portable = self.closest(
            |t, r, h| levels::nearer_without_avx512(world, filter, t, r, h),
            moves,
        );
        for i in 0..fast.len() {
            let ray = (self.rays.origin[i], self.rays.direction[i]);
            let unspecified = fast[i][0] == NO_PRIMITIVE && portable[i][0] == NO_PRIMITIVE;
            assert!(
                unspecified || fast[i] == portable[i],
                "ray {i}, {ray:?}: {:?}, {:?}",
                fast[i],
                portable[i]
            );
        }
        let fast_blocked =
            self.occluded(|t, s, o| levels::obstructed(world, filter, t, s, o), moves);
        let portable = self.occluded(
            |t, s, o| levels::obstructed_without_avx512(world, filter, t, s, o),
            moves,
        );
        assert_eq!(fast_blocked, portable);
        let other = |(hit, known): (&[u32; 4], &Hit)| hit[0] != known.primitive;
        let met = fast.iter().zip(&self.known).filter(|&pair| other(pair));
        met.count().min(portable.iter().filter(|b| **b).count())
    }
}

#[test]
fn all_forms_answer_alike() {
    for (seed, copies, balls) in [(20, 40, 60), (21, 300, 0), (22, 0, 400), (23, 1, 1)] {
        let mut scene = mixed(copies, balls, seed);
        let mut random = Random(seed);
        for instance in scene.instances.iter_mut().step_by(2) {
            let [x, y, z] = random.point().map(f64::from);
            let axis = glam::DVec3::new(x, y, z).normalize().as_vec3().to_array();
            instance.motion = Some(Motion {
                travel: random.point().map(|p| 0.3 * p),
                axis,
                turns: random.unit(),
            });
        }
        // Every other triangle of the world is for the filter.
        let mut holes = Material::diffuse("holes", [0.5; 3], [0.0; 3]);
        holes.alpha = Some(Alpha {
            opacity: 0.5.into(),
            cutoff: None,
        });
        scene.materials.push(holes);
        scene
            .mesh
            .material
            .iter_mut()
            .step_by(2)
            .for_each(|m| *m = 1);
        let geometry = Geometry::of(&scene, Preset::Balanced);
        let world = geometry.beside().expect("something besides");
        let question = Question::random(3001, 1400, seed);
        for moves in [false, true] {
            let met = question.ask(&world, &Everything, moves);
            assert!(met > 200, "seed {seed}: {met}");
            let met = question.ask(&world, &Holes, moves);
            assert!(met > 100, "seed {seed}: {met}");
        }
    }
}
