//! A* over a costmap.

use serde::{Deserialize, Serialize};
use std::ops::Range;

use headway_sim::Point;

use crate::costmap::{Costmap, INSCRIBED};
use crate::scan_map::Window;

/// What a step costs, in whole numbers, by the cost of the cell stepped into.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Weights {
    /// For costs 0 to 255; [`CLOSED`] from 253 up.
    by_cost: Vec<u32>,
    /// Of a cell next to the vehicle or its goal that would be closed.
    dear: u32,
}

/// The weight of a cell that cannot be entered.
pub(super) const CLOSED: u32 = u32::MAX;
/// The weight of a cell near which nothing is.
const NEUTRAL: u32 = 16;
/// A straight step times its weight; a diagonal one, 17/12 = 1.4167 times as long.
const STRAIGHT: u32 = 12;
const DIAGONAL: u32 = 17;

impl Weights {
    pub(super) fn new(neutral_cost: f64, cost_factor: f64) -> Self {
        let weight =
            |cost: usize| (f64::from(NEUTRAL) * (1.0 + cost_factor * cost as f64 / neutral_cost)).round() as u32;
        let by_cost = (0..256).map(|cost| if cost >= usize::from(INSCRIBED) { CLOSED } else { weight(cost) }).collect();
        Self { by_cost, dear: 4 * weight(252) }
    }
}

/// A costmap as a search sees it.
pub(super) struct Grid<'a> {
    pub(super) window: Window,
    costs: &'a [u8],
    weights: &'a Weights,
    /// Cells around the start and the goal that are never closed: middle and squared radius, in cells.
    open: [([i64; 2], f64); 2],
    /// Side of a cell, metres.
    cell: f64,
}

impl<'a> Grid<'a> {
    pub(super) fn new(costmap: &'a Costmap, weights: &'a Weights, ends: [(usize, usize); 2], reach: f64) -> Self {
        let window = *costmap.window();
        let cell = costmap.spec().map.cell;
        let radius = reach / cell;
        let open = ends.map(|(column, row)| ([column as i64, row as i64], radius * radius));
        Self { window, costs: costmap.costs(), weights, open, cell }
    }

    #[inline]
    pub(super) fn weight(&self, index: usize) -> u32 {
        let weight = self.weights.by_cost[usize::from(self.costs[index])];
        if weight == CLOSED { self.weight_near_ends(index) } else { weight }
    }

    #[cold]
    fn weight_near_ends(&self, index: usize) -> u32 {
        let (column, row) = ((index % self.window.n_x) as i64, (index / self.window.n_x) as i64);
        let is_near = |([x, y], square): &([i64; 2], f64)| ((column - x).pow(2) + (row - y).pow(2)) as f64 <= *square;
        if self.open.iter().any(is_near) { self.weights.dear } else { CLOSED }
    }

    /// The weight of the cell that holds a point; closed outside the window.
    pub(super) fn weight_at(&self, point: &Point) -> u32 {
        self.window.cell_of(point).map_or(CLOSED, |cell| self.weight(self.window.index(cell)))
    }

    /// Distance between samples of a line, metres.
    pub(super) fn sample(&self) -> f64 {
        self.cell / 2.0
    }

    /// The most that a step can cost.
    fn dearest_step(&self) -> u32 {
        self.weights.dear * DIAGONAL
    }
}

/// The tables of a search, kept from one to the next.
///
/// Cells wait in buckets by the whole cost of a way through them, a quarter of a neutral step wide; of those in a bucket, the one
/// that came last is next. The way found may be dearer than the best by less than that.
#[derive(Debug, Clone, Default)]
pub(super) struct Search {
    /// Which search a cell's entry belongs to.
    stamps: Vec<u32>,
    stamp: u32,
    reached: Vec<u32>,
    /// The step that led to each cell, as an index into the neighbours.
    steps: Vec<u8>,
    buckets: Vec<Vec<(u32, u32)>>,
    path: Vec<usize>,
}

const BUCKET: u32 = NEUTRAL * STRAIGHT / 4;

impl Search {
    /// The cells of a cheapest way between two cells, both included.
    pub(super) fn run(&mut self, grid: &Grid<'_>, from: (usize, usize), to: (usize, usize)) -> Option<&[usize]> {
        let window = &grid.window;
        self.prepare(window.n_x * window.n_y, grid.dearest_step());
        let n_x = window.n_x as isize;
        let (start, goal) = (window.index(from), window.index(to));
        let neighbours: [(isize, isize); 8] = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];
        let offsets = neighbours.map(|(dx, dy)| dy * n_x + dx);
        let mask = self.buckets.len() - 1;
        (self.stamps[start], self.reached[start]) = (self.stamp, 0);
        let mut bucket = (heuristic(from, to) / BUCKET) as usize;
        self.buckets[bucket & mask].push((start as u32, 0));
        let (mut n_empty, interior) = (0, [1..window.n_x - 1, 1..window.n_y - 1]);
        while n_empty <= mask {
            let Some((here, cost)) = self.buckets[bucket & mask].pop() else {
                (bucket, n_empty) = (bucket + 1, n_empty + 1);
                continue;
            };
            n_empty = 0;
            let here = here as usize;
            if cost > self.reached[here] {
                continue; // a better way here was found since
            }
            if here == goal {
                return Some(self.trace(start, goal, &offsets));
            }
            let (column, row) = (here % window.n_x, here / window.n_x);
            if !is_within(&interior, (column, row)) {
                continue; // the outermost cells have no neighbours: they lie a raytrace range away from all that matters
            }
            let weights = offsets.map(|offset| grid.weight(here.wrapping_add_signed(offset)));
            for (k, &(dx, dy)) in neighbours.iter().enumerate() {
                let cuts_a_corner =
                    k >= 4 && (weights[usize::from(dx < 0)] == CLOSED || weights[2 + usize::from(dy < 0)] == CLOSED);
                if weights[k] == CLOSED || cuts_a_corner {
                    continue;
                }
                let next = here.wrapping_add_signed(offsets[k]);
                let through = cost + weights[k] * if k < 4 { STRAIGHT } else { DIAGONAL };
                if self.stamps[next] == self.stamp && self.reached[next] <= through {
                    continue;
                }
                (self.stamps[next], self.reached[next], self.steps[next]) = (self.stamp, through, k as u8);
                let place = (column.wrapping_add_signed(dx), row.wrapping_add_signed(dy));
                let whole = ((through + heuristic(place, to)) / BUCKET) as usize;
                self.buckets[whole.max(bucket) & mask].push((next as u32, through));
            }
        }
        None
    }

    fn prepare(&mut self, n_cells: usize, dearest_step: u32) {
        if self.stamps.len() != n_cells || self.stamp == u32::MAX {
            self.stamps.clear();
            self.stamps.resize(n_cells, 0);
            self.reached.resize(n_cells, 0);
            self.steps.resize(n_cells, 0);
            self.stamp = 0;
        }
        self.stamp += 1;
        // A step raises the whole cost by what it costs and by what the heuristic may rise.
        let n_buckets = ((dearest_step + NEUTRAL * DIAGONAL) / BUCKET + 2).next_power_of_two() as usize;
        self.buckets.resize(n_buckets, Vec::new());
        self.buckets.iter_mut().for_each(Vec::clear);
    }

    fn trace(&mut self, start: usize, goal: usize, offsets: &[isize; 8]) -> &[usize] {
        self.path.clear();
        let mut here = goal;
        self.path.push(here);
        while here != start {
            here = here.wrapping_add_signed(-offsets[usize::from(self.steps[here])]);
            self.path.push(here);
        }
        self.path.reverse();
        &self.path
    }
}

fn is_within(ranges: &[Range<usize>; 2], (column, row): (usize, usize)) -> bool {
    ranges[0].contains(&column) && ranges[1].contains(&row)
}

/// The cost of the shortest way between two cells where nothing is near.
fn heuristic(a: (usize, usize), b: (usize, usize)) -> u32 {
    let (dx, dy) = (a.0.abs_diff(b.0) as u32, a.1.abs_diff(b.1) as u32);
    NEUTRAL * (STRAIGHT * dx.max(dy) + (DIAGONAL - STRAIGHT) * dx.min(dy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CostmapSpec, Sensed};
    use headway_sim::{Pose, Twist, VehicleSpec};
    use proptest::prelude::*;

    /// Dijkstra without a heuristic or a queue: the least cost of getting to each cell.
    fn slow_costs(grid: &Grid<'_>, start: usize) -> Vec<u32> {
        let (n_x, n_y) = (grid.window.n_x, grid.window.n_y);
        let mut reached = vec![CLOSED; n_x * n_y];
        reached[start] = 0;
        let mut changed = true;
        while std::mem::take(&mut changed) {
            for here in (0..n_x * n_y).filter(|here| is_within(&[1..n_x - 1, 1..n_y - 1], (here % n_x, here / n_x))) {
                for (dx, dy) in [(0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (-1, 1), (1, -1), (-1, -1)] {
                    let at = |dx: isize, dy: isize| here.wrapping_add_signed(dy * n_x as isize + dx);
                    let is_closed = |index| grid.weight(index) == CLOSED;
                    if reached[here] == CLOSED || is_closed(at(dx, dy)) || is_closed(at(dx, 0)) || is_closed(at(0, dy))
                    {
                        continue;
                    }
                    let length = if dx != 0 && dy != 0 { DIAGONAL } else { STRAIGHT };
                    let through = reached[here] + grid.weight(at(dx, dy)) * length;
                    if through < reached[at(dx, dy)] {
                        (reached[at(dx, dy)], changed) = (through, true);
                    }
                }
            }
        }
        reached
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8))]
        #[test]
        fn ways_are_as_cheap_as_can_be(
            scan in prop::collection::vec(prop_oneof![0.5..3.0_f32, Just(5.0_f32)], 30),
            goal in (-3.0..3.0, -3.0..3.0),
        ) {
            let vehicle = VehicleSpec::default();
            let angles: Vec<_> = (0..30).map(|k| f64::from(k) * 0.21).collect();
            let (pose, goal) = (Pose::identity(), Point::new(goal.0, goal.1));
            let sensed = Sensed {
                vehicle: &vehicle, scan: &scan, beam_angles: &angles, max_range: 5.0,
                pose, twist: Twist::zeros(), goal, route: None, last_command: headway_sim::Command::default(), movers: &[],
            };
            let mut costmap = CostmapSpec::default().build().unwrap();
            costmap.update(&sensed);
            let window = *costmap.window();
            let ends = [Point::origin(), goal].map(|point| window.nearest_cell(&point));
            let weights = Weights::new(50.0, 0.8);
            let grid = Grid::new(&costmap, &weights, ends, 0.4);
            let mut search = Search::default();
            let slow = slow_costs(&grid, window.index(ends[0]))[window.index(ends[1])];
            // The second search finds what the first left behind.
            for _ in 0..2 {
                let found = search.run(&grid, ends[0], ends[1]).map(<[usize]>::to_vec);
                prop_assert_eq!(found.is_some(), slow != CLOSED);
                let Some(cells) = found else { continue };
                let step = |pair: &[usize]| {
                    let is_straight = matches!(pair[0].abs_diff(pair[1]), 1) || pair[0].abs_diff(pair[1]) == window.n_x;
                    grid.weight(pair[1]) * if is_straight { STRAIGHT } else { DIAGONAL }
                };
                let cost: u32 = cells.windows(2).map(step).sum();
                prop_assert!(cost >= slow && cost < slow + BUCKET, "{cost} {slow}");
            }
        }
    }
}
