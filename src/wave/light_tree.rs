//! Builds the light tree: the lights at a finite distance, bounded and split in two until each stands
//! alone.
//!
//! Splits are the cheapest of twelve along each axis by the surface area orientation heuristic of
//! Conty Estevez and Kulla (HPG 2018): intensity times the area of the box times the solid angle that
//! the lights shine into, weighted for narrow boxes. All in f64; nodes are rounded outwards where it
//! matters.

use super::tables::luminance;
use crate::scene::{LightKind, Mesh, Scene};
use glam::DVec3;
use huygens_kernels::light::{LEAF, NO_LIGHT, Node, PUNCTUAL, Tree};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Candidates on each axis are one fewer.
const BUCKETS: usize = 12;
/// Levels that a trail of 32 bits can lead down.
const LEVELS: usize = 32;
/// What a spot is taken to shine beyond its cone, radians: rounding must not cut what it does shine.
const MARGIN: f64 = 0.02;

/// Tables of `huygens_kernels::light::Tree`.
#[derive(Debug, Default)]
pub(crate) struct LightTree {
    nodes: Vec<Node>,
    source: Vec<u32>,
    inverse_area: Vec<f32>,
    trail: Vec<u32>,
    of_triangle: Vec<u32>,
    /// Probability to select the tree before a light of it.
    pub(crate) selection: f32,
}

/// Bounds of lights: what a node says, not yet rounded.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: DVec3,
    high: DVec3,
    axis: DVec3,
    theta_o: f64,
    theta_e: f64,
    intensity: f64,
    two_sided: bool,
}

/// A light and what it is.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    bounds: Bounds,
    source: u32,
    inverse_area: f64,
}

impl LightTree {
    /// The tree of a scene's lights at a finite distance, of which there is at least one: triangles of
    /// positive `luminance_of` their radiance, in the mean, and points and spots.
    pub(crate) fn new(scene: &Scene, luminance_of: impl Fn(usize) -> f64) -> Self {
        let mut leaves: Vec<Leaf> = (0..scene.mesh.triangles())
            .map(|i| (i, luminance_of(i)))
            .filter(|&(_, radiance)| radiance > 0.0)
            .map(|(i, radiance)| triangle(scene, i, radiance))
            .collect();
        for (k, light) in scene.lights.iter().enumerate() {
            leaves.extend(punctual(&light.kind, k));
        }
        // Importances are compared with each other only; so that sums of them do not overflow:
        let largest = leaves
            .iter()
            .map(|l| l.bounds.intensity)
            .fold(0.0, f64::max);
        for leaf in &mut leaves {
            // What f32 would round to nothing is still a light.
            let share = leaf.bounds.intensity / largest;
            leaf.bounds.intensity = share.max(f64::from(f32::MIN_POSITIVE));
        }
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * leaves.len()),
            of_triangle: vec![NO_LIGHT; scene.mesh.triangles()],
            ..Self::default()
        };
        tree.nodes.push(Node::default());
        tree.grow(0, &mut leaves, 0, 0);
        tree
    }

    /// Makes node `at` of `leaves`, at the end of the `trail` of `level` steps.
    fn grow(&mut self, at: usize, leaves: &mut [Leaf], trail: u32, level: usize) {
        let all = bounds_of(leaves);
        if let [leaf] = leaves {
            let light = self.source.len() as u32;
            self.source.push(leaf.source);
            self.inverse_area.push(leaf.inverse_area as f32);
            self.trail.push(trail);
            if leaf.source < PUNCTUAL {
                self.of_triangle[leaf.source as usize] = light;
            }
            self.nodes[at] = all.node(LEAF | light);
            return;
        }
        let middle = split(leaves, &all, level);
        let child = self.nodes.len();
        self.nodes[at] = all.node(child as u32);
        self.nodes.resize(child + 2, Node::default());
        let (first, second) = leaves.split_at_mut(middle);
        self.grow(child, first, trail, level + 1);
        self.grow(child + 1, second, trail | (1 << level), level + 1);
    }

    /// The view that kernels take.
    pub(crate) fn view(&self) -> Tree<'_> {
        Tree {
            nodes: &self.nodes,
            source: &self.source,
            inverse_area: &self.inverse_area,
            trail: &self.trail,
            of_triangle: &self.of_triangle,
            selection: self.selection,
        }
    }
}

/// Sorts `leaves` so that the first child's come first; how many those are.
fn split(leaves: &mut [Leaf], all: &Bounds, level: usize) -> usize {
    let n = leaves.len();
    let middles = |leaves: &[Leaf]| {
        let mut middles = leaves.iter().map(|l| l.bounds.middle());
        let first = middles.next().unwrap_or(DVec3::ZERO);
        middles.fold((first, first), |(lo, hi), m| (lo.min(m), hi.max(m)))
    };
    let (low, high) = middles(leaves);
    let extent = high - low;
    // As many levels as halving needs must be left.
    let halving = n.next_power_of_two().ilog2() as usize;
    let mut best: Option<(f64, usize, usize)> = None;
    if level + halving < LEVELS {
        for axis in (0..3).filter(|&a| extent[a] > 0.0) {
            for (bucket, cost) in costs(leaves, all, axis, low[axis], extent[axis]) {
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, bucket));
                }
            }
        }
    }
    if let Some((_, axis, bucket)) = best {
        let side = |l: &Leaf| bucket_of(l, axis, low[axis], extent[axis]) > bucket;
        // Stable, so that the tree depends on nothing but the scene.
        leaves.sort_by_key(side);
        return leaves.partition_point(|l| !side(l));
    }
    let axis = extent.max_position();
    leaves.sort_by(|a, b| a.bounds.middle()[axis].total_cmp(&b.bounds.middle()[axis]));
    n / 2
}

fn bucket_of(leaf: &Leaf, axis: usize, low: f64, extent: f64) -> usize {
    let at = (leaf.bounds.middle()[axis] - low) / extent * BUCKETS as f64;
    (at as usize).min(BUCKETS - 1)
}

/// Costs of splits behind each bucket that leaves something on both sides.
fn costs(leaves: &[Leaf], all: &Bounds, axis: usize, low: f64, extent: f64) -> Vec<(usize, f64)> {
    let mut buckets = [None; BUCKETS];
    for leaf in leaves {
        let bucket = &mut buckets[bucket_of(leaf, axis, low, extent)];
        *bucket = join(*bucket, Some(leaf.bounds));
    }
    let size = all.high - all.low;
    let narrow = size.max_element() / size[axis].max(size.max_element() * 1e-6);
    let cost = |b: Bounds| b.intensity * b.area() * b.shining();
    let candidates = (0..BUCKETS - 1).filter_map(|k| {
        let of = |range: &[Option<Bounds>]| range.iter().fold(None, |a, b| join(a, *b));
        let (first, second) = (of(&buckets[..=k])?, of(&buckets[k + 1..])?);
        Some((k, narrow * (cost(first) + cost(second))))
    });
    candidates.collect()
}

fn join(a: Option<Bounds>, b: Option<Bounds>) -> Option<Bounds> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.with(&b)),
        (a, b) => a.or(b),
    }
}

fn bounds_of(leaves: &[Leaf]) -> Bounds {
    let mut all = leaves[0].bounds;
    for leaf in &leaves[1..] {
        all = all.with(&leaf.bounds);
    }
    all
}

impl Bounds {
    fn middle(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    fn area(&self) -> f64 {
        let size = self.high - self.low;
        2.0 * (size.x * size.y + size.y * size.z + size.z * size.x)
    }

    /// The solid angle that the lights shine into, weighted by the cosine beyond the cone of normals.
    fn shining(&self) -> f64 {
        let (o, w) = (self.theta_o, (self.theta_o + self.theta_e).min(PI));
        let beyond = 2.0 * w * o.sin() - (o - 2.0 * w).cos() - 2.0 * o * o.sin() + o.cos();
        TAU * (1.0 - o.cos()) + FRAC_PI_2 * beyond
    }

    fn with(&self, other: &Self) -> Self {
        let (axis, theta_o) = cone(self.axis, self.theta_o, other.axis, other.theta_o);
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            axis,
            theta_o,
            theta_e: self.theta_e.max(other.theta_e),
            intensity: self.intensity + other.intensity,
            two_sided: self.two_sided | other.two_sided,
        }
    }

    fn node(&self, child: u32) -> Node {
        // Rounded, the sphere and the cone must not be smaller: by a few units in the last place.
        let wider = 1.0 + 4.0 * f64::from(f32::EPSILON);
        let centre = self.middle().as_vec3();
        let off = (self.middle() - centre.as_dvec3()).length();
        let radius = (0.5 * (self.high - self.low).length() + off) * wider;
        let theta_o = match self.theta_o {
            0.0 => 0.0,
            theta => (theta + 4.0 * f64::from(f32::EPSILON)).min(PI),
        };
        Node {
            centre: centre.to_array(),
            radius2: (radius * radius) as f32,
            axis: self.axis.as_vec3().to_array(),
            cos_o: theta_o.cos() as f32,
            sin_o: theta_o.sin().max(0.0) as f32,
            cos_e: self.theta_e.cos().max(0.0) as f32,
            intensity: self.intensity as f32,
            two_sided: if self.two_sided { u32::MAX } else { 0 },
            child,
        }
    }
}

/// The smallest cone around two: axis and half angle.
fn cone(a: DVec3, theta_a: f64, b: DVec3, theta_b: f64) -> (DVec3, f64) {
    let (a, theta_a, b, theta_b) = if theta_a < theta_b {
        (b, theta_b, a, theta_a)
    } else {
        (a, theta_a, b, theta_b)
    };
    let between = a.angle_between(b);
    if (between + theta_b).min(PI) <= theta_a {
        return (a, theta_a);
    }
    let theta = 0.5 * (theta_a + between + theta_b);
    let pole = a.cross(b);
    match pole.try_normalize() {
        Some(pole) if theta < PI => {
            let turned = glam::DQuat::from_axis_angle(pole, theta - theta_a) * a;
            (turned.normalize(), theta)
        }
        // All around, or opposite axes.
        _ => (a, PI),
    }
}

fn triangle(scene: &Scene, i: usize, radiance: f64) -> Leaf {
    let mesh: &Mesh = &scene.mesh;
    let material = &scene.materials[mesh.material[i] as usize];
    let [a, b, c] = mesh.corners(i).map(|v| DVec3::from_array(v.map(f64::from)));
    let normal = (b - a).cross(c - a);
    let area = 0.5 * normal.length();
    Leaf {
        bounds: Bounds {
            low: a.min(b).min(c),
            high: a.max(b).max(c),
            axis: normal.normalize(),
            theta_o: 0.0,
            theta_e: FRAC_PI_2,
            intensity: radiance * area,
            two_sided: material.two_sided,
        },
        source: i as u32,
        inverse_area: 1.0 / area,
    }
}

/// A light of no area, unless it is distant.
fn punctual(kind: &LightKind, k: usize) -> Option<Leaf> {
    let LightKind::Point {
        position,
        intensity,
        spot,
    } = *kind
    else {
        return None;
    };
    let at = DVec3::from_array(position.map(f64::from));
    let (axis, theta_o, theta_e) = match spot {
        None => (DVec3::Y, PI, FRAC_PI_2),
        Some(spot) => (
            DVec3::from_array(spot.axis.map(f64::from)),
            f64::from(spot.dark).clamp(-1.0, 1.0).acos(),
            MARGIN,
        ),
    };
    Some(Leaf {
        bounds: Bounds {
            low: at,
            high: at,
            axis,
            theta_o,
            theta_e,
            intensity: luminance(intensity),
            two_sided: false,
        },
        source: PUNCTUAL | k as u32,
        inverse_area: 1.0,
    })
}

#[cfg(test)]
mod tests;
