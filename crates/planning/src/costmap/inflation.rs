//! Spreading costs around marks.

use crate::scan_map::Area;
use crate::{CostmapSpec, ScanMap};
use serde::{Deserialize, Serialize};

/// The costs around one marked cell.
///
/// Costs fall with distance, so the greatest cost that any mark gives a cell is that of the nearest: a maximum over marks
/// is an exact Euclidean distance transform.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Kernel {
    /// In cells, to each side.
    radius: usize,
    /// `2 radius + 1` rows of [`Self::stride`] costs each, zeros at their ends.
    costs: Vec<u8>,
}

/// How many costs are compared at once.
const LANES: usize = 16;

impl Kernel {
    pub(super) fn new(spec: &CostmapSpec, inradius: f64) -> Self {
        let reach = spec.inflation_radius.max(inradius) / spec.map.cell;
        let radius = (reach + 1e-9) as usize;
        let mut kernel = Self { radius, costs: Vec::new() };
        let n = 2 * radius + 1;
        for row in 0..n {
            for column in 0..kernel.stride() {
                let (x, y) = (column as f64 - radius as f64, row as f64 - radius as f64);
                kernel.costs.push(if column < n { spec.cost(x.hypot(y) * spec.map.cell, inradius) } else { 0 });
            }
        }
        kernel
    }

    /// Costs per row.
    pub(super) fn stride(&self) -> usize {
        (2 * self.radius + 1).next_multiple_of(LANES)
    }

    /// Costs anew whatever the marks of a changed area may have cost.
    pub(super) fn inflate(&self, map: &ScanMap, changed: Area, costs: &mut [u8]) {
        let window = map.window();
        let (columns, rows) = changed.grown(self.radius, window);
        for row in rows {
            let start = row * window.n_x;
            costs[start + columns.start..start + columns.end].fill(0);
        }
        let (columns, rows) = changed.grown(2 * self.radius, window);
        for row in rows {
            for column in map.marks(row, columns.clone()) {
                self.stamp((window.n_x, window.n_y), (column, row), costs);
            }
        }
    }

    /// Raises the costs around a cell.
    fn stamp(&self, (n_x, n_y): (usize, usize), (column, row): (usize, usize), costs: &mut [u8]) {
        let (radius, stride) = (self.radius, self.stride());
        let is_inside = column >= radius && column + radius < n_x;
        for k in radius.saturating_sub(row)..(2 * radius + 1).min(n_y + radius - row) {
            let start = (row + k - radius) * n_x;
            let kernel = &self.costs[k * stride..(k + 1) * stride];
            if is_inside {
                // The zeros at the end of the kernel's row may lie over the next row, and change nothing there.
                let costs = &mut costs[start + column - radius..][..stride];
                for (costs, kernel) in costs.chunks_exact_mut(LANES).zip(kernel.chunks_exact(LANES)) {
                    raise(costs, kernel);
                }
            } else {
                let (low, high) = (column.saturating_sub(radius), (column + radius + 1).min(n_x));
                raise(&mut costs[start + low..start + high], &kernel[low + radius - column..]);
            }
        }
    }
}

#[inline]
fn raise(costs: &mut [u8], kernel: &[u8]) {
    for (cost, more) in costs.iter_mut().zip(kernel) {
        *cost = (*cost).max(*more);
    }
}
