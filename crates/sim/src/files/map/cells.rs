//! Cells of a map, occupied or not.

/// A raster of cells, each occupied or not; column 0 is at the left, row 0 at the bottom.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cells {
    pub(super) n_columns: usize,
    pub(super) n_rows: usize,
    /// Row by row.
    pub(super) occupied: Vec<bool>,
}

impl Cells {
    pub(super) fn empty(n_columns: usize, n_rows: usize) -> Self {
        Self { n_columns, n_rows, occupied: vec![false; n_columns * n_rows] }
    }

    pub(super) fn row(&self, row: usize) -> &[bool] {
        &self.occupied[row * self.n_columns..][..self.n_columns]
    }

    pub(super) fn occupy(&mut self, column: usize, row: usize) {
        self.occupied[row * self.n_columns + column] = true;
    }
}
