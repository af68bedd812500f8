//! Seeded scenarios: a world, a start and a goal that a path joins.

mod generate;
mod path_check;
mod spec;

use nalgebra::distance;
use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::{Footprint, Point, Pose, SimError, World};
use path_check::PathCheck;

pub use spec::{Interval, Kinds, Quantity, RoomSpec, WeightedWorld, WorldSource, WorldSpec};

/// A world with a start and a goal that are joined by a path for the footprint it was made for.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// The room and its obstacles.
    pub world: World,
    /// Where the vehicle starts, at rest.
    pub start: Pose,
    /// Where it is to go.
    pub goal: Point,
    /// How further goals in this world are drawn.
    pub goal_rule: GoalRule,
}

/// What a start and a goal must satisfy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GoalRule {
    /// Least straight distance from start to goal, metres.
    pub distance: f64,
    /// Least distance from the footprint's circumscribed circle to any surface, at both ends, metres.
    pub clearance: f64,
}

impl GoalRule {
    /// How many places are tried before one gives up.
    const TRIES: usize = 200;

    /// A place for the footprint with the required clearance, uniform over the room, or `None` after
    /// [`Self::TRIES`] tries.
    fn place(&self, world: &World, footprint: &Footprint, rng: &mut impl RngExt) -> Option<Point> {
        let margin = footprint.circumradius() + self.clearance;
        let room = world.room();
        (0..Self::TRIES)
            .map(|_| Point::new(rng.random_range(0.0..room.width), rng.random_range(0.0..room.height)))
            .find(|point| world.distance(point) >= margin)
    }
}

impl Scenario {
    /// A further goal for a vehicle that is at `from`: joined to the start, and so to wherever the
    /// vehicle has driven to, and at least the rule's distance away. Where the room has no such place in
    /// view of `from` (a small room, a vehicle in its middle), the farthest one drawn.
    ///
    /// # Errors
    /// [`SimError::NoRoute`] if no drawn place is joined to the start.
    pub fn new_goal(&self, from: &Point, footprint: &Footprint, rng: &mut impl RngExt) -> Result<Point, SimError> {
        const DRAWS: usize = 50;
        let rule = &self.goal_rule;
        let mut check = PathCheck::new(&self.world, self.start.translation.vector.into(), footprint, rule);
        let mut farthest: Option<Point> = None;
        for _ in 0..DRAWS {
            let Some(goal) = rule.place(&self.world, footprint, rng) else {
                continue;
            };
            if farthest.is_some_and(|best| distance(&best, from) >= distance(&goal, from)) || !check.joins(&goal) {
                continue;
            }
            farthest = Some(goal);
            if distance(&goal, from) >= rule.distance {
                break;
            }
        }
        farthest.ok_or_else(|| spec::no_route(&self.world.room(), rule, footprint, DRAWS))
    }
}
