//! `packet/` for processors with AVX-512: sixteen rays that go the same way, a lane each.
//!
//! The walk is that of `packet/eight.rs`: nodes are tested once for all against the same interval,
//! leaves' boxes and triangles ray by ray. A leaf's box is tested as in `node.rs`, triangles as in
//! `few.rs`; rays for which some triangle was in doubt are asked about again one at a time.

use super::few::{Doubt, meet};
use super::simd::{load16_u32, store_lanes};
use super::sixteen::{Sixteen, slack};
use crate::bvh::{Block, Bvh, LEAF, NOTHING, Node, WIDTH, index};
use crate::lanes::iota;
use crate::order::Stack;
use crate::packet::{Hull, SPREAD, UseOfLanes};
use crate::query::ClosestHit;
use crate::rays::{Hits, NO_PRIMITIVE, Rays};
use crate::slabs::PAD;
use crate::{traverse, visits};
use std::arch::x86_64::*;

/// Rays of a packet.
pub(crate) const RAYS: usize = 16;
/// The bits of a mask that is true everywhere.
const ALL: __mmask16 = !0;

/// Sixteen rays that go the same way, in the units of [`Sixteen`].
struct Packet {
    /// Origins along the axes first, second, main.
    origin: [__m512; 3],
    slope: [__m512; 2],
    /// First, second, main.
    axes: [usize; 3],
    /// 1 over the main component.
    inverse_main: __m512,
    leaves: __m512i,
    /// By axis, what is added for planes met first and last, and reciprocal directions: `node.rs`.
    enter: [__m512; 3],
    leave: [__m512; 3],
    inverse: [__m512; 3],
    /// Callers' distances over these.
    scale: __m512,
    hull: Hull,
}

/// The closest hits so far.
struct Found {
    t: __m512,
    u: __m512,
    v: __m512,
    primitive: __m512i,
}

/// Writes the closest hits of the sixteen rays from `i` on if they make a packet, and says how many
/// rays entered its leaves; else does nothing. No coordinate of the tree's boxes is larger than `extent`.
///
/// # Panics
/// If a column is shorter than `i + 16`, or [`available`](super::available) is false.
pub(crate) fn closest(
    bvh: Bvh,
    rays: &Rays,
    hits: &mut Hits,
    i: usize,
    extent: f32,
    stack: &mut Stack,
) -> Option<UseOfLanes> {
    assert!(super::available(), "a processor with AVX-512");
    // SAFETY: the processor has what the function is compiled for.
    unsafe { trace(bvh, rays, hits, i, extent, stack) }
}

#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn trace(
    bvh: Bvh,
    rays: &Rays,
    hits: &mut Hits,
    i: usize,
    extent: f32,
    stack: &mut Stack,
) -> Option<UseOfLanes> {
    let packet = Packet::load(rays, i, extent)?;
    let mut found = Found {
        t: _mm512_set1_ps(f32::MAX),
        u: _mm512_setzero_ps(),
        v: _mm512_setzero_ps(),
        primitive: _mm512_set1_epi32(NO_PRIMITIVE as i32),
    };
    let mut doubt = Doubt::new();
    let lanes = packet.walk(bvh, stack, &mut found, &mut doubt);
    found.store(packet.scale, hits, i);
    let mut unsure = doubt.lanes(ALL);
    while unsure != 0 {
        let i = i + unsure.trailing_zeros() as usize;
        traverse::closest(bvh, rays.part(i..i + 1), hits.part(i..i + 1));
        unsure &= unsure - 1;
    }
    Some(lanes)
}

impl Packet {
    /// Rays `i .. i + 16`, if they make a packet.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn load(rays: &Rays, i: usize, extent: f32) -> Option<Self> {
        let mut negative = [false; 3];
        for (negative, column) in negative.iter_mut().zip(rays.direction) {
            let signs = _mm512_movepi32_mask(load16_u32(bytemuck::cast_ref(row(column, i))));
            if signs != 0 && signs != ALL {
                return None;
            }
            *negative = signs != 0;
        }
        let sixteen = Sixteen::new(rays.origin, rays.direction, i..i + RAYS);
        let main = match (sixteen.x_main, sixteen.y_main) {
            (ALL, _) => 0,
            (0, ALL) => 1,
            (0, 0) => 2,
            _ => return None,
        };
        let slope = sixteen.slope();
        let mut together = sixteen.usual() == ALL;
        for slope in slope {
            // Asked this way round, a NaN makes no packet.
            together &= _mm512_reduce_max_ps(slope) - _mm512_reduce_min_ps(slope) <= SPREAD;
        }
        let mut ends = [[[0.0; 2]; 3]; 2];
        for axis in 0..3 {
            let inverse = sixteen.inverse[axis];
            let origin = sixteen.o[axis];
            ends[0][axis] = [_mm512_reduce_min_ps(origin), _mm512_reduce_max_ps(origin)];
            ends[1][axis] = [_mm512_reduce_min_ps(inverse), _mm512_reduce_max_ps(inverse)];
            together &= ends[1][axis].iter().all(|end| end.abs() <= f32::MAX);
        }
        if !together {
            return None;
        }
        let [enter, leave, inverse] = slack(sixteen.o, sixteen.d, sixteen.inverse, extent);
        Some(Self {
            origin: sixteen.permute(sixteen.o),
            slope,
            axes: [(main + 1) % 3, (main + 2) % 3, main],
            inverse_main: sixteen.by_main(sixteen.inverse),
            leaves: load16_u32(bytemuck::cast_ref(row(
                bytemuck::cast_slice(rays.leaves),
                i,
            ))),
            enter,
            leave,
            inverse,
            scale: sixteen.scale,
            hull: Hull::new(negative, ends[0], ends[1]),
        })
    }

    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn walk(
        &self,
        bvh: Bvh,
        stack: &mut Stack,
        found: &mut Found,
        doubt: &mut Doubt,
    ) -> UseOfLanes {
        let mut lanes = UseOfLanes::default();
        let mut limit = f32::INFINITY;
        let mut node = 0;
        stack.clear();
        loop {
            visits::add(1, 0);
            let (hits, enter) = self.hull.test(&bvh.nodes[node], limit);
            // A child by its place, not its reference: its box is wanted too.
            let places = iota((node * WIDTH) as u32);
            stack.push_references::<ClosestHit>(places, hits, enter);
            node = loop {
                let place = stack.pop::<ClosestHit>(limit);
                if place == NOTHING {
                    return lanes;
                }
                let (parent, slot) = (&bvh.nodes[place as usize / WIDTH], place as usize % WIDTH);
                let child = parent.child.as_array()[slot];
                if child & LEAF == 0 {
                    break index(child);
                }
                let inside = self.enters(parent, slot, found.t);
                lanes.leaves += 1;
                lanes.inside += inside.count_ones();
                if inside != 0 {
                    self.visit(found, &bvh.blocks[index(child)], inside, doubt);
                    limit = _mm512_reduce_max_ps(found.t) * (1.0 + PAD);
                }
            };
        }
    }

    /// Which rays enter the box of a slot at `limit` or before: [`super::node::test`], a ray a lane.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn enters(&self, node: &Node, slot: usize, limit: __m512) -> __mmask16 {
        let plane = |axis: usize, plane: usize, add: __m512| {
            let plane = _mm512_set1_ps(node.planes[plane % 6].as_array()[slot % WIDTH]);
            _mm512_fmadd_ps(plane, self.inverse[axis], add)
        };
        let near = |axis: usize| plane(axis, self.hull.near[axis], self.enter[axis]);
        let far = |axis: usize| plane(axis, self.hull.near[axis] ^ 1, self.leave[axis]);
        // What may be NaN stands first: the second is then what is left.
        let last = _mm512_max_ps(near(2), _mm512_setzero_ps());
        let last = _mm512_max_ps(near(0), _mm512_max_ps(near(1), last));
        let first = _mm512_min_ps(far(1), _mm512_min_ps(far(2), limit));
        let first = _mm512_min_ps(far(0), first);
        let left = _mm512_mul_ps(first, _mm512_set1_ps(1.0 + PAD));
        _mm512_cmp_ps_mask::<_CMP_NGT_UQ>(last, left)
    }

    /// Tests the triangles of a block, for the rays `inside` its box.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn visit(&self, found: &mut Found, block: &Block, inside: __mmask16, doubt: &mut Doubt) {
        let primitives = block.primitive.as_array();
        for lane in 0..primitives.len() {
            // Unused lanes repeat the last used one.
            if lane > 0 && primitives[lane] == primitives[lane - 1] {
                break;
            }
            visits::add(0, RAYS);
            let index = _mm512_set1_epi32(primitives[lane] as i32);
            let wanted = _mm512_mask_cmpneq_epi32_mask(inside, index, self.leaves);
            let corners = [
                self.corner(block, 0, lane),
                self.corner(block, 1, lane),
                self.corner(block, 2, lane),
            ];
            let met = meet(corners.each_ref(), self.inverse_main, wanted, doubt);
            let tied = _mm512_mask_cmp_ps_mask::<_CMP_EQ_OQ>(met.which, met.t, found.t);
            let nearer = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(met.which, met.t, found.t)
                | _mm512_mask_cmplt_epu32_mask(tied, index, found.primitive);
            found.t = _mm512_mask_mov_ps(found.t, nearer, met.t);
            found.u = _mm512_mask_mov_ps(found.u, nearer, met.u);
            found.v = _mm512_mask_mov_ps(found.v, nearer, met.v);
            found.primitive = _mm512_mask_mov_epi32(found.primitive, nearer, index);
        }
    }

    /// A corner as the rays see it.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn corner(&self, block: &Block, corner: usize, lane: usize) -> [__m512; 3] {
        let away = |k: usize| {
            // The remainders tell the compiler that no index is out of range.
            let of_all = block.vertex[self.axes[k] % 3][corner].as_array();
            _mm512_sub_ps(_mm512_set1_ps(of_all[lane % 4]), self.origin[k])
        };
        let z = away(2);
        let x = _mm512_fnmadd_ps(self.slope[0], z, away(0));
        let y = _mm512_fnmadd_ps(self.slope[1], z, away(1));
        [x, y, z]
    }
}

impl Found {
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn store(&self, scale: __m512, hits: &mut Hits, i: usize) {
        // What f32 cannot hold becomes the nearest it can.
        let t = _mm512_mul_ps(self.t, scale);
        let t = _mm512_max_ps(t, _mm512_set1_ps(f32::from_bits(1)));
        let t = _mm512_min_ps(t, _mm512_set1_ps(f32::MAX));
        let zero = _mm512_setzero_ps();
        let primitive = _mm512_castsi512_ps(self.primitive);
        store_lanes(bytemuck::cast_slice_mut(hits.primitive), i, ALL, primitive);
        store_lanes(hits.t, i, ALL, t);
        // Adding 0 turns -0 into 0.
        store_lanes(hits.u, i, ALL, _mm512_add_ps(self.u, zero));
        store_lanes(hits.v, i, ALL, _mm512_add_ps(self.v, zero));
    }
}

/// Elements `i .. i + 16` of a column.
#[inline]
fn row(column: &[f32], i: usize) -> &[f32; RAYS] {
    column[i..].first_chunk().expect("sixteen rays")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packet::tests::assert_what_makes_a_packet;

    #[test]
    fn rays_that_go_the_same_way_make_a_packet_and_others_do_not() {
        if !crate::avx512::available() {
            eprintln!("SKIPPED: no AVX-512 here");
            return;
        }
        // SAFETY: the processor has what the function is compiled for.
        assert_what_makes_a_packet::<RAYS>(|rays| unsafe { Packet::load(rays, 0, 1.0).is_some() });
    }
}
