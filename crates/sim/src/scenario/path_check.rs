//! Whether two places are joined by a path.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::GoalRule;
use super::lattice::Lattice;
use crate::{Footprint, Point, World};

/// Joins of places in one world, for a footprint and a rule.
///
/// Where every gap is wider than the footprint, all free places are joined; elsewhere a path is searched for.
pub(super) enum PathCheck<'a> {
    /// Every gap is wider than this circumradius times two.
    Roomy { world: &'a World, circumradius: f64 },
    /// There may be dead ends.
    Tight(LatticeSearch<'a>),
}

impl<'a> PathCheck<'a> {
    /// A check for footprints and a rule; one that joins nothing if the rule is not allowed in the room.
    pub(super) fn new(world: &'a World, footprint: &Footprint, rule: &GoalRule) -> Self {
        let circumradius = footprint.circumradius();
        let is_allowed = Lattice::new(&world.room(), rule.clearance).is_some();
        if is_allowed && world.has_gaps_above(2.0 * circumradius) {
            Self::Roomy { world, circumradius }
        } else {
            Self::Tight(LatticeSearch::new(world, circumradius, rule))
        }
    }

    /// Whether a path joins two places; never to or from one that is not finite.
    ///
    /// # Panics
    /// After 65 534 searches.
    pub(super) fn joins(&mut self, from: &Point, to: &Point) -> bool {
        match self {
            Self::Roomy { world, circumradius } => {
                [from, to].into_iter().all(|place| world.has_room_around(place, *circumradius))
            }
            Self::Tight(search) => search.joins(from, to),
        }
    }
}

/// Marks a node that is not free.
const BLOCKED: u16 = u16::MAX;

/// A best-first search over a lattice of free points.
///
/// Lattice points lie `step` apart, at most half the rule's clearance, and a point is free if the distance
/// to the nearest surface is at least the footprint's circumradius plus half a step. Distances change by at
/// most a metre a metre, so the footprint, whatever its yaw, can move between free neighbours: what is
/// found joined *is* joined. Passages barely wider than the footprint may be missed. A place is tied to the
/// free points within a step that it can reach in a straight line; with the rule's clearance, to all of them.
pub(super) struct LatticeSearch<'a> {
    world: &'a World,
    lattice: Lattice,
    circumradius: f64,
    /// Of each node: 0, or [`BLOCKED`], or the last search that came there.
    seen: Vec<u16>,
    n_searches: u16,
    /// The searches that failed: each has seen all that is joined to its start, which need not be searched again.
    dry: Vec<u16>,
}

impl<'a> LatticeSearch<'a> {
    fn new(world: &'a World, circumradius: f64, rule: &GoalRule) -> Self {
        let lattice = Lattice::new(&world.room(), rule.clearance).unwrap_or(Lattice::EMPTY);
        let seen = vec![0; lattice.n_nodes()];
        Self { world, lattice, circumradius, seen, n_searches: 0, dry: Vec::new() }
    }

    fn joins(&mut self, from: &Point, to: &Point) -> bool {
        let (starts, ends) = (self.ties(from), self.ties(to));
        let (dry, fresh): (Vec<usize>, Vec<usize>) =
            starts.into_iter().partition(|start| self.dry.contains(&self.seen[*start]));
        dry.iter().any(|start| ends.iter().any(|end| self.seen[*start] == self.seen[*end]))
            || !fresh.is_empty() && !ends.is_empty() && self.search(&fresh, &ends, to)
    }

    /// The free nodes to which a place is tied.
    fn ties(&self, place: &Point) -> Vec<usize> {
        let mut nodes = self.lattice.around(place);
        nodes.retain(|node| {
            self.is_free(*node) && self.world.is_free(place, &self.lattice.point(*node), self.circumradius)
        });
        nodes
    }

    fn is_free(&self, node: usize) -> bool {
        self.world.has_room_around(&self.lattice.point(node), self.circumradius + self.lattice.step / 2.0)
    }

    /// Whether one of the nodes `ends`, which lie around `to`, is joined to one of `starts`.
    fn search(&mut self, starts: &[usize], ends: &[usize], to: &Point) -> bool {
        self.n_searches += 1;
        let search = self.n_searches;
        assert!(search < BLOCKED, "searches are counted by 16 bits");
        let lattice = &self.lattice;
        let urgency = |node| {
            let steps = (lattice.point(node) - to).norm() / lattice.step;
            (Reverse((steps * 1024.0) as u64), node)
        };
        starts.iter().for_each(|start| self.seen[*start] = search);
        let mut open: BinaryHeap<_> = starts.iter().copied().map(urgency).collect();
        while let Some((_, node)) = open.pop() {
            if ends.contains(&node) {
                return true;
            }
            for next in lattice.neighbours(node) {
                if self.seen[next] == search || self.seen[next] == BLOCKED {
                    continue;
                }
                let is_free = self.is_free(next);
                self.seen[next] = if is_free { search } else { BLOCKED };
                if is_free {
                    open.push(urgency(next));
                }
            }
        }
        self.dry.push(search);
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Obstacle, Room, Shape, WorldSpec};

    fn room_with_barrier(gap: f64) -> World {
        let barrier = |y: f64, width: f64| Obstacle { shape: Shape::Box { length: 0.2, width }, x: 5.0, y, yaw: 0.0 };
        let (low, high) = (4.0, 6.0 - gap);
        let obstacles = vec![barrier(low / 2.0, low), barrier(10.0 - high / 2.0, high)];
        World::new(Room::new(10.0, 10.0), obstacles).unwrap()
    }

    fn joined(gap: f64) -> bool {
        let world = room_with_barrier(gap);
        let footprint = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
        let rule = GoalRule { distance: 4.0, clearance: 0.2 };
        PathCheck::new(&world, &footprint, &rule).joins(&Point::new(2.0, 5.0), &Point::new(8.0, 7.0))
    }

    #[test]
    fn a_barrier_divides_and_a_gap_joins() {
        assert!(!joined(0.0));
        assert!(!joined(0.48));
        assert!(joined(0.75));
        assert!(joined(2.0));
    }

    #[test]
    fn one_check_answers_many_questions() {
        let world = room_with_barrier(0.0);
        let footprint = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
        let mut check = PathCheck::new(&world, &footprint, &GoalRule { distance: 4.0, clearance: 0.2 });
        let [left, below, right, above] =
            [[2.0, 5.0], [1.0, 1.0], [8.0, 7.0], [9.0, 9.0]].map(|[x, y]| Point::new(x, y));
        for _ in 0..2 {
            for (a, b, expected) in [
                (left, below, true),
                (left, right, false),
                (below, above, false),
                (below, left, true),
                (right, above, true),
                (right, below, false),
                (above, right, true),
            ] {
                assert_eq!(check.joins(&a, &b), expected, "{a} to {b}");
            }
        }
        let PathCheck::Tight(search) = check else { panic!("the barrier touches the walls") };
        assert_eq!(search.n_searches, 4, "each half is searched to its end once");
    }

    #[test]
    fn what_is_not_allowed_joins_nothing() {
        let world = room_with_barrier(2.0);
        let footprint = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
        let joins = |clearance, from| {
            PathCheck::new(&world, &footprint, &GoalRule { distance: 1.0, clearance })
                .joins(&from, &Point::new(2.0, 7.0))
        };
        assert!(joins(0.2, Point::new(2.0, 5.0)));
        // A clearance of 0 was a step of 0: this never came back.
        for clearance in [0.0, -1.0, 1e-9, f64::NAN] {
            assert!(!joins(clearance, Point::new(2.0, 5.0)));
        }
        for (x, y) in [(f64::NAN, 5.0), (2.0, f64::INFINITY), (-1.0, 5.0), (5.0, 2.0)] {
            assert!(!joins(0.2, Point::new(x, y)));
        }
    }

    /// That all free places are joined where all gaps are wide is checked against the search.
    #[test]
    fn what_needs_no_search_is_found_by_one() {
        let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
        for spec in [WorldSpec::Room10x15 {}, WorldSpec::Room25x25 {}] {
            let source = spec.build(&vehicle).unwrap();
            for index in 0..20 {
                let scenario = source.scenario(5, index).unwrap();
                let rule = scenario.goal_rule;
                let mut check = PathCheck::new(&scenario.world, &vehicle, &rule);
                assert!(matches!(check, PathCheck::Roomy { .. }), "gaps of 0.8 m, a vehicle of 0.5 m");
                let mut search = LatticeSearch::new(&scenario.world, vehicle.circumradius(), &rule);
                let start = scenario.start.translation.vector.into();
                assert!(check.joins(&start, &scenario.goal) && search.joins(&start, &scenario.goal));
                let in_an_obstacle = Point::new(scenario.world.obstacles()[0].x, scenario.world.obstacles()[0].y);
                assert!(!check.joins(&start, &in_an_obstacle) && !search.joins(&start, &in_an_obstacle));
            }
        }
    }

    #[test]
    fn gaps_are_as_wide_as_they_are() {
        for gap in [0.3, 0.5, 1.0] {
            assert!(room_with_barrier(gap).has_gaps_above(-1e-9));
            assert!(!room_with_barrier(gap).has_gaps_above(1e-9), "the barrier touches the walls");
        }
        let disc = |x, y| Obstacle { shape: Shape::Disc { radius: 0.5 }, x, y, yaw: 0.0 };
        let square = Obstacle { shape: Shape::Box { length: 1.0, width: 1.0 }, x: 5.0, y: 8.0, yaw: 0.0 };
        let room = Room::new(10.0, 10.0);
        // To the wall 0.7, between the discs 1.0, between a disc and the square 1.5.
        let world = World::new(room, vec![disc(1.2, 5.0), disc(3.2, 5.0), disc(5.0, 5.5), square]).unwrap();
        assert!(world.has_gaps_above(0.69) && !world.has_gaps_above(0.71));
        // Farther from the walls, the discs' 0.8 decides; then the 1.5 between a disc and the square.
        let world = World::new(room, vec![disc(3.0, 5.0), disc(4.8, 5.0)]).unwrap();
        assert!(world.has_gaps_above(0.79) && !world.has_gaps_above(0.81));
        let square = Obstacle { shape: Shape::Box { length: 1.0, width: 1.0 }, x: 5.0, y: 7.0, yaw: 0.0 };
        let world = World::new(room, vec![disc(5.0, 4.5), square.clone()]).unwrap();
        assert!(world.has_gaps_above(1.49) && !world.has_gaps_above(1.51));
        // Two squares, turned by 45 degrees: their corners are 5 - sqrt(2) apart; and many posts between.
        let turned = |x: f64| Obstacle { x, y: 5.0, yaw: std::f64::consts::FRAC_PI_4, ..square.clone() };
        let large = Room::new(100.0, 100.0);
        let posts =
            (0..40).map(|k| Obstacle { shape: Shape::Disc { radius: 0.5 }, x: 50.0 + f64::from(k), y: 50.0, yaw: 0.0 });
        let spread = posts.clone().map(|post| Obstacle {
            x: 5.0 * (post.x - 50.0).rem_euclid(15.0) + 20.0,
            y: 20.0 + 8.0 * ((post.x - 50.0) / 15.0).floor(),
            ..post
        });
        let world = World::new(large, [turned(4.5), turned(9.5)].into_iter().chain(spread).collect()).unwrap();
        let gap = 5.0 - std::f64::consts::SQRT_2;
        assert!(world.has_gaps_above(gap - 0.01) && !world.has_gaps_above(gap + 0.01));
    }
}
