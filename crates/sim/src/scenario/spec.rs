//! Worlds as data.

use std::ops::RangeInclusive;

use rand::RngExt;
use serde::{Deserialize, Serialize};

use super::{GoalRule, Scenario, generate};
use crate::{FieldError, Footprint, Room, SimError, non_negative, positive, within};

/// A number, or a range from which one is drawn uniformly: `2.5` or `[2.0, 3.0]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a number or a range [low, high]")]
pub enum Interval {
    /// Always this.
    Fixed(f64),
    /// Anything from the first to the second.
    Range([f64; 2]),
}

impl Interval {
    /// The least and the greatest value.
    #[must_use]
    pub fn bounds(&self) -> RangeInclusive<f64> {
        match *self {
            Self::Fixed(value) => value..=value,
            Self::Range([low, high]) => low..=high,
        }
    }

    /// A draw.
    pub fn sample(&self, rng: &mut impl RngExt) -> f64 {
        match *self {
            Self::Fixed(value) => value,
            Self::Range(_) => rng.random_range(self.bounds()),
        }
    }

    fn check(&self, field: &str, number: fn(&str, f64) -> Result<(), FieldError>) -> Result<(), FieldError> {
        let (low, high) = self.bounds().into_inner();
        number(field, low)?;
        number(field, high)?;
        if low > high {
            let value = format!("[{low}, {high}]");
            return Err(FieldError::new(field, value, "a range with its lower end first"));
        }
        Ok(())
    }
}

/// How many obstacles: `{ count = 12 }` or `{ density = 0.08 }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// This many, at most 10 000.
    Count(usize),
    /// This many per square metre of the room, at most 100, rounded to the nearest whole number.
    Density(Interval),
}

/// Relative frequencies of the kinds of obstacles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Kinds {
    /// Discs.
    pub disc: f64,
    /// Rectangles of random proportions and yaw.
    pub r#box: f64,
    /// Convex polygons with three to seven corners on a circle.
    pub polygon: f64,
}

impl Default for Kinds {
    fn default() -> Self {
        Self { disc: 1.0, r#box: 0.0, polygon: 0.0 }
    }
}

/// A closed room with random obstacles, a start and a goal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RoomSpec {
    /// Extent along x, metres.
    pub width: Interval,
    /// Extent along y, metres.
    pub height: Interval,
    /// How many obstacles.
    pub obstacles: Quantity,
    /// Of which kinds.
    pub kinds: Kinds,
    /// Radius of an obstacle's circumscribed circle, metres.
    pub obstacle_radius: Interval,
    /// Least gap between two obstacles, and between an obstacle and a wall, metres.
    pub min_gap: f64,
    /// Least straight distance from start to goal, metres.
    pub start_goal_distance: f64,
    /// Least distance from the vehicle's circumscribed circle to any surface at start and goal, metres,
    /// at least 0.01.
    pub start_goal_clearance: f64,
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

    fn check(&self) -> Result<(), FieldError> {
        self.width.check("width", positive)?;
        self.height.check("height", positive)?;
        self.obstacle_radius.check("obstacle_radius", positive)?;
        non_negative("min_gap", self.min_gap)?;
        within("start_goal_clearance", self.start_goal_clearance, 0.01, 1e3)?;
        non_negative("start_goal_distance", self.start_goal_distance)?;
        let diagonal = self.width.bounds().end().hypot(*self.height.bounds().end());
        if self.start_goal_distance >= diagonal {
            let allowed = format!("less than the room's diagonal, {diagonal:.2} m");
            return Err(FieldError::new("start_goal_distance", self.start_goal_distance, allowed));
        }
        match self.obstacles {
            Quantity::Count(n) => within("obstacles.count", n as f64, 0.0, 1e4)?,
            Quantity::Density(density) => {
                density.check("obstacles.density", |field, x| within(field, x, 0.0, 100.0))?;
            }
        }
        let Kinds { disc, r#box, polygon } = self.kinds;
        for (field, weight) in [("kinds.disc", disc), ("kinds.box", r#box), ("kinds.polygon", polygon)] {
            non_negative(field, weight)?;
        }
        positive("kinds (their sum)", disc + r#box + polygon)
    }
}

/// Where scenarios come from, as data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum WorldSpec {
    /// A room with every number given.
    Room(RoomSpec),
    /// The paper's small room: [`RoomSpec::room_10x15`].
    #[serde(rename = "room_10x15")]
    Room10x15 {},
    /// The paper's large room: [`RoomSpec::room_25x25`].
    #[serde(rename = "room_25x25")]
    Room25x25 {},
    /// Each scenario from one of several worlds, drawn by weight.
    Mixture {
        /// The worlds.
        worlds: Vec<WeightedWorld>,
    },
}

impl Default for WorldSpec {
    fn default() -> Self {
        Self::Room10x15 {}
    }
}

/// A part of a mixture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WeightedWorld {
    /// Relative frequency, above 0.
    pub weight: f64,
    /// The world.
    pub world: WorldSpec,
}

impl WorldSpec {
    /// The tags of all kinds of worlds.
    pub const TYPES: [&str; 4] = ["room", "room_10x15", "room_25x25", "mixture"];

    /// Checks the numbers, and makes a scenario of every part for `footprint`, so that what cannot be
    /// placed is found out now.
    ///
    /// # Errors
    /// Names the field, or says what does not fit.
    pub fn build(&self, footprint: &Footprint) -> Result<WorldSource, SimError> {
        let mut rooms = Vec::new();
        self.collect(1.0, &mut rooms)?;
        let source = WorldSource { rooms, footprint: footprint.clone() };
        for (_, room) in &source.rooms {
            generate::scenario(room, footprint, &mut crate::stream(0, "trial", 0))?;
        }
        Ok(source)
    }

    /// The rooms within, each with its share of all scenarios.
    fn collect(&self, share: f64, rooms: &mut Vec<(f64, RoomSpec)>) -> Result<(), FieldError> {
        match self {
            Self::Room(room) => {
                room.check()?;
                rooms.push((share, room.clone()));
            }
            Self::Room10x15 {} => rooms.push((share, RoomSpec::room_10x15())),
            Self::Room25x25 {} => rooms.push((share, RoomSpec::room_25x25())),
            Self::Mixture { worlds } => {
                if worlds.is_empty() {
                    return Err(FieldError::new("worlds", "[]", "one world or more"));
                }
                let place = |i: usize, field: &str| format!("worlds.{i}.{field}");
                for (i, part) in worlds.iter().enumerate() {
                    positive(&place(i, "weight"), part.weight)?;
                }
                let total: f64 = worlds.iter().map(|part| part.weight).sum();
                for (i, part) in worlds.iter().enumerate() {
                    let share = share * part.weight / total;
                    part.world.collect(share, rooms).map_err(|e| e.under(&place(i, "world")))?;
                }
            }
        }
        Ok(())
    }
}

/// A checked source of scenarios for one footprint.
#[derive(Debug, Clone)]
pub struct WorldSource {
    rooms: Vec<(f64, RoomSpec)>,
    footprint: Footprint,
}

impl WorldSource {
    /// A scenario. Equal random streams give equal scenarios.
    ///
    /// # Errors
    /// Says what could not be placed, if the spec leaves too little room.
    ///
    /// ```
    /// use headway_sim::{stream, Footprint, Shape, WorldSpec};
    /// let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 })?;
    /// let source = WorldSpec::Room10x15 {}.build(&vehicle)?;
    /// let scenario = source.sample(&mut stream(0, "layout", 0))?;
    /// assert_eq!(scenario.world.obstacles().len(), 12);
    /// assert!(!scenario.world.collides(&vehicle, &scenario.start));
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    pub fn sample(&self, rng: &mut impl RngExt) -> Result<Scenario, SimError> {
        let mut share = if self.rooms.len() > 1 { rng.random_range(0.0..1.0) } else { 0.0 };
        let mut chosen = &self.rooms[0].1;
        for (weight, room) in &self.rooms {
            chosen = room;
            if share < *weight {
                break;
            }
            share -= weight;
        }
        generate::scenario(chosen, &self.footprint, rng)
    }
}

/// The error of a room without a start and goal.
pub(super) fn no_route(room: &Room, rule: &GoalRule, footprint: &Footprint, tries: usize) -> SimError {
    SimError::NoRoute {
        distance: rule.distance,
        clearance: rule.clearance,
        diameter: 2.0 * footprint.circumradius(),
        width: room.width,
        height: room.height,
        tries,
    }
}
