//! Several splits of a node, chosen between cells of a grid.

use super::bounds::Bounds;
use super::split::{BINS, Bins};

/// Fewer references than this are a bucket.
const BUCKET: usize = 256;
/// Cells that make a task of their own worth while.
pub(super) const CELLS: usize = 1 << 11;

/// Splits of a node: what they leave lies one after the other in the order of the tree.
pub(super) struct Plan {
    pub(super) bounds: Bounds,
    pub(super) count: usize,
    /// Cells that are not empty.
    pub(super) cells: usize,
    /// None of a bucket.
    pub(super) halves: Option<Box<[Plan; 2]>>,
}

/// A cell that is not empty.
#[derive(Clone, Copy)]
pub(super) struct Cell {
    pub(super) bounds: Bounds,
    pub(super) place: [u32; 3],
    pub(super) id: u32,
    pub(super) count: u32,
}

/// Splits nodes of cells until they are buckets.
pub(super) struct Splitter {
    /// With fewer to choose from a node is a bucket.
    pub(super) planes: u32,
}

impl Splitter {
    pub(super) fn split(&self, cells: &mut [Cell]) -> Plan {
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
        Plan {
            bounds,
            count,
            cells: cells.len(),
            halves,
        }
    }

    fn halve(
        &self,
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
        let bins = Bins::of(cells, CELLS, |bins, cells| {
            for cell in cells {
                for axis in 0..3 {
                    bins.add(axis, bin(cell, axis), cell.bounds, cell.count);
                }
            }
        });
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
        if below.len() + above.len() < CELLS {
            return Some([self.split(below), self.split(above)]);
        }
        let (below, above) = rayon::join(|| self.split(below), || self.split(above));
        Some([below, above])
    }
}
