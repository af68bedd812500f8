//! The MDP as data.

use std::sync::Arc;

use headway_planning::{PurePursuit, ScanPlannerSpec, Sensed};
use headway_reward::Reward;
use headway_sensors::{LidarSpec, ObstacleAngleSpec, OdometrySpec};
use headway_sim::FieldError;
use headway_sim::check::{non_negative, positive, within};
use headway_sim::{Command, VehicleSpec, WorldSpec};
use serde::{Deserialize, Serialize};

use crate::{ActionSpec, ObservationSpec, RandomizeSpec};

/// A whole navigation MDP as data: one field per table of a spec file.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NavSpec {
    /// Where episodes take place.
    pub world: WorldSpec,
    /// Who drives.
    pub vehicle: VehicleSpec,
    /// What it sees with.
    pub lidar: LidarSpec,
    /// How it knows its own motion.
    pub odometry: OdometrySpec,
    /// Which of these numbers differ from episode to episode.
    pub randomize: RandomizeSpec,
    /// The rules.
    pub env: EnvSpec,
    /// What it is paid.
    pub reward: Arc<dyn Reward>,
}

impl Default for NavSpec {
    /// The paper's small room and its reward R, with the defaults of all other tables.
    fn default() -> Self {
        Self {
            world: WorldSpec::default(),
            vehicle: VehicleSpec::default(),
            lidar: LidarSpec::default(),
            odometry: OdometrySpec::default(),
            randomize: RandomizeSpec::default(),
            env: EnvSpec::default(),
            reward: Arc::new(headway_reward::R::default()),
        }
    }
}

/// The rules of the MDP: the table `[env]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EnvSpec {
    /// What reaching a goal does to the episode.
    pub goal: GoalHandling,
    /// Distance from the vehicle's origin to the goal at which it counts as reached, metres, looked at once
    /// per control period.
    pub reach_radius: f64,
    /// Time from the start, or from the last goal, after which the episode is cut, seconds.
    pub time_limit: f64,
    /// The route to the goal that drivers are shown.
    pub route: RouteSource,
    /// What the agent controls.
    pub control: Control,
    /// What it can choose from.
    pub actions: ActionSpec,
    /// What it observes.
    pub observation: ObservationSpec,
    /// Which obstacles have an angle, for rewards that use it.
    pub obstacle_angle: ObstacleAngleSpec,
}

impl Default for EnvSpec {
    fn default() -> Self {
        Self {
            goal: GoalHandling::Terminate,
            reach_radius: 0.5,
            time_limit: 60.0,
            route: RouteSource::default(),
            control: Control::default(),
            actions: ActionSpec::default(),
            observation: ObservationSpec::default(),
            obstacle_angle: ObstacleAngleSpec::default(),
        }
    }
}

/// What reaching a goal does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GoalHandling {
    /// It ends the episode: the step is terminated.
    Terminate,
    /// The vehicle is given a new goal in the same world and drives on: the step is neither terminated nor
    /// truncated. Its reward uses the old goal, its `next_obs` shows the new one, and the time limit counts
    /// anew.
    NewGoal,
}

/// What the agent controls.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Control {
    /// Speed and yaw rate.
    Full {},
    /// The speed alone: pure pursuit steers along the route.
    SpeedOnly {
        /// How the route is followed.
        #[serde(default)]
        pursuit: PurePursuit,
    },
}

/// Where the route to the goal comes from that drivers are shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum RouteSource {
    /// There is none.
    None {},
    /// Planned once over the true map, from the start or the last goal.
    TrueMap(TrueMapSpec),
    /// Planned again and again over what the vehicle's own scans have shown.
    Scans(ScanPlannerSpec),
}

impl Default for RouteSource {
    fn default() -> Self {
        Self::None {}
    }
}

impl RouteSource {
    /// The tags of all kinds.
    pub const TYPES: [&str; 3] = ["none", "true_map", "scans"];

    fn check(&self) -> Result<(), FieldError> {
        match self {
            Self::None {} => Ok(()),
            Self::TrueMap(spec) => spec.check(),
            Self::Scans(spec) => spec.check(),
        }
    }
}

/// How routes are planned over the true map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrueMapSpec {
    /// Edge of a cell of the map, metres, from 0.02 to 0.5.
    pub cell: f64,
    /// Distance that the route keeps from surfaces beyond the footprint's circumradius, metres. Where no route keeps it all
    /// the way, half of it, then none.
    pub margin: f64,
}

impl Default for TrueMapSpec {
    fn default() -> Self {
        Self { cell: 0.1, margin: 0.15 }
    }
}

impl TrueMapSpec {
    fn check(&self) -> Result<(), FieldError> {
        within("cell", self.cell, 0.02, 0.5)?;
        non_negative("margin", self.margin)
    }
}

impl Default for Control {
    fn default() -> Self {
        Self::Full {}
    }
}

impl Control {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn check(&self) -> Result<(), FieldError> {
        match self {
            Self::Full {} => Ok(()),
            Self::SpeedOnly { pursuit } => pursuit.check().map_err(|e| e.under("pursuit")),
        }
    }

    /// What the vehicle is told when the agent asks for a command: that, or what steers at its speed along the route, or along
    /// the straight line to the goal where there is none.
    #[must_use]
    pub fn command(&self, asked: Command, sensed: &Sensed<'_>) -> Command {
        match self {
            Self::Full {} => asked,
            Self::SpeedOnly { pursuit } => {
                let turning_radius = sensed.vehicle.drive.turning_radius();
                pursuit.follow(&sensed.route_or_straight(), &sensed.pose, asked.speed, turning_radius)
            }
        }
    }
}

impl EnvSpec {
    /// Checks all but the actions and the observation, which depend on the vehicle and its lidar.
    pub(crate) fn check(&self) -> Result<(), FieldError> {
        positive("reach_radius", self.reach_radius)?;
        positive("time_limit", self.time_limit)?;
        self.control.check().map_err(|e| e.under("control"))?;
        self.route.check().map_err(|e| e.under("route"))?;
        if self.route != (RouteSource::None {}) {
            return Ok(());
        }
        let needs = |field: &str, value: &str| {
            Err(FieldError::new(field, value, "used with a route: set `route`, to `true_map` for example"))
        };
        if let Control::SpeedOnly { .. } = self.control {
            return needs("control", "speed_only");
        }
        match &self.observation.look_ahead[..] {
            [] => Ok(()),
            points => needs("observation.look_ahead", &format!("{points:?}")),
        }
    }
}
