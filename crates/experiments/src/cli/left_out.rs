//! What the worlds of a grid lack of their files.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::spec::Grid;

/// Entries that are told; the others are counted.
const N_TOLD: usize = 20;

/// What the world files of a grid hold and its worlds do not, since `unsupported = "ignore"` allows it, as lines of text; empty
/// where that is nothing.
pub(super) fn in_words(grid: &Grid) -> String {
    listed(&grid.cells.iter().flat_map(|cell| &cell.left_out).collect())
}

fn listed(entries: &BTreeSet<&String>) -> String {
    if entries.is_empty() {
        return String::new();
    }
    // Writing to a string cannot fail.
    let mut text = format!("left out of the world files, as `unsupported = \"ignore\"` has it: {}\n", entries.len());
    for entry in entries.iter().take(N_TOLD) {
        let _ = writeln!(text, "  {entry}");
    }
    if let Some(more @ 1..) = entries.len().checked_sub(N_TOLD) {
        let _ = writeln!(text, "  and {more} more");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_entries_are_counted() {
        let all: Vec<_> = (0..N_TOLD + 2).map(|k| format!("a.world: mesh '{k:02}.dae'")).collect();
        let entries = |n: usize| all[..n].iter().collect();
        assert_eq!(listed(&entries(0)), "");
        let text = listed(&entries(N_TOLD + 2));
        assert!(text.contains("has it: 22\n") && text.ends_with("'19.dae'\n  and 2 more\n"), "{text}");
        assert!(!listed(&entries(N_TOLD)).contains("more"));
    }
}
