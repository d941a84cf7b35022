//! One ray at a time through the tree: the closest hit, and whether anything is in the way.
//!
//! This is the plain form, and the oracle of the faster ones. Both answers depend on the ray and
//! the triangles alone as far as computed distances go: of equally near triangles the one with the
//! smallest index is taken, and boxes are never missed (`slabs.rs`), so neither the tree nor the
//! order of traversal shows.
//!
//! Distances that f32 cannot hold in the unit of an extremely short or long direction are reported
//! as the nearest that it can.
//!
//! Input: as [`crate::rays`] says; a ray with a component that is not finite, or without a
//! direction, meets nothing. Reads 32 to 36 bytes of a ray and writes 16 (closest) or 4 (occluded).

use crate::bvh::{Block, Bvh, LEAF, leaf_blocks};
use crate::order::Stack;
use crate::rays::{Hits, NO_PRIMITIVE, Rays, Segments};
use crate::slabs::{PAD, Slabs};
use crate::triangle::{Shear, normalize_exponent};
use crate::vec3::Columns;
use wide::{f32x4, u32x4};

/// A ray made ready for both tests, in units that make its direction's largest component 1 to 2.
#[derive(Clone, Copy, Debug, Default)]
pub struct Prepared {
    slabs: Slabs,
    shear: Shear,
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

    /// A distance of the caller's in the kernel's units.
    #[inline(always)]
    fn inward(&self, t: f32) -> f32 {
        (f64::from(t) / self.scale) as f32
    }

    /// A hit's distance in the caller's units; what f32 cannot hold becomes the nearest it can.
    #[inline(always)]
    fn outward(&self, t: f32) -> f32 {
        ((f64::from(t) * self.scale) as f32).clamp(f32::from_bits(1), f32::MAX)
    }
}

/// The closest hit so far.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    t: f32,
    /// `t (1 + PAD)`: boxes entered beyond are not visited.
    limit: f32,
    primitive: u32,
    u: f32,
    v: f32,
}

impl Closest {
    /// No hit yet.
    pub const NONE: Self = Self {
        t: f32::MAX,
        limit: f32::INFINITY,
        primitive: NO_PRIMITIVE,
        u: 0.0,
        v: 0.0,
    };

    /// Takes the block's nearest triangle, unless it is the one excluded or lies no nearer.
    #[inline(always)]
    fn visit(&mut self, block: &Block, ray: &Prepared, leaves: u32) {
        let found = ray.shear.test(block);
        if found.mask == 0 {
            return;
        }
        let near: f32x4 = found.t.simd_le(f32x4::splat(self.t));
        let own = block.primitive.simd_eq(u32x4::splat(leaves));
        let mut mask = found.mask & near.to_bitmask() & !own.to_bitmask();
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 3;
            mask &= mask - 1;
            let (t, primitive) = (found.t.as_array()[lane], block.primitive.as_array()[lane]);
            if t < self.t || (t == self.t && primitive < self.primitive) {
                let [u, v] = found.barycentric(lane);
                let limit = t * (1.0 + PAD);
                *self = Self {
                    t,
                    limit,
                    primitive,
                    u,
                    v,
                };
            }
        }
    }
}

/// What an occlusion query asks, in the kernel's units.
#[derive(Clone, Copy, Debug, Default)]
pub struct Within {
    t_max: f32,
    limit: f32,
    excluded: [u32; 2],
}

impl Within {
    /// Whether a triangle of the block is in the way.
    #[inline(always)]
    fn visit(&self, block: &Block, ray: &Prepared) -> bool {
        let found = ray.shear.test(block);
        if found.mask == 0 {
            return false;
        }
        let near: f32x4 = found.t.simd_lt(f32x4::splat(self.t_max));
        let excluded = block.primitive.simd_eq(u32x4::splat(self.excluded[0]))
            | block.primitive.simd_eq(u32x4::splat(self.excluded[1]));
        found.mask & near.to_bitmask() & !excluded.to_bitmask() != 0
    }
}

/// Writes the closest hit of each ray.
///
/// # Panics
/// If a column is shorter than `rays.len`.
pub fn closest(bvh: Bvh, rays: Rays, hits: &mut Hits) {
    let mut stack = Stack::default();
    for i in 0..rays.len {
        hits.primitive[i] = NO_PRIMITIVE;
        let Some(ray) = Prepared::load(rays.origin, rays.direction, i) else {
            continue;
        };
        let hit = closest_one(bvh, &ray, rays.leaves[i], &mut stack);
        hits.primitive[i] = hit.primitive;
        hits.t[i] = ray.outward(hit.t);
        hits.u[i] = hit.u;
        hits.v[i] = hit.v;
    }
}

fn closest_one(bvh: Bvh, ray: &Prepared, leaves: u32, stack: &mut Stack) -> Closest {
    let mut hit = Closest::NONE;
    let mut next = root(bvh);
    stack.clear();
    while let Some(reference) = next {
        if reference & LEAF == 0 {
            let node = &bvh.nodes[reference as usize];
            let (mask, enter) = ray.slabs.test(node, hit.limit);
            stack.push_ordered(node, mask, enter);
        } else {
            for block in &bvh.blocks[leaf_blocks(reference)] {
                hit.visit(block, ray, leaves);
            }
        }
        next = stack.pop_within(hit.limit);
    }
    hit
}

/// Writes 1 for each segment that something lies on, else 0.
///
/// # Panics
/// If a column is shorter than `segments.len`.
pub fn occluded(bvh: Bvh, segments: Segments, occluded: &mut [u32]) {
    let mut stack = Stack::default();
    for i in 0..segments.len {
        occluded[i] = 0;
        let Some(ray) = Prepared::load(segments.origin, segments.direction, i) else {
            continue;
        };
        let t_max = ray.inward(segments.t_max[i]);
        if t_max.is_nan() || t_max <= 0.0 {
            continue;
        }
        let within = Within {
            t_max,
            limit: t_max * (1.0 + PAD),
            excluded: [segments.leaves[i], segments.reaches[i]],
        };
        occluded[i] = u32::from(occluded_one(bvh, &ray, &within, &mut stack));
    }
}

fn occluded_one(bvh: Bvh, ray: &Prepared, within: &Within, stack: &mut Stack) -> bool {
    let mut next = root(bvh);
    stack.clear();
    while let Some(reference) = next {
        if reference & LEAF == 0 {
            let node = &bvh.nodes[reference as usize];
            let (mask, _) = ray.slabs.test(node, within.limit);
            stack.push(node, mask);
        } else {
            let blocks = &bvh.blocks[leaf_blocks(reference)];
            if blocks.iter().any(|block| within.visit(block, ray)) {
                return true;
            }
        }
        next = stack.pop();
    }
    false
}

/// The reference to start from.
#[inline(always)]
fn root(bvh: Bvh) -> Option<u32> {
    (!bvh.nodes.is_empty()).then_some(0)
}
