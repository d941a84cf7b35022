//! What is asked of the tree: the closest hit of a ray, or whether a segment is free.
//!
//! A [`Query`] knows how to start a ray, what a block of triangles does to its answer, and where
//! the answer goes. How rays walk through the tree, one at a time or many at once, is written once
//! for both queries, in `traverse.rs` and `flight.rs`.

use crate::bvh::Block;
use crate::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use crate::slabs::{PAD, Slabs};
use crate::triangle::{Shear, normalize_exponent};
use crate::vec3::Columns;
use wide::{f32x4, u32x4};

/// A ray made ready for both tests, in units that make its direction's largest component 1 to 2.
#[derive(Clone, Copy, Debug, Default)]
pub struct Prepared {
    /// For boxes.
    pub slabs: Slabs,
    /// For triangles.
    pub shear: Shear,
    /// The kernel's distances times this are the caller's: a power of two, so nothing is rounded.
    scale: f64,
}

impl Prepared {
    /// Ray `i` of the columns. `None` if it can meet nothing.
    #[inline(always)]
    #[must_use]
    pub fn load(origin: Columns, direction: Columns, i: usize) -> Option<Self> {
        let origin = origin.map(|column| column[i]);
        let (direction, scale) = normalize_exponent(direction.map(|column| column[i]))?;
        if !origin.iter().all(|o| o.is_finite()) {
            return None;
        }
        Some(Self {
            slabs: Slabs::new(origin, direction),
            shear: Shear::new(origin, direction),
            scale,
        })
    }

    /// The same ray in another space; distances along it stay the numbers that they are.
    #[inline(always)]
    pub(crate) fn seen_as(&self, origin: [f32; 3], direction: [f32; 3]) -> Self {
        Self {
            slabs: Slabs::new(origin, direction),
            shear: Shear::new(origin, direction),
            scale: self.scale,
        }
    }

    /// A distance of the caller's in the kernel's units.
    #[inline(always)]
    pub(crate) fn inward(&self, t: f32) -> f32 {
        (f64::from(t) / self.scale) as f32
    }

    /// A hit's distance in the caller's units; what f32 cannot hold becomes the nearest it can.
    #[inline(always)]
    fn outward(&self, t: f32) -> f32 {
        ((f64::from(t) * self.scale) as f32).clamp(f32::from_bits(1), f32::MAX)
    }
}

/// A question asked of every ray of a view.
pub trait Query {
    /// What is known so far about one ray.
    type State: Copy + Default;
    /// Whether nearer boxes should be visited first.
    const ORDERED: bool;

    /// Rays in the view.
    fn len(&self) -> usize;
    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Makes ray `i` ready. `None` if it can meet nothing; that is then its answer.
    fn start(&mut self, i: usize) -> Option<(Prepared, Self::State)>;
    /// Boxes entered beyond this distance need no visit.
    fn limit(state: &Self::State) -> f32;
    /// Tests a block.
    fn visit(state: &mut Self::State, ray: &Prepared, block: &Block);
    /// Whether no further visit can change the answer.
    fn settled(state: &Self::State) -> bool;
    /// Writes the answer of ray `i`.
    fn finish(&mut self, i: usize, ray: &Prepared, state: &Self::State);
}

/// The closest hit of each ray.
#[derive(Debug)]
pub struct ClosestHit<'a, 'b> {
    /// Rays in.
    pub rays: Rays<'a>,
    /// Hits out.
    pub hits: Hits<'b>,
}

/// The closest hit so far.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    pub(crate) t: f32,
    /// `t (1 + PAD)`.
    pub(crate) limit: f32,
    pub(crate) primitive: u32,
    pub(crate) u: f32,
    pub(crate) v: f32,
    pub(crate) leaves: u32,
}

impl Default for Closest {
    fn default() -> Self {
        Self {
            t: f32::MAX,
            limit: f32::INFINITY,
            primitive: NO_PRIMITIVE,
            u: 0.0,
            v: 0.0,
            leaves: NO_PRIMITIVE,
        }
    }
}

impl Query for ClosestHit<'_, '_> {
    type State = Closest;
    const ORDERED: bool = true;

    #[inline(always)]
    fn len(&self) -> usize {
        self.rays.len
    }

    #[inline(always)]
    fn start(&mut self, i: usize) -> Option<(Prepared, Closest)> {
        self.hits.primitive[i] = NO_PRIMITIVE;
        let ray = Prepared::load(self.rays.origin, self.rays.direction, i)?;
        let leaves = self.rays.leaves[i];
        Some((
            ray,
            Closest {
                leaves,
                ..Closest::default()
            },
        ))
    }

    #[inline(always)]
    fn limit(state: &Closest) -> f32 {
        state.limit
    }

    /// Takes the block's nearest triangle, unless it is the one excluded or lies no nearer; of
    /// equally near ones that with the smallest index. Straight code: whether there is anything to
    /// take cannot be foreseen.
    #[inline(always)]
    fn visit(state: &mut Closest, ray: &Prepared, block: &Block) {
        let own: f32x4 = bytemuck::cast(block.primitive.simd_eq(u32x4::splat(state.leaves)));
        let found = ray.shear.test_but(block, own);
        let near: f32x4 = found.t.simd_le(f32x4::splat(state.t));
        let taken: u32x4 = bytemuck::cast(found.met & near & !own);
        // Bits of positive distances order like the distances; what is not taken comes last.
        let t = bytemuck::cast::<_, u32x4>(found.t) | !taken;
        let least = horizontal_min(t);
        // The first of equally near ones has the smallest index: see `Block`.
        let lane = t.simd_eq(least).to_bitmask().trailing_zeros() as usize & 3;
        let t = least.as_array()[0];
        let primitive = block.primitive.as_array()[lane];
        let current = state.t.to_bits();
        // One comparison for distance and index: two would become a branch.
        let key = |t: u32, primitive: u32| u64::from(t) << 32 | u64::from(primitive);
        let better = key(t, primitive) < key(current, state.primitive);
        let take = |new: f32, old: f32| f32::from_bits(pick(better, new.to_bits(), old.to_bits()));
        state.u = take(found.u.as_array()[lane], state.u);
        state.v = take(found.v.as_array()[lane], state.v);
        state.t = f32::from_bits(pick(better, t, current));
        state.primitive = pick(better, primitive, state.primitive);
        state.limit = state.t * (1.0 + PAD);
    }

    #[inline(always)]
    fn settled(_: &Closest) -> bool {
        false
    }

    #[inline(always)]
    fn finish(&mut self, i: usize, ray: &Prepared, state: &Closest) {
        self.hits.primitive[i] = state.primitive;
        self.hits.t[i] = ray.outward(state.t);
        self.hits.u[i] = state.u;
        self.hits.v[i] = state.v;
    }
}

/// Whether anything lies on each segment.
#[derive(Debug)]
pub struct Occlusion<'a, 'b> {
    /// Segments in.
    pub segments: Segments<'a>,
    /// 1 or 0 out.
    pub occluded: &'b mut [u32],
}

/// What one occlusion query asks, in the kernel's units, and its answer so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Within {
    pub(crate) t_max: f32,
    /// `t_max (1 + PAD)`.
    pub(crate) limit: f32,
    pub(crate) excluded: [u32; 2],
    pub(crate) occluded: u32,
}

impl Query for Occlusion<'_, '_> {
    type State = Within;
    const ORDERED: bool = false;

    #[inline(always)]
    fn len(&self) -> usize {
        self.segments.len
    }

    #[inline(always)]
    fn start(&mut self, i: usize) -> Option<(Prepared, Within)> {
        self.occluded[i] = 0;
        let ray = Prepared::load(self.segments.origin, self.segments.direction, i)?;
        let t_max = ray.inward(self.segments.t_max[i]);
        if t_max.is_nan() || t_max <= 0.0 {
            return None;
        }
        Some((
            ray,
            Within {
                t_max,
                limit: t_max * (1.0 + PAD),
                excluded: [self.segments.leaves[i], self.segments.reaches[i]],
                occluded: 0,
            },
        ))
    }

    #[inline(always)]
    fn limit(state: &Within) -> f32 {
        state.limit
    }

    #[inline(always)]
    fn visit(state: &mut Within, ray: &Prepared, block: &Block) {
        let excluded = block.primitive.simd_eq(u32x4::splat(state.excluded[0]))
            | block.primitive.simd_eq(u32x4::splat(state.excluded[1]));
        let excluded: f32x4 = bytemuck::cast(excluded);
        let found = ray.shear.test_but(block, excluded);
        let near: f32x4 = found.t.simd_lt(f32x4::splat(state.t_max));
        state.occluded |= u32::from((found.met & near & !excluded).any());
    }

    #[inline(always)]
    fn settled(state: &Within) -> bool {
        state.occluded != 0
    }

    #[inline(always)]
    fn finish(&mut self, i: usize, _: &Prepared, state: &Within) {
        self.occluded[i] = state.occluded;
    }
}

/// The least of four in every lane.
#[inline(always)]
fn horizontal_min(x: u32x4) -> u32x4 {
    let x = x.min(x.shuffle(u32x4::new([1, 0, 3, 2])));
    x.min(x.shuffle(u32x4::new([2, 3, 0, 1])))
}

/// `new` if `condition`, else `old`, without a branch.
#[inline(always)]
fn pick(condition: bool, new: u32, old: u32) -> u32 {
    let mask = u32::from(condition).wrapping_neg();
    (new & mask) | (old & !mask)
}
