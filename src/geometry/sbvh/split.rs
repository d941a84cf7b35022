//! Where to split a node: costs of binned object splits and of binned spatial splits.
//!
//! Object splits part references by their centres (I. Wald, "On Fast Construction of SAH-Based
//! Bounding Volume Hierarchies", RT 2007); spatial splits part space, and references that reach
//! over the plane go to both sides (M. Stich, H. Friedrich, A. Dietrich, HPG 2009). The planes
//! tried are those between [`BINS`] equal bins along each axis. The cost of two halves is the sum
//! of area times blocks of triangles, which is what a leaf costs.

use super::bounds::{Bounds, Least, blocks};
use super::reference::{Cutter, Reference};
use crate::scene::Mesh;
use rayon::prelude::*;
use wide::{f32x4, i32x4};

/// Bins along an axis.
pub(super) const BINS: usize = 16;
/// References that one task puts into bins.
pub(super) const CHUNK: usize = 1 << 14;

/// A way to split.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    /// Sum over the halves of area times blocks.
    pub(super) cost: f32,
    pub(super) axis: usize,
    /// The first bin of the upper half.
    pub(super) bin: usize,
    pub(super) halves: [Bounds; 2],
    pub(super) counts: [usize; 2],
}

/// Which bin a coordinate lies in, along each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    low: f32x4,
    scale: f32x4,
    /// Width of a bin.
    pub(super) step: f32x4,
}

impl Grid {
    pub(super) fn new(bounds: Bounds) -> Self {
        let extent = bounds.extent();
        let positive = extent.simd_gt(f32x4::ZERO);
        let scale = f32x4::splat(BINS as f32) / extent;
        // An extent so small that its reciprocal overflows counts as none.
        let usable = positive & scale.simd_lt(f32x4::splat(f32::INFINITY));
        Self {
            low: bounds.min(),
            scale: usable.select(scale, f32x4::ZERO),
            step: extent * f32x4::splat(1.0 / BINS as f32),
        }
    }

    /// Bins of a point. Grows with the coordinate, and so do the planes of [`Grid::plane`]; the two
    /// may disagree by rounding.
    #[inline(always)]
    pub(super) fn bin(&self, p: f32x4) -> [usize; 3] {
        let last = f32x4::splat((BINS - 1) as f32);
        let at = ((p - self.low) * self.scale)
            .fast_max(f32x4::ZERO)
            .fast_min(last);
        let [x, y, z, _] = at.fast_trunc_int().to_array();
        // The remainder tells the compiler that no index is out of range.
        [x, y, z].map(|i| i as usize % BINS)
    }

    /// Whether the bin along `axis` of a reference, by its centre, is `bin` or above; not for bin 0.
    pub(super) fn reaches(&self, axis: usize, bin: usize) -> impl Fn(&Reference) -> bool + use<> {
        let (low, scale) = (self.low.as_array()[axis], self.scale.as_array()[axis]);
        let bin = bin as f32;
        move |reference| {
            // From memory, where it lies: to pick a lane of a vector takes longer.
            let lanes: &[f32; 8] = bytemuck::cast_ref(reference);
            let centre = lanes[axis + 4] - lanes[axis];
            (centre - low) * scale >= bin
        }
    }

    /// Which axes have bins at all.
    fn divides(&self) -> [bool; 3] {
        [0, 1, 2].map(|axis| self.scale.as_array()[axis] > 0.0)
    }

    /// The plane below `bin`.
    #[inline(always)]
    pub(super) fn plane(&self, axis: usize, bin: usize) -> f32 {
        (bin as f32).mul_add(self.step.as_array()[axis], self.low.as_array()[axis])
    }
}

/// Boxes and counts of what the bins hold. References that begin in a bin and those that end in it
/// are counted apart; for object splits the two are the same.
#[derive(Clone)]
pub(super) struct Bins {
    bounds: [[Bounds; BINS]; 3],
    begin: [[u32; BINS]; 3],
    end: [[u32; BINS]; 3],
}

impl Bins {
    pub(super) const EMPTY: Self = Self {
        bounds: [[Bounds::EMPTY; BINS]; 3],
        begin: [[0; BINS]; 3],
        end: [[0; BINS]; 3],
    };

    /// Adds `count` references, with `bounds` around them, that begin and end in a bin.
    #[inline(always)]
    pub(super) fn add(&mut self, axis: usize, bin: usize, bounds: Bounds, count: u32) {
        self.bounds[axis][bin] = self.bounds[axis][bin].union(bounds);
        self.begin[axis][bin] += count;
        self.end[axis][bin] += count;
    }

    /// Bins `all`, in parallel where there are at least two of `chunk`. Maxima and integer sums do not
    /// depend on how the work is cut up.
    pub(super) fn of<T: Sync>(
        all: &[T],
        chunk: usize,
        put: impl Fn(&mut Self, &[T]) + Sync,
    ) -> Self {
        let mut bins = Self::EMPTY;
        if all.len() < 2 * chunk {
            put(&mut bins, all);
            return bins;
        }
        let parts = all.par_chunks(chunk).map(|chunk| {
            let mut bins = Box::new(Self::EMPTY);
            put(&mut bins, chunk);
            bins
        });
        *parts.reduce(|| Box::new(Self::EMPTY), |a, b| a.merge(&b))
    }

    fn merge(mut self: Box<Self>, other: &Self) -> Box<Self> {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.bounds[axis][bin] = self.bounds[axis][bin].union(other.bounds[axis][bin]);
                self.begin[axis][bin] += other.begin[axis][bin];
                self.end[axis][bin] += other.end[axis][bin];
            }
        }
        self
    }

    /// The cheapest plane between two bins, along the axes that have any, that leaves something on
    /// both sides.
    pub(super) fn best(&self, divides: [bool; 3]) -> Option<Split> {
        let mut least = Least::new();
        for axis in (0..3).filter(|&axis| divides[axis]) {
            let bounds = &self.bounds[axis];
            let mut above = [Bounds::EMPTY; BINS];
            let (mut lower, mut upper) = ([0; BINS], [0; BINS]);
            let (mut box_above, mut count_above) = (Bounds::EMPTY, 0);
            for bin in (0..BINS).rev() {
                box_above = box_above.union(bounds[bin]);
                count_above += self.end[axis][bin] as i32;
                (above[bin], upper[bin]) = (box_above, count_above);
            }
            for bin in 1..BINS {
                lower[bin] = lower[bin - 1] + self.begin[axis][bin - 1] as i32;
            }
            let mut box_below = Bounds::EMPTY;
            for four in (0..BINS).step_by(4) {
                let below = [0, 1, 2, 3].map(|i| {
                    let below = box_below;
                    box_below = box_below.union(bounds[four + i]);
                    below
                });
                let above = [0, 1, 2, 3].map(|i| above[four + i]);
                let blocks =
                    |n: &[i32; BINS]| blocks(i32x4::new([0, 1, 2, 3].map(|i| n[four + i])));
                let costs = Bounds::half_areas(below) * blocks(&lower)
                    + Bounds::half_areas(above) * blocks(&upper);
                least.consider(costs, axis * BINS + four);
            }
        }
        let (cost, best) = least.get()?;
        let (axis, bin) = (best / BINS, best % BINS);
        let around = |bins: std::ops::Range<usize>| {
            let boxes = self.bounds[axis][bins].iter();
            boxes.fold(Bounds::EMPTY, |sum, &of| sum.union(of))
        };
        let count = |bins: &[u32]| bins.iter().sum::<u32>() as usize;
        Some(Split {
            cost,
            axis,
            bin,
            halves: [around(0..bin), around(bin..BINS)],
            counts: [
                count(&self.begin[axis][..bin]),
                count(&self.end[axis][bin..]),
            ],
        })
    }
}

/// The best object split on `grid`, which spans twice the centres.
pub(super) fn object(references: &[Reference], grid: &Grid) -> Option<Split> {
    let put = |bins: &mut Bins, references: &[Reference]| {
        for reference in references {
            let bounds = reference.bounds();
            let at = grid.bin(bounds.twice_centre().max());
            for axis in 0..3 {
                let bin = at[axis];
                bins.bounds[axis][bin] = bins.bounds[axis][bin].union(bounds);
                bins.begin[axis][bin] += 1;
            }
        }
    };
    let mut bins = Bins::of(references, CHUNK, put);
    bins.end = bins.begin;
    bins.best(grid.divides())
}

/// The best spatial split on `grid`, which spans the node.
pub(super) fn spatial(mesh: &Mesh, references: &[Reference], grid: &Grid) -> Option<Split> {
    let put = |bins: &mut Bins, references: &[Reference]| {
        for reference in references {
            let bounds = reference.bounds();
            let (first, last) = (grid.bin(bounds.min()), grid.bin(bounds.max()));
            let mut cutter = None;
            for axis in 0..3 {
                bins.begin[axis][first[axis]] += 1;
                bins.end[axis][last[axis]] += 1;
                let mut rest = bounds;
                if first[axis] < last[axis] {
                    let cutter =
                        cutter.get_or_insert_with(|| Cutter::new(mesh, reference.triangle()));
                    for bin in first[axis]..last[axis] {
                        let [below, above] = cutter.cut(rest, axis, grid.plane(axis, bin + 1));
                        if !below.is_empty() {
                            bins.bounds[axis][bin] = bins.bounds[axis][bin].union(below);
                        }
                        rest = above;
                    }
                }
                if !rest.is_empty() {
                    let bin = last[axis];
                    bins.bounds[axis][bin] = bins.bounds[axis][bin].union(rest);
                }
            }
        }
    };
    Bins::of(references, CHUNK, put).best(grid.divides())
}
