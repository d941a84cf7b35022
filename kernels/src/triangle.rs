//! A ray against a block of four triangles, watertight.
//!
//! S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013: the
//! ray is sheared and permuted so that it runs along an axis, the triangle's corners with it; the
//! signs of three two-dimensional edge functions then decide. A corner is sheared by itself, and
//! an edge function is a difference of two *separately rounded* products, so that exchanging an
//! edge's ends changes its sign and nothing else: the two triangles at an edge decide alike, and a
//! ray cannot slip between them. (A fused product would break exactly this.) An edge function that
//! is 0, tiny or not finite is computed again in f64, where the products of f32 are exact and the
//! sign is the true one; what is still 0 counts as inside, for both neighbours. The paper then
//! recomputes all three, which makes a triangle disagree with its neighbour about the other two.
//!
//! The distance is a weighted mean of the corners' distances along the ray's main axis, with the
//! edge functions as weights, so it lies between them to rounding.
//!
//! Input: any finite triangles and origins; directions as [`Shear::new`] takes them. A triangle
//! seen edge-on, or without area, is never hit. Reads 160 bytes a block.

use crate::bvh::{BLOCK, Block};
use wide::f32x4;

/// Edge functions below this, and triangles whose doubled area, seen from the ray, is above its
/// reciprocal, are decided in f64. It is no tolerance (both ways of deciding give an answer, and
/// the f64 one is exact): from 2^-102 down, f32 products lose bits to underflow.
const SURE: f32 = 1.0 / ((1u128 << 100) as f32);

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

/// What a block's four triangles answer, before anyone asks which answer is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Candidates {
    /// True for each triangle that the ray's line meets at `t > 0`; elsewhere the rest is
    /// unspecified.
    pub met: f32x4,
    /// Distances.
    pub t: f32x4,
    /// Barycentric weight of the second corner, at least 0.
    pub u: f32x4,
    /// Barycentric weight of the third corner, at least 0; `u + v` is at most 1 to rounding.
    pub v: f32x4,
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

impl Shear {
    /// Prepares a ray whose direction [`normalize_exponent`] returned.
    #[inline(always)]
    #[must_use]
    pub fn new(origin: [f32; 3], direction: [f32; 3]) -> Self {
        let [x, y, z] = direction.map(f32::abs);
        let main = if x > y && x > z {
            0
        } else if y > z {
            1
        } else {
            2
        };
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
    pub fn test(&self, block: &Block) -> Candidates {
        // The remainder tells the compiler that no index is out of range.
        let axes = self.axes.map(|a| (a % 3) as usize);
        let [ox, oy, oz] = self.origin.map(f32x4::splat);
        let [sx, sy] = self.shear.map(f32x4::splat);
        let corner = |c: usize| {
            let vertex = &block.vertex[c];
            let z = vertex[axes[2]] - oz;
            let x = sx.mul_neg_add(z, vertex[axes[0]] - ox);
            let y = sy.mul_neg_add(z, vertex[axes[1]] - oy);
            [x, y, z]
        };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let edge = |p: [f32x4; 3], q: [f32x4; 3]| p[0] * q[1] - p[1] * q[0];
        let (wa, wb, wc) = (edge(c, b), edge(a, c), edge(b, a));
        let det = wa + wb + wc;

        let zero = f32x4::ZERO;
        let negative = wa.simd_lt(zero) | wb.simd_lt(zero) | wc.simd_lt(zero);
        let positive = wa.simd_gt(zero) | wb.simd_gt(zero) | wc.simd_gt(zero);
        let least = wa.abs().fast_min(wb.abs().fast_min(wc.abs()));
        let sure = least.simd_ge(f32x4::splat(SURE)) & det.abs().simd_le(f32x4::splat(1.0 / SURE));
        // The weights are divided before they meet a distance: their products with it would
        // overflow or vanish long before they do. What is computed for lanes that are not met is
        // computed in vain; a branch around it would be mispredicted every other time.
        let share = f32x4::ONE / det;
        let (ua, ub, uc) = (wa * share, wb * share, wc * share);
        let depth = ua.mul_add(a[2], ub.mul_add(b[2], uc * c[2]));
        let t = depth * f32x4::splat(self.inverse);
        let mut candidates = Candidates {
            met: !(negative & positive) & t.simd_gt(zero),
            t,
            // Adding 0 turns -0 into 0.
            u: ub + zero,
            v: uc + zero,
        };
        if !sure.all() {
            self.decide_exactly(sure, [a, b, c], [wa, wb, wc], &mut candidates);
        }
        candidates
    }

    /// The same test in f64 for the lanes that are not `sure`, from the same sheared corners. An edge
    /// that is not in doubt keeps its f32 value: the neighbour beyond that edge decided by it.
    #[cold]
    #[inline(never)]
    fn decide_exactly(
        &self,
        sure: f32x4,
        corners: [[f32x4; 3]; 3],
        weights: [f32x4; 3],
        out: &mut Candidates,
    ) {
        let sure = sure.to_bitmask();
        for lane in (0..BLOCK).filter(|lane| sure >> lane & 1 == 0) {
            let [a, b, c] = corners.map(|p| p.map(|e| f64::from(e.as_array()[lane])));
            let edge = |single: f32x4, p: [f64; 3], q: [f64; 3]| {
                let single = single.as_array()[lane];
                if single.is_finite() && single.abs() >= SURE {
                    f64::from(single)
                } else {
                    p[0] * q[1] - p[1] * q[0]
                }
            };
            let w = [
                edge(weights[0], c, b),
                edge(weights[1], a, c),
                edge(weights[2], b, a),
            ];
            let det = w[0] + w[1] + w[2];
            let inside = w.iter().all(|&e| e >= 0.0) || w.iter().all(|&e| e <= 0.0);
            let depth = (w[0] * a[2] + w[1] * b[2] + w[2] * c[2]) / det;
            let t = (depth * f64::from(self.inverse)) as f32;
            // A det of 0, or a corner that overflowed, leaves NaN or infinity in t.
            let met = inside && det != 0.0 && t > 0.0 && t < f32::INFINITY;
            out.met.as_mut_array()[lane] = f32::from_bits(if met { !0 } else { 0 });
            out.t.as_mut_array()[lane] = t;
            out.u.as_mut_array()[lane] = (w[1] / det) as f32 + 0.0;
            out.v.as_mut_array()[lane] = (w[2] / det) as f32 + 0.0;
        }
    }
}
