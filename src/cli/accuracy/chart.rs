//! A chart of letters: both axes logarithmic, in decades.

use std::fmt::Write;

/// Columns and rows of the plot.
const SIZE: [usize; 2] = [72, 18];

/// Marks of the guides, in order.
const GUIDES: [char; 4] = ['.', ':', '-', '='];

/// The letter that stands for a curve, in charts and tables.
pub(crate) fn letter(index: usize) -> char {
    char::from(b'a' + (index % 26) as u8)
}

/// Curves, and lines of known slopes that start together above the leftmost and highest point.
#[derive(Clone, Debug)]
pub(crate) struct Chart<'a> {
    pub(crate) title: &'a str,
    pub(crate) series: Vec<Series>,
    pub(crate) guides: Vec<f64>,
}

/// A curve and the letter it is drawn with.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    pub(crate) marker: char,
    pub(crate) points: Vec<(f64, f64)>,
}

impl Chart<'_> {
    /// The chart as lines; nothing but the title if there is no point to show. A `*` stands where
    /// curves meet.
    pub(crate) fn draw(&self) -> String {
        let mut text = format!("{}\n", self.title);
        let log = |&(x, y): &(f64, f64)| [x.log10(), y.log10()];
        let finite = |p: &[f64; 2]| p.iter().all(|v| v.is_finite());
        let points =
            |s: &Series| -> Vec<[f64; 2]> { s.points.iter().map(log).filter(finite).collect() };
        let all: Vec<[f64; 2]> = self.series.iter().flat_map(points).collect();
        if all.is_empty() {
            return text;
        }
        let axes = [0, 1].map(|axis| Axis::over(all.iter().map(|p| p[axis]), SIZE[axis]));
        let mut grid = vec![[' '; SIZE[0]]; SIZE[1]];
        let corner = [
            all.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min),
            all.iter().map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max),
        ];
        for (slope, mark) in self.guides.iter().zip(GUIDES) {
            // Dotted: every other column.
            for column in (0..SIZE[0]).step_by(2) {
                let x = axes[0].value(column);
                let row = axes[1].cell(corner[1] + slope * (x - corner[0]));
                if let (true, Some(row)) = (x >= corner[0], row) {
                    grid[row][column] = mark;
                }
            }
        }
        for series in &self.series {
            for [x, y] in points(series) {
                if let (Some(column), Some(row)) = (axes[0].cell(x), axes[1].cell(y)) {
                    let cell = &mut grid[row][column];
                    let free = *cell == ' ' || GUIDES.contains(cell) || *cell == series.marker;
                    *cell = if free { series.marker } else { '*' };
                }
            }
        }
        // The highest row is the last.
        for (row, cells) in grid.iter().enumerate().rev() {
            let label = axes[1].label(row).unwrap_or_default();
            let line: String = cells.iter().collect();
            let _ = writeln!(text, "{label:>6} |{}", line.trim_end());
        }
        let mut labels = String::new();
        for column in 0..SIZE[0] {
            if let Some(label) = axes[0].label(column).filter(|_| labels.len() <= column) {
                let _ = write!(
                    labels,
                    "{:column$}{} ",
                    "",
                    label,
                    column = column - labels.len()
                );
            }
        }
        let _ = writeln!(text, "{:>6} +{}", "", "-".repeat(SIZE[0]));
        let _ = writeln!(text, "{:>6}  {}", "", labels.trim_end());
        let slopes = self.guides.iter().zip(GUIDES);
        for (index, (slope, mark)) in slopes.enumerate() {
            let separator = if index == 0 { "        " } else { "   " };
            let _ = write!(text, "{separator}{mark}{mark}{mark} slope {slope:.2}");
        }
        if !self.guides.is_empty() {
            text.push('\n');
        }
        text
    }
}

/// One axis: cell 0 is centred on `low`, the last on `high`.
struct Axis {
    low: f64,
    step: f64,
    cells: usize,
}

impl Axis {
    fn over(values: impl Iterator<Item = f64> + Clone, cells: usize) -> Self {
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(f64::NEG_INFINITY, f64::max);
        // Of a single value, one decade.
        let extent = if high > low { high - low } else { 1.0 };
        Self {
            low,
            step: extent / (cells - 1) as f64,
            cells,
        }
    }

    fn value(&self, cell: usize) -> f64 {
        self.low + cell as f64 * self.step
    }

    fn cell(&self, value: f64) -> Option<usize> {
        let cell = ((value - self.low) / self.step).round();
        (0.0..self.cells as f64)
            .contains(&cell)
            .then_some(cell as usize)
    }

    /// What stands at a cell: a power of ten; where the axis has none, the values at its ends.
    fn label(&self, cell: usize) -> Option<String> {
        if let Some(decade) = self.decade(cell) {
            return Some(format!("1e{decade}"));
        }
        let end = cell == 0 || cell + 1 == self.cells;
        let none = end && (0..self.cells).all(|c| self.decade(c).is_none());
        none.then(|| format!("{:.1e}", 10f64.powf(self.value(cell))))
    }

    /// The power of ten whose cell this is.
    fn decade(&self, cell: usize) -> Option<i32> {
        let decade = self.value(cell).round();
        (self.cell(decade) == Some(cell)).then_some(decade as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_and_its_guide() {
        let points = (0..=17).map(|k| (10f64.powi(k), 10f64.powi(-k)));
        let chart = Chart {
            title: "title",
            series: vec![Series {
                marker: 'a',
                points: points.collect(),
            }],
            guides: vec![-0.5],
        };
        let text = chart.draw();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 1 + SIZE[1] + 3);
        // From the upper left to the lower right corner, a decade a row.
        // The guide starts with it.
        assert_eq!(lines[1], "   1e0 |a . .");
        assert_eq!(lines[18], format!(" 1e-17 |{:>1$}", 'a', SIZE[0]));
        // In the last even column the guide has come half as far down: 16.8 decades, 8.4 rows.
        assert_eq!(lines[9].rfind('.'), Some(8 + 70));
        assert!(!lines[10].contains('.'));
        assert_eq!(lines[21], "        ... slope -0.50");
    }

    #[test]
    fn an_axis_within_a_decade_has_its_ends() {
        let axis = Axis::over([0.002f64, 0.008].map(f64::log10).into_iter(), 10);
        let labels: Vec<_> = (0..10).filter_map(|cell| axis.label(cell)).collect();
        assert_eq!(labels, ["2.0e-3", "8.0e-3"]);
        let axis = Axis::over([0.002f64, 0.08].map(f64::log10).into_iter(), 10);
        let labels: Vec<_> = (0..10).filter_map(|cell| axis.label(cell)).collect();
        assert_eq!(labels, ["1e-2"]);
    }

    #[test]
    fn curves_that_meet_and_points_that_cannot_be_drawn() {
        let series = |marker, points: &[(f64, f64)]| Series {
            marker,
            points: points.to_vec(),
        };
        let chart = |series| Chart {
            title: "t",
            series,
            guides: Vec::new(),
        };
        let meet = chart(vec![
            series('a', &[(1.0, 1.0), (10.0, 0.1)]),
            series('b', &[(1.0, 1.0), (10.0, 0.0)]),
        ]);
        let text = meet.draw();
        assert_eq!(text.matches('*').count(), 1);
        assert_eq!(text.matches('b').count(), 0);
        assert_eq!(chart(vec![series('a', &[(0.0, 0.0)])]).draw(), "t\n");
        let one = chart(vec![series('a', &[(1.0, 1.0)])]).draw();
        assert_eq!(one.matches('a').count(), 1);
    }
}
