//! A scene of few triangles: eight rays, a lane each, against every triangle, without a tree.
//!
//! A walk through a tree costs a few hundred cycles however small the tree: sorting children,
//! stacks, queues. Up to about fifty triangles it is cheaper to test them all.
//!
//! 1. The lanes of a vector must agree on the main axis of their rays. So rays are dealt into three
//!    hands by axis, whole columns at a time, compacted by lanes; what does not fill a vector waits for
//!    the next rays.
//! 2. Every vertex is sheared once for eight rays, not once for each triangle at it.
//! 3. A triangle is three edge functions of sheared vertices. Where they are sure (see
//!    [`crate::triangle`]) none is 0, so that their sign bits alone tell inside from outside. Whether
//!    they all were is asked once, after the last triangle; if not, which is rare, all are tested again
//!    in the exact way.
//!
//! The arithmetic is that of [`crate::triangle::View`], so a triangle gives the same bits here and
//! there. Triangles are visited by rising index and a later one must be strictly nearer: of equally
//! near ones the first is taken, as everywhere.
//!
//! Input and output: as `traverse.rs`, and triangles by rising index. Reads 12 bytes a vertex, 8 a
//! triangle, and 96 of sheared vertices a corner, for eight rays.

use crate::lanes::{Fx, LANES, Mask, Ux, as_bits, as_mask, first, iota, load_u32, store_u32};
use crate::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use crate::triangle::{self, Candidates, SURE, View, normalize_exponent};
use crate::vec3::Columns;
use crate::{compact::Kept, visits};

mod deal;
pub(crate) use deal::load_part;
use deal::{Eight, deal};

/// Most vertices of a [`Few`].
pub const MAX_VERTICES: usize = 256;

/// A triangle: its index in the mesh, and its corners' places among the vertices.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Index in the mesh.
    pub primitive: u32,
    /// Corners.
    pub corners: [u8; 3],
}

/// A few triangles. Those with a corner that is not finite are left out.
#[derive(Clone, Copy, Debug)]
pub struct Few<'a> {
    /// At most [`MAX_VERTICES`].
    pub vertices: &'a [[f32; 3]],
    /// By rising index.
    pub triangles: &'a [Triangle],
}

/// Writes the closest hit of each ray.
///
/// # Panics
/// If a column is shorter than `rays.len`, or there are too many vertices.
pub fn closest(few: Few, rays: Rays, hits: Hits) {
    hits.primitive[..rays.len].fill(NO_PRIMITIVE);
    let mut visitor = ClosestOf {
        few,
        leaves: rays.leaves,
        hits,
    };
    deal(rays.len, rays.origin, rays.direction, &mut visitor);
}

/// Writes 1 for each segment that something lies on, else 0.
///
/// # Panics
/// If a column is shorter than `segments.len`, or there are too many vertices.
pub fn occluded(few: Few, segments: Segments, occluded: &mut [u32]) {
    occluded[..segments.len].fill(0);
    let mut visitor = OcclusionBy {
        few,
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

/// [`closest`] for ray `i` alone, by the exact test.
#[cfg(target_arch = "x86_64")]
pub(crate) fn closest_of_one(few: Few, rays: Rays, hits: Hits, i: usize) {
    hits.primitive[i] = NO_PRIMITIVE;
    let Some(eight) = Eight::of_one(rays.origin, rays.direction, i) else {
        return;
    };
    let leaves = Ux::splat(rays.leaves[i]);
    let mut visitor = ClosestOf {
        few,
        leaves: rays.leaves,
        hits,
    };
    let best = visitor.visit_exactly(&eight, leaves);
    visitor.store(&eight, &best);
}

/// [`occluded`] for segment `i` alone, by the exact test.
#[cfg(target_arch = "x86_64")]
pub(crate) fn occluded_of_one(few: Few, segments: Segments, occluded: &mut [u32], i: usize) {
    occluded[i] = 0;
    let Some(eight) = Eight::of_one(segments.origin, segments.direction, i) else {
        return;
    };
    let t_max = eight.inward(Fx::splat(segments.t_max[i]));
    let named = [segments.leaves[i], segments.reaches[i]];
    let visitor = OcclusionBy {
        few,
        segments,
        occluded,
    };
    let excluded = |triangle: &Triangle| {
        let one = if named.contains(&triangle.primitive) {
            u32::MAX
        } else {
            0
        };
        as_mask(Ux::splat(one))
    };
    let met = visitor.visit_exactly(&eight, t_max, excluded).to_bitmask();
    visitor.occluded[i] = met & 1;
}

/// Vertices as eight rays see them.
type Sheared = [[Fx; 3]; MAX_VERTICES];

/// What is done with eight rays.
trait Visitor {
    /// Words of a ray besides its origin and direction.
    const WORDS: usize;
    /// Those of rays `i .. i + LANES`, into the first `WORDS`.
    fn words(&self, i: usize) -> [Ux; 3];
    /// Tests them against all triangles. Their vertices are sheared into `sheared`, whatever was there.
    fn visit(&mut self, eight: &Eight, words: [Ux; 3], sheared: &mut Sheared);
}

struct ClosestOf<'a, 'b> {
    few: Few<'a>,
    leaves: &'a [u32],
    hits: Hits<'b>,
}

impl Visitor for ClosestOf<'_, '_> {
    const WORDS: usize = 1;

    #[inline(always)]
    fn words(&self, i: usize) -> [Ux; 3] {
        [Ux::new(load_part(self.leaves, i)), Ux::ZERO, Ux::ZERO]
    }

    #[inline(always)]
    fn visit(&mut self, eight: &Eight, [leaves, ..]: [Ux; 3], sheared: &mut Sheared) {
        visits::add(0, LANES * self.few.triangles.len());
        eight.shear(self.few.vertices, sheared);
        let mut best = Best::default();
        let mut doubt = Doubt::default();
        for triangle in self.few.triangles {
            let own = as_mask(leaves.simd_eq(Ux::splat(triangle.primitive)));
            let found = eight.test(triangle, sheared, own, &mut doubt);
            best.take(triangle, found, leaves);
        }
        if !doubt.none() {
            best = self.visit_exactly(eight, leaves);
        }
        self.store(eight, &best);
    }
}

impl ClosestOf<'_, '_> {
    #[cold]
    #[inline(never)]
    fn visit_exactly(&self, eight: &Eight, leaves: Ux) -> Best {
        let mut best = Best::default();
        for triangle in self.few.triangles {
            best.take(
                triangle,
                eight.test_exactly(triangle, self.few.vertices),
                leaves,
            );
        }
        best
    }

    #[inline(always)]
    fn store(&mut self, eight: &Eight, best: &Best) {
        let t = eight.outward(best.t).to_array();
        let (u, v) = (best.u.to_array(), best.v.to_array());
        let (id, primitive) = (eight.id.to_array(), best.primitive.to_array());
        for lane in 0..eight.used {
            let i = id[lane] as usize;
            self.hits.primitive[i] = primitive[lane];
            self.hits.t[i] = t[lane];
            self.hits.u[i] = u[lane];
            self.hits.v[i] = v[lane];
        }
    }
}

/// The closest hits so far, a ray a lane.
struct Best {
    t: Fx,
    u: Fx,
    v: Fx,
    primitive: Ux,
}

impl Default for Best {
    #[inline(always)]
    fn default() -> Self {
        Self {
            t: Fx::splat(f32::MAX),
            u: Fx::ZERO,
            v: Fx::ZERO,
            primitive: Ux::splat(NO_PRIMITIVE),
        }
    }
}

impl Best {
    #[inline(always)]
    fn take(&mut self, triangle: &Triangle, found: Candidates<Fx>, leaves: Ux) {
        let index = Ux::splat(triangle.primitive);
        let own = as_mask(index.simd_eq(leaves));
        let nearer: Mask = found.met & found.t.simd_lt(self.t) & !own;
        self.t = nearer.select(found.t, self.t);
        self.u = nearer.select(found.u, self.u);
        self.v = nearer.select(found.v, self.v);
        self.primitive = as_bits(nearer).select(index, self.primitive);
    }
}

struct OcclusionBy<'a, 'b> {
    few: Few<'a>,
    segments: Segments<'a>,
    occluded: &'b mut [u32],
}

impl Visitor for OcclusionBy<'_, '_> {
    const WORDS: usize = 3;

    #[inline(always)]
    fn words(&self, i: usize) -> [Ux; 3] {
        let s = &self.segments;
        [
            Ux::new(load_part(s.leaves, i)),
            Ux::new(load_part(s.reaches, i)),
            bytemuck::cast(load_part(s.t_max, i)),
        ]
    }

    #[inline(always)]
    fn visit(&mut self, eight: &Eight, [leaves, reaches, t_max]: [Ux; 3], sheared: &mut Sheared) {
        visits::add(0, LANES * self.few.triangles.len());
        eight.shear(self.few.vertices, sheared);
        let t_max = eight.inward(bytemuck::cast(t_max));
        let excluded = |triangle: &Triangle| {
            let index = Ux::splat(triangle.primitive);
            as_mask(index.simd_eq(leaves) | index.simd_eq(reaches))
        };
        let mut met = Fx::ZERO;
        let mut doubt = Doubt::default();
        for triangle in self.few.triangles {
            let found = eight.test(triangle, sheared, excluded(triangle), &mut doubt);
            met |= found.met & found.t.simd_lt(t_max) & !excluded(triangle);
        }
        if !doubt.none() {
            met = self.visit_exactly(eight, t_max, excluded);
        }
        let (met, id) = (met.to_bitmask(), eight.id.to_array());
        for lane in 0..eight.used {
            self.occluded[id[lane] as usize] = met >> lane & 1;
        }
    }
}

impl OcclusionBy<'_, '_> {
    #[cold]
    #[inline(never)]
    fn visit_exactly(&self, eight: &Eight, t_max: Fx, excluded: impl Fn(&Triangle) -> Mask) -> Fx {
        let mut met = Fx::ZERO;
        for triangle in self.few.triangles {
            let found = eight.test_exactly(triangle, self.few.vertices);
            met |= found.met & found.t.simd_lt(t_max) & !excluded(triangle);
        }
        met
    }
}

/// What decides in the end whether all edge functions were sure.
struct Doubt {
    /// The least magnitude of an edge function.
    least: Fx,
    /// The bits of the greatest magnitude of a doubled area: those of a NaN are greater still.
    most: Ux,
    /// Where a triangle is met so near that only its plane can tell on which side.
    contact: Mask,
}

impl Default for Doubt {
    #[inline(always)]
    fn default() -> Self {
        Self {
            least: Fx::splat(f32::MAX),
            most: Ux::ZERO,
            contact: Fx::ZERO,
        }
    }
}

impl Doubt {
    #[inline(always)]
    fn none(&self) -> bool {
        let most = Ux::splat((1.0 / SURE).to_bits());
        let sure =
            Fx::splat(SURE).simd_le(self.least) & !as_mask(most.simd_lt(self.most)) & !self.contact;
        sure.all()
    }
}

impl Eight {
    /// All vertices as these rays see them.
    #[inline(always)]
    fn shear(&self, vertices: &[[f32; 3]], into: &mut Sheared) {
        let axes = self.axes.map(|a| a % 3);
        for (vertex, into) in vertices.iter().zip(into) {
            let corner = axes.map(|a| Fx::splat(vertex[a]));
            *into = triangle::shear(corner, &self.origin, &self.slope);
        }
    }

    /// All eight against one triangle; nobody looks at the lanes that are `ignored`.
    #[inline(always)]
    fn test(
        &self,
        triangle: &Triangle,
        sheared: &Sheared,
        ignored: Mask,
        doubt: &mut Doubt,
    ) -> Candidates<Fx> {
        let corners = triangle.corners.map(|c| &sheared[usize::from(c)]);
        let weights = triangle::weights(corners);
        let [a, b, c] = weights;
        let det = a + b + c;
        doubt.least = doubt
            .least
            .fast_min(a.abs().fast_min(b.abs().fast_min(c.abs())));
        doubt.most = doubt.most.max(bytemuck::cast(det.abs()));
        let [depth, u, v] = triangle::share(corners, weights, det);
        let t = depth * self.inverse;
        // Where all are sure, signs differ where sign bits do.
        let mixed: wide::i32x8 = bytemuck::cast((a ^ b) | (b ^ c));
        let outside: Mask = bytemuck::cast(mixed >> 31_i32);
        doubt.contact |= triangle::touches(corners, depth) & !outside & !ignored;
        Candidates {
            met: !outside & Fx::ZERO.simd_lt(t),
            t,
            u,
            v,
        }
    }

    fn test_exactly(&self, triangle: &Triangle, vertices: &[[f32; 3]]) -> Candidates<Fx> {
        let axes = self.axes.map(|a| a % 3);
        let corner = |c: u8| axes.map(|a| Fx::splat(vertices[usize::from(c)][a]));
        let view = View {
            corners: triangle.corners.map(corner),
            origin: self.origin,
            slope: self.slope,
            inverse: self.inverse,
        };
        view.meet_exactly()
    }
}
