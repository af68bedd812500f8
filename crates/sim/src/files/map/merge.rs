//! Occupied cells as few rectangles.

use std::ops::Range;

use super::cells::Cells;

/// A rectangle of cells: columns `left..right`, rows `bottom..top`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) left: usize,
    pub(super) right: usize,
    pub(super) bottom: usize,
    pub(super) top: usize,
}

impl Block {
    pub(super) fn width(&self) -> usize {
        self.right - self.left
    }

    pub(super) fn height(&self) -> usize {
        self.top - self.bottom
    }
}

/// Rectangles that cover the occupied cells, each cell once; none if they are more than `most`.
///
/// Greedy: from below, every first cell still uncovered becomes the corner of a rectangle, grown first to the right and
/// then up, or first up and then to the right, whichever covers more.
pub(super) fn blocks(cells: &Cells, most: usize) -> Option<Vec<Block>> {
    let mut left = cells.clone();
    let mut found = Vec::new();
    for row in 0..cells.n_rows {
        let mut column = 0;
        while let Some(next) = left.row(row)[column..].iter().position(|occupied| *occupied) {
            column += next;
            if found.len() == most {
                return None;
            }
            let block = largest(&left, column, row);
            for row in block.bottom..block.top {
                left.occupied[row * cells.n_columns..][block.left..block.right].fill(false);
            }
            column = block.right;
            found.push(block);
        }
    }
    Some(found)
}

/// The larger of the two rectangles up and right of an occupied cell. Looks at no more cells than a few times those of
/// the rectangle and one row and one column, so that all rectangles of a map together take time in proportion to the
/// map.
fn largest(cells: &Cells, left: usize, bottom: usize) -> Block {
    let is_full = |columns: Range<usize>, row: usize| cells.row(row)[columns].iter().all(|occupied| *occupied);
    let right = (left..cells.n_columns).find(|column| !cells.row(bottom)[*column]).unwrap_or(cells.n_columns);
    let top = (bottom..cells.n_rows).find(|row| !cells.row(*row)[left]).unwrap_or(cells.n_rows);
    let wide_top = (bottom + 1..top).find(|row| !is_full(left..right, *row)).unwrap_or(top);
    let is_standing = |column: usize| (bottom..top).all(|row| cells.row(row)[column]);
    let tall_right = (left + 1..right).find(|column| !is_standing(*column)).unwrap_or(right);
    let wide = Block { left, right, bottom, top: wide_top };
    let tall = Block { left, right: tall_right, bottom, top };
    let area = |block: &Block| block.width() * block.height();
    if area(&tall) > area(&wide) { tall } else { wide }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cells(picture: &[&str]) -> Cells {
        let occupied = picture.iter().rev().flat_map(|row| row.bytes().map(|byte| byte == b'#')).collect();
        Cells { n_columns: picture[0].len(), n_rows: picture.len(), occupied }
    }

    #[test]
    fn walls_become_one_block_each() {
        let room = cells(&["######", "#....#", "#....#", "######"]);
        assert_eq!(blocks(&room, 10).unwrap().len(), 4);
        let corner = cells(&["#.....", "#.....", "#.....", "######"]);
        assert_eq!(blocks(&corner, 10).unwrap().len(), 2);
        assert_eq!(blocks(&corner, 1), None);
    }

    proptest! {
        #[test]
        fn every_cell_is_covered_once(n_columns in 1..20_usize, occupied in prop::collection::vec(any::<bool>(), 20..200)) {
            let n_rows = occupied.len() / n_columns;
            let cells = Cells { n_columns, n_rows, occupied: occupied[..n_rows * n_columns].to_vec() };
            let mut covered = vec![0; n_rows * n_columns];
            for block in blocks(&cells, usize::MAX).unwrap() {
                for row in block.bottom..block.top {
                    (block.left..block.right).for_each(|column| covered[row * n_columns + column] += 1);
                }
            }
            let expected: Vec<_> = cells.occupied.iter().map(|occupied| i32::from(*occupied)).collect();
            prop_assert_eq!(covered, expected);
        }
    }
}
