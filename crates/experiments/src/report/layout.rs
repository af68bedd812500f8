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

/// The text in lines of at most `n_most` characters (long words aside), all but the first of them indented.
pub(crate) fn wrapped(text: &str, n_most: usize) -> String {
    const INDENT: &str = "    ";
    let (mut lines, mut width) = (String::new(), 0);
    for word in text.split(' ') {
        let n = word.chars().count();
        if width > 0 && width + 1 + n > n_most {
            lines.push('\n');
            lines.push_str(INDENT);
            width = INDENT.len();
        } else if width > 0 {
            lines.push(' ');
            width += 1;
        }
        lines.push_str(word);
        width += n;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_wrapped() {
        let text = wrapped(&["word"; 60].join(" "), 50);
        assert!(text.lines().all(|line| line.chars().count() <= 50));
        assert!(text.lines().skip(1).all(|line| line.starts_with("    word")));
        assert_eq!(text.split_whitespace().count(), 60);
        assert_eq!(wrapped("a b", 50), "a b");
    }
}
