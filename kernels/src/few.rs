//! A scene of few triangles: eight rays, a lane each, against every triangle, without a tree.
//!
//! A walk through a tree costs a few hundred cycles however small the tree: sorting children,
//! stacks, queues. A triangle against eight rays is some eighty instructions, so up to about fifty
//! triangles it is cheaper to test them all.
//!
//! The lanes of a vector must agree on the main axis of their rays, so rays are dealt into three
//! lists by axis first. The arithmetic of the test is that of [`crate::triangle::View`], so a
//! triangle gives the same bits here and there. Triangles are visited by rising index and a later
//! one must be strictly nearer: of equally near ones the first is taken, as everywhere.
//!
//! Input and output: as `traverse.rs`, and triangles by rising index. Reads 40 bytes a triangle and
//! eight rays.

use crate::lanes::{Fx, LANES, Mask, Ux, as_bits, as_mask};
use crate::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use crate::triangle::{Candidates, View, main_axis, normalize_exponent};
use crate::vec3::Columns;

/// A triangle: its index in the mesh and its corners.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Index in the mesh.
    pub primitive: u32,
    /// Corners.
    pub corners: [[f32; 3]; 3],
}

/// Rays dealt at once.
const HAND: usize = 128;

/// Eight rays with the same main axis.
struct Eight {
    /// Their places in the view; unused lanes repeat the first.
    id: [usize; LANES],
    /// Lanes in use.
    used: usize,
    /// Along the axes first, second, main.
    origin: [Fx; 3],
    slope: [Fx; 2],
    inverse: Fx,
    /// Callers' distances over the kernel's.
    scale: [f64; LANES],
}

/// Writes the closest hit of each ray.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest(triangles: &[Triangle], rays: Rays, hits: Hits) {
    hits.primitive[..rays.len].fill(NO_PRIMITIVE);
    let mut visitor = ClosestOf {
        triangles,
        rays,
        hits,
    };
    deal(rays.len, rays.origin, rays.direction, &mut visitor);
}

/// Writes 1 for each segment that something lies on, else 0.
///
/// # Panics
/// If a column is shorter than `segments.len`.
pub fn occluded(triangles: &[Triangle], segments: Segments, occluded: &mut [u32]) {
    occluded[..segments.len].fill(0);
    let mut visitor = OcclusionBy {
        triangles,
        segments,
        occluded,
    };
    deal(
        segments.len,
        segments.origin,
        segments.direction,
        &mut visitor,
    );
}

/// What is done with eight rays whose main axis is `MAIN`: a constant, so that reading a corner
/// along their axes costs nothing.
trait Visitor {
    fn visit<const MAIN: usize>(&mut self, eight: &Eight);
}

struct ClosestOf<'a, 'b> {
    triangles: &'a [Triangle],
    rays: Rays<'a>,
    hits: Hits<'b>,
}

impl Visitor for ClosestOf<'_, '_> {
    #[inline(always)]
    fn visit<const MAIN: usize>(&mut self, eight: &Eight) {
        let leaves = Ux::new(eight.id.map(|i| self.rays.leaves[i]));
        let (mut t, mut u, mut v) = (Fx::splat(f32::MAX), Fx::ZERO, Fx::ZERO);
        let mut primitive = Ux::splat(NO_PRIMITIVE);
        for triangle in self.triangles {
            let index = Ux::splat(triangle.primitive);
            let own = as_mask(index.simd_eq(leaves));
            let found = eight.test::<MAIN>(triangle, own);
            let nearer: Mask = found.met & found.t.simd_lt(t) & !own;
            t = nearer.select(found.t, t);
            u = nearer.select(found.u, u);
            v = nearer.select(found.v, v);
            primitive = as_bits(nearer).select(index, primitive);
        }
        for lane in 0..eight.used {
            let i = eight.id[lane];
            let outward = f64::from(t.as_array()[lane]) * eight.scale[lane];
            self.hits.primitive[i] = primitive.as_array()[lane];
            self.hits.t[i] = (outward as f32).clamp(f32::from_bits(1), f32::MAX);
            self.hits.u[i] = u.as_array()[lane];
            self.hits.v[i] = v.as_array()[lane];
        }
    }
}

struct OcclusionBy<'a, 'b> {
    triangles: &'a [Triangle],
    segments: Segments<'a>,
    occluded: &'b mut [u32],
}

impl Visitor for OcclusionBy<'_, '_> {
    #[inline(always)]
    fn visit<const MAIN: usize>(&mut self, eight: &Eight) {
        let Segments {
            t_max,
            leaves,
            reaches,
            ..
        } = self.segments;
        let inward = |lane: usize| f64::from(t_max[eight.id[lane]]) / eight.scale[lane];
        let t_max = Fx::new(std::array::from_fn(|lane| inward(lane) as f32));
        let leaves = Ux::new(eight.id.map(|i| leaves[i]));
        let reaches = Ux::new(eight.id.map(|i| reaches[i]));
        let mut met = Fx::ZERO;
        for triangle in self.triangles {
            let index = Ux::splat(triangle.primitive);
            let excluded = as_mask(index.simd_eq(leaves) | index.simd_eq(reaches));
            let found = eight.test::<MAIN>(triangle, excluded);
            met |= found.met & found.t.simd_lt(t_max) & !excluded;
        }
        let met = met.to_bitmask();
        for lane in 0..eight.used {
            self.occluded[eight.id[lane]] = met >> lane & 1;
        }
    }
}

impl Eight {
    /// All eight against one triangle; nobody looks at the lanes that are `ignored`.
    #[inline(always)]
    fn test<const MAIN: usize>(&self, triangle: &Triangle, ignored: Mask) -> Candidates<Fx> {
        let (found, sure) = self.view::<MAIN>(triangle).meet();
        if (sure | ignored).all() {
            return found;
        }
        let exact = self.test_exactly::<MAIN>(triangle);
        Candidates {
            met: exact.met,
            t: exact.t,
            u: exact.u,
            v: exact.v,
        }
    }

    #[cold]
    #[inline(never)]
    fn test_exactly<const MAIN: usize>(&self, triangle: &Triangle) -> Candidates<Fx> {
        self.view::<MAIN>(triangle).meet_exactly()
    }

    #[inline(always)]
    fn view<const MAIN: usize>(&self, triangle: &Triangle) -> View<Fx> {
        let axes = const { [(MAIN + 1) % 3, (MAIN + 2) % 3, MAIN] };
        View {
            corners: triangle.corners.map(|c| axes.map(|a| Fx::splat(c[a]))),
            origin: self.origin,
            slope: self.slope,
            inverse: self.inverse,
        }
    }
}

/// Deals the rays that can meet anything into eights of one main axis.
#[inline(always)]
fn deal(len: usize, origin: Columns, direction: Columns, visitor: &mut impl Visitor) {
    for first in (0..len).step_by(HAND) {
        let mut lists = [[0u8; HAND]; 3];
        let mut lengths = [0usize; 3];
        for i in first..len.min(first + HAND) {
            let o = origin.map(|column| column[i]);
            let d = direction.map(|column| column[i]);
            let axis = main_axis(d);
            let usable = o.iter().all(|o| o.is_finite())
                && d.iter().all(|d| d.is_finite())
                && d[axis] != 0.0;
            lists[axis][lengths[axis]] = (i - first) as u8;
            lengths[axis] += usize::from(usable);
        }
        for main in 0..3 {
            let axes = [(main + 1) % 3, (main + 2) % 3, main];
            for list in lists[main][..lengths[main]].chunks(LANES) {
                let eight = gather(first, list, origin, direction, axes);
                match main {
                    0 => visitor.visit::<0>(&eight),
                    1 => visitor.visit::<1>(&eight),
                    _ => visitor.visit::<2>(&eight),
                }
            }
        }
    }
}

#[inline(always)]
fn gather(
    first: usize,
    list: &[u8],
    origin: Columns,
    direction: Columns,
    axes: [usize; 3],
) -> Eight {
    let mut eight = Eight {
        id: std::array::from_fn(|l| first + usize::from(*list.get(l).unwrap_or(&list[0]))),
        used: list.len(),
        origin: [Fx::ZERO; 3],
        slope: [Fx::ZERO; 2],
        inverse: Fx::ZERO,
        scale: [1.0; LANES],
    };
    let mut rows = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let d = direction.map(|column| column[eight.id[lane]]);
        // Dealt rays are usable.
        let (d, scale) = normalize_exponent(d).unwrap_or(([1.0; 3], 1.0));
        eight.scale[lane] = scale;
        for k in 0..3 {
            rows[k][lane] = d[axes[k]];
        }
    }
    let d = rows.map(Fx::new);
    eight.origin = axes.map(|a| Fx::new(eight.id.map(|i| origin[a][i])));
    eight.slope = [d[0] / d[2], d[1] / d[2]];
    eight.inverse = Fx::ONE / d[2];
    eight
}
