//! Items by bounce.
//!
//! Paths keep their order from queue to queue and new ones join at the end, so a queue holds few
//! runs of equal bounce; counting runs, not items, is what makes the accounting by bounce cheap.

use huygens_kernels::queues::MARKS;

/// Bounces told apart; the last row holds all deeper ones.
pub(crate) const ROWS: usize = 64;

/// Items by bounce.
#[derive(Clone, Debug)]
pub(crate) struct Tally {
    pub(crate) rows: [u32; ROWS],
    pub(crate) depth: usize,
    pub(crate) total: u32,
}

impl Default for Tally {
    fn default() -> Self {
        Self {
            rows: [0; ROWS],
            depth: 0,
            total: 0,
        }
    }
}

impl Tally {
    pub(crate) fn add(&mut self, bounce: u32, items: usize) {
        let row = (bounce as usize).min(ROWS - 1);
        self.rows[row] += items as u32;
        self.depth = self.depth.max(row + 1);
        self.total += items as u32;
    }

    /// The tally of a queue's `bounces` column, or of one `later` by so many bounces.
    pub(crate) fn of(bounces: &[u32], later: u32) -> Self {
        let mut tally = Self::default();
        for_each_run(bounces, true, |bounce, run| {
            tally.add(bounce.wrapping_add(later), run.len());
        });
        tally
    }

    /// Both together.
    pub(crate) fn plus(mut self, other: &Self) -> Self {
        self.extend(other);
        self
    }

    /// Adds another one's items.
    pub(crate) fn extend(&mut self, other: &Self) {
        for row in 0..other.depth {
            self.rows[row] += other.rows[row];
        }
        self.depth = self.depth.max(other.depth);
        self.total += other.total;
    }

    pub(crate) fn total(&self) -> usize {
        self.total as usize
    }
}

/// Calls `run` with each longest range of equal bounces, in order; with all of them as one, unless
/// they are to be `told_apart`. [`MARKS`] are not looked at.
pub(crate) fn for_each_run(
    bounces: &[u32],
    told_apart: bool,
    mut run: impl FnMut(u32, std::ops::Range<usize>),
) {
    let mut start = 0;
    while start < bounces.len() {
        let bounce = bounces[start] & !MARKS;
        if !told_apart {
            return run(bounce, 0..bounces.len());
        }
        let rest = &bounces[start..];
        // Whole blocks of equal bounces first: the compiler compares them in lanes.
        let mut end = start + equal_blocks::<32>(rest, bounce) * 32;
        end += equal_blocks::<8>(&bounces[end..], bounce) * 8;
        let same = |b: &&u32| **b & !MARKS == bounce;
        end += bounces[end..].iter().take_while(same).count();
        run(bounce, start..end);
        start = end;
    }
}

/// How many blocks of `N` hold nothing but `bounce` before the first that does not.
#[inline(always)]
fn equal_blocks<const N: usize>(bounces: &[u32], bounce: u32) -> usize {
    let blocks = bounces.as_chunks::<N>().0.iter();
    let equal = |block: &&[u32; N]| block.iter().fold(0, |all, b| all | (b ^ bounce)) & !MARKS == 0;
    blocks.take_while(equal).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_cover_the_column_in_order_and_ignore_the_last_ray_mark() {
        let mut column = vec![5; 70];
        column.extend([3, 3, 3 | MARKS, 2]);
        column.extend([0; 33]);
        let mut runs = Vec::new();
        for_each_run(&column, true, |b, r| runs.push((b, r)));
        assert_eq!(runs, [(5, 0..70), (3, 70..73), (2, 73..74), (0, 74..107)]);
        assert_eq!(Tally::of(&column, 1).total(), column.len());
    }
}
