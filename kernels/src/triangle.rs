//! A ray against a block of four triangles, watertight.
//!
//! S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013: the
//! ray is sheared and permuted so that it runs along an axis, the triangle's corners with it; the
//! signs of three two-dimensional edge functions then decide. A corner is sheared by itself, and
//! an edge function of two sheared corners is computed with a relative error of at most `2u`,
//! `u = 2^-24`, by Kahan's difference of products (C.-P. Jeannerod, N. Louvet, J.-M. Muller, "Further
//! analysis of Kahan's algorithm for the accurate computation of 2 x 2 determinants", Math. Comp.
//! 82, 2013). So its sign is the true one: the two triangles at an edge decide alike, and a ray
//! cannot slip between them. An edge function that is 0, tiny or not finite is computed again in
//! f64, where the products of f32 are exact; what is still 0 counts as inside, for both neighbours.
//! (Without fused instructions Kahan's formula falls back to the difference of two rounded products:
//! less accurate, but exchanging an edge's ends still changes its sign and nothing else.)
//!
//! The distance is a weighted mean of the corners' distances along the ray's main axis, with the
//! edge functions as weights, so it lies between them to rounding.
//!
//! **How exact the distance is.** Of a triangle that is met, the weights have the same sign and
//! `2u` each; so their sum has `4u`, their shares `8u`, and the mean, in three more operations, lies within
//! `11u` of the true mean's terms: a needle however long and thin loses nothing. Let `S` be the
//! largest component of a corner seen from the origin. A sheared corner is off by `5uS` along the
//! first and second axis (a subtraction, the slope, the product's distance, the fused sum, which is
//! at most `2S`) and by `uS` along the main one. Moving the point with those weights back into the
//! ray moves the distance by at most `5 sqrt(2) uS / cos`, with `cos` between ray and normal; along
//! the ray, main-axis errors of `12uS` count `sqrt(3)` times at most. With the two roundings of the
//! last product, the distance of a unit direction is off by less than `(7.1 / cos + 23) uS`.
//!
//! **Contact.** A ray that leaves a triangle starts, to rounding, in the plane of a coplanar neighbour,
//! and must not meet it: there the sign of the distance decides, and an error of `uS` is too much.
//! So where the distance along the main axis is less than `CONTACT` of the farthest corner's, it is
//! computed again in f64, from the plane of the corners as they are given, not sheared: an origin in
//! that plane is at distance 0, and one above it by as little as `surface.rs` makes it is above it.
//! Sheared corners' errors move a distance by up to `10u` times the farthest corner's, times length
//! over width of the triangle as the ray sees it: up to a ratio of `2^16 / 10` no sign is wrong.
//!
//! Input: any finite triangles and origins; directions as [`Shear::new`] takes them. A triangle
//! seen edge-on, or without area, is never hit. Reads 160 bytes a block.

use crate::bvh::Block;
use crate::vector::Lanes;
use wide::f32x4;

/// Edge functions below this, and triangles whose doubled area, seen from the ray, is above its
/// reciprocal, are decided in f64. It is no tolerance (both ways of deciding give an answer, and
/// the f64 one is exact): from 2^-102 down, f32 products lose bits to underflow.
pub(crate) const SURE: f32 = 1.0 / ((1u128 << 100) as f32);

/// Distances below this share of the farthest corner's are computed in f64 from the plane.
pub(crate) const CONTACT: f32 = 1.0 / 256.0;

/// What the triangle test needs of a ray.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shear {
    /// Axes in the order first, second, main; the main one has the largest component.
    axes: [u32; 3],
    /// The origin along `axes`.
    origin: [f32; 3],
    /// First and second component of the direction over the main one.
    shear: [f32; 2],
    /// 1 over the main component.
    inverse: f32,
}

/// What a test answers lane by lane, before anyone asks which answer is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Candidates<V> {
    /// True where the ray's line meets the triangle at `t > 0`; elsewhere the rest is unspecified.
    pub met: V,
    /// Distances.
    pub t: V,
    /// Barycentric weight of the second corner, at least 0.
    pub u: V,
    /// Barycentric weight of the third corner, at least 0; `u + v` is at most 1 to rounding.
    pub v: V,
}

/// A direction with its largest component in `[1, 2)`, and the power of two that made it so.
/// `None` if it is zero or not finite.
///
/// Distances along the result are the caller's distances divided by that power.
#[inline(always)]
#[must_use]
pub fn normalize_exponent(direction: [f32; 3]) -> Option<([f32; 3], f64)> {
    let largest = direction.iter().fold(0.0, |m: f32, d| m.max(d.abs()));
    // `max` drops a NaN; this does not.
    if largest == 0.0 || !direction.iter().all(|d| d.is_finite()) {
        return None;
    }
    // In f64 every f32 is normal, and so is the reciprocal of its power of two.
    let exponent = f64::from(largest).to_bits() >> 52;
    let scale = f64::from_bits((2046 - exponent) << 52);
    Some((direction.map(|d| (f64::from(d) * scale) as f32), scale))
}

/// The axis of the largest component; of equally large ones the last.
#[inline(always)]
#[must_use]
pub fn main_axis(direction: [f32; 3]) -> usize {
    let [x, y, z] = direction.map(f32::abs);
    if x > y && x > z {
        0
    } else if y > z {
        1
    } else {
        2
    }
}

impl Shear {
    /// Prepares a ray whose direction [`normalize_exponent`] returned.
    #[inline(always)]
    #[must_use]
    pub fn new(origin: [f32; 3], direction: [f32; 3]) -> Self {
        let main = main_axis(direction);
        let axes = [(main + 1) % 3, (main + 2) % 3, main];
        let d = axes.map(|a| direction[a]);
        Self {
            axes: axes.map(|a| a as u32),
            origin: axes.map(|a| origin[a]),
            shear: [d[0] / d[2], d[1] / d[2]],
            inverse: 1.0 / d[2],
        }
    }

    /// Which triangles of `block` the ray meets, and where.
    #[inline(always)]
    #[must_use]
    pub fn test(&self, block: &Block) -> Candidates<f32x4> {
        self.test_but(block, f32x4::splat(0.0))
    }

    /// The same where nobody will look at the lanes of the mask `ignored`, as at the triangle that
    /// the ray leaves: it would need the exact test every time.
    #[inline(always)]
    #[must_use]
    pub fn test_but(&self, block: &Block, ignored: f32x4) -> Candidates<f32x4> {
        let (found, sure) = self.view(block).meet();
        if (sure | ignored).all() {
            return found;
        }
        // Field by field: handed on whole, it would go through memory on the usual way too.
        let exact = self.test_exactly(block);
        Candidates {
            met: exact.met,
            t: exact.t,
            u: exact.u,
            v: exact.v,
        }
    }

    /// Starts over, so that nothing has to be kept for it on the usual way.
    #[cold]
    #[inline(never)]
    fn test_exactly(&self, block: &Block) -> Candidates<f32x4> {
        self.view(block).meet_exactly()
    }

    #[inline(always)]
    fn view(&self, block: &Block) -> View<f32x4> {
        // The remainder tells the compiler that no index is out of range.
        let [x, y, z] = self.axes.map(|a| &block.vertex[(a % 3) as usize]);
        View {
            corners: [[x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]]],
            origin: self.origin.map(f32x4::splat),
            slope: self.shear.map(f32x4::splat),
            inverse: f32x4::splat(self.inverse),
        }
    }
}

/// A triangle and a ray in every lane, along the ray's axes first, second, main.
#[derive(Clone, Copy, Debug)]
pub struct View<V> {
    /// The triangle's corners.
    pub corners: [[V; 3]; 3],
    /// The ray's origin.
    pub origin: [V; 3],
    /// The direction's first and second component over its main one.
    pub slope: [V; 2],
    /// 1 over the direction's main component.
    pub inverse: V,
}

/// Corners and edge functions as the ray sees them.
struct Sheared<V> {
    corners: [[V; 3]; 3],
    weights: [V; 3],
}

/// A corner, along the ray's axes, as the ray sees it.
#[inline(always)]
pub(crate) fn shear<V: Lanes>(corner: [V; 3], origin: &[V; 3], slope: &[V; 2]) -> [V; 3] {
    let z = corner[2] - origin[2];
    let x = slope[0].mul_neg_add(z, corner[0] - origin[0]);
    let y = slope[1].mul_neg_add(z, corner[1] - origin[1]);
    [x, y, z]
}

/// The edge functions of sheared corners, by the corner that each lies opposite to.
#[inline(always)]
pub(crate) fn weights<V: Lanes>([a, b, c]: [&[V; 3]; 3]) -> [V; 3] {
    // Kahan: what rounding took from one product is put back with the other.
    let edge = |p: &[V; 3], q: &[V; 3]| {
        let product = p[1] * q[0];
        p[1].mul_neg_add(q[0], product) - p[0].mul_neg_add(q[1], product)
    };
    [edge(c, b), edge(a, c), edge(b, a)]
}

/// Depth along the main axis, and the barycentric weights of the second and third corner; `det` is
/// the sum of the weights.
#[inline(always)]
pub(crate) fn share<V: Lanes>([a, b, c]: [&[V; 3]; 3], weights: [V; 3], det: V) -> [V; 3] {
    let share = V::splat(1.0) / det;
    let [ua, ub, uc] = weights.map(|w| w * share);
    let depth = ua.mul_add(a[2], ub.mul_add(b[2], uc * c[2]));
    // Adding 0 turns -0 into 0.
    let zero = V::splat(0.0);
    [depth, ub + zero, uc + zero]
}

/// Where the distance is so small a share of the corners' that only the plane knows its sign.
#[inline(always)]
pub(crate) fn touches<V: Lanes>([a, b, c]: [&[V; 3]; 3], depth: V) -> V {
    let farthest = a[2].abs().fast_max(b[2].abs().fast_max(c[2].abs()));
    depth.abs().less(farthest * V::splat(CONTACT))
}

impl<V: Lanes> View<V> {
    #[inline(always)]
    fn shear(&self) -> Sheared<V> {
        let corners = self.corners.map(|v| shear(v, &self.origin, &self.slope));
        Sheared {
            corners,
            weights: weights(corners.each_ref()),
        }
    }

    /// The test in f32, and where it is sure: elsewhere [`View::meet_exactly`] must be asked.
    #[inline(always)]
    #[must_use]
    pub fn meet(&self) -> (Candidates<V>, V) {
        let sheared = self.shear();
        let [wa, wb, wc] = sheared.weights;
        let det = wa + wb + wc;
        let zero = V::splat(0.0);
        let negative = wa.less(zero) | wb.less(zero) | wc.less(zero);
        let positive = zero.less(wa) | zero.less(wb) | zero.less(wc);
        let least = wa.abs().fast_min(wb.abs().fast_min(wc.abs()));
        let sure = V::splat(SURE).at_most(least) & det.abs().at_most(V::splat(1.0 / SURE));
        // The weights are divided before they meet a distance: their products with it would
        // overflow or vanish long before they do. What is computed for lanes that are not met is
        // computed in vain; a branch around it would be mispredicted every other time.
        let [depth, u, v] = share(sheared.corners.each_ref(), sheared.weights, det);
        let t = depth * self.inverse;
        let inside = !(negative & positive);
        let sure = sure & !(inside & touches(sheared.corners.each_ref(), depth));
        let found = Candidates {
            met: inside & zero.less(t),
            t,
            u,
            v,
        };
        (found, sure)
    }

    /// Distance along the main axis to the plane of a lane's triangle, from the corners as given.
    fn plane_depth(&self, lane: usize) -> f64 {
        let number = |v: &V| f64::from(v.lanes()[lane]);
        let [a, b, c] = self
            .corners
            .each_ref()
            .map(|p| [0, 1, 2].map(|k| number(&p[k]) - number(&self.origin[k])));
        let (p, q) = (
            [0, 1, 2].map(|k| b[k] - a[k]),
            [0, 1, 2].map(|k| c[k] - a[k]),
        );
        let normal = [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ];
        let along = normal[0] * number(&self.slope[0]) + normal[1] * number(&self.slope[1]);
        let away = normal[0] * a[0] + normal[1] * a[1] + normal[2] * a[2];
        away / (along + normal[2])
    }

    /// The test, with the lanes that f32 is not sure of decided in f64 from the same sheared
    /// corners. An edge that is not in doubt keeps its f32 value: the neighbour beyond that edge
    /// decided by it.
    #[must_use]
    pub fn meet_exactly(&self) -> Candidates<V> {
        let (mut out, sure) = self.meet();
        let sheared = self.shear();
        for lane in 0..sure.lanes().len() {
            if sure.lanes()[lane].to_bits() != 0 {
                continue;
            }
            let [a, b, c] = sheared
                .corners
                .map(|p| p.map(|e| f64::from(e.lanes()[lane])));
            let edge = |single: V, p: [f64; 3], q: [f64; 3]| {
                let single = single.lanes()[lane];
                if single.is_finite() && single.abs() >= SURE {
                    f64::from(single)
                } else {
                    p[0] * q[1] - p[1] * q[0]
                }
            };
            let w = [
                edge(sheared.weights[0], c, b),
                edge(sheared.weights[1], a, c),
                edge(sheared.weights[2], b, a),
            ];
            let det = w[0] + w[1] + w[2];
            let inside = w.iter().all(|&e| e >= 0.0) || w.iter().all(|&e| e <= 0.0);
            let mean = (w[0] * a[2] + w[1] * b[2] + w[2] * c[2]) / det;
            let plane = self.plane_depth(lane);
            // Seen edge-on, the plane says nothing; nor may it lead out of the triangle. Where a
            // sheared corner overflowed, nothing is met.
            let depth = if plane.is_finite() && mean.is_finite() {
                let (low, high) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
                plane.max(low).min(high)
            } else {
                mean
            };
            let t = (depth * f64::from(self.inverse.lanes()[lane])) as f32;
            // A det of 0, or a corner that overflowed, leaves NaN or infinity in t.
            let met = inside && det != 0.0 && t > 0.0 && t < f32::INFINITY;
            out.met.lanes_mut()[lane] = f32::from_bits(if met { !0 } else { 0 });
            out.t.lanes_mut()[lane] = t;
            out.u.lanes_mut()[lane] = (w[1] / det) as f32 + 0.0;
            out.v.lanes_mut()[lane] = (w[2] / det) as f32 + 0.0;
        }
        out
    }
}
