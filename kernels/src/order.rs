//! The children of a node that a ray enters, on to its stack, the nearest on top.
//!
//! No branch depends on how many there are or where they lie: the distances are sorted by a
//! bitonic network of eight (K. Batcher, 1968) and all eight slots are stored; the stack's length
//! then grows by the number hit, and what was stored above it is never read.
//!
//! A key is the bits of a distance, which order like the distance since it is not negative, with
//! the three lowest replaced by the lane. A lane that is not hit has key 0 at most and sinks to
//! the end. So the order is total and the same on every machine.

use crate::bvh::{MAX_DEPTH, Node, WIDTH};
use crate::lanes::{Fx, Ux, as_bits};

/// Slots of a stack: a node takes one entry and leaves at most eight, and the last store may write
/// eight slots above the top.
pub const STACK: usize = (WIDTH - 1) * MAX_DEPTH + 2 * WIDTH;

/// What a ray has still to visit, the next one last.
#[derive(Clone, Debug)]
pub struct Stack {
    child: [u32; STACK],
    enter: [f32; STACK],
    len: usize,
}

impl Default for Stack {
    fn default() -> Self {
        Self {
            child: [0; STACK],
            enter: [0.0; STACK],
            len: 0,
        }
    }
}

impl Stack {
    /// Nothing to visit.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds the children of `node` in `mask`, which the ray enters at `enter`, farthest first.
    #[inline(always)]
    pub fn push_ordered(&mut self, node: &Node, mask: u32, enter: Fx) {
        let order = descending(mask, enter);
        let end = self.len + WIDTH;
        let child = node.child.shuffle_wrapping(order);
        let enter: Fx = bytemuck::cast(as_bits(enter).shuffle_wrapping(order));
        self.child[self.len..end].copy_from_slice(child.as_array());
        self.enter[self.len..end].copy_from_slice(enter.as_array());
        self.len += mask.count_ones() as usize;
    }

    /// Takes the next reference that is entered at `limit` or before.
    #[inline(always)]
    pub fn pop_within(&mut self, limit: f32) -> Option<u32> {
        while self.len > 0 {
            self.len -= 1;
            // Asked this way round, a NaN is visited.
            let beyond = self.enter[self.len] > limit;
            if !beyond {
                return Some(self.child[self.len]);
            }
        }
        None
    }

    /// Adds the children of `node` in `mask`, in no particular order (but always the same).
    #[inline(always)]
    pub fn push(&mut self, node: &Node, mask: u32) {
        let end = self.len + WIDTH;
        let child = node.child.shuffle_wrapping(compacting(mask));
        self.child[self.len..end].copy_from_slice(child.as_array());
        self.len += mask.count_ones() as usize;
    }

    /// Takes the next reference.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<u32> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        Some(self.child[self.len])
    }
}

/// For each mask of eight bits the lanes that are set, in the lowest nibbles.
static COMPACTING: [u32; 256] = {
    let mut table = [0; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut slot) = (0, 0);
        while lane < WIDTH {
            if mask >> lane & 1 != 0 {
                table[mask] |= (lane as u32) << (4 * slot);
                slot += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// Lane numbers that gather the lanes of `mask` into the lowest ones.
#[inline(always)]
fn compacting(mask: u32) -> Ux {
    let nibbles = COMPACTING[(mask & 0xff) as usize];
    Ux::splat(nibbles) >> Ux::new([0, 4, 8, 12, 16, 20, 24, 28])
}

/// Lane numbers (in the low three bits) that sort the lanes of `mask` by falling `enter`.
#[inline(always)]
fn descending(mask: u32, enter: Fx) -> Ux {
    let lane = Ux::new([0, 1, 2, 3, 4, 5, 6, 7]);
    let bit = Ux::new([1, 2, 4, 8, 16, 32, 64, 128]);
    let hit = (Ux::splat(mask) & bit).simd_eq(bit);
    let key = ((as_bits(enter) & Ux::splat(!7)) | lane) & hit;
    // A lane that is not hit loses its number, so two keys may be equal; only keys of hits count.
    let stage = |key: Ux, partner: [u32; 8], keep_max: [bool; 8]| {
        let other = key.shuffle_wrapping(Ux::new(partner));
        let keep_max = Ux::new(keep_max.map(|k| if k { !0 } else { 0 }));
        keep_max.select(key.max(other), key.min(other))
    };
    const BY1: [u32; 8] = [1, 0, 3, 2, 5, 4, 7, 6];
    const BY2: [u32; 8] = [2, 3, 0, 1, 6, 7, 4, 5];
    const BY4: [u32; 8] = [4, 5, 6, 7, 0, 1, 2, 3];
    const T: bool = true;
    const F: bool = false;
    let key = stage(key, BY1, [T, F, F, T, T, F, F, T]);
    let key = stage(key, BY2, [T, T, F, F, F, F, T, T]);
    let key = stage(key, BY1, [T, F, T, F, F, T, F, T]);
    let key = stage(key, BY4, [T, T, T, T, F, F, F, F]);
    let key = stage(key, BY2, [T, T, F, F, T, T, F, F]);
    stage(key, BY1, [T, F, T, F, T, F, T, F])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mask_comes_out_farthest_first() {
        let mut node = Node::EMPTY;
        node.child = Ux::new([10, 11, 12, 13, 14, 15, 16, 17]);
        let enter = [0.0f32, 3.0, 1.0, 1e-40, 3.0, 7.5, 2.0, 1e30];
        for mask in 0u32..256 {
            let mut hit: Vec<usize> = (0..8).filter(|l| mask >> l & 1 != 0).collect();
            hit.sort_by(|&a, &b| enter[a].total_cmp(&enter[b]).then(a.cmp(&b)));
            let mut stack = Stack::default();
            stack.push_ordered(&node, mask, Fx::new(enter));
            let popped: Vec<usize> = std::iter::from_fn(|| stack.pop_within(f32::MAX))
                .map(|c| c as usize - 10)
                .collect();
            assert_eq!(popped, hit, "mask {mask:08b}");
        }
    }

    #[test]
    fn every_mask_is_compacted() {
        let mut node = Node::EMPTY;
        node.child = Ux::new([0, 1, 2, 3, 4, 5, 6, 7]);
        for mask in 0u32..256 {
            let mut stack = Stack::default();
            stack.push(&node, mask);
            let mut popped: Vec<u32> = std::iter::from_fn(|| stack.pop()).collect();
            popped.reverse();
            let expected: Vec<u32> = (0..8).filter(|l| mask >> l & 1 != 0).collect();
            assert_eq!(popped, expected, "mask {mask:08b}");
        }
    }

    #[test]
    fn what_lies_beyond_the_limit_is_skipped() {
        let mut node = Node::EMPTY;
        node.child = Ux::new([0, 1, 2, 3, 4, 5, 6, 7]);
        let mut stack = Stack::default();
        stack.push_ordered(
            &node,
            0xff,
            Fx::new([5.0, 1.0, 2.0, 3.0, 4.0, 6.0, 7.0, 8.0]),
        );
        assert_eq!(stack.pop_within(1.0), Some(1));
        assert_eq!(stack.pop_within(1.5), None);
    }
}
