//! Whether two places are joined by a path: a best-first search over a lattice of free points.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

use super::GoalRule;
use crate::{Footprint, Point, World};

/// Joins of one start with many goals in one world.
///
/// Lattice points lie `step` apart, the start is one of them, and a point is free if the distance to
/// the nearest surface is at least the footprint's circumradius plus half a step. Distances change by at
/// most a metre a metre, so the footprint, whatever its yaw, can move between free neighbours: what is
/// found joined *is* joined. Passages barely wider than the footprint may be missed.
pub(super) struct PathCheck<'a> {
    world: &'a World,
    start: Point,
    step: f64,
    margin: f64,
}

type Node = (i32, i32);

impl<'a> PathCheck<'a> {
    /// The longest step, metres.
    const STEP: f64 = 0.1;

    pub(super) fn new(world: &'a World, start: Point, footprint: &Footprint, rule: &GoalRule) -> Self {
        // With the rule's clearance at both ends, a goal sees all lattice points within a step.
        let step = Self::STEP.min(rule.clearance);
        Self { world, start, step, margin: footprint.circumradius() + step / 2.0 }
    }

    /// Whether a path joins the start to `goal`.
    pub(super) fn joins(&mut self, goal: &Point) -> bool {
        let urgency = |node: Node| {
            let steps = (self.point(node) - goal).norm() / self.step;
            (Reverse((steps * 1024.0) as u64), node)
        };
        let mut open = BinaryHeap::from([urgency((0, 0))]);
        let mut seen = HashSet::from([(0, 0)]);
        while let Some((_, (i, j))) = open.pop() {
            if (self.point((i, j)) - goal).norm() <= self.step {
                return true;
            }
            for node in [(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)] {
                if seen.insert(node) && self.world.distance(&self.point(node)) >= self.margin {
                    open.push(urgency(node));
                }
            }
        }
        false
    }

    fn point(&self, (i, j): Node) -> Point {
        self.start + nalgebra::Vector2::new(f64::from(i), f64::from(j)) * self.step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Obstacle, Room, Shape};

    fn room_with_barrier(gap: f64) -> World {
        let barrier = |y: f64, width: f64| Obstacle { shape: Shape::Box { length: 0.2, width }, x: 5.0, y, yaw: 0.0 };
        let (low, high) = (4.0, 6.0 - gap);
        let obstacles = vec![barrier(low / 2.0, low), barrier(10.0 - high / 2.0, high)];
        World::new(Room { width: 10.0, height: 10.0 }, obstacles).unwrap()
    }

    fn joined(gap: f64) -> bool {
        let world = room_with_barrier(gap);
        let footprint = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
        let rule = GoalRule { distance: 4.0, clearance: 0.2 };
        PathCheck::new(&world, Point::new(2.0, 5.0), &footprint, &rule).joins(&Point::new(8.0, 7.0))
    }

    #[test]
    fn a_barrier_divides_and_a_gap_joins() {
        assert!(!joined(0.0));
        assert!(!joined(0.48));
        assert!(joined(0.75));
        assert!(joined(2.0));
    }
}
