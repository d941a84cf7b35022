//! Tables of two dimensions: a marginal and the conditionals of its rows.

use super::{Table, TableError};
use crate::estimate::Density;

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
