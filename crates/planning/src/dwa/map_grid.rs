//! Distances to the route and to the local goal, counted around what is closed.

use headway_sim::{Point, Pose};

use crate::Route;
use crate::costmap::{Costmap, INSCRIBED};
use crate::scan_map::Window;

/// For each cell of a window, the steps to the route and to its last point within the window (`base_local_planner::MapGrid`).
#[derive(Debug, Clone, Default)]
pub(super) struct MapGrid {
    to_path: Vec<u16>,
    to_goal: Vec<u16>,
    /// Which cells a wave may enter: [`OPEN`] or [`SHUT`].
    blank: Vec<u16>,
    queue: Vec<u32>,
    path: Vec<usize>,
}

const OPEN: u16 = u16::MAX;
const SHUT: u16 = u16::MAX - 1;

impl MapGrid {
    /// Spreads the waves anew.
    pub(super) fn set(&mut self, costmap: &Costmap, pose: &Pose, route: &Route) {
        let window = *costmap.window();
        self.shut(costmap, pose);
        self.lay_path(costmap, pose, route);
        let local_goal = self.path.iter().rev().find(|cell| costmap.costs()[**cell] < INSCRIBED);
        let local_goal = local_goal.or(self.path.last()).copied();
        spread(&self.blank, &self.path, window.n_x, &mut self.queue, &mut self.to_path);
        spread(&self.blank, local_goal.as_slice(), window.n_x, &mut self.queue, &mut self.to_goal);
    }

    /// Shuts the outermost cells and those that cost 253 or more; the vehicle's own cells stay open.
    fn shut(&mut self, costmap: &Costmap, pose: &Pose) {
        let window = costmap.window();
        let (n_x, n_y) = (window.n_x, window.n_y);
        self.blank.clear();
        let state = |cost: &u8| if *cost < INSCRIBED { OPEN } else { SHUT };
        self.blank.extend(costmap.costs()[..n_x * n_y].iter().map(state));
        if let Some(own) = costmap.outline() {
            let here = Point::from(pose.translation.vector);
            for row in window.rows_near(&here, own.circumradius()) {
                for column in window.columns_near(&here, own.circumradius()) {
                    if own.contains(&pose.inverse_transform_point(&window.center((column, row)))) {
                        self.blank[window.index((column, row))] = OPEN;
                    }
                }
            }
        }
        self.blank[..n_x].fill(SHUT);
        self.blank[n_x * (n_y - 1)..].fill(SHUT);
        for row in self.blank.chunks_exact_mut(n_x) {
            (row[0], row[n_x - 1]) = (SHUT, SHUT);
        }
    }

    /// The cells of the route from beside the vehicle on, as long as it stays within the window.
    fn lay_path(&mut self, costmap: &Costmap, pose: &Pose, route: &Route) {
        let window = costmap.window();
        let step = costmap.spec().map.cell / 2.0;
        let along = route.project(&pose.translation.vector.into());
        let n = ((route.length() - along) / step).clamp(0.0, 1e5) as usize + 1;
        self.path.clear();
        for k in 0..=n {
            match inner_cell(window, &route.at(along + k as f64 * step)) {
                Some(cell) if self.path.last() == Some(&cell) => {}
                Some(cell) => self.path.push(cell),
                None if self.path.is_empty() => {}
                None => break,
            }
        }
        if self.path.is_empty() {
            // The route lies outside: the way leads to where it is nearest.
            let (column, row) = window.nearest_cell(&route.at(along));
            let inner = |at: usize, n: usize| at.clamp(1, n.max(3) - 2);
            self.path.push(window.index((inner(column, window.n_x), inner(row, window.n_y))));
        }
    }

    /// Steps from a cell to the route and to the local goal, if there is a way.
    #[inline]
    pub(super) fn distances(&self, cell: usize) -> Option<(u16, u16)> {
        let (path, goal) = (self.to_path[cell], self.to_goal[cell]);
        (path < SHUT && goal < SHUT).then_some((path, goal))
    }

    /// Steps from a cell to the local goal; very many if there is no way.
    pub(super) fn to_goal(&self, cell: usize) -> u16 {
        self.to_goal[cell].min(SHUT)
    }
}

/// The cell that holds a point, unless it is one of the outermost.
fn inner_cell(window: &Window, point: &Point) -> Option<usize> {
    let (column, row) = window.cell_of(point)?;
    let is_inner = column > 0 && row > 0 && column + 1 < window.n_x && row + 1 < window.n_y;
    is_inner.then(|| window.index((column, row)))
}

/// Counts the steps from the nearest source to each cell that is open; the outermost cells must be shut.
fn spread(blank: &[u16], sources: &[usize], n_x: usize, queue: &mut Vec<u32>, steps: &mut Vec<u16>) {
    steps.clear();
    steps.extend_from_slice(blank);
    queue.clear();
    for source in sources {
        steps[*source] = 0;
        queue.push(*source as u32);
    }
    let mut next = 0;
    while next < queue.len() {
        let here = queue[next] as usize;
        next += 1;
        let beyond = steps[here].saturating_add(1).min(SHUT - 1);
        for cell in [here - 1, here + 1, here - n_x, here + n_x] {
            if steps[cell] == OPEN {
                steps[cell] = beyond;
                queue.push(cell as u32);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_go_round_what_is_shut() {
        // Seven columns and five rows; a bar in the middle column, open at its upper end.
        let n_x = 7;
        let is_shut = |k: usize| !(7..28).contains(&k) || [0, 6].contains(&(k % 7)) || [10, 17].contains(&k);
        let blank: Vec<_> = (0..35).map(|k| if is_shut(k) { SHUT } else { OPEN }).collect();
        let (mut queue, mut steps) = (Vec::new(), Vec::new());
        spread(&blank, &[9], n_x, &mut queue, &mut steps);
        let rows: Vec<_> = (1..4).map(|row| steps[row * 7 + 1..row * 7 + 6].to_vec()).collect();
        assert_eq!(rows, [[1, 0, SHUT, 6, 7], [2, 1, SHUT, 5, 6], [3, 2, 3, 4, 5]]);
    }
}
