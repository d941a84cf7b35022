//! The best object split of a few references: of up to four, every way to part them; of more, every
//! way in the order of their centres along an axis. Cheaper than bins as long as there are fewer
//! references than bins, and there are more such nodes than of all others together: so loops have
//! fixed lengths, filled up with boxes of nothing, and nothing but the last choice is a branch.

use super::bounds::{Bounds, Least, blocks};
use super::grown::Run;
use super::reference::Reference;

use huygens_kernels::bvh::BLOCK;
use obvhs::bvh2::node::Bvh2Node;
use wide::{f32x4, f32x8, i32x4, i32x8};

/// Most references that are swept.
pub(super) const FEW: usize = 16;
/// A block's worth of references is split all the same where that leaves less than this share of
/// the area: they lie far apart. (More splits would gain hardly anything, and cost memory.)
const SPREAD: f32 = 0.8;

/// Builds the subtree over up to [`FEW`] references, at least one, with its root at `run.nodes[at]`. What is
/// in `spare`, which is as long, does not matter.
pub(super) fn grow(
    references: &mut [Reference],
    spare: &mut [Reference],
    bounds: Bounds,
    at: usize,
    run: &mut Run,
) {
    let n = references.len();
    let split = (n > 1).then(|| sweep(references));
    if n <= BLOCK && split.is_none_or(|split| split.cost >= SPREAD * bounds.half_area()) {
        run.nodes[at] = Bvh2Node::new(bounds.to_aabb(), n as u32, run.triangles.len() as u32);
        run.triangles
            .extend(references.iter().map(|r| r.triangle()));
        return;
    }
    let Some(split) = split else { return };
    let move_half = |half: &mut [Reference], order: &[u8]| {
        let mut around = Bounds::EMPTY;
        for (to, &from) in half.iter_mut().zip(order) {
            *to = references[usize::from(from)];
            around = around.union(to.bounds());
        }
        around
    };
    let (low, high) = spare.split_at_mut(split.lower);
    let (low_order, high_order) = split.order.split_at(split.lower);
    let around = [move_half(low, low_order), move_half(high, high_order)];
    let first = run.fork(at, bounds);
    let (spare_low, spare_high) = references.split_at_mut(split.lower);
    grow(low, spare_low, around[0], first, run);
    grow(high, spare_high, around[1], first + 1, run);
}

/// A way to part at most [`FEW`] references.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sweep {
    /// Sum over the halves of area times blocks.
    pub(super) cost: f32,
    /// The references, the lower half's before the upper half's.
    pub(super) order: [u8; FEW],
    /// How many of them are in the lower half.
    pub(super) lower: usize,
}

/// The best split of 2 to [`FEW`] references; of equally good ones the first. Equal centres keep
/// their order, so there always is one.
pub(super) fn sweep(references: &[Reference]) -> Sweep {
    debug_assert!((2..=FEW).contains(&references.len()));
    match references.len() {
        0..=4 => any_two(references),
        5..=8 => along_axes::<8>(references),
        _ => along_axes::<FEW>(references),
    }
}

/// Ways to part four references, and how many of them are in the lower half. The first three are the
/// ways to part three.
const PARTS: [([u8; 4], usize); 7] = [
    ([0, 1, 2, 3], 2),
    ([0, 2, 1, 3], 2),
    ([1, 2, 0, 3], 2),
    ([1, 2, 3, 0], 3),
    ([0, 2, 3, 1], 3),
    ([0, 1, 3, 2], 3),
    ([0, 1, 2, 3], 3),
];

/// The best way to part two to four references, of all that there are. Each half is a block.
fn any_two(references: &[Reference]) -> Sweep {
    const { assert!(BLOCK == 4) };
    let n = references.len();
    let one = |i: usize| references.get(i).map_or(Bounds::EMPTY, |r| r.bounds());
    let [a, b, c, d] = [0, 1, 2, 3].map(one);
    let (cost, (order, lower)) = if n == 2 {
        (a.half_area() + b.half_area(), ([0, 1, 2, 3], 1))
    } else {
        let (ab, cd, nothing) = (a.union(b), c.union(d), Bounds::EMPTY);
        let two_and_two = Bounds::half_areas([ab, a.union(c), b.union(c), nothing])
            + Bounds::half_areas([cd, b.union(d), a.union(d), nothing]);
        let three_and_one =
            Bounds::half_areas([b.union(cd), a.union(cd), ab.union(d), ab.union(c)])
                + Bounds::half_areas([a, b, c, d]);
        let [p, q, r, _] = two_and_two.to_array();
        let [s, t, u, v] = three_and_one.to_array();
        let ways = [p, q, r, s, t, u, v];
        let ways = if n == 3 { &ways[..3] } else { &ways[..] };
        let (mut cost, mut best) = (ways[0], 0);
        for (way, &other) in ways.iter().enumerate().skip(1) {
            best = if other < cost { way } else { best };
            cost = cost.min(other);
        }
        (cost, PARTS[best])
    };
    let mut all = [0; FEW];
    all[..4].copy_from_slice(&order);
    Sweep {
        cost,
        order: all,
        lower,
    }
}

/// The best way to part up to `N` references in the order of their centres along an axis.
fn along_axes<const N: usize>(references: &[Reference]) -> Sweep {
    let n = references.len();
    let mut boxes = [Bounds::EMPTY; N];
    let mut centres = [f32x4::splat(f32::INFINITY); N];
    for (i, reference) in references.iter().enumerate() {
        boxes[i] = reference.bounds();
        centres[i] = boxes[i].twice_centre().max();
    }
    let mut orders = [[0u8; FEW]; 3];
    for (i, places) in places(&centres).as_flattened()[..N].iter().enumerate() {
        for axis in 0..3 {
            orders[axis][places[axis] as usize % FEW] = i as u8;
        }
    }
    // The same along all axes.
    let counts = |first: usize| i32x4::splat(first as i32) + i32x4::new([0, 1, 2, 3]);
    let lower: [f32x4; FEW / 4] = std::array::from_fn(|i| blocks(counts(4 * i)));
    let upper: [f32x4; FEW / 4] =
        std::array::from_fn(|i| blocks(i32x4::splat(n as i32) - counts(4 * i)));
    let mut least = Least::new();
    for axis in 0..3 {
        let bounds = |i: usize| boxes[orders[axis][i] as usize % N];
        let mut above = [Bounds::EMPTY; N];
        let mut box_above = Bounds::EMPTY;
        for i in (0..N).rev() {
            box_above = box_above.union(bounds(i));
            above[i] = box_above;
        }
        let mut box_below = Bounds::EMPTY;
        for four in (0..N).step_by(4) {
            let below = [0, 1, 2, 3].map(|i| {
                let below = box_below;
                box_below = box_below.union(bounds(four + i));
                below
            });
            let above = [0, 1, 2, 3].map(|i| above[four + i]);
            let costs = Bounds::half_areas(below) * lower[four / 4]
                + Bounds::half_areas(above) * upper[four / 4];
            least.consider(costs, axis * N + four);
        }
    }
    // Where all costs are infinite, any split will do.
    let (cost, best) = least.get().unwrap_or((f32::INFINITY, n / 2));
    Sweep {
        cost,
        order: orders[best / N % 3],
        lower: best % N,
    }
}

/// Which place each centre has along each axis, by pairs of centres; equal ones keep their order.
#[inline(always)]
fn places<const N: usize>(centres: &[f32x4; N]) -> [[[i32; 4]; 2]; FEW / 2] {
    let mut places = [[[0; 4]; 2]; FEW / 2];
    for pair in 0..N / 2 {
        let (first, second) = (2 * pair, 2 * pair + 1);
        let both: f32x8 = bytemuck::cast([centres[first], centres[second]]);
        let other = |j: usize| bytemuck::cast::<[f32x4; 2], f32x8>([centres[j]; 2]);
        // What is true is -1. The first will be found to be no larger than itself.
        let mut place = i32x8::new([-1, -1, -1, -1, 0, 0, 0, 0]);
        for j in 0..=first {
            place -= bytemuck::cast::<f32x8, i32x8>(other(j).simd_le(both));
        }
        for j in second..N {
            place -= bytemuck::cast::<f32x8, i32x8>(other(j).simd_lt(both));
        }
        places[pair] = bytemuck::cast(place);
    }
    places
}
