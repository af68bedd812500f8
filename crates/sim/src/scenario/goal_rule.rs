//! Which starts and goals will do.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use super::lattice::Lattice;
use crate::check::{non_negative, within};
use crate::{FieldError, Footprint, Point, Room, SimError, World};

/// What a start and a goal must satisfy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GoalRule {
    /// Least straight distance from start to goal, metres, less than the room's diagonal.
    pub distance: f64,
    /// Least distance from the footprint's circumscribed circle to any surface, at both ends, metres,
    /// at least 0.01.
    pub clearance: f64,
}

impl GoalRule {
    /// How many places are tried before one gives up.
    const TRIES: usize = 200;

    /// Checks the rule for a room.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed. The clearance must not be so small that the lattice
    /// on which paths are searched, at most half of it apart, gets too large.
    ///
    /// ```
    /// use headway_sim::{GoalRule, Room};
    /// let room = Room::new(10.0, 15.0);
    /// let error = GoalRule { distance: 4.0, clearance: 0.0 }.check(&room).unwrap_err();
    /// assert_eq!(error.to_string(), "clearance = 0: must be from 0.01 to 1000");
    /// ```
    pub fn check(&self, room: &Room) -> Result<(), FieldError> {
        non_negative("distance", self.distance)?;
        let diagonal = room.width.hypot(room.height);
        if self.distance >= diagonal {
            let allowed = format!("less than the room's diagonal, {diagonal:.2} m");
            return Err(FieldError::new("distance", self.distance, allowed));
        }
        within("clearance", self.clearance, 0.01, 1e3)?;
        let least = Lattice::least_clearance(room);
        if self.clearance < least {
            let Room { width, height, .. } = room;
            let allowed = format!("{least} or more in a {width:.1} x {height:.1} m room, to find paths in time");
            return Err(FieldError::new("clearance", self.clearance, allowed));
        }
        Ok(())
    }

    /// A place for the footprint with the required clearance, uniform over the room, or `None` after
    /// [`Self::TRIES`] tries.
    pub(super) fn place(&self, world: &World, footprint: &Footprint, rng: &mut impl RngExt) -> Option<Point> {
        let margin = footprint.circumradius() + self.clearance;
        let room = world.room();
        (0..Self::TRIES).map(|_| room.sample(rng)).find(|point| world.has_room_around(point, margin))
    }

    /// The error of a room in which `tries` pairs of start and goal failed.
    pub(super) fn no_route(&self, room: &Room, footprint: &Footprint, tries: usize) -> SimError {
        SimError::NoRoute {
            distance: self.distance,
            clearance: self.clearance,
            diameter: 2.0 * footprint.circumradius(),
            width: room.width,
            height: room.height,
            tries,
        }
    }
}
