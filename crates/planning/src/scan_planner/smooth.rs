//! From cells to a route.

use headway_sim::Point;

use super::search::{CLOSED, Grid};

/// Leaves out the cells that can be passed by in a straight line at no greater cost, from the start on.
pub(super) fn straighten(grid: &Grid<'_>, cells: &[usize], start: &Point, goal: &Point) -> Vec<Point> {
    let center = |index: usize| grid.window.center((index % grid.window.n_x, index / grid.window.n_x));
    let mut points: Vec<_> = cells.iter().map(|cell| center(*cell)).collect();
    points[0] = *start;
    if points.len() == 1 {
        points.push(*goal);
    }
    let last = points.len() - 1;
    points[last] = *goal;
    // What the way through the cells costs, up to each point.
    let mut costs = vec![0.0];
    for pair in points.windows(2) {
        costs.push(costs[costs.len() - 1] + line_cost(grid, &pair[0], &pair[1], f64::INFINITY));
    }
    let mut kept = vec![points[0]];
    let mut here = 0;
    while here < last {
        let is_no_dearer = |k: usize| {
            let most = (costs[k] - costs[here]) * (1.0 + 1e-9);
            line_cost(grid, &points[here], &points[k], most) <= most
        };
        // Ever farther by doubling, then closing in: where one line will do, a shorter one usually does.
        let (mut good, mut bad) = (here + 1, last + 1);
        let mut stride = 1;
        while good + 1 < bad {
            let next = if bad > last { (here + 1 + stride).min(last) } else { good.midpoint(bad) };
            if is_no_dearer(next) {
                good = next;
                if next == last {
                    break;
                }
            } else {
                bad = next;
            }
            stride *= 2;
        }
        here = good;
        kept.push(points[here]);
    }
    kept
}

/// What a straight line costs: the weights of what lies below it, times metres; infinite once it exceeds `most` or meets a
/// closed cell.
fn line_cost(grid: &Grid<'_>, a: &Point, b: &Point, most: f64) -> f64 {
    let along = b - a;
    let n = (along.norm() / grid.sample()).ceil().max(1.0);
    let share = along.norm() / n;
    let mut cost = 0.0;
    for k in 0..n as usize {
        let weight = grid.weight_at(&(a + along * ((k as f64 + 0.5) / n)));
        cost += f64::from(weight) * share;
        if weight == CLOSED || cost > most {
            return f64::INFINITY;
        }
    }
    cost
}

/// The same way with points at most `spacing` metres apart.
pub(super) fn resample(points: &[Point], spacing: f64) -> Vec<Point> {
    let mut dense = vec![points[0]];
    for pair in points.windows(2) {
        let along = pair[1] - pair[0];
        let n = (along.norm() / spacing).ceil().clamp(1.0, 1e5);
        dense.extend((1..=n as usize).map(|k| pair[0] + along * (k as f64 / n)));
    }
    dense
}
