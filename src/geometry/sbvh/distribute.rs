//! Hands the references of a node to its halves: the lower half's from the front of the other
//! buffer on, the upper half's from its end backwards, so that one pass does, however many there
//! will be of either.

use super::Task;
use super::bounds::Bounds;
use super::reference::{Cutter, Reference};
use super::split::{Grid, Split};
use crate::scene::Mesh;

/// Both halves while they fill.
struct Halves<'a> {
    to: &'a mut [Reference],
    counts: [usize; 2],
    bounds: [Bounds; 2],
}

impl<'a> Halves<'a> {
    fn new(to: &'a mut [Reference]) -> Self {
        Self {
            to,
            counts: [0; 2],
            bounds: [Bounds::EMPTY; 2],
        }
    }

    /// Gives `reference` to half `upper`.
    #[inline(always)]
    fn push(&mut self, upper: bool, reference: Reference) {
        let half = usize::from(upper);
        let [low, high] = self.counts;
        let at = if upper { self.to.len() - 1 - high } else { low };
        self.to[at] = reference;
        self.counts[half] += 1;
        self.bounds[half] = self.bounds[half].union(reference.bounds());
    }

    /// The halves as tasks, with the room that is left in proportion to their references.
    fn finish(self, from: &'a mut [Reference], depth: u32) -> (Task<'a>, Task<'a>) {
        let [low, high] = self.counts;
        let spare = (self.to.len() - low - high) as u64;
        let share = spare * low as u64 / (low + high) as u64;
        let middle = low + share as usize;
        let (to_low, to_high) = self.to.split_at_mut(middle);
        let (from_low, from_high) = from.split_at_mut(middle);
        let end = to_high.len();
        let lower = Task {
            from: to_low,
            valid: 0..low,
            to: from_low,
            bounds: self.bounds[0],
            depth: depth + 1,
        };
        let upper = Task {
            from: to_high,
            valid: end - high..end,
            to: from_high,
            bounds: self.bounds[1],
            depth: depth + 1,
        };
        (lower, upper)
    }
}

impl<'a> Task<'a> {
    /// Halves the list as it stands.
    pub(super) fn halve(self) -> (Task<'a>, Task<'a>) {
        let mut halves = Halves::new(self.to);
        let references = &self.from[self.valid];
        for (i, &reference) in references.iter().enumerate() {
            halves.push(2 * i >= references.len(), reference);
        }
        halves.finish(self.from, self.depth)
    }

    /// Parts the references by their centres, as `split` on `grid` says.
    pub(super) fn part(self, grid: &Grid, split: &Split) -> (Task<'a>, Task<'a>) {
        // Each reference is written to both ends and counted at one: which one it is has no pattern
        // that a branch could be predicted from.
        let (mut low, mut high) = (0, 0);
        let last = self.to.len() - 1;
        let reaches = grid.reaches(split.axis, split.bin);
        for reference in &self.from[self.valid] {
            let upper = reaches(reference);
            self.to[low] = *reference;
            self.to[last - high] = *reference;
            low += usize::from(!upper);
            high += usize::from(upper);
        }
        let halves = Halves {
            to: self.to,
            counts: [low, high],
            bounds: split.halves,
        };
        halves.finish(self.from, self.depth)
    }

    /// Cuts the references at the plane of `split`, except those that cost less when they are left
    /// whole on one side (the paper's unsplitting).
    pub(super) fn cut(self, mesh: &Mesh, grid: &Grid, split: &Split) -> (Task<'a>, Task<'a>) {
        let (axis, bin) = (split.axis, split.bin);
        let plane = grid.plane(axis, bin);
        let mut halves = Halves::new(self.to);
        let mut sides = split.halves;
        let mut counts = split.counts.map(|n| n as f32);
        for &reference in &self.from[self.valid.clone()] {
            let bounds = reference.bounds();
            if grid.bin(bounds.max())[axis] < bin {
                halves.push(false, reference);
                continue;
            }
            if grid.bin(bounds.min())[axis] >= bin {
                halves.push(true, reference);
                continue;
            }
            let triangle = reference.triangle();
            let parts = Cutter::new(mesh, triangle).cut(bounds, axis, plane);
            let empty = parts.map(Bounds::is_empty);
            let grown = sides.map(|side| side.union(bounds));
            let [area_low, area_high] = sides.map(Bounds::half_area);
            let [grown_low, grown_high] = grown.map(Bounds::half_area);
            let both = area_low * counts[0] + area_high * counts[1];
            let only_low = grown_low * counts[0] + area_high * (counts[1] - 1.0);
            let only_high = area_low * (counts[0] - 1.0) + grown_high * counts[1];
            if empty[1] || (!empty[0] && only_low <= both && only_low <= only_high) {
                // Where nothing is left on either side, the boxes have become loose; it may stay.
                sides[0] = grown[0];
                counts[1] -= 1.0;
                halves.push(false, reference);
            } else if empty[0] || only_high <= both {
                sides[1] = grown[1];
                counts[0] -= 1.0;
                halves.push(true, reference);
            } else {
                halves.push(false, Reference::new(parts[0], triangle));
                halves.push(true, Reference::new(parts[1], triangle));
            }
        }
        if halves.counts.contains(&0) {
            // All of them went, whole, to the same side.
            let to = halves.to;
            return Task { to, ..self }.halve();
        }
        halves.finish(self.from, self.depth)
    }
}
