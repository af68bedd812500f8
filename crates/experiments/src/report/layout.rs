//! Text in columns.

use std::fmt::Write;

/// The space between two columns.
const GAP: usize = 2;

/// One column of a text table; every column has the same number of cells.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    pub(crate) align: Align,
    /// The header's lines and the table's, top to bottom.
    pub(crate) cells: Vec<String>,
}

/// The side to which a column's cells are flush.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Right,
}

impl Column {
    fn width(&self) -> usize {
        self.cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0)
    }
}

/// The width of the table, in characters.
pub(crate) fn width(columns: &[&Column]) -> usize {
    columns.iter().map(|column| column.width()).sum::<usize>() + GAP * columns.len().saturating_sub(1)
}

/// The table's lines, with a rule below the first `n_header`.
pub(crate) fn lines(columns: &[&Column], n_header: usize) -> Vec<String> {
    let n_lines = columns.first().map_or(0, |column| column.cells.len());
    let mut lines: Vec<_> = (0..n_lines).map(|i| line(columns, i)).collect();
    lines.insert(n_header, "\u{2500}".repeat(width(columns)));
    lines
}

fn line(columns: &[&Column], i: usize) -> String {
    let mut line = String::new();
    for (k, column) in columns.iter().enumerate() {
        let gap = if k > 0 { GAP } else { 0 };
        let (cell, width) = (&column.cells[i], column.width());
        // Writing to a string cannot fail.
        let _ = match column.align {
            Align::Left => write!(line, "{:gap$}{cell:<width$}", ""),
            Align::Right => write!(line, "{:gap$}{cell:>width$}", ""),
        };
    }
    line.trim_end().to_owned()
}
