//! Tables in Markdown, aligned for people who read them as they are.

use std::fmt::Write;

/// A table under construction.
#[derive(Debug)]
pub(crate) struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// With the given column heads.
    pub(crate) fn new(head: &[&str]) -> Self {
        Self {
            rows: vec![head.iter().map(|&h| h.to_owned()).collect()],
        }
    }

    /// Appends a row, as long as the head.
    pub(crate) fn row(&mut self, cells: Vec<String>) {
        assert_eq!(cells.len(), self.rows[0].len(), "a cell for each column");
        self.rows.push(cells);
    }

    /// Whether there is more than a head.
    pub(crate) fn has_rows(&self) -> bool {
        self.rows.len() > 1
    }

    /// The table as text: the first column to the left, the others to the right.
    pub(crate) fn text(&self) -> String {
        let columns = self.rows[0].len();
        let width = |c: usize| self.rows.iter().map(|row| row[c].chars().count()).max();
        let widths: Vec<usize> = (0..columns).map(|c| width(c).unwrap_or(0)).collect();
        let mut text = String::new();
        for (r, row) in self.rows.iter().enumerate() {
            for (c, cell) in row.iter().enumerate() {
                let w = widths[c];
                // Writing to a string cannot fail.
                let _ = if c == 0 {
                    write!(text, "| {cell:<w$} ")
                } else {
                    write!(text, "| {cell:>w$} ")
                };
            }
            text.push_str("|\n");
            if r == 0 {
                for (c, w) in widths.iter().enumerate() {
                    let dashes = "-".repeat(w + 1);
                    let _ = if c == 0 {
                        write!(text, "|{dashes}-")
                    } else {
                        write!(text, "|{dashes}:")
                    };
                }
                text.push_str("|\n");
            }
        }
        text
    }
}
