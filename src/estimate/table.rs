//! Densities from tables: constant in each cell, drawn by inversion of their cumulated sums.

mod two;

pub use two::Table2;

use super::Density;

/// Why a table is no density.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// It has no values, or not a whole number of rows.
    #[error("a table of {0} values is no rectangle")]
    Shape(usize),
    /// A value is negative or not finite.
    #[error("value {index} is {value}, expected a finite number of 0 or more")]
    Value {
        /// Where it stands.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// All are 0, or their sum is more than an f64 holds.
    #[error("the values add up to {0}, expected a finite number above 0")]
    Sum(f64),
    /// The interval is empty or not finite.
    #[error("{0} to {1} is no interval")]
    Interval(f64, f64),
}

/// A density on an interval, constant in each of `n` equal cells and proportional to a value there.
///
/// A sample costs a binary search, `log2 n` steps. A cell of value 0 is never drawn from.
///
/// ```
/// use huygens::estimate::{Density, Table};
/// let table = Table::new(0.0, 4.0, &[0.0, 3.0, 0.0, 1.0]).unwrap();
/// assert_eq!(table.sample([0.0]), 1.0);
/// assert_eq!(table.sample([0.75]), 3.0);
/// assert_eq!(table.pdf(&1.5), 0.75);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    low: f64,
    high: f64,
    values: Vec<f64>,
    /// `sums[i]` is the sum of the first `i` values; one more than there are values.
    sums: Vec<f64>,
}

impl Table {
    /// On `[low, high]`, with one of `values` in each cell.
    ///
    /// # Errors
    /// If there are no values, one is negative or not finite, all are 0, their sum is not finite, or
    /// the interval is empty or not finite.
    pub fn new(low: f64, high: f64, values: &[f64]) -> Result<Self, TableError> {
        if values.is_empty() {
            return Err(TableError::Shape(0));
        }
        if !(low < high && (high - low).is_finite()) {
            return Err(TableError::Interval(low, high));
        }
        let wrong = |v: &f64| !(*v >= 0.0 && v.is_finite());
        if let Some(index) = values.iter().position(wrong) {
            let value = values[index];
            return Err(TableError::Value { index, value });
        }
        let mut sum = 0.0;
        let cumulated = values.iter().map(|v| {
            sum += v;
            sum
        });
        let sums: Vec<f64> = std::iter::once(0.0).chain(cumulated).collect();
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(TableError::Sum(sum));
        }
        Ok(Self {
            low,
            high,
            values: values.to_vec(),
            sums,
        })
    }

    /// The table of `f` at the middle of each of `cells` cells.
    ///
    /// As a density to integrate `f` with it must not be 0 where `f` is not: of a function with
    /// narrow features, mix in a constant.
    ///
    /// # Errors
    /// As [`Table::new`].
    pub fn of(
        low: f64,
        high: f64,
        cells: usize,
        f: impl Fn(f64) -> f64,
    ) -> Result<Self, TableError> {
        let middle = |i: usize| low + (high - low) * ((i as f64 + 0.5) / cells as f64);
        let values: Vec<f64> = (0..cells).map(|i| f(middle(i))).collect();
        Self::new(low, high, &values)
    }

    /// Probability of a sample below `x`.
    #[must_use]
    pub fn cdf(&self, x: f64) -> f64 {
        if x <= self.low {
            return 0.0;
        }
        if x >= self.high {
            return 1.0;
        }
        let cell = self.cell(x);
        let [start, end] = [self.edge(cell), self.edge(cell + 1)];
        let within = self.values[cell] * ((x - start) / (end - start));
        (self.sums[cell] + within) / self.total()
    }

    /// The cell of a sample, and how far into the cell it lies, in `[0, 1)`.
    fn invert(&self, u: f64) -> (usize, f64) {
        let height = u * self.total();
        // The last cell that starts at or below `height`: never one of value 0, unless rounding has
        // made `height` the whole sum. Then it is the last cell that has a value.
        let after = self.sums.partition_point(|s| *s <= height);
        let cell = after.saturating_sub(1).min(self.values.len() - 1);
        let cell = match self.values[cell] {
            0.0 => self.sums.partition_point(|s| *s < self.total()) - 1,
            _ => cell,
        };
        let within = (height - self.sums[cell]) / self.values[cell];
        (cell, within.clamp(0.0, 1.0 - 0.5 * f64::EPSILON))
    }

    /// A sample, and the cell it was drawn from.
    fn sample_with_cell(&self, u: f64) -> (f64, usize) {
        let (cell, within) = self.invert(u);
        let [start, end] = [self.edge(cell), self.edge(cell + 1)];
        // Kept in the cell, whose density belongs to it.
        let last = end.next_down().max(start);
        ((start + within * (end - start)).clamp(start, last), cell)
    }

    /// The cell that holds `x`, which lies in the interval.
    fn cell(&self, x: f64) -> usize {
        let n = self.values.len();
        let guess = ((x - self.low) / (self.high - self.low) * n as f64) as usize;
        let mut cell = guess.min(n - 1);
        // The quotient and the edges round differently.
        while cell > 0 && x < self.edge(cell) {
            cell -= 1;
        }
        while cell + 1 < n && x >= self.edge(cell + 1) {
            cell += 1;
        }
        cell
    }

    /// Where cell `i` starts and the one before ends.
    fn edge(&self, i: usize) -> f64 {
        match self.values.len() {
            n if i == n => self.high,
            n => self.low + (self.high - self.low) * (i as f64 / n as f64),
        }
    }

    fn total(&self) -> f64 {
        self.sums[self.values.len()]
    }
}

impl Density<1> for Table {
    type Point = f64;

    fn sample(&self, [u]: [f64; 1]) -> f64 {
        self.sample_with_cell(u).0
    }

    fn pdf(&self, x: &f64) -> f64 {
        if !(self.low..=self.high).contains(x) {
            return 0.0;
        }
        let width = (self.high - self.low) / self.values.len() as f64;
        self.values[self.cell(*x)] / (self.total() * width)
    }
}

#[cfg(test)]
mod tests;
