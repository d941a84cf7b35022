//! Light trees: a light chosen by how much it may send to a point.
//!
//! A. Conty Estevez, C. Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
//! HPG 2018, as *PBRT* 4th ed., 12.6.3, has it. A node bounds its lights: a sphere around their box
//! (centre `c`, radius `r`), a cone around their normals (axis `w`, half angle `theta_o`) and how far
//! beyond that they shine (`theta_e`), and the sum `I` of their greatest intensities. Its importance
//! for a point `p` at distance `d` from `c` bounds nothing, but follows what it sends there:
//!
//! ```text
//! I cos(theta') / max(d^2, r^2)    theta' = max(theta - theta_o - theta_b, 0)
//! ```
//!
//! with `theta` between `w` and the way to `p`, and `theta_b` the angle that the sphere subtends from
//! `p` (all directions, from within it). It is 0, and only then, where `theta' > theta_e`: nothing of
//! the node shines there. At each node one of the two children is drawn in proportion, but with
//! at least 2^-10 if it shines at all; the product of these probabilities is the light's.
//!
//! The surface's own normal has no part in it, so that the probability of a light that a path has
//! found is a function of where the path came from alone, whatever stood there.
//!
//! Sampling walks all lanes down together; a number is used up by halves, so that the upper eight
//! levels take it from one number and the lower ones from another.
//!
//! Bytes a level: 128.

use crate::lanes::{Fx, LANES, Mask, Ux, as_bits, as_mask, gather, gather_u32};
use crate::vec3::Vec3x;

/// A node: the bounds of some lights.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    /// Centre of the sphere.
    pub centre: [f32; 3],
    /// Square of its radius.
    pub radius2: f32,
    /// Unit axis of the cone of normals.
    pub axis: [f32; 3],
    /// `cos(theta_o)`.
    pub cos_o: f32,
    /// `sin(theta_o)`, >= 0.
    pub sin_o: f32,
    /// `cos(theta_e)`.
    pub cos_e: f32,
    /// Sum of the lights' greatest luminous intensities, finite and positive.
    pub intensity: f32,
    /// All bits set if a light in it shines backwards too, else 0.
    pub two_sided: u32,
    /// Of an inner node, the index of its first child, the second one behind it; of a leaf, the
    /// light's and [`LEAF`].
    pub child: u32,
}

/// The least probability of a child that shines.
const LEAST: f32 = 1.0 / 1024.0;

/// Set in `child` of a leaf.
pub const LEAF: u32 = 1 << 31;
/// In `Tree::of_triangle`: no light of the tree.
pub const NO_LIGHT: u32 = u32::MAX;

/// A tree of lights, its root first. Lights are numbered in an order of their own.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    /// Nodes; at most 33 levels.
    pub nodes: &'a [Node],
    /// What each light is, as in `Lights::source`.
    pub source: &'a [u32],
    /// One over the area of each light that is a triangle; 1 for others.
    pub inverse_area: &'a [f32],
    /// The way to each light: bit `k` says which child to take at level `k`.
    pub trail: &'a [u32],
    /// The light of each triangle, or [`NO_LIGHT`].
    pub of_triangle: &'a [u32],
    /// Probability to select the tree before a light of it.
    pub selection: f32,
}

/// The cosine of `max(a - b, 0)`.
#[inline(always)]
fn cos_less(sin_a: Fx, cos_a: Fx, sin_b: Fx, cos_b: Fx) -> Fx {
    let less = cos_a.mul_add(cos_b, sin_a * sin_b);
    cos_a.simd_gt(cos_b).select(Fx::ONE, less)
}

/// The sine of the same.
#[inline(always)]
fn sin_less(sin_a: Fx, cos_a: Fx, sin_b: Fx, cos_b: Fx) -> Fx {
    let less = sin_a.mul_sub(cos_b, cos_a * sin_b);
    cos_a.simd_gt(cos_b).select(Fx::ZERO, less)
}

/// The sine in `[0, 1]` of an angle in `[0, pi]`.
#[inline(always)]
fn sine(cos: Fx) -> Fx {
    ((Fx::ONE - cos) * (Fx::ONE + cos))
        .fast_max(Fx::ZERO)
        .sqrt()
}

impl Tree<'_> {
    /// The importance of nodes `at` for `point`, finite and >= 0.
    #[inline(always)]
    #[must_use]
    pub fn importance(&self, at: Ux, point: Vec3x) -> Fx {
        let at = at.to_array();
        let node = |lane: usize| &self.nodes[at[lane] as usize];
        let number = |of: fn(&Node) -> f32| Fx::new(std::array::from_fn(|l| of(node(l))));
        let centre = Vec3x::new(
            number(|n| n.centre[0]),
            number(|n| n.centre[1]),
            number(|n| n.centre[2]),
        );
        let axis = Vec3x::new(
            number(|n| n.axis[0]),
            number(|n| n.axis[1]),
            number(|n| n.axis[2]),
        );
        let two_sided: Mask =
            bytemuck::cast(std::array::from_fn::<u32, LANES, _>(|l| node(l).two_sided));
        let radius2 = number(|n| n.radius2);
        let way = point - centre;
        let d2 = way.dot(way);
        let cos = axis.dot(way) / d2.sqrt();
        let cos = two_sided.select(cos.abs(), cos);
        let cos = cos.fast_max(-Fx::ONE).fast_min(Fx::ONE);
        // From within the sphere it is all around: theta_b = pi.
        let inside = d2.simd_le(radius2);
        let sin_b2 = inside.select(Fx::ZERO, radius2 / d2);
        let sin_b = sin_b2.sqrt();
        let cos_b = inside.select(-Fx::ONE, (Fx::ONE - sin_b2).sqrt());
        let (sin, sin_o, cos_o) = (sine(cos), number(|n| n.sin_o), number(|n| n.cos_o));
        let cos_x = cos_less(sin, cos, sin_o, cos_o);
        let sin_x = sin_less(sin, cos, sin_o, cos_o);
        let cos_rest = inside.select(Fx::ONE, cos_less(sin_x, cos_x, sin_b, cos_b));
        let shines = cos_rest.simd_ge(number(|n| n.cos_e)) & cos_rest.simd_gt(Fx::ZERO);
        let near = d2.fast_max(radius2);
        let importance = number(|n| n.intensity) * cos_rest / near;
        // A light of no extent at the point itself sends it no light that could be added up.
        (shines & importance.is_finite()) & importance
    }

    /// The probability of the first child of nodes `at`, and where neither child shines.
    #[inline(always)]
    fn first(&self, child: Ux, point: Vec3x) -> (Fx, Mask) {
        let a = self.importance(child, point);
        let b = self.importance(child + Ux::ONE, point);
        let sum = a + b;
        let dark = sum.simd_eq(Fx::ZERO);
        let p = a / dark.select(Fx::ONE, sum);
        // However little the other sends, it is drawn sometimes: what is bright may be hidden.
        let both = a.simd_gt(Fx::ZERO) & b.simd_gt(Fx::ZERO);
        let least = Fx::splat(LEAST);
        let held = p.fast_max(least).fast_min(Fx::ONE - least);
        (both.select(held, p), dark)
    }

    #[inline(always)]
    fn children(&self, at: Ux) -> Ux {
        let at = at.to_array();
        Ux::new(std::array::from_fn(|l| self.nodes[at[l] as usize].child))
    }

    /// Draws a light for each `point`, by two numbers in `[0, 1)`: the light, and its probability,
    /// the tree's own selection included; 0 where nothing of the tree shines at the point.
    #[inline(never)]
    #[must_use]
    pub fn sample(&self, point: Vec3x, u: Fx, v: Fx) -> (Ux, Fx) {
        let below_one = Fx::splat(super::BELOW_ONE);
        let mut probability = Fx::splat(self.selection);
        let mut child = self.children(Ux::splat(0));
        let mut u = u;
        let mut level = 0;
        loop {
            let is_leaf = as_mask((child & Ux::splat(LEAF)).simd_eq(Ux::splat(LEAF)));
            if is_leaf.all() {
                return (child & Ux::splat(!LEAF), probability);
            }
            if level == 8 {
                u = v;
            }
            // Lanes that have arrived look at the root's children, which are there.
            let at = as_bits(is_leaf).select(self.children(Ux::splat(0)), child);
            let (p, dark) = self.first(at, point);
            let left = u.simd_lt(p);
            let q = left.select(p, Fx::ONE - p);
            let rest = left.select(u, u - p) / q;
            let next = self.children(at + as_bits(left).select(Ux::splat(0), Ux::ONE));
            probability = is_leaf.select(probability, (!dark) & (probability * q));
            u = is_leaf.select(u, rest.fast_min(below_one));
            child = as_bits(is_leaf).select(child, next);
            level += 1;
        }
    }

    /// The probability with which [`Self::sample`] draws the light on each `triangle` for `point`; 0
    /// for triangles that are no lights of the tree.
    #[inline(never)]
    #[must_use]
    pub fn probability(&self, point: Vec3x, triangle: Ux) -> Fx {
        let light = gather_u32(self.of_triangle, triangle);
        let none = as_mask(light.simd_eq(Ux::splat(NO_LIGHT)));
        let mut trail = gather_u32(self.trail, as_bits(none).select(Ux::splat(0), light));
        let mut probability = (!none) & Fx::splat(self.selection);
        let root = self.children(Ux::splat(0));
        let mut child = root;
        loop {
            let is_leaf = as_mask((child & Ux::splat(LEAF)).simd_eq(Ux::splat(LEAF)));
            if is_leaf.all() {
                return probability;
            }
            let at = as_bits(is_leaf).select(root, child);
            let (p, dark) = self.first(at, point);
            let second = trail & Ux::ONE;
            let left = as_mask(second.simd_eq(Ux::splat(0)));
            let q = left.select(p, Fx::ONE - p);
            let next = self.children(at + second);
            probability = is_leaf.select(probability, (!dark) & (probability * q));
            trail >>= 1;
            child = as_bits(is_leaf).select(child, next);
        }
    }

    /// One over the area of the light on each `triangle`, which has one.
    #[inline(always)]
    pub(super) fn inverse_area_of(&self, triangle: Ux) -> Fx {
        let light = gather_u32(self.of_triangle, triangle);
        let none = as_mask(light.simd_eq(Ux::splat(NO_LIGHT)));
        gather(self.inverse_area, as_bits(none).select(Ux::splat(0), light))
    }
}
