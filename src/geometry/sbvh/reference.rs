//! References: a triangle, or the part of it inside a box.
//!
//! A spatial split cuts a triangle's reference in two. **What must hold** for rays not to slip
//! between: the triangle test (`kernels/src/triangle.rs`) is exact for a triangle whose vertices
//! are moved, along each axis, by at most `5u` of their distance from the ray's origin `o`
//! (`u = 2^-24`), and its distance is rounded by as much again. Let `p` be the point of the true
//! triangle with the same barycentric weights as the hit that the test reports, and `E` the
//! triangle's largest extent. Vertices are at most `|p - o| + E` away, so the reported hit lies
//! within `10u (|p - o| + E)` of `p`. The part with `|p - o|` is what the box test's own slack
//! covers (`kernels/src/slabs.rs`). The part with `E` is new: with whole triangles it stays inside
//! the moved vertices' box, but a cut box has no vertex there. So every cut box is made larger, on
//! all sides, by [`SLACK`] of `E`, and then cut down again to the reference that was split.
//!
//! Then, by induction over the splits: for each point `p` of the triangle there is a reference
//! whose box contains all of the whole triangle's box that is within `10u E` of `p`. A split at a
//! plane passes that on to the half in which `p` lies.
//!
//! The cut itself is rounded too: the intersection of an edge with the plane is off by at most
//! `4u E` for the quotient and the product (differences of vertices, each rounded once, are at
//! most `E`), and by `u` of its own coordinate for the last sum; adding the slack rounds by `u` of
//! the coordinate again. `10u + 4u` is less than [`SLACK`] with all second-order terms; the sums
//! are paid for by `4u` of the coordinate.

use super::bounds::Bounds;
use crate::scene::Mesh;
use bytemuck::{Pod, Zeroable};
use wide::f32x8;

/// `32 u`, of the triangle's largest extent.
const SLACK: f32 = 1.0 / 524_288.0;
/// `4 u`, of a coordinate.
const ROUNDING: f32 = 1.0 / 4_194_304.0;
/// The lane in which a reference keeps its triangle.
const TRIANGLE: usize = 3;

/// A triangle's index and the box of what is left of it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Reference(Bounds);

impl Reference {
    pub(super) fn new(bounds: Bounds, triangle: u32) -> Self {
        let mut lanes = bounds.0;
        lanes.as_mut_array()[TRIANGLE] = f32::from_bits(triangle);
        Self(Bounds(lanes))
    }

    #[inline(always)]
    pub(super) fn bounds(self) -> Bounds {
        self.0
    }

    #[inline(always)]
    pub(super) fn triangle(self) -> u32 {
        self.0.0.as_array()[TRIANGLE].to_bits()
    }
}

/// A triangle to be cut.
pub(super) struct Cutter {
    vertices: [[f32; 3]; 3],
    points: [Bounds; 3],
    slack: f32x8,
}

impl Cutter {
    pub(super) fn new(mesh: &Mesh, triangle: u32) -> Self {
        let vertices = mesh.corners(triangle as usize);
        let points = vertices.map(Bounds::point);
        let whole = points[0].union(points[1]).union(points[2]);
        let [x, y, z, _] = whole.extent().to_array();
        // The smallest normal number is for triangles so small that everything underflows: each
        // rounding is then below it.
        let slack = x.max(y).max(z) * SLACK + f32::MIN_POSITIVE;
        Self {
            vertices,
            points,
            slack: f32x8::splat(slack),
        }
    }

    /// Boxes of what is left of the triangle in `bounds`, below and above `plane`; either may be
    /// empty.
    #[inline(always)]
    pub(super) fn cut(&self, bounds: Bounds, axis: usize, plane: f32) -> [Bounds; 2] {
        let mut halves = [Bounds::EMPTY; 2];
        let at = self.vertices.map(|v| v[axis]);
        for i in 0..3 {
            if at[i] <= plane {
                halves[0] = halves[0].union(self.points[i]);
            }
            if at[i] >= plane {
                halves[1] = halves[1].union(self.points[i]);
            }
            let j = (i + 1) % 3;
            let (a, b) = (at[i], at[j]);
            if (a < plane && plane < b) || (b < plane && plane < a) {
                let share = f32x8::splat((plane - a) / (b - a));
                let (p, q) = (self.points[i].0, self.points[j].0);
                let crossing = Bounds((q - p).mul_add(share, p));
                halves = halves.map(|half| half.union(crossing));
            }
        }
        halves.map(|half| {
            // An empty half stays empty: -inf + inf would be NaN.
            if half.0.as_array()[0] == f32::NEG_INFINITY {
                return Bounds::EMPTY;
            }
            let slack = half.0.abs().mul_add(f32x8::splat(ROUNDING), self.slack);
            Bounds(half.0 + slack).intersection(bounds)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In `[-1, 1)`.
    fn signed(state: &mut u64) -> f32 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(99);
        ((*state >> 40) as f32) / 8_388_608.0 - 1.0
    }

    fn mesh(corners: [[f32; 3]; 3]) -> Mesh {
        Mesh {
            vertices: corners.to_vec(),
            indices: vec![[0, 1, 2]],
            material: vec![0],
            ..Mesh::default()
        }
    }

    /// Needles, slivers and others, of sizes from 1e-3 to 1e3, up to 1e4 from the origin.
    fn triangle(state: &mut u64) -> [[f32; 3]; 3] {
        let size = 10f32.powf(3.0 * signed(state));
        let at = [(); 3].map(|()| 1e4 * signed(state).powi(3));
        let stretch = [(); 3].map(|()| signed(state).powi(4));
        [(); 3].map(|()| std::array::from_fn(|a| at[a] + size * stretch[a] * signed(state)))
    }

    /// What the header promises, after up to twelve cuts: around every point of the triangle, all of
    /// the whole box within `10u` of the extent lies in one of the pieces.
    #[test]
    fn pieces_cover_the_triangle_and_what_the_triangle_test_may_add() {
        let state = &mut 1u64;
        for _ in 0..400 {
            let corners = triangle(state);
            let cutter = Cutter::new(&mesh(corners), 0);
            let [a, b, c] = corners.map(Bounds::point);
            let whole = a.union(b).union(c);
            let mut pieces = vec![whole];
            for _ in 0..12 {
                // Some piece, along some axis, where something of it is.
                let at =
                    ((signed(state).abs() * pieces.len() as f32) as usize).min(pieces.len() - 1);
                let piece = pieces.swap_remove(at);
                let axis = (signed(state).abs() * 3.0) as usize % 3;
                let (low, high) = (piece.min().to_array()[axis], piece.max().to_array()[axis]);
                let plane = low + (high - low) * signed(state).abs();
                let halves = cutter.cut(piece, axis, plane);
                pieces.extend(halves.into_iter().filter(|half| !half.is_empty()));
            }
            let (low, high) = (whole.min().to_array(), whole.max().to_array());
            let extent = (0..3).map(|k| f64::from(high[k]) - f64::from(low[k]));
            let reach = extent.fold(0.0, f64::max) * 10.0 / 16_777_216.0;
            for _ in 0..100 {
                let (mut u, mut v) = (signed(state).abs(), signed(state).abs());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let [u, v] = [u, v].map(f64::from);
                let corner = |i: usize, k: usize| f64::from(corners[i][k]);
                let p: [f64; 3] = std::array::from_fn(|k| {
                    (1.0 - u - v) * corner(0, k) + u * corner(1, k) + v * corner(2, k)
                });
                let holds = |piece: &Bounds| {
                    let (from, to) = (piece.min().to_array(), piece.max().to_array());
                    (0..3).all(|k| {
                        f64::from(from[k]) <= (p[k] - reach).max(low[k].into())
                            && f64::from(to[k]) >= (p[k] + reach).min(high[k].into())
                    })
                };
                assert!(pieces.iter().any(holds), "{corners:?} at {p:?}");
            }
        }
    }

    #[test]
    fn cuts_are_tight() {
        // The diagonal of a square, cut at a quarter: what is below is a quarter wide and high.
        let mesh = mesh([[0.0; 3], [1.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
        let cutter = Cutter::new(&mesh, 0);
        let whole = Bounds::point([0.0; 3]).union(Bounds::point([1.0, 1.0, 0.0]));
        let [below, above] = cutter.cut(whole, 0, 0.25);
        let two_slacks = 2.0 * SLACK;
        assert!((below.max().to_array()[1] - 0.25).abs() < two_slacks);
        assert!((above.min().to_array()[1] - 0.25).abs() < two_slacks);
        assert_eq!(below.max().to_array()[2], 0.0, "and never beyond the whole");
        let [_, nothing] = cutter.cut(below, 0, 0.75);
        assert!(nothing.is_empty());
    }

    #[test]
    fn a_reference_keeps_its_triangle() {
        let reference = Reference::new(Bounds::point([1.0, 2.0, 3.0]), u32::MAX - 1);
        assert_eq!(reference.triangle(), u32::MAX - 1);
        assert_eq!(reference.bounds().extent().to_array()[..3], [0.0; 3]);
    }
}
