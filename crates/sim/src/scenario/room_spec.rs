//! Random rooms as data.

use serde::{Deserialize, Serialize};

use super::populate::check_crowd;
use super::{GoalRule, Interval, Kinds, Quantity};
use crate::check::{non_negative, positive, within};
use crate::{CrowdSpec, FieldError, Room};

/// The most obstacles that a room may be given.
const MOST_OBSTACLES: f64 = 1e4;

/// A closed room with random obstacles, a start and a goal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RoomSpec {
    /// Extent along x, metres, from 0.1 to 1000.
    pub width: Interval,
    /// Extent along y, metres, from 0.1 to 1000.
    pub height: Interval,
    /// How many obstacles, at most 10 000 in the largest room.
    pub obstacles: Quantity,
    /// Of which kinds.
    pub kinds: Kinds,
    /// Radius of an obstacle's circumscribed circle, metres, from 0.001 to 1000.
    pub obstacle_radius: Interval,
    /// Least gap between two obstacles, and between an obstacle and a wall, metres.
    pub min_gap: f64,
    /// Least straight distance from start to goal, metres, less than the smallest room's diagonal.
    pub start_goal_distance: f64,
    /// Least distance from the vehicle's circumscribed circle to any surface at start and goal, metres,
    /// at least 0.01. Paths are searched on a lattice of at most half of it, so a large room needs more.
    pub start_goal_clearance: f64,
    /// What moves in it; nothing if not given. Paths from start to goal lead round what stands still.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crowd: Option<CrowdSpec>,
}

impl Default for RoomSpec {
    /// The paper's 10 x 15 m room.
    fn default() -> Self {
        Self::room_10x15()
    }
}

impl RoomSpec {
    /// The paper's 10 x 15 m room with 12 discs (the paper says "many obstacles", not how many).
    #[must_use]
    pub fn room_10x15() -> Self {
        Self {
            width: Interval::Fixed(10.0),
            height: Interval::Fixed(15.0),
            obstacles: Quantity::Count(12),
            kinds: Kinds::default(),
            obstacle_radius: Interval::Range([0.2, 0.5]),
            min_gap: 0.8,
            start_goal_distance: 4.0,
            start_goal_clearance: 0.2,
            crowd: None,
        }
    }

    /// The paper's 25 x 25 m room with 30 discs.
    #[must_use]
    pub fn room_25x25() -> Self {
        Self {
            width: Interval::Fixed(25.0),
            height: Interval::Fixed(25.0),
            obstacles: Quantity::Count(30),
            start_goal_distance: 8.0,
            ..Self::room_10x15()
        }
    }

    /// What starts and goals must satisfy.
    #[must_use]
    pub fn goal_rule(&self) -> GoalRule {
        GoalRule { distance: self.start_goal_distance, clearance: self.start_goal_clearance }
    }

    pub(super) fn check(&self) -> Result<(), FieldError> {
        self.width.check("width", |field, x| within(field, x, 0.1, 1000.0))?;
        self.height.check("height", |field, x| within(field, x, 0.1, 1000.0))?;
        self.obstacle_radius.check("obstacle_radius", |field, x| {
            positive(field, x)?;
            within(field, x, 1e-3, 1000.0)
        })?;
        non_negative("min_gap", self.min_gap)?;
        let smallest = Room::new(*self.width.bounds().start(), *self.height.bounds().start());
        let largest = Room::new(*self.width.bounds().end(), *self.height.bounds().end());
        for room in [smallest, largest] {
            self.goal_rule().check(&room).map_err(|e| FieldError { field: format!("start_goal_{}", e.field), ..e })?;
        }
        check_crowd(self.crowd.as_ref())?;
        self.check_obstacles(largest.width * largest.height)
    }

    /// Checks the number of obstacles, in a room of at most `area` square metres, and their kinds.
    fn check_obstacles(&self, area: f64) -> Result<(), FieldError> {
        match self.obstacles {
            Quantity::Count(n) => within("obstacles.count", n as f64, 0.0, MOST_OBSTACLES)?,
            Quantity::Density(density) => {
                density.check("obstacles.density", |field, x| within(field, x, 0.0, 100.0))?;
                let highest = *density.bounds().end();
                if highest * area > MOST_OBSTACLES {
                    let allowed = format!(
                        "at most {} in a room of up to {area:.0} square metres: {MOST_OBSTACLES} obstacles",
                        MOST_OBSTACLES / area
                    );
                    return Err(FieldError::new("obstacles.density", highest, allowed));
                }
            }
        }
        self.kinds.check()
    }
}
