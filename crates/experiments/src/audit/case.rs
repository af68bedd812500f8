//! All that an audit depends on.

use std::sync::Arc;

use headway_env::{ActionSpec, Control, EnvSpec, GoalHandling, NavSpec, ObservationSpec, RouteSource};
use headway_reward::Reward;
use headway_sensors::{LidarSpec, ObstacleAngleSpec};
use headway_sim::{ActuationSpec, Interval, Quantity, RoomSpec, VehicleSpec, WorldSpec};
use serde::Serialize;
use toml::Value;

use crate::spec::RunSpec;

/// The desired speed of Liu et al., m/s: that of rewards that name none.
const DESIRED_SPEED: f64 = 1.2;

/// All that the audit of a cell depends on: cells that agree in it are one case.
#[derive(Debug, Clone, Serialize)]
pub struct Case {
    /// The discount, per env step.
    pub gamma: f64,
    /// What a reached goal does.
    pub goal: GoalHandling,
    /// Distance at which the goal counts as reached, metres.
    pub reach_radius: f64,
    /// How far the goal is at least, metres.
    pub goal_distance: f64,
    /// Whether the agent steers.
    pub steering: Steering,
    /// The lowest and the highest speed that the agent can ask for, m/s.
    pub speeds: [f64; 2],
    /// The highest yaw rate that the agent can ask for, rad/s.
    pub yaw_rate: f64,
    /// What drives, without noise.
    pub vehicle: VehicleSpec,
    /// What it sees with, without noise.
    pub lidar: LidarSpec,
    /// Which obstacles have an angle.
    pub obstacle_angle: ObstacleAngleSpec,
    /// What is paid.
    pub reward: Arc<dyn Reward>,
}

/// Who steers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Steering {
    /// The agent.
    Agent,
    /// A route does: under `speed_only` control nobody leaves it.
    Route,
}

impl Case {
    /// The case of a cell: its training, with a nominal vehicle and a lidar without noise.
    ///
    /// ```
    /// use headway_experiments::{audit::Case, spec::RunSpec};
    /// let case = Case::of(&RunSpec::default());
    /// assert_eq!((case.gamma, case.speeds, case.desired_speed()), (0.95, [0.0, 1.5], 1.2));
    /// ```
    pub fn of(spec: &RunSpec) -> Self {
        let steering = match spec.env.control {
            Control::Full {} => Steering::Agent,
            Control::SpeedOnly { .. } => Steering::Route,
        };
        let yaw_rate = match &spec.env.actions {
            ActionSpec::SetPoints { yaw_rates, .. } | ActionSpec::Accelerate { yaw_rates } => {
                yaw_rates.iter().fold(0.0, |most: f64, yaw_rate| most.max(yaw_rate.abs()))
            }
        };
        let speeds = match &spec.env.actions {
            ActionSpec::SetPoints { speeds, .. } => {
                let lowest = speeds.iter().copied().fold(f64::INFINITY, f64::min);
                [lowest.max(0.0), speeds.iter().copied().fold(0.0, f64::max)]
            }
            ActionSpec::Accelerate { .. } => [0.0, spec.vehicle.max_speed],
        };
        Self {
            gamma: spec.agent.gamma,
            goal: spec.env.goal,
            reach_radius: spec.env.reach_radius,
            goal_distance: spec.least_goal_distance(),
            steering,
            speeds,
            yaw_rate,
            vehicle: VehicleSpec {
                actuation: ActuationSpec { noise: 0.0, ..spec.vehicle.actuation },
                ..spec.vehicle.clone()
            },
            lidar: LidarSpec { noise: 0.0, dropout: 0.0, ..spec.lidar.clone() },
            obstacle_angle: spec.env.obstacle_angle,
            reward: Arc::clone(&spec.reward),
        }
    }

    /// v_bar, the speed at which drivers drive that are in no hurry, m/s: the first `desired_speed` among the reward's
    /// fields, or else the 1.2 m/s of Liu et al.; within what the agent can ask for.
    pub fn desired_speed(&self) -> f64 {
        let fields = Value::try_from(&self.reward).ok();
        let desired = fields.as_ref().and_then(|fields| find(fields, "desired_speed")).unwrap_or(DESIRED_SPEED);
        desired.clamp(self.speeds[0], self.speeds[1].max(self.speeds[0]))
    }

    /// The reward in a few words: the types of its terms with their weights.
    pub fn reward_in_words(&self) -> String {
        Value::try_from(&self.reward).map_or_else(|_| "?".to_owned(), |fields| in_words(&fields))
    }

    /// What the process has in common with the training: vehicle, lidar, obstacle angle, reach radius and reward.
    pub(super) fn process(&self) -> NavSpec {
        let yaw_rates = vec![0.0];
        NavSpec {
            world: WorldSpec::Room(RoomSpec {
                width: Interval::Fixed(1000.0),
                height: Interval::Fixed(1000.0),
                obstacles: Quantity::Count(0),
                start_goal_clearance: 10.0,
                ..RoomSpec::default()
            }),
            vehicle: self.vehicle.clone(),
            lidar: self.lidar.clone(),
            env: EnvSpec {
                goal: GoalHandling::Terminate,
                reach_radius: self.reach_radius,
                route: RouteSource::None {},
                control: Control::Full {},
                actions: ActionSpec::Accelerate { yaw_rates },
                observation: ObservationSpec::default(),
                obstacle_angle: self.obstacle_angle,
                ..EnvSpec::default()
            },
            reward: Arc::clone(&self.reward),
            ..NavSpec::default()
        }
    }
}

/// The first number called `key` in a tree.
fn find(tree: &Value, key: &str) -> Option<f64> {
    match tree {
        Value::Table(table) => {
            let own = table.get(key).and_then(|value| value.as_float().or(value.as_integer().map(|n| n as f64)));
            own.or_else(|| table.values().find_map(|value| find(value, key)))
        }
        Value::Array(values) => values.iter().find_map(|value| find(value, key)),
        _ => None,
    }
}

/// A reward's type; of a sum, those of its terms with their weights.
fn in_words(reward: &Value) -> String {
    let of_type = reward.get("type").and_then(Value::as_str).unwrap_or("?");
    let Some(terms) = reward.get("terms").and_then(Value::as_array).filter(|_| of_type == "sum") else {
        return of_type.to_owned();
    };
    let mut words = String::new();
    for term in terms {
        let weight = term.get("weight").and_then(Value::as_float).unwrap_or(1.0);
        let Some(reward) = term.get("reward").filter(|_| weight != 0.0) else { continue };
        let inner = in_words(reward);
        let inner = if inner.contains(' ') { format!("({inner})") } else { inner };
        let sign = match (weight < 0.0, words.is_empty()) {
            (true, true) => "-",
            (true, false) => " - ",
            (false, true) => "",
            (false, false) => " + ",
        };
        let factor = if weight.abs() == 1.0 { String::new() } else { format!("{} ", weight.abs()) };
        words += &format!("{sign}{factor}{inner}");
    }
    if words.is_empty() { "nothing".to_owned() } else { words }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_reward::{R, RCouple, SteadySpeed, Sum};

    fn paying(reward: impl Reward + 'static) -> Case {
        Case::of(&RunSpec { reward: Arc::new(reward), ..RunSpec::default() })
    }

    #[test]
    fn rewards_in_words() {
        assert_eq!(paying(R::default()).reward_in_words(), "r");
        let inner = Sum::default().with(-2.0, R::default()).with(0.0, R::default()).with(1.0, RCouple::default());
        assert_eq!(paying(inner.clone()).reward_in_words(), "-2 r + r_couple");
        assert_eq!(paying(Sum::default().with(3.0, inner)).reward_in_words(), "3 (-2 r + r_couple)");
        assert_eq!(Case::of(&RunSpec::default()).reward_in_words(), "r + 40 progress - 2.5 time - 5 proximity");
    }

    #[test]
    fn the_desired_speed_is_the_rewards_within_what_can_be_asked_for() {
        assert_eq!(paying(SteadySpeed { desired_speed: 0.7, ..SteadySpeed::default() }).desired_speed(), 0.7);
        let inner = RCouple { desired_speed: 9.0, ..RCouple::default() };
        assert_eq!(paying(Sum::default().with(1.0, R::default()).with(1.0, inner)).desired_speed(), 1.5);
        assert_eq!(paying(R::default()).desired_speed(), 1.2);
    }
}
