//! An interval that holds all rays of a packet, and what it may enter.

use crate::bvh::Node;
use crate::lanes::{Fx, LANES, Mask, Ux, as_bits};
use crate::slabs::PAD;

/// An interval that holds all rays of a packet, and the planes they meet.
pub(crate) struct Hull {
    /// The plane of a node that is met first, by axis; the other is met last.
    pub(crate) near: [usize; 3],
    /// The origins' end that makes the distance to near planes least, and that which makes the
    /// distance to far planes most.
    origin: [[f32; 2]; 3],
    /// Ends of the reciprocal directions.
    inverse: [[f32; 2]; 3],
}

impl Hull {
    /// By axis, whether the rays go downwards, the least and the greatest coordinate of their origins, and
    /// the same of their reciprocal directions.
    #[inline(always)]
    pub(crate) fn new(negative: [bool; 3], origin: [[f32; 2]; 3], inverse: [[f32; 2]; 3]) -> Self {
        Self {
            near: [0, 1, 2].map(|axis| 2 * axis + usize::from(negative[axis])),
            origin: [0, 1, 2].map(|axis| {
                let [low, high] = origin[axis];
                // Upwards, planes are nearest from the highest origin; downwards from the lowest.
                if negative[axis] {
                    [low, high]
                } else {
                    [high, low]
                }
            }),
            inverse,
        }
    }

    /// Which boxes any of the rays may enter at `0 ..= limit`, and where at the earliest.
    #[inline(always)]
    pub(crate) fn test(&self, node: &Node, limit: f32) -> (Mask, Fx) {
        let near = |axis: usize| {
            let plane = node.planes[self.near[axis] % 6] - Fx::splat(self.origin[axis][0]);
            let [a, b] = self.inverse[axis].map(|i| plane * Fx::splat(i));
            a.fast_min(b)
        };
        let far = |axis: usize| {
            let plane = node.planes[(self.near[axis] ^ 1) % 6] - Fx::splat(self.origin[axis][1]);
            let [a, b] = self.inverse[axis].map(|i| plane * Fx::splat(i));
            a.fast_max(b)
        };
        let enter = near(0).fast_max(near(1).fast_max(near(2).fast_max(Fx::ZERO)));
        let leave = far(0).fast_min(far(1).fast_min(far(2)));
        let leave = (leave * Fx::splat(1.0 + PAD)).fast_min(Fx::splat(limit));
        (!enter.simd_gt(leave), enter)
    }
}

/// The bits of a mask that is true everywhere.
pub(super) const ALL: u32 = (1 << LANES) - 1;

/// The least and the greatest lane.
#[inline(always)]
pub(super) fn ends(x: Fx) -> [f32; 2] {
    [fold(x, Fx::fast_min), greatest(x)]
}

/// The greatest lane.
#[inline(always)]
pub(super) fn greatest(x: Fx) -> f32 {
    fold(x, Fx::fast_max)
}

#[inline(always)]
fn fold(x: Fx, of: impl Fn(Fx, Fx) -> Fx) -> f32 {
    let across = |x: Fx, partner: [u32; LANES]| {
        let other = as_bits(x).shuffle_wrapping(Ux::new(partner));
        of(x, bytemuck::cast(other))
    };
    let x = across(x, [4, 5, 6, 7, 0, 1, 2, 3]);
    let x = across(x, [2, 3, 0, 1, 6, 7, 4, 5]);
    across(x, [1, 0, 3, 2, 5, 4, 7, 6]).as_array()[0]
}
