//! A random goal for a given start, and the reverse.

use std::f64::consts::PI;

use nalgebra::distance;
use rand::RngExt;

use crate::scenario::GoalRule;
use crate::scenario::path_check::PathCheck;
use crate::{Footprint, Point, Pose, SimError, World};

/// How many places are tried: what is joined to the given end may be a small part of the room.
const TRIES: usize = 2000;

/// A goal that a path joins to a start.
pub(super) fn goal_for(
    start: &Pose,
    rule: &GoalRule,
    world: &World,
    footprint: &Footprint,
    rng: &mut impl RngExt,
) -> Result<Point, SimError> {
    other_end(&start.translation.vector.into(), rule, world, footprint, rng)
}

/// A start, of any yaw, that a path joins to a goal.
pub(super) fn start_for(
    goal: &Point,
    rule: &GoalRule,
    world: &World,
    footprint: &Footprint,
    rng: &mut impl RngExt,
) -> Result<Pose, SimError> {
    let start = other_end(goal, rule, world, footprint, rng)?;
    Ok(Pose::new(start.coords, rng.random_range(-PI..PI)))
}

/// A place with the rule's clearance that is far enough from the given end and joined to it.
fn other_end(
    given: &Point,
    rule: &GoalRule,
    world: &World,
    footprint: &Footprint,
    rng: &mut impl RngExt,
) -> Result<Point, SimError> {
    let mut check = PathCheck::new(world, footprint, rule);
    for _ in 0..TRIES {
        let Some(drawn) = rule.place(world, footprint, rng) else { break };
        if distance(given, &drawn) >= rule.distance && check.joins(given, &drawn) {
            return Ok(drawn);
        }
    }
    Err(rule.no_route(&world.room(), footprint, TRIES))
}
