//! Eight rays that go the same way: what makes them a packet, and their walk through the tree.

use super::SPREAD;
use super::hull::{ALL, Hull, ends, greatest};
use super::pace::UseOfLanes;
use crate::bvh::{Block, Bvh, LEAF, NOTHING, Node, WIDTH, index};
use crate::lanes::{Fx, LANES, Mask, Ux, as_bits, as_mask, iota, load, load_u32, store, store_u32};
use crate::order::Stack;
use crate::query::ClosestHit;
use crate::rays::{Hits, NO_PRIMITIVE, Rays};
use crate::slabs::PAD;
use crate::triangle::{Candidates, View};
use crate::visits;

/// Eight rays that go the same way, in the units of [`crate::query::Prepared`].
struct Packet {
    origin: [Fx; 3],
    inverse: [Fx; 3],
    /// First, second, main.
    axes: [usize; 3],
    slope: [Fx; 2],
    leaves: Ux,
    /// Callers' distances over the kernel's: powers of two.
    scale: Fx,
    hull: Hull,
}

/// The closest hits so far, a ray a lane.
struct Found {
    t: Fx,
    u: Fx,
    v: Fx,
    primitive: Ux,
}

/// Writes the closest hits of the rays `i .. i + LANES` if they make a packet, and says how many rays
/// entered its leaves; else does nothing.
#[inline(always)]
pub(super) fn closest(
    bvh: Bvh,
    rays: &Rays,
    hits: &mut Hits,
    i: usize,
    stack: &mut Stack,
) -> Option<UseOfLanes> {
    let packet = Packet::load(rays, i)?;
    let (found, lanes) = packet.walk(bvh, stack);
    found.store(&packet, hits, i);
    Some(lanes)
}

impl Packet {
    /// Rays `i .. i + LANES`, if they make a packet.
    #[inline(always)]
    fn load(rays: &Rays, i: usize) -> Option<Self> {
        let origin = rays.origin.map(|column| load(column, i));
        let direction = rays.direction.map(|column| load(column, i));
        let signs = direction.map(|d| d.to_bitmask());
        if signs.iter().any(|&s| s != 0 && s != ALL) {
            return None;
        }
        let most = Fx::splat(f32::MAX);
        let finite = |x: Fx| x.abs().simd_le(most);
        let [x, y, z] = direction.map(Fx::abs);
        let largest = x.fast_max(y.fast_max(z));
        // The exponent that takes the largest component to [1, 2): where it and its reciprocal are
        // normal numbers, multiplying in f32 rounds as the detour over f64 does.
        let exponent: Ux = as_bits(largest) >> 23_u32;
        let normal = exponent.simd_gt(Ux::splat(0)) & exponent.simd_lt(Ux::splat(254));
        let scale: Fx = bytemuck::cast((Ux::splat(254) - exponent) << 23_u32);
        let direction = direction.map(|d| d * scale);
        let inverse = direction.map(|d| Fx::ONE / d);
        let usable = [origin, inverse, direction]
            .as_flattened()
            .iter()
            .fold(as_mask(normal), |all, &x| all & finite(x));
        let first = (x.simd_gt(y) & x.simd_gt(z)).to_bitmask();
        let second = y.simd_gt(z).to_bitmask();
        let main = match (first, second) {
            (ALL, _) => 0,
            (0, ALL) => 1,
            (0, 0) => 2,
            _ => return None,
        };
        let axes = [(main + 1) % 3, (main + 2) % 3, main];
        let slope = [0, 1].map(|k| direction[axes[k]] / direction[main]);
        let apart = slope.map(|s| {
            let [low, high] = ends(s);
            high - low
        });
        // Asked this way round, a NaN makes no packet.
        let together = apart.iter().all(|&a| a <= SPREAD);
        if !together || usable.to_bitmask() != ALL {
            return None;
        }
        Some(Self {
            origin,
            inverse,
            axes,
            slope,
            leaves: load_u32(rays.leaves, i),
            scale,
            hull: Hull::new(signs.map(|s| s != 0), origin.map(ends), inverse.map(ends)),
        })
    }

    fn walk(&self, bvh: Bvh, stack: &mut Stack) -> (Found, UseOfLanes) {
        let mut found = Found {
            t: Fx::splat(f32::MAX),
            u: Fx::ZERO,
            v: Fx::ZERO,
            primitive: Ux::splat(NO_PRIMITIVE),
        };
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
                    return (found, lanes);
                }
                let (parent, slot) = (&bvh.nodes[place as usize / WIDTH], place as usize % WIDTH);
                let child = parent.child.as_array()[slot];
                if child & LEAF == 0 {
                    break index(child);
                }
                let inside = self.enters(parent, slot, found.limit());
                lanes.leaves += 1;
                lanes.inside += inside.to_bitmask().count_ones();
                if inside.any() {
                    self.visit(&mut found, &bvh.blocks[index(child)], inside);
                    limit = greatest(found.limit());
                }
            };
        }
    }

    /// Which rays enter the box of a slot: [`crate::slabs::Slabs::test`], a ray a lane.
    #[inline(always)]
    fn enters(&self, node: &Node, slot: usize, limit: Fx) -> Mask {
        let plane = |axis: usize, plane: usize| {
            Fx::splat(node.planes[plane].as_array()[slot]) - self.origin[axis]
        };
        let near = |axis: usize| plane(axis, self.hull.near[axis]) * self.inverse[axis];
        let far = |axis: usize| plane(axis, self.hull.near[axis] ^ 1) * self.inverse[axis];
        let enter = near(0).fast_max(near(1).fast_max(near(2).fast_max(Fx::ZERO)));
        let leave = far(0).fast_min(far(1).fast_min(far(2)));
        let leave = (leave * Fx::splat(1.0 + PAD)).fast_min(limit);
        !enter.simd_gt(leave)
    }

    /// Tests the triangles of a block, for the rays `inside` its box.
    #[inline(always)]
    fn visit(&self, found: &mut Found, block: &Block, inside: Mask) {
        let primitives = block.primitive.to_array();
        for lane in 0..primitives.len() {
            // Unused lanes repeat the last used one.
            if lane > 0 && primitives[lane] == primitives[lane - 1] {
                break;
            }
            visits::add(0, LANES);
            let index = Ux::splat(primitives[lane]);
            let own = as_mask(index.simd_eq(self.leaves));
            let new = self.test(block, lane, inside & !own);
            let tied = new.t.simd_eq(found.t) & as_mask(index.simd_lt(found.primitive));
            let nearer = (new.t.simd_lt(found.t) | tied) & new.met & inside & !own;
            found.t = nearer.select(new.t, found.t);
            found.u = nearer.select(new.u, found.u);
            found.v = nearer.select(new.v, found.v);
            found.primitive = as_bits(nearer).select(index, found.primitive);
        }
    }

    #[inline(always)]
    fn test(&self, block: &Block, lane: usize, inside: Mask) -> Candidates<Fx> {
        let (found, sure) = self.view(block, lane).meet();
        if (sure | !inside).all() {
            return found;
        }
        // Field by field: handed on whole, it would go through memory on the usual way too.
        let exact = self.test_exactly(block, lane);
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
    fn test_exactly(&self, block: &Block, lane: usize) -> Candidates<Fx> {
        self.view(block, lane).meet_exactly()
    }

    #[inline(always)]
    fn view(&self, block: &Block, lane: usize) -> View<Fx> {
        // The remainders tell the compiler that no index is out of range.
        let axes = self.axes.map(|a| a % 3);
        let [x, y, z] = axes.map(|a| &block.vertex[a]);
        let corner = |c: usize| [x, y, z].map(|v| Fx::splat(v[c].as_array()[lane & 3]));
        View {
            corners: [corner(0), corner(1), corner(2)],
            origin: axes.map(|a| self.origin[a]),
            slope: self.slope,
            inverse: self.inverse[axes[2]],
        }
    }
}

impl Found {
    /// Boxes entered beyond this distance need no visit.
    #[inline(always)]
    fn limit(&self) -> Fx {
        self.t * Fx::splat(1.0 + PAD)
    }

    #[inline(always)]
    fn store(&self, packet: &Packet, hits: &mut Hits, i: usize) {
        // What f32 cannot hold becomes the nearest it can.
        let t = self.t * packet.scale;
        let t = t
            .fast_max(Fx::splat(f32::from_bits(1)))
            .fast_min(Fx::splat(f32::MAX));
        store(hits.t, i, t);
        store(hits.u, i, self.u);
        store(hits.v, i, self.v);
        store_u32(hits.primitive, i, self.primitive);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packet::tests::assert_what_makes_a_packet;

    #[test]
    fn rays_that_go_the_same_way_make_a_packet_and_others_do_not() {
        assert_what_makes_a_packet::<LANES>(|rays| Packet::load(rays, 0).is_some());
    }
}
