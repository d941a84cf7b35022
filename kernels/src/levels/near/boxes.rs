//! Eight rays against the boxes around all that a world of two levels holds.
//!
//! The question is the one that a walk would ask first, of the eight boxes of its first node: the
//! arithmetic of `slabs.rs` with a ray a lane instead of a box, in the caller's units. They differ from the
//! kernel's by a power of two, which rounds nothing while numbers stay normal; rays whose direction is
//! longer or shorter than [`ORDINARY`] are not asked about and walk. The limit is what a ray is known to
//! meet.
//!

use crate::bvh::{NOTHING, Node, WIDTH};
use crate::lanes::{Fx, Mask};
use crate::levels::World;
use crate::slabs::PAD;

/// Largest components of directions between one over this and this are asked about.
const ORDINARY: f32 = (1u64 << 60) as f32;

/// Boxes around all that there is.
pub(super) struct Boxes {
    planes: [[[f32; 3]; 2]; WIDTH],
    len: usize,
}

impl Boxes {
    /// Those of the world's first node; none if there is nothing.
    pub(super) fn new(world: &World) -> Option<Self> {
        let node: &Node = world.first_node()?;
        let mut boxes = Self {
            planes: Default::default(),
            len: 0,
        };
        for slot in (0..WIDTH).filter(|&slot| node.child.as_array()[slot] != NOTHING) {
            let side = |side: usize| [0, 1, 2].map(|a| node.planes[2 * a + side].as_array()[slot]);
            boxes.planes[boxes.len] = [side(0), side(1)];
            boxes.len += 1;
        }
        Some(boxes)
    }

    /// Which rays meet some box at `0 ..= end`.
    #[inline(always)]
    pub(super) fn met(&self, origin: [Fx; 3], direction: [Fx; 3], end: Fx) -> Mask {
        let inverse = direction.map(|d| Fx::ONE / d);
        // The sign of the bit, not of the number: -0 belongs with the negatives.
        let negative = direction.map(|d| {
            let bits: wide::i32x8 = bytemuck::cast(d);
            bytemuck::cast::<_, Mask>(bits >> 31_i32)
        });
        let limit = end * Fx::splat(1.0 + PAD);
        let mut met = Fx::ZERO;
        for [low, high] in &self.planes[..self.len] {
            let planes = |axis: usize| {
                let (low, high) = (Fx::splat(low[axis]), Fx::splat(high[axis]));
                let near = negative[axis].select(high, low);
                let far = negative[axis].select(low, high);
                [near, far].map(|plane| (plane - origin[axis]) * inverse[axis])
            };
            let [x, y, z] = [planes(0), planes(1), planes(2)];
            // What may be NaN stands first.
            let enter = x[0].fast_max(y[0].fast_max(z[0].fast_max(Fx::ZERO)));
            let leave = x[1].fast_min(y[1].fast_min(z[1].fast_min(Fx::splat(f32::INFINITY))));
            let leave = (leave * Fx::splat(1.0 + PAD)).fast_min(limit);
            met |= !enter.simd_gt(leave);
        }
        let [x, y, z] = direction.map(|d| d.abs());
        let largest = x.fast_max(y.fast_max(z));
        let ordinary =
            largest.simd_lt(Fx::splat(ORDINARY)) & largest.simd_gt(Fx::splat(1.0 / ORDINARY));
        met | !ordinary
    }
}
