//! A binary tree by parallel locally-ordered clustering: boxes in Morton order, each looking for
//! the neighbour with which it makes the smallest box, and pairs that choose each other merging,
//! pass after pass (D. Meister, J. Bittner, "Parallel Locally-Ordered Clustering for Bounding
//! Volume Hierarchy Construction", TVCG 24(3), 2018).
//!
//! Why not obvhs' own: where many unions are equally large (identical triangles, points, boxes
//! inside each other) its passes merge one pair each, so that 20,000 copies of a triangle take
//! seconds and make a tree 20,000 deep. Here ties go to the neighbour with which an index makes an
//! even-odd pair, and a stretch of boxes that hardly merges is paired off by force, so every pass
//! removes a fixed share and the depth is logarithmic whatever comes in. The tree is a function
//! of the boxes alone: chunks have a fixed size, and nothing depends on the number of threads.

use glam::Vec3A;
use huygens_kernels::lanes::{self, Fx, LANES, Ux, as_bits, as_mask};
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};
use rayon::prelude::*;

/// How far to either side a box looks for a partner.
const REACH: usize = 14;
/// Boxes before the first and after the last, as infinite as boxes get, so that no search needs
/// to know where the ends are.
const MARGIN: usize = REACH.next_multiple_of(LANES);
/// A stretch of boxes that is paired off by force when fewer than two pairs find each other.
const STRETCH: usize = 32;
/// Boxes that one task handles.
const CHUNK: usize = 4096;
/// The bit of `Clusters::first` that says leaf.
const LEAF: u32 = 1 << 31;

/// The clusters of one pass, in Morton order.
#[derive(Default)]
struct Clusters {
    len: usize,
    /// `min x, y, z, max x, y, z`, from `MARGIN` on.
    columns: [Vec<f32>; 6],
    /// A triangle with `LEAF`, or the first of two adjacent nodes.
    first: Vec<u32>,
}

impl Clusters {
    fn with_capacity(len: usize) -> Self {
        let column = |value: f32| vec![value; len + 2 * MARGIN + LANES];
        Self {
            len: 0,
            columns: std::array::from_fn(|c| column(if c < 3 { -f32::MAX } else { f32::MAX })),
            first: vec![0; len],
        }
    }

    fn push(&mut self, aabb: &Aabb, first: u32) {
        let (min, max) = (aabb.min.to_array(), aabb.max.to_array());
        for axis in 0..3 {
            self.columns[axis][MARGIN + self.len] = min[axis];
            self.columns[axis + 3][MARGIN + self.len] = max[axis];
        }
        self.first[self.len] = first;
        self.len += 1;
    }

    /// Starts over; the boxes beyond the new end become infinite again as it grows.
    fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes the margin behind the last cluster infinite.
    fn close(&mut self) {
        for (c, column) in self.columns.iter_mut().enumerate() {
            let end = MARGIN + self.len;
            column[end..end + MARGIN + LANES].fill(if c < 3 { -f32::MAX } else { f32::MAX });
        }
    }

    fn aabb(&self, i: usize) -> Aabb {
        let [a, b, c, d, e, f] = std::array::from_fn(|k| self.columns[k][MARGIN + i]);
        Aabb::new(Vec3A::new(a, b, c), Vec3A::new(d, e, f))
    }

    fn node(&self, i: usize) -> Bvh2Node {
        let first = self.first[i];
        Bvh2Node::new(self.aabb(i), u32::from(first & LEAF != 0), first & !LEAF)
    }
}

/// The tree over `boxes`: node 0 is the root, two children lie side by side, a leaf holds one
/// triangle whose index in `boxes` is its `first_index`. Empty for no boxes.
pub(super) fn build(boxes: &[Aabb]) -> Vec<Bvh2Node> {
    let Some(last) = boxes.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut nodes = vec![Bvh2Node::default(); 2 * last + 1];
    let mut free = nodes.len();
    let mut current = Clusters::with_capacity(boxes.len());
    for i in morton_order(boxes) {
        current.push(&boxes[i as usize], i | LEAF);
    }
    let mut next = Clusters::with_capacity(boxes.len());
    let mut mate = vec![0u32; boxes.len()];
    while current.len > 1 {
        current.close();
        let mate = &mut mate[..current.len];
        choose(&current, mate);
        pair_off(mate);
        next.clear();
        for i in 0..current.len {
            let other = mate[i] as usize;
            if other == i || mate[other] as usize != i {
                next.push(&current.aabb(i), current.first[i]);
            } else if i < other {
                free -= 2;
                nodes[free] = current.node(i);
                nodes[free + 1] = current.node(other);
                next.push(&current.aabb(i).union(&current.aabb(other)), free as u32);
            }
        }
        std::mem::swap(&mut current, &mut next);
    }
    nodes[0] = current.node(0);
    nodes
}

/// For each cluster the neighbour with which it would make the smallest box, or itself.
fn choose(clusters: &Clusters, mate: &mut [u32]) {
    let search = |(chunk, mate): (usize, &mut [u32])| {
        let mut found = [0u32; LANES];
        for (v, out) in mate.chunks_mut(LANES).enumerate() {
            let first = chunk * CHUNK + v * LANES;
            lanes::store_u32(&mut found, 0, choose_eight(clusters, first));
            out.copy_from_slice(&found[..out.len()]);
        }
    };
    mate.par_chunks_mut(CHUNK).enumerate().for_each(search);
}

/// The choices of eight clusters, a lane each, `first` a multiple of eight.
fn choose_eight(clusters: &Clusters, first: usize) -> Ux {
    let at = |offset: isize| -> [Fx; 6] {
        let i = (MARGIN + first).wrapping_add_signed(offset);
        std::array::from_fn(|c| lanes::load(&clusters.columns[c], i))
    };
    let own = at(0);
    let area = |offset: isize| {
        let other = at(offset);
        let [x, y, z] =
            std::array::from_fn(|a| own[a + 3].fast_max(other[a + 3]) - own[a].fast_min(other[a]));
        (x + y).mul_add(z, x * y)
    };
    let index = lanes::iota(first as u32);
    let mut least = Fx::splat(f32::INFINITY);
    let mut mate = index;
    let mut consider = |offset: isize, area: Fx, ties: Fx| {
        let take = area.simd_lt(least) | (area.simd_eq(least) & ties);
        least = take.select(area, least);
        let other = index + Ux::splat(offset as u32);
        mate = as_bits(take).select(other, mate);
    };
    // An odd cluster prefers the even one before it where both neighbours are as good, and nearer
    // neighbours win over farther ones.
    let odd = as_mask((index & Ux::splat(1)).simd_eq(Ux::splat(1)));
    consider(1, area(1), Fx::ZERO);
    consider(-1, area(-1), odd);
    for offset in 2..=REACH as isize {
        consider(offset, area(offset), Fx::ZERO);
        consider(-offset, area(-offset), Fx::ZERO);
    }
    mate
}

/// Pairs off, in order, every stretch in which fewer than two clusters found each other: whatever
/// the boxes, of three stretches on end at least two pairs merge.
fn pair_off(mate: &mut [u32]) {
    for start in (0..mate.len()).step_by(STRETCH) {
        let end = (start + STRETCH).min(mate.len());
        let mutual = |&i: &usize| {
            let other = mate[i] as usize;
            other > i && mate[other] as usize == i
        };
        // A short last stretch is content with one pair.
        let wanted = if end - start == STRETCH { 2 } else { 1 };
        if (start..end).filter(mutual).take(wanted).count() < wanted {
            for i in start..end {
                mate[i] = (i as u32 ^ 1).min(end as u32 - 1);
            }
        }
    }
}

/// Indices of the boxes along a Morton curve of 21 bits an axis through their centres; equal codes
/// in index order.
fn morton_order(boxes: &[Aabb]) -> impl Iterator<Item = u32> {
    let centre = |b: &Aabb| (b.min.as_dvec3() + b.max.as_dvec3()) * 0.5;
    let (mut low, mut high) = (glam::DVec3::INFINITY, glam::DVec3::NEG_INFINITY);
    for b in boxes {
        low = low.min(centre(b));
        high = high.max(centre(b));
    }
    let cells = f64::from((1u32 << 21) - 1);
    let scale = (high - low)
        .to_array()
        .map(|extent| if extent > 0.0 { cells / extent } else { 0.0 });
    let code = |b: &Aabb| {
        let p = ((centre(b) - low) * glam::DVec3::from_array(scale)).to_array();
        spread(p[0] as u64) | spread(p[1] as u64) << 1 | spread(p[2] as u64) << 2
    };
    let mut order: Vec<(u64, u32)> = boxes
        .par_iter()
        .enumerate()
        .map(|(i, b)| (code(b), i as u32))
        .collect();
    order.par_sort_unstable();
    order.into_iter().map(|(_, i)| i)
}

/// Two zero bits between any two of the lowest 21.
fn spread(x: u64) -> u64 {
    let x = x & 0x1f_ffff;
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}
