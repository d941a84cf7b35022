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
use super::reference::Reference;
use super::split::{BINS, Bins};
use rayon::prelude::*;
use wide::f32x4;

/// References from which on a grid pays.
pub(super) const FROM: usize = 2048;
/// Fewer references than this are a bucket.
const BUCKET: usize = 256;
/// Fewer planes to choose from than this, along all axes together, and a node is a bucket: on the
/// grids of many references, which decide the top of the tree, and on others. A node has three times
/// `BINS - 1` at most.
const PLANES: [u32; 2] = [30, 16];
/// What many references are.
const MANY: usize = 1 << 15;
/// Most cells, as a power of two, and most along an axis.
const MOST: u32 = 15;
const MOST_ALONG: u32 = 6;
/// References that make a task of their own worth while.
const CHUNK: usize = 1 << 14;

/// Splits of a node: what they leave lies one after the other in the order of the tree.
pub(super) struct Plan {
    pub(super) bounds: Bounds,
    pub(super) count: usize,
    /// None of a bucket.
    pub(super) halves: Option<Box<[Plan; 2]>>,
}

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

/// A cell that is not empty.
#[derive(Clone, Copy)]
struct Cell {
    bounds: Bounds,
    place: [u32; 3],
    id: u32,
    count: u32,
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
    let mut used = Vec::with_capacity(cells.len() / 4);
    for id in 0..cells.len() {
        let count = shares.iter().map(|s| s.counts[id]).sum();
        if count > 0 {
            let bounds = shares.iter().map(|s| s.bounds[id]);
            used.push(Cell {
                bounds: bounds.fold(Bounds::EMPTY, Bounds::union),
                place: cells.place(id),
                id: id as u32,
                count,
            });
        }
    }
    let mut splitter = Splitter {
        bucket_of: vec![0; cells.len()],
        buckets: 0,
        planes: PLANES[usize::from(n < MANY)],
    };
    let plan = splitter.split(&mut used);
    plan.halves.as_ref()?;
    let mut rooms = rooms(&shares, &splitter, to);
    let pieces = from.par_chunks(chunk).zip(&shares).zip(&mut rooms);
    pieces.for_each(|((references, share), rooms)| {
        for (&reference, &id) in references.iter().zip(&share.ids) {
            let bucket = splitter.bucket_of[usize::from(id)];
            if let Some(place) = rooms[usize::from(bucket)].next() {
                *place = reference;
            }
        }
    });
    Some(plan)
}

/// For each share, where in `to` its references of each bucket go.
fn rooms<'a>(
    shares: &[Share],
    splitter: &Splitter,
    mut to: &'a mut [Reference],
) -> Vec<Vec<std::slice::IterMut<'a, Reference>>> {
    let counts = |share: &Share| {
        let mut counts = vec![0usize; splitter.buckets];
        for (&bucket, &n) in splitter.bucket_of.iter().zip(&share.counts) {
            counts[usize::from(bucket)] += n as usize;
        }
        counts
    };
    let counts: Vec<Vec<usize>> = shares.iter().map(counts).collect();
    let mut rooms: Vec<Vec<_>> = shares.iter().map(|_| Vec::new()).collect();
    for bucket in 0..splitter.buckets {
        for (rooms, counts) in rooms.iter_mut().zip(&counts) {
            let (room, rest) = std::mem::take(&mut to).split_at_mut(counts[bucket]);
            rooms.push(room.iter_mut());
            to = rest;
        }
    }
    rooms
}

/// Splits nodes of cells until they are buckets.
struct Splitter {
    /// The bucket of each cell.
    bucket_of: Vec<u16>,
    buckets: usize,
    /// With fewer to choose from a node is a bucket.
    planes: u32,
}

impl Splitter {
    fn split(&mut self, cells: &mut [Cell]) -> Plan {
        let (mut low, mut high) = ([u32::MAX; 3], [0; 3]);
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for cell in cells.iter() {
            bounds = bounds.union(cell.bounds);
            count += cell.count as usize;
            for axis in 0..3 {
                low[axis] = low[axis].min(cell.place[axis]);
                high[axis] = high[axis].max(cell.place[axis]);
            }
        }
        let halves = self.halve(cells, count, low, high).map(Box::new);
        if halves.is_none() {
            for cell in cells.iter() {
                self.bucket_of[cell.id as usize] = self.buckets as u16;
            }
            self.buckets += 1;
        }
        Plan {
            bounds,
            count,
            halves,
        }
    }

    fn halve(
        &mut self,
        cells: &mut [Cell],
        count: usize,
        low: [u32; 3],
        high: [u32; 3],
    ) -> Option<[Plan; 2]> {
        let planes: u32 = (0..3)
            .map(|a| (high[a] - low[a]).min(BINS as u32 - 1))
            .sum();
        if count < BUCKET || planes < self.planes {
            return None;
        }
        // Cells along an axis that make a bin, as a power of two.
        let wide = [0, 1, 2].map(|a| {
            let cells = high[a] - low[a] + 1;
            cells.div_ceil(BINS as u32).next_power_of_two().ilog2()
        });
        let bin = |cell: &Cell, a: usize| ((cell.place[a] - low[a]) >> wide[a]) as usize % BINS;
        let mut bins = Bins::EMPTY;
        for cell in cells.iter() {
            for axis in 0..3 {
                bins.add(axis, bin(cell, axis), cell.bounds, cell.count);
            }
        }
        let split = bins.best([0, 1, 2].map(|a| high[a] > low[a]))?;
        // Which cells come first does not matter: references keep their own order.
        let mut lower = 0;
        for i in 0..cells.len() {
            if bin(&cells[i], split.axis) < split.bin {
                cells.swap(lower, i);
                lower += 1;
            }
        }
        let (below, above) = cells.split_at_mut(lower);
        Some([self.split(below), self.split(above)])
    }
}
