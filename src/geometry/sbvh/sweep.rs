//! The best object split of a few references, exactly: every way to part them in the order of their
//! centres along an axis. Cheaper than bins as long as there are fewer references than bins, and
//! there are more such nodes than of all others together.

use super::bounds::Bounds;
use super::reference::Reference;
use super::split::cost;

/// Most references that are swept.
pub(super) const FEW: usize = 16;

/// A way to part at most [`FEW`] references.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sweep {
    /// Sum over the halves of area times blocks.
    pub(super) cost: f32,
    /// The references in order along the axis.
    pub(super) order: [u8; FEW],
    /// How many of them are in the lower half.
    pub(super) lower: usize,
}

/// The best split of 2 to [`FEW`] references; of equally good ones the first. Equal centres keep
/// their order, so there always is one.
pub(super) fn sweep(references: &[Reference]) -> Sweep {
    let n = references.len();
    debug_assert!((2..=FEW).contains(&n));
    let mut best = Sweep {
        cost: f32::INFINITY,
        order: std::array::from_fn(|i| i as u8),
        lower: n / 2,
    };
    for axis in 0..3 {
        let mut order = [(0.0f32, 0u8); FEW];
        for (i, reference) in references.iter().enumerate() {
            let centre = reference.bounds().twice_centre().max().as_array()[axis];
            let mut at = i;
            while at > 0 && order[at - 1].0 > centre {
                order[at] = order[at - 1];
                at -= 1;
            }
            order[at] = (centre, i as u8);
        }
        let bounds = |i: usize| references[order[i].1 as usize % n].bounds();
        let mut below = [0.0; FEW];
        let mut sum = Bounds::EMPTY;
        for lower in 1..n {
            sum = sum.union(bounds(lower - 1));
            below[lower] = cost(sum.half_area(), lower);
        }
        sum = Bounds::EMPTY;
        for lower in (1..n).rev() {
            sum = sum.union(bounds(lower));
            let cost = below[lower] + cost(sum.half_area(), n - lower);
            if cost < best.cost {
                best = Sweep {
                    cost,
                    order: order.map(|(_, i)| i),
                    lower,
                };
            }
        }
    }
    best
}
