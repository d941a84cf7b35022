//! Several levels of a large node's object splits at once. References are counted in the cells of a
//! grid over their centres; splits are chosen between bins of cells, of which there are far fewer than
//! references; then each reference moves once, to where the last of the splits puts it. (A grid
//! under a top-down build: compare K. Garanzha, J. Pantaleoni, D. McAllister, "Simpler and Faster
//! HLBVH with Work Queues", HPG 2011.)
//!
//! Below some splits cells are too coarse to choose between; what is left there is a bucket, which
//! the builder goes on with, where it is large on a grid of its own.
//!
//! Nothing depends on how many tasks share the work: boxes are maxima, counts are integers, and
//! references keep their order within a bucket.

use super::bounds::Bounds;
use super::plan::{CELLS, Cell, Plan, Splitter};
use super::reference::Reference;
use rayon::prelude::*;
use wide::f32x4;

/// References from which on a grid pays.
pub(super) const FROM: usize = 2048;
/// Fewer planes to choose from than this, along all axes together, and a node is a bucket: on the
/// grids of many references, which decide the top of the tree, and on others. A node has three times
/// `split::BINS - 1` at most.
const PLANES: [u32; 2] = [30, 16];
/// What many references are.
const MANY: usize = 1 << 15;
/// Most cells, as a power of two, and most along an axis.
const MOST: u32 = 15;
const MOST_ALONG: u32 = 6;
/// References that make a task of their own worth while.
const CHUNK: usize = 1 << 14;

/// The grid. Along an axis, as many cells as a power of two.
struct Cells {
    low: f32x4,
    scale: f32x4,
    last: f32x4,
    bits: [u32; 3],
}

impl Cells {
    /// About so many cells as `total` bits can number, about as long as they are wide.
    fn new(centres: Bounds, total: u32) -> Self {
        let extent = centres.extent().to_array();
        let mut bits = [0u32; 3];
        let cell = |bits: &[u32; 3], a: usize| extent[a] / (1u32 << bits[a]) as f32;
        for _ in 0..total {
            let longest = (0..3)
                .filter(|&a| bits[a] < MOST_ALONG && extent[a] > 0.0)
                .max_by(|&a, &b| cell(&bits, a).total_cmp(&cell(&bits, b)));
            if let Some(axis) = longest {
                bits[axis] += 1;
            }
        }
        let along = |f: fn(f32, f32) -> f32| {
            let lane = |a: usize| f(extent[a], (1u32 << bits[a]) as f32);
            f32x4::new([lane(0), lane(1), lane(2), 0.0])
        };
        Self {
            low: centres.min(),
            // An extent so small that its reciprocal overflows counts as none.
            scale: along(|extent, cells| {
                let scale = cells / extent;
                if scale < f32::INFINITY { scale } else { 0.0 }
            }),
            last: along(|_, cells| cells - 1.0),
            bits,
        }
    }

    fn len(&self) -> usize {
        1 << self.bits.iter().sum::<u32>()
    }

    /// The cell of a point.
    #[inline(always)]
    fn of(&self, p: f32x4) -> usize {
        let at = ((p - self.low) * self.scale)
            .fast_max(f32x4::ZERO)
            .fast_min(self.last);
        let [x, y, z, _] = at.fast_trunc_int().to_array();
        let [by_x, by_y, _] = self.bits;
        (x | y << by_x | z << (by_x + by_y)) as usize
    }

    /// Where along the axes a cell lies.
    fn place(&self, cell: usize) -> [u32; 3] {
        let [x, y, z] = self.bits;
        let low = |v: usize, bits: u32| v as u32 & ((1 << bits) - 1);
        [low(cell, x), low(cell >> x, y), low(cell >> (x + y), z)]
    }
}

/// What one task found in its share of the references.
struct Share {
    ids: Vec<u16>,
    bounds: Vec<Bounds>,
    counts: Vec<u32>,
}

impl Share {
    fn new(cells: &Cells, references: &[Reference]) -> Self {
        const { assert!(MOST <= u16::BITS) };
        let mut bounds = vec![Bounds::EMPTY; cells.len()];
        let mut counts = vec![0; cells.len()];
        let last = cells.len() - 1;
        let mut ids = vec![0; references.len()];
        for (id, reference) in ids.iter_mut().zip(references) {
            let of = reference.bounds();
            let cell = cells.of(of.twice_centre().max()) & last;
            bounds[cell] = bounds[cell].union(of);
            counts[cell] += 1;
            *id = cell as u16;
        }
        Self {
            ids,
            bounds,
            counts,
        }
    }
}

/// Splits the references `from`, whose centres twice over span `centres`, and writes them to `to`,
/// which is as long, in the order of the tree. None if all of them are one bucket.
pub(super) fn part(from: &[Reference], to: &mut [Reference], centres: Bounds) -> Option<Plan> {
    let n = from.len();
    let cells = Cells::new(centres, (n.ilog2() - 1).min(MOST));
    let tasks = (n / CHUNK).clamp(1, rayon::current_num_threads());
    let chunk = n.div_ceil(tasks);
    let shares: Vec<Share> = from
        .par_chunks(chunk)
        .map(|references| Share::new(&cells, references))
        .collect();
    let mut used = used(&cells, &shares);
    let splitter = Splitter {
        planes: PLANES[usize::from(n < MANY)],
    };
    let plan = splitter.split(&mut used);
    plan.halves.as_ref()?;
    let mut buckets = Buckets {
        shares: &shares,
        of_cell: vec![0; cells.len()],
        counts: vec![Vec::new(); shares.len()],
    };
    buckets.number(&plan, &used);
    let mut rooms = buckets.rooms(to);
    let pieces = from.par_chunks(chunk).zip(&shares).zip(&mut rooms);
    pieces.for_each(|((references, share), rooms)| {
        for (&reference, &id) in references.iter().zip(&share.ids) {
            let bucket = buckets.of_cell[usize::from(id)];
            if let Some(place) = rooms[usize::from(bucket)].next() {
                *place = reference;
            }
        }
    });
    Some(plan)
}

/// The cells that are not empty, in order.
fn used(cells: &Cells, shares: &[Share]) -> Vec<Cell> {
    let some = |first: usize| {
        let ids = first..cells.len().min(first + CELLS);
        let cell = |id: usize| {
            let count = shares.iter().map(|s| s.counts[id]).sum();
            (count > 0).then(|| {
                let bounds = shares.iter().map(|s| s.bounds[id]);
                Cell {
                    bounds: bounds.fold(Bounds::EMPTY, Bounds::union),
                    place: cells.place(id),
                    id: id as u32,
                    count,
                }
            })
        };
        ids.filter_map(cell).collect::<Vec<_>>()
    };
    let parts = (0..cells.len()).into_par_iter().step_by(CELLS).map(some);
    parts.collect::<Vec<_>>().concat()
}

/// Which bucket each cell belongs to.
struct Buckets<'a> {
    shares: &'a [Share],
    of_cell: Vec<u16>,
    /// For each share its references in each bucket.
    counts: Vec<Vec<usize>>,
}

impl Buckets<'_> {
    /// Numbers the buckets of a plan and counts what is in them; returns the rest of the cells.
    fn number<'c>(&mut self, plan: &Plan, mut cells: &'c [Cell]) -> &'c [Cell] {
        if let Some(halves) = &plan.halves {
            cells = self.number(&halves[0], cells);
            return self.number(&halves[1], cells);
        }
        let bucket = self.counts[0].len();
        let (mine, rest) = cells.split_at(plan.cells);
        for cell in mine {
            self.of_cell[cell.id as usize] = bucket as u16;
        }
        for (counts, share) in self.counts.iter_mut().zip(self.shares) {
            let of_cell = |cell: &Cell| share.counts[cell.id as usize] as usize;
            counts.push(mine.iter().map(of_cell).sum());
        }
        rest
    }

    /// For each share, where in `to` its references of each bucket go.
    fn rooms<'a>(
        &self,
        mut to: &'a mut [Reference],
    ) -> Vec<Vec<std::slice::IterMut<'a, Reference>>> {
        let buckets = self.counts[0].len();
        let mut rooms: Vec<Vec<_>> = Vec::new();
        rooms.resize_with(self.counts.len(), || Vec::with_capacity(buckets));
        for bucket in 0..buckets {
            for (rooms, counts) in rooms.iter_mut().zip(&self.counts) {
                let (room, rest) = std::mem::take(&mut to).split_at_mut(counts[bucket]);
                rooms.push(room.iter_mut());
                to = rest;
            }
        }
        rooms
    }
}
