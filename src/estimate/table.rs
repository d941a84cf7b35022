//! Densities from tables: constant in each cell, drawn by inversion of their cumulated sums.

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

/// A density on a rectangle, constant in each of `columns` by `rows` equal cells: the row from the
/// marginal density of `y`, then the column from the conditional density of `x` in that row.
///
/// ```
/// use huygens::estimate::{Density, Table2};
/// let table = Table2::new([0.0, 0.0], [2.0, 2.0], 2, &[1.0, 0.0, 0.0, 3.0]).unwrap();
/// // The first coordinate chooses x, the second y: here the lower row has the first quarter.
/// assert_eq!(table.sample([0.5, 0.125]), [0.5, 0.5]);
/// assert_eq!(table.sample([0.5, 0.25]), [1.5, 1.0]);
/// assert_eq!(table.pdf(&[1.5, 1.5]), 0.75);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table2 {
    marginal: Table,
    /// One a row; none where the whole row is 0.
    conditional: Vec<Option<Table>>,
}

impl Table2 {
    /// On the rectangle from `low` to `high` (x, y), with `values` row by row from the lowest `y`,
    /// `columns` to a row.
    ///
    /// # Errors
    /// As [`Table::new`], and if the values do not fill whole rows.
    pub fn new(
        low: [f64; 2],
        high: [f64; 2],
        columns: usize,
        values: &[f64],
    ) -> Result<Self, TableError> {
        if columns == 0 || values.is_empty() || !values.len().is_multiple_of(columns) {
            return Err(TableError::Shape(values.len()));
        }
        let row = |(index, row): (usize, &[f64])| match Table::new(low[0], high[0], row) {
            Ok(table) => Ok(Some(table)),
            Err(TableError::Sum(0.0)) => Ok(None),
            Err(TableError::Value { index: i, value }) => Err(TableError::Value {
                index: index * columns + i,
                value,
            }),
            Err(error) => Err(error),
        };
        let rows = values.chunks_exact(columns).enumerate().map(row);
        let conditional: Vec<Option<Table>> = rows.collect::<Result<_, _>>()?;
        let sum = |row: &Option<Table>| row.as_ref().map_or(0.0, Table::total);
        let sums: Vec<f64> = conditional.iter().map(sum).collect();
        let marginal = Table::new(low[1], high[1], &sums)?;
        Ok(Self {
            marginal,
            conditional,
        })
    }
}

impl Density<2> for Table2 {
    type Point = [f64; 2];

    fn sample(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (y, row) = self.marginal.sample_with_cell(v);
        let row = self.conditional[row].as_ref();
        let row = row.expect("a cell of value 0 is never drawn from");
        [row.sample([u]), y]
    }

    fn pdf(&self, [x, y]: &[f64; 2]) -> f64 {
        let across = |row: usize| self.conditional[row].as_ref().map_or(0.0, |t| t.pdf(x));
        match self.marginal.pdf(y) {
            0.0 => 0.0,
            p => p * across(self.marginal.cell(*y)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_no_density_is_refused() {
        let new = |values: &[f64]| {
            Table::new(0.0, 1.0, values)
                .expect_err("refused")
                .to_string()
        };
        assert_eq!(new(&[]), "a table of 0 values is no rectangle");
        assert_eq!(
            new(&[1.0, -2.0]),
            "value 1 is -2, expected a finite number of 0 or more"
        );
        assert_eq!(
            new(&[f64::NAN]),
            "value 0 is NaN, expected a finite number of 0 or more"
        );
        let sum = "expected a finite number above 0";
        assert_eq!(new(&[0.0, 0.0]), format!("the values add up to 0, {sum}"));
        assert_eq!(new(&[1e308; 3]), format!("the values add up to inf, {sum}"));
        assert_eq!(
            Table::new(1.0, 1.0, &[1.0]),
            Err(TableError::Interval(1.0, 1.0))
        );
        let two = |columns, values: &[f64]| Table2::new([0.0; 2], [1.0; 2], columns, values);
        assert_eq!(two(2, &[1.0; 3]), Err(TableError::Shape(3)));
        assert_eq!(two(0, &[1.0]), Err(TableError::Shape(1)));
        let [index, value] = [3.0, -1.0];
        let error = TableError::Value {
            index: index as usize,
            value,
        };
        assert_eq!(two(2, &[1.0, 1.0, 1.0, value]), Err(error));
    }

    fn table() -> impl Strategy<Value = Table> {
        let value = prop_oneof![Just(0.0), 0.0..1.0, 1e-300..1e-290, 1e10..1e20];
        let values = prop::collection::vec(value, 1..40);
        let ends = (-1e6..1e6f64, 1e-3..1e3f64);
        (values, ends).prop_filter_map("all zero", |(values, (low, extent))| {
            Table::new(low, low + extent, &values).ok()
        })
    }

    proptest! {
        #[test]
        fn samples_have_a_density_and_the_cdf_undoes_them(
            table in table(),
            u in prop_oneof![0.0..1.0, Just(0.0), Just(1.0 - 0.5 * f64::EPSILON)],
        ) {
            let x = table.sample([u]);
            prop_assert!(table.pdf(&x) > 0.0);
            // Rounding x by 2^-53 of the interval's magnitude moves the cdf by so much times the
            // pdf; a clamped or rounded sum moves it by some 2^-52 a cell.
            let magnitude = table.low.abs().max(table.high.abs());
            let slack = (4.0 * magnitude * table.pdf(&x) + 40.0) * f64::EPSILON;
            prop_assert!((table.cdf(x) - u).abs() <= slack, "{} for {}", table.cdf(x), u);
        }

        #[test]
        fn the_density_integrates_to_one(table in table()) {
            let n = table.values.len();
            let cells = (0..n).map(|i| {
                let [start, end] = [table.edge(i), table.edge(i + 1)];
                // Not the middle: that of a narrow cell may round to its end.
                table.pdf(&start) * (end - start)
            });
            let relative = table.low.abs().max(table.high.abs()) / (table.high - table.low);
            let slack = (n as f64 + 4.0 * relative * n as f64) * 2.0 * f64::EPSILON;
            prop_assert!((cells.sum::<f64>() - 1.0).abs() <= slack);
        }
    }
}
