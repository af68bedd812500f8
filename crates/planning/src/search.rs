//! A* on a grid map.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::SQRT_2;

use headway_sim::Point;

use crate::grid::Cell;
use crate::{GridMap, Route};

/// A shortest way from `start` to `goal` over a map's free cells, pulled straight; `None` if there is
/// none.
///
/// A* (Hart, Nilsson, Raphael 1968) over eight neighbours, diagonals only where both cells beside them
/// are free. The heuristic is the octile distance and a millionth more, by which the way found may be longer than the
/// shortest of the grid. Then corners that are not needed are left out as long
/// as [`GridMap::sees`] allows. A start or goal in a blocked cell is joined to the nearest free one.
#[must_use]
pub fn plan(map: &GridMap, start: &Point, goal: &Point) -> Option<Route> {
    if map.sees(start, goal) {
        return Some(Route::new(vec![*start, *goal]));
    }
    let (from, to) = (map.nearest_free(start)?, map.nearest_free(goal)?);
    let cells = search(map, from, to)?;
    let mut points = vec![*start];
    points.extend(cells.into_iter().map(|cell| map.center(cell)));
    points.push(*goal);
    Some(Route::new(straighten(map, &points)))
}

/// The cells from `from` to `to`, both included.
fn search(map: &GridMap, from: Cell, to: Cell) -> Option<Vec<Cell>> {
    let (n_x, n_y) = map.size();
    let index = |(column, row): Cell| row * n_x + column;
    let mut cost = vec![f64::INFINITY; n_x * n_y];
    let mut parent = vec![from; n_x * n_y];
    cost[index(from)] = 0.0;
    let mut open = BinaryHeap::from([entry(heuristic(from, to), from)]);
    while let Some((Reverse(bits), here)) = open.pop() {
        if here == to {
            return Some(trace(&parent, from, to, index));
        }
        if f64::from_bits(bits) > cost[index(here)] + heuristic(here, to) {
            continue; // a better way here was found since
        }
        for (next, length) in neighbours(map, here) {
            let through = cost[index(here)] + length;
            if through < cost[index(next)] {
                cost[index(next)] = through;
                parent[index(next)] = here;
                open.push(entry(through + heuristic(next, to), next));
            }
        }
    }
    None
}

/// A heap entry; the bits of numbers from 0 up sort as the numbers do.
fn entry(priority: f64, cell: Cell) -> (Reverse<u64>, Cell) {
    (Reverse(priority.to_bits()), cell)
}

/// The octile distance, in cells, and a millionth more: of cells with equal promise, the search goes on from that nearest to
/// the goal.
fn heuristic(a: Cell, b: Cell) -> f64 {
    octile(a, b) * (1.0 + 1e-6)
}

/// The length of the shortest way between two cells where all are free, in cells.
fn octile(a: Cell, b: Cell) -> f64 {
    let (dx, dy) = (a.0.abs_diff(b.0) as f64, a.1.abs_diff(b.1) as f64);
    dx.max(dy) + (SQRT_2 - 1.0) * dx.min(dy)
}

fn neighbours(map: &GridMap, (column, row): Cell) -> impl Iterator<Item = (Cell, f64)> {
    let (n_x, n_y) = map.size();
    let at = move |dx: isize, dy: isize| {
        let cell = (column.checked_add_signed(dx)?, row.checked_add_signed(dy)?);
        (cell.0 < n_x && cell.1 < n_y && !map.is_blocked(cell)).then_some(cell)
    };
    let offsets = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];
    offsets.into_iter().filter_map(move |(dx, dy)| {
        let cuts_a_corner = dx != 0 && dy != 0 && (at(dx, 0).is_none() || at(0, dy).is_none());
        let length = if dx != 0 && dy != 0 { SQRT_2 } else { 1.0 };
        if cuts_a_corner { None } else { at(dx, dy).map(|cell| (cell, length)) }
    })
}

fn trace(parent: &[Cell], from: Cell, to: Cell, index: impl Fn(Cell) -> usize) -> Vec<Cell> {
    let mut cells = vec![to];
    let mut here = to;
    while here != from {
        here = parent[index(here)];
        cells.push(here);
    }
    cells.reverse();
    cells
}

/// Leaves out the points that can be passed by in a straight line, from the start on.
fn straighten(map: &GridMap, points: &[Point]) -> Vec<Point> {
    let mut kept = vec![points[0]];
    let mut here = 0;
    while here + 1 < points.len() {
        let farthest = (here + 2..points.len()).take_while(|&k| map.sees(&points[here], &points[k])).last();
        here = farthest.unwrap_or(here + 1);
        kept.push(points[here]);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_sim::{Footprint, Obstacle, Room, Shape, World, WorldSpec};

    /// Dijkstra without a heuristic or a heap: the length of the shortest way in cells.
    fn slow_length(map: &GridMap, from: Cell, to: Cell) -> Option<f64> {
        let (n_x, n_y) = map.size();
        let mut cost = vec![f64::INFINITY; n_x * n_y];
        cost[from.1 * n_x + from.0] = 0.0;
        for _ in 0..n_x * n_y {
            let mut changed = false;
            for row in 0..n_y {
                for column in 0..n_x {
                    let here = cost[row * n_x + column];
                    for (next, length) in neighbours(map, (column, row)) {
                        let slot = &mut cost[next.1 * n_x + next.0];
                        if here + length < *slot - 1e-12 {
                            *slot = here + length;
                            changed = true;
                        }
                    }
                }
            }
            if !changed {
                break;
            }
        }
        Some(cost[to.1 * n_x + to.0]).filter(|c| c.is_finite())
    }

    #[test]
    fn finds_the_shortest_way_of_the_grid() {
        let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
        let source = WorldSpec::default().build(&vehicle).unwrap();
        for k in 0..5 {
            let scenario = source.scenario(2, k).unwrap();
            let map = GridMap::from_world(&scenario.world, 0.25, 0.3);
            let from = map.cell_of(&scenario.start.translation.vector.into());
            let to = map.cell_of(&scenario.goal);
            let length =
                search(&map, from, to).map(|cells| cells.windows(2).map(|pair| octile(pair[0], pair[1])).sum::<f64>());
            let slow = slow_length(&map, from, to);
            assert!((length.unwrap() - slow.unwrap()).abs() < 1e-9);
        }
    }

    #[test]
    fn goes_round_a_barrier_and_knows_when_it_cannot() {
        let barrier = |width| {
            let shape = Shape::Box { length: 0.2, width };
            let obstacle = Obstacle { shape, x: 5.0, y: width / 2.0, yaw: 0.0 };
            World::new(Room::new(10.0, 10.0), vec![obstacle]).unwrap()
        };
        let (start, goal) = (Point::new(2.0, 2.0), Point::new(8.0, 2.0));
        let route = plan(&GridMap::from_world(&barrier(6.0), 0.1, 0.25), &start, &goal).unwrap();
        // Round the end of the barrier, (5 -+ 0.35, 6.25): 2 x hypot(2.65, 4.25) + 0.7 = 10.72 m at least.
        assert!((10.5..11.1).contains(&route.length()), "{}", route.length());
        assert!(plan(&GridMap::from_world(&barrier(9.9), 0.1, 0.25), &start, &goal).is_none());
    }
}
