//! The part of the plane that a map covers.

use serde::{Deserialize, Serialize};
use std::ops::Range;

use headway_sim::Point;
use nalgebra::Vector2;

use super::ScanMapSpec;

/// A rectangle of cells of a grid over the whole plane, one of whose corners is the origin.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Window {
    /// Side of a cell, metres; 0 before the first scan.
    cell: f64,
    /// The least column and row, counted from the origin.
    first: [i64; 2],
    pub(crate) n_x: usize,
    pub(crate) n_y: usize,
}

impl Window {
    pub(crate) fn corner(&self) -> Point {
        Point::new(self.first[0] as f64, self.first[1] as f64) * self.cell
    }

    /// A point in units of cells, counted from the window's corner.
    pub(crate) fn in_cells(&self, point: &Point) -> Vector2<f64> {
        point.coords / self.cell - Vector2::new(self.first[0] as f64, self.first[1] as f64)
    }

    /// The cell that holds a point, if it is within the window.
    pub(crate) fn cell_of(&self, point: &Point) -> Option<(usize, usize)> {
        let at = self.in_cells(point);
        let is_within = at.x >= 0.0 && at.y >= 0.0 && at.x < self.n_x as f64 && at.y < self.n_y as f64;
        is_within.then_some((at.x as usize, at.y as usize))
    }

    /// The cell of the window that is nearest to a point.
    pub(crate) fn nearest_cell(&self, point: &Point) -> (usize, usize) {
        let at = self.in_cells(point);
        let index = |x: f64, n: usize| (x.max(0.0) as usize).min(n.saturating_sub(1));
        (index(at.x, self.n_x), index(at.y, self.n_y))
    }

    pub(crate) fn index(&self, (column, row): (usize, usize)) -> usize {
        row * self.n_x + column
    }

    pub(crate) fn center(&self, (column, row): (usize, usize)) -> Point {
        self.corner() + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * self.cell
    }

    /// The index of a place given in units of cells.
    pub(super) fn index_at(&self, at: &Vector2<f64>) -> usize {
        self.index((at.x.max(0.0) as usize, at.y.max(0.0) as usize))
    }

    /// How far a ray can go, in units of cells, without leaving the window or its outermost cells; 0 if it starts there.
    pub(super) fn ray_length(&self, origin: &Vector2<f64>, direction: &Vector2<f64>) -> f64 {
        let along = |at: f64, rate: f64, n: usize| {
            let border = if rate > 0.0 { n as f64 - 1.0 } else { 1.0 };
            if rate == 0.0 { f64::INFINITY } else { (border - at) / rate }
        };
        along(origin.x, direction.x, self.n_x).min(along(origin.y, direction.y, self.n_y)).max(0.0)
    }

    pub(crate) fn columns_near(&self, point: &Point, reach: f64) -> Range<usize> {
        span(self.in_cells(point).x, reach / self.cell, self.n_x)
    }

    pub(crate) fn rows_near(&self, point: &Point, reach: f64) -> Range<usize> {
        span(self.in_cells(point).y, reach / self.cell, self.n_y)
    }

    /// A window that covers the vehicle and its goal with `reach` metres around both, this one where it does; around
    /// the vehicle alone where that would be too much.
    pub(super) fn grown(&self, spec: &ScanMapSpec, reach: f64, here: &Point, goal: &Point) -> Self {
        let block = (1.0 / spec.cell).ceil().max(1.0);
        let axis = |k: usize, n: usize| {
            let to_blocks = |x: f64| x / (spec.cell * block);
            let reach = reach + 2.0 * spec.cell;
            let (low, high) = (here[k].min(goal[k]) - reach, here[k].max(goal[k]) + reach);
            let (mut low, mut high) = (to_blocks(low).floor(), to_blocks(high).ceil());
            let blocks = block as i64;
            if n > 0 {
                low = low.min((self.first[k] / blocks) as f64);
                high = high.max(((self.first[k] + n as i64) / blocks) as f64);
            }
            let most = to_blocks(spec.max_size).floor().max(1.0);
            if high - low > most {
                low = (to_blocks(here[k]) - most / 2.0).round();
                high = low + most;
            }
            (low as i64 * blocks, ((high - low) * block) as usize)
        };
        let ((x, n_x), (y, n_y)) = (axis(0, self.n_x), axis(1, self.n_y));
        Self { cell: spec.cell, first: [x, y], n_x, n_y }
    }

    /// Copies what two windows have in common.
    pub(super) fn copy_from(&self, cells: &mut [u8], old: &Self, before: &[u8]) {
        let common = |k: usize, n: usize, n_old: usize| {
            let low = self.first[k].max(old.first[k]);
            low..(self.first[k] + n as i64).min(old.first[k] + n_old as i64).max(low)
        };
        let (columns, rows) = (common(0, self.n_x, old.n_x), common(1, self.n_y, old.n_y));
        let n = (columns.end - columns.start) as usize;
        if n == 0 {
            return;
        }
        for row in rows {
            let at = |window: &Self| {
                (row - window.first[1]) as usize * window.n_x + (columns.start - window.first[0]) as usize
            };
            let (to, from) = (at(self), at(old));
            cells[to..to + n].copy_from_slice(&before[from..from + n]);
        }
    }
}

/// The cells of an axis that come within `reach` of a place, all in units of cells.
fn span(at: f64, reach: f64, n: usize) -> Range<usize> {
    let high = ((at + reach).floor().max(-1.0) + 1.0) as usize;
    ((at - reach).max(0.0) as usize).min(n)..high.min(n)
}

/// A rectangle of cells, borders included.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Area {
    low: [usize; 2],
    high: [usize; 2],
}

impl Area {
    /// Makes an area hold a cell.
    #[inline]
    pub(crate) fn add(area: &mut Option<Self>, (column, row): (usize, usize)) {
        let at = area.get_or_insert(Self { low: [column, row], high: [column, row] });
        at.low = [at.low[0].min(column), at.low[1].min(row)];
        at.high = [at.high[0].max(column), at.high[1].max(row)];
    }

    /// Columns and rows of the area and of `by` cells around it, within a window.
    pub(crate) fn grown(&self, by: usize, window: &Window) -> (Range<usize>, Range<usize>) {
        let axis = |k: usize, n: usize| self.low[k].saturating_sub(by)..(self.high[k] + by + 1).min(n);
        (axis(0, window.n_x), axis(1, window.n_y))
    }

    /// All of a window.
    pub(crate) fn whole(window: &Window) -> Option<Self> {
        let high = [window.n_x.checked_sub(1)?, window.n_y.checked_sub(1)?];
        Some(Self { low: [0, 0], high })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_grows_by_blocks_and_moves_on_when_full() {
        let spec = ScanMapSpec { max_size: 20.0, ..ScanMapSpec::default() };
        let goal = Point::new(10.0, 0.5);
        let first = Window::default().grown(&spec, 3.0, &Point::new(0.5, 0.5), &goal);
        // From 0.5 - 3.1 to 10 + 3.1 m along x, from -2.6 to 3.6 m along y.
        assert_eq!((first.first, first.n_x, first.n_y), ([-60, -60], 340, 140));
        assert_eq!(first.grown(&spec, 3.0, &Point::new(5.0, 0.7), &goal), first);
        let higher = first.grown(&spec, 3.0, &Point::new(5.0, 1.5), &goal);
        assert_eq!((higher.first, higher.n_y), ([-60, -60], 160));
        let far = higher.grown(&spec, 3.0, &Point::new(18.2, 1.5), &goal);
        assert_eq!((far.first[0], far.n_x), (160, 400));
        let lost = higher.grown(&spec, 3.0, &Point::new(5.0, 1.5), &Point::new(f64::NAN, 1e300));
        assert_eq!((lost.n_x.max(lost.n_y)), 400);
    }

    #[test]
    fn what_is_known_stays_where_it_is() {
        let spec = ScanMapSpec { max_size: 8.0, ..ScanMapSpec::default() };
        let here = Point::new(0.0, 0.0);
        let old = Window::default().grown(&spec, 3.0, &here, &here);
        let new = old.grown(&spec, 3.0, &Point::new(2.0, -3.0), &here);
        let place = Point::new(1.52, -1.33);
        let mut before = vec![0; old.n_x * old.n_y];
        before[old.index(old.cell_of(&place).unwrap())] = 2;
        let mut cells = vec![0; new.n_x * new.n_y];
        new.copy_from(&mut cells, &old, &before);
        assert_eq!(cells[new.index(new.cell_of(&place).unwrap())], 2);
        assert_eq!(cells.iter().filter(|state| **state == 2).count(), 1);
    }
}
