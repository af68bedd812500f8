//! Seeded scenarios: a world, a start and a goal that a path joins.

mod barn;
mod files_spec;
mod generate;
mod goal_rule;
mod lattice;
mod path_check;
mod populate;
mod quantity;
mod room_spec;
mod source;
mod spec;

use nalgebra::distance;
use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::{Crowd, FieldError, Footprint, Point, Pose, SimError, World};
use path_check::PathCheck;

pub use barn::BarnSpec;
pub use files_spec::{FilePart, FilesSpec};
pub(crate) use generate::draw_shape;
pub use goal_rule::GoalRule;
pub use quantity::{Interval, Kinds, Quantity};
pub use room_spec::RoomSpec;
pub use source::WorldSource;
pub use spec::{WeightedWorld, WorldSpec};

/// A world with a start and a goal.
///
/// In those that a [`WorldSource`] makes, a path joins the two for the footprint they were made for.
/// Deserialising checks what [`Scenario::new`] checks.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "ScenarioData")]
pub struct Scenario {
    /// The room and its obstacles.
    pub world: World,
    /// Where the vehicle starts, at rest.
    pub start: Pose,
    /// Where it is to go.
    pub goal: Point,
    /// How further goals in this world are drawn.
    pub goal_rule: GoalRule,
    /// What moves the world's movers, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crowd: Option<Crowd>,
}

/// A scenario before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScenarioData {
    world: World,
    start: Pose,
    goal: Point,
    goal_rule: GoalRule,
    #[serde(default)]
    crowd: Option<Crowd>,
}

impl TryFrom<ScenarioData> for Scenario {
    type Error = SimError;
    fn try_from(data: ScenarioData) -> Result<Self, SimError> {
        if let Some(crowd) = &data.crowd {
            crowd.check(&data.world).map_err(|e| e.under("crowd"))?;
        }
        Ok(Self { crowd: data.crowd, ..Self::new(data.world, data.start, data.goal, data.goal_rule)? })
    }
}

impl Scenario {
    /// A scenario by hand, without a crowd.
    ///
    /// # Errors
    /// If the rule is not allowed in this room, or the start or the goal is not a point inside the room and
    /// outside of all obstacles that stand still. Whether a path joins them depends on who drives, and is not checked.
    ///
    /// ```
    /// use headway_sim::{GoalRule, Point, Pose, Room, Scenario, World};
    /// let world = World::new(Room::new(10.0, 15.0), vec![])?;
    /// let rule = GoalRule { distance: 4.0, clearance: 0.2 };
    /// let scenario = Scenario::new(world.clone(), Pose::translation(2.0, 5.0), Point::new(8.0, 5.0), rule)?;
    /// assert_eq!(scenario.goal.x, 8.0);
    /// let error = Scenario::new(world, Pose::translation(2.0, 5.0), Point::new(12.0, 5.0), rule).unwrap_err();
    /// assert_eq!(error.to_string(), "goal = (12, 5): must be inside the room and outside of all obstacles");
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    pub fn new(world: World, start: Pose, goal: Point, goal_rule: GoalRule) -> Result<Self, SimError> {
        goal_rule.check(&world.room()).map_err(|e| e.under("goal_rule"))?;
        let still = world.without_movers();
        for (field, point) in [("start", start.translation.vector.into()), ("goal", goal)] {
            let room = still.distance(&point);
            if room.is_nan() || room <= 0.0 {
                let value = format!("({}, {})", point.x, point.y);
                return Err(FieldError::new(field, value, "inside the room and outside of all obstacles").into());
            }
        }
        drop(still);
        let rotation = start.rotation.into_inner();
        let off = (rotation.norm() - 1.0).abs();
        if off.is_nan() || off > 1e-6 {
            return Err(FieldError::new("start.rotation", rotation, "a complex number of length 1").into());
        }
        Ok(Self { world, start, goal, goal_rule, crowd: None })
    }

    /// A further goal for a vehicle that is at `from`: joined to the start, and so to wherever the
    /// vehicle has driven to. Movers, which will be elsewhere, do not count.
    ///
    /// The first of 50 draws that is at least the rule's distance away. Where there is none (a small room, a
    /// vehicle in its middle), the farthest that is at least half as far, of up to 200 draws. Failing that,
    /// the start or the first goal, whichever is farther: the two are the rule's distance apart, so one of
    /// them is at least half of it away.
    pub fn new_goal(&self, from: &Point, footprint: &Footprint, rng: &mut impl RngExt) -> Point {
        const DRAWS: usize = 50;
        const MOST_DRAWS: usize = 200;
        let rule = &self.goal_rule;
        let start = self.start.translation.vector.into();
        let world = self.world.without_movers();
        let mut check = PathCheck::new(&world, footprint, rule);
        let mut farthest: Option<(f64, Point)> = None;
        for draw in 0..MOST_DRAWS {
            let enough = if draw < DRAWS { rule.distance } else { rule.distance / 2.0 };
            let so_far = farthest.map_or(f64::NEG_INFINITY, |(apart, _)| apart);
            if so_far >= enough {
                break;
            }
            let better = rule.place(&world, footprint, rng).filter(|goal| distance(goal, from) > so_far);
            if let Some(goal) = better.filter(|goal| check.joins(&start, goal)) {
                farthest = Some((distance(&goal, from), goal));
            }
        }
        match farthest {
            Some((apart, goal)) if apart >= rule.distance / 2.0 => goal,
            _ if distance(&start, from) > distance(&self.goal, from) => start,
            _ => self.goal,
        }
    }
}
