//! Light trees: is each light drawn with the probability that is said of it, and does every light that
//! shines on a point have one?

mod common;

use common::{CORNERS, Source, Suite};
use huygens_kernels::lanes::{Fx, LANES, Ux};
use huygens_kernels::light::{LEAF, NO_LIGHT, Node, Tree};
use huygens_kernels::vec3::Vec3x;

/// Lights in the test's tree.
const LIGHTS: usize = 13;

/// A tree as deep on one side as it is shallow on the other, over small flat lights that face
/// anywhere; each node bounds its children generously, as a builder's might.
struct Lights {
    nodes: Vec<Node>,
    source: Vec<u32>,
    trail: Vec<u32>,
    of_triangle: Vec<u32>,
    /// Place, normal and intensity of each light.
    lamps: Vec<([f32; 3], [f32; 3], f32)>,
}

impl Lights {
    fn new(seed: u64) -> Self {
        let mut source = Source(seed);
        let mut lamp = || {
            let place = source.direction().map(|c| 3.0 * c);
            (place, source.direction(), 0.1 + source.unit())
        };
        let lamps: Vec<_> = (0..LIGHTS).map(|_| lamp()).collect();
        let mut lights = Self {
            nodes: vec![Node::default()],
            source: (0..LIGHTS as u32).collect(),
            trail: vec![0; LIGHTS],
            // Triangle k is light k; every other triangle is none.
            of_triangle: (0..2 * LIGHTS as u32)
                .map(|t| if t % 2 == 0 { t / 2 } else { NO_LIGHT })
                .collect(),
            lamps,
        };
        lights.grow(0, 0..LIGHTS, 0, 0);
        lights
    }

    fn grow(&mut self, at: usize, range: std::ops::Range<usize>, trail: u32, level: u32) {
        let (first, n) = (range.start, range.len());
        if n == 1 {
            let (place, normal, intensity) = self.lamps[first];
            self.trail[first] = trail;
            self.nodes[at] = Node {
                centre: place,
                radius2: 0.01,
                axis: normal,
                cos_o: 1.0,
                intensity,
                child: LEAF | first as u32,
                two_sided: if first % 4 == 0 { u32::MAX } else { 0 },
                ..Node::default()
            };
            return;
        }
        let child = self.nodes.len();
        self.nodes.extend([Node::default(); 2]);
        let cut = first + (n / 4).max(1);
        self.grow(child, first..cut, trail, level + 1);
        self.grow(child + 1, cut..range.end, trail | (1 << level), level + 1);
        // Around everything, and facing everywhere.
        let intensity = self.nodes[child].intensity + self.nodes[child + 1].intensity;
        self.nodes[at] = Node {
            radius2: 10.0,
            axis: [0.0, 1.0, 0.0],
            cos_o: -1.0,
            intensity,
            child: child as u32,
            ..Node::default()
        };
    }

    fn tree(&self) -> Tree<'_> {
        Tree {
            nodes: &self.nodes,
            source: &self.source,
            inverse_area: &[1.0; LIGHTS],
            trail: &self.trail,
            of_triangle: &self.of_triangle,
            selection: 0.75,
        }
    }
}

/// The probability of each light at a point, as the kernel says it.
fn probabilities(tree: &Tree, point: Vec3x) -> Vec<f64> {
    let of = |k: usize| tree.probability(point, Ux::splat(2 * k as u32)).as_array()[0];
    (0..LIGHTS).map(|k| f64::from(of(k))).collect()
}

#[test]
fn lights_are_drawn_by_the_probability_that_is_said_of_them() {
    const DRAWS: usize = 1 << 18;
    let lights = Lights::new(51);
    let tree = lights.tree();
    let mut source = Source(53);
    let mut suite = Suite::default();
    for (name, point) in [
        ("among them", [0.1, -0.2, 0.3]),
        ("near one", lights.lamps[5].0.map(|c| c * 1.1)),
        ("beside them", [4.0, 1.0, 0.0]),
        ("far away", [300.0, -200.0, 100.0]),
    ] {
        let point = Vec3x::splat(point);
        let said = probabilities(&tree, point);
        let mut drawn = [0u64; LIGHTS];
        let mut missed = 0u64;
        for _ in 0..DRAWS / LANES {
            let (light, p) = tree.sample(point, source.unit_lanes(), source.unit_lanes());
            for lane in 0..LANES {
                let (light, p) = (light.as_array()[lane] as usize, p.as_array()[lane]);
                if p == 0.0 {
                    missed += 1;
                    continue;
                }
                drawn[light] += 1;
                assert_eq!(f64::from(p), said[light], "{name}");
            }
        }
        // What is missing to the tree's own probability ends at nodes that do not shine.
        let total: f64 = said.iter().sum();
        assert!(total <= 0.75 * (1.0 + 1e-6));
        let mut counts = vec![missed];
        let mut expected = vec![(1.0 - total / 0.75) * DRAWS as f64];
        if expected[0] < 1e-3 {
            // Rounding of the sum.
            assert_eq!(missed, 0, "{name}");
            (counts, expected) = (Vec::new(), Vec::new());
        }
        for (count, p) in drawn.into_iter().zip(&said) {
            if *p == 0.0 {
                assert_eq!(count, 0, "{name}");
            } else {
                counts.push(count);
                expected.push(p / 0.75 * DRAWS as f64);
            }
        }
        suite.test(name, &counts, &expected);
    }
    suite.finish();
}

#[test]
fn importance_is_that_of_its_twin() {
    let mut source = Source(55);
    for _ in 0..4096 {
        let theta_o = std::f64::consts::PI * f64::from(source.unit());
        let node = Node {
            centre: source.direction(),
            radius2: source.unit(),
            axis: source.direction(),
            cos_o: theta_o.cos() as f32,
            sin_o: theta_o.sin() as f32,
            cos_e: if source.unit() < 0.5 { 0.0 } else { 0.9998 },
            intensity: source.unit(),
            two_sided: if source.unit() < 0.3 { u32::MAX } else { 0 },
            child: LEAF,
        };
        let nodes = [node];
        let tree = Tree {
            nodes: &nodes,
            source: &[0],
            inverse_area: &[1.0],
            trail: &[0],
            of_triangle: &[],
            selection: 1.0,
        };
        let point = source.direction().map(|c| 4.0 * c * c * c);
        let found = tree
            .importance(Ux::splat(0), Vec3x::splat(point))
            .as_array()[0];

        let way: [f64; 3] =
            std::array::from_fn(|c| f64::from(point[c]) - f64::from(node.centre[c]));
        let d2: f64 = way.iter().map(|c| c * c).sum();
        let dot: f64 = (0..3).map(|c| way[c] * f64::from(node.axis[c])).sum();
        let mut theta = (dot / d2.sqrt()).clamp(-1.0, 1.0).acos();
        if node.two_sided != 0 {
            theta = theta.min(std::f64::consts::PI - theta);
        }
        let r2 = f64::from(node.radius2);
        let theta_b = if d2 <= r2 {
            std::f64::consts::PI
        } else {
            (r2 / d2).sqrt().asin()
        };
        let rest = (theta - theta_o).max(0.0) - theta_b;
        let rest = rest.max(0.0);
        let twin = f64::from(node.intensity) * rest.cos().max(0.0) / d2.max(r2);
        // Cosines to a few roundings are angles to the square root of that, at their worst: 1e-3.
        // Where the limit is so near either may say that nothing shines, and so may the sphere's.
        let theta_e = f64::from(node.cos_e).acos();
        let close = (rest - theta_e).abs() < 2e-3 || (d2 / r2 - 1.0).abs() < 1e-5;
        let expected = if rest > theta_e { 0.0 } else { twin };
        let scale = f64::from(node.intensity) / d2.max(r2);
        assert!(
            close || (f64::from(found) - expected).abs() <= 2e-3 * scale,
            "{found} for {expected}: {node:?} at {point:?}"
        );
    }
}

#[test]
fn whatever_shines_on_a_point_can_be_drawn_there() {
    let mut source = Source(57);
    for seed in 0..64 {
        let lights = Lights::new(100 + seed);
        let tree = lights.tree();
        let point = source.direction().map(|c| 5.0 * c);
        let said = probabilities(&tree, Vec3x::splat(point));
        for (k, &(place, normal, _)) in lights.lamps.iter().enumerate() {
            let cos: f32 = (0..3).map(|c| (point[c] - place[c]) * normal[c]).sum();
            if cos > 0.0 || k % 4 == 0 {
                assert!(said[k] > 0.0, "light {k} of tree {seed}");
            }
        }
        assert_eq!(
            tree.probability(Vec3x::splat(point), Ux::splat(1))
                .to_array(),
            [0.0; LANES],
            "a triangle that is no light"
        );
    }
}

#[test]
fn numbers_at_their_ends_lead_to_lights_that_exist() {
    let lights = Lights::new(59);
    let tree = lights.tree();
    let on_a_light = lights.lamps[3].0;
    for point in [[0.0; 3], on_a_light, [1e30, 0.0, 0.0], [-1e-30, 0.0, 0.0]] {
        for v in CORNERS {
            let u = Fx::new(CORNERS);
            let (light, p) = tree.sample(Vec3x::splat(point), u, Fx::splat(v));
            for lane in 0..LANES {
                assert!((light.as_array()[lane] as usize) < LIGHTS);
                let p = p.as_array()[lane];
                assert!((0.0..=0.75).contains(&p), "{p} at {point:?}");
            }
        }
    }
}

#[test]
fn a_tree_of_one_light_is_that_light() {
    let nodes = [Node {
        centre: [0.0, 1.0, 0.0],
        radius2: 0.1,
        axis: [0.0, -1.0, 0.0],
        cos_o: 1.0,
        intensity: 1.0,
        child: LEAF,
        ..Node::default()
    }];
    let tree = Tree {
        nodes: &nodes,
        source: &[7],
        inverse_area: &[1.0],
        trail: &[0],
        of_triangle: &[0],
        selection: 1.0,
    };
    let point = Vec3x::splat([0.0; 3]);
    let (light, p) = tree.sample(point, Fx::new(CORNERS), Fx::new(CORNERS));
    assert_eq!((light.to_array(), p.to_array()), ([0; LANES], [1.0; LANES]));
    assert_eq!(
        tree.probability(point, Ux::splat(0)).to_array(),
        [1.0; LANES]
    );
}
