//! The children of a node that a ray enters, on to its stack, the nearest on top.
//!
//! No branch depends on how many there are or where they lie: the distances are sorted by a
//! bitonic network of eight (K. Batcher, 1968) and all eight slots are stored; the stack's length
//! then grows by the number hit, and what was stored above it is never read.
//!
//! A key is the bits of a distance, which order like the distance since it is not negative, with
//! the three lowest replaced by 7 less the lane: of equally near children, as all are whose boxes
//! the ray starts in, the highest slot, where layout puts the smallest box, is visited first. A
//! lane that is not hit has key 0 at most and sinks to the end. So the order is total and the same
//! on every machine.

use crate::bvh::{MAX_DEPTH, NOTHING, Node, WIDTH};
use crate::lanes::{self, Fx, Mask, Ux, as_bits};
use crate::query::Query;

/// Entries below the first, so that the eight topmost ones can always be looked at together. The
/// last of them is a sentinel, which says that nothing is left.
const BELOW: usize = WIDTH;
/// Entries of a stack: a node takes one and leaves at most eight, and the last store may write
/// eight above the top.
const STACK: usize = BELOW + (WIDTH - 1) * MAX_DEPTH + 2 * WIDTH;

/// What a ray has still to visit, the next one last.
#[derive(Clone, Debug)]
pub struct Stack {
    len: usize,
    child: [u32; STACK],
    enter: [f32; STACK],
}

impl Default for Stack {
    fn default() -> Self {
        Self {
            len: BELOW,
            child: [NOTHING; STACK],
            enter: [f32::NEG_INFINITY; STACK],
        }
    }
}

impl Stack {
    /// Nothing to visit.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.len = BELOW;
    }

    /// Adds the children of `node` that the ray `hits`, which it enters at `enter`: farthest first
    /// if the query wants its children ordered, else from the lowest slot up.
    #[inline(always)]
    pub fn push<Q: Query>(&mut self, node: &Node, hits: Mask, enter: Fx) {
        self.push_references::<Q>(node.child, hits, enter);
    }

    /// As [`Stack::push`], with what to call the children: anything below [`NOTHING`].
    #[inline(always)]
    pub fn push_references<Q: Query>(&mut self, children: Ux, hits: Mask, enter: Fx) {
        let end = self.len + WIDTH;
        let mask = hits.to_bitmask();
        if Q::ORDERED {
            let order = descending(hits, enter);
            let child = children.shuffle_wrapping(order);
            let enter = as_bits(enter).shuffle_wrapping(order);
            self.child[self.len..end].copy_from_slice(child.as_array());
            self.enter[self.len..end].copy_from_slice(bytemuck::cast_ref::<_, [f32; 8]>(&enter));
        } else {
            let child = children.shuffle_wrapping(compacting(mask));
            self.child[self.len..end].copy_from_slice(child.as_array());
        }
        self.len += mask.count_ones() as usize;
    }

    /// Takes the next reference, [`NOTHING`] at the end; if they are ordered, the next that is
    /// entered at `limit` or before.
    #[inline(always)]
    pub fn pop<Q: Query>(&mut self, limit: f32) -> u32 {
        if Q::ORDERED {
            // Eight at a time: how many a shrunken limit has made useless no branch can foresee.
            loop {
                let start = self.len - WIDTH;
                let beyond = lanes::load(&self.enter, start).simd_gt(Fx::splat(limit));
                // Asked this way round, a NaN is visited, and so is the sentinel.
                let within = !beyond.to_bitmask() & 0xff;
                if within != 0 {
                    self.len = start + within.ilog2() as usize;
                    break;
                }
                self.len = start;
            }
        } else {
            self.len -= 1;
        }
        self.child[self.len]
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

/// Lane numbers (in the low three bits) that sort the lanes of `hits` by falling `enter`.
#[inline(always)]
fn descending(hits: Mask, enter: Fx) -> Ux {
    let last_first = Ux::new([7, 6, 5, 4, 3, 2, 1, 0]);
    let key = ((as_bits(enter) & Ux::splat(!7)) | last_first) & as_bits(hits);
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
    stage(key, BY1, [T, F, T, F, T, F, T, F]) ^ Ux::splat(7)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::{ClosestHit, Occlusion};

    type Ordered = ClosestHit<'static, 'static>;
    type Plain = Occlusion<'static, 'static>;

    fn hits(mask: u32) -> Mask {
        bytemuck::cast(Ux::new(std::array::from_fn(|l| {
            if mask >> l & 1 != 0 { !0 } else { 0 }
        })))
    }

    fn node() -> Node {
        Node {
            child: Ux::new([0, 1, 2, 3, 4, 5, 6, 7]),
            ..Node::EMPTY
        }
    }

    fn pop_all<Q: Query>(stack: &mut Stack) -> Vec<usize> {
        std::iter::from_fn(|| Some(stack.pop::<Q>(f32::MAX)).filter(|&c| c != NOTHING))
            .map(|child| child as usize)
            .collect()
    }

    #[test]
    fn every_mask_comes_out_nearest_first() {
        let enter = [0.0f32, 3.0, 1.0, 1e-40, 3.0, 7.5, 2.0, 1e30];
        for mask in 0u32..256 {
            let mut expected: Vec<usize> = (0..8).filter(|l| mask >> l & 1 != 0).collect();
            expected.sort_by(|&a, &b| enter[a].total_cmp(&enter[b]).then(b.cmp(&a)));
            let mut stack = Stack::default();
            stack.push::<Ordered>(&node(), hits(mask), Fx::new(enter));
            assert_eq!(pop_all::<Ordered>(&mut stack), expected, "mask {mask:08b}");
        }
    }

    #[test]
    fn every_mask_is_compacted() {
        for mask in 0u32..256 {
            let mut stack = Stack::default();
            stack.push::<Plain>(&node(), hits(mask), Fx::ZERO);
            let mut popped = pop_all::<Plain>(&mut stack);
            popped.reverse();
            let expected: Vec<usize> = (0..8).filter(|l| mask >> l & 1 != 0).collect();
            assert_eq!(popped, expected, "mask {mask:08b}");
        }
    }

    #[test]
    fn what_lies_beyond_the_limit_is_skipped_however_much_it_is() {
        let mut stack = Stack::default();
        let near = Fx::new([0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 7.0, 8.0]);
        stack.push::<Ordered>(&node(), hits(0b11), near);
        for _ in 0..5 {
            stack.push::<Ordered>(&node(), hits(0xff), near + Fx::splat(9.0));
        }
        assert_eq!(stack.pop::<Ordered>(9.5), 0);
        assert_eq!(stack.pop::<Ordered>(0.9), 0);
        assert_eq!(stack.pop::<Ordered>(0.4), NOTHING);
    }

    #[test]
    fn the_deepest_tree_fits() {
        let mut stack = Stack::default();
        for _ in 0..MAX_DEPTH {
            stack.push::<Ordered>(&node(), hits(0xff), Fx::ONE);
            assert_ne!(stack.pop::<Ordered>(f32::MAX), NOTHING);
        }
        let all = pop_all::<Ordered>(&mut stack);
        assert_eq!(all.len(), (WIDTH - 1) * MAX_DEPTH);
    }
}
