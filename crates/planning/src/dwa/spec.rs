//! The dynamic window approach as data.

use headway_sim::FieldError;
use headway_sim::check::{non_negative, positive, within};
use serde::{Deserialize, Serialize};

use super::map_grid::MapGrid;
use super::recovery::Recovery;
use super::rollout::OutlinePoints;
use super::{Dwa, Turns};
use crate::{CostmapSpec, ScanMapSpec};

/// Which costs a trajectory is charged with. Whichever it is, no outline may touch a marked cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ObstacleCost {
    /// The greatest on the padded footprint's outline and at its middle, as `base_local_planner` has it. An outline that comes within
    /// the inscribed radius of a mark pays 253 already: with the published scale of 0.1 as much as 25 cells, more than
    /// what two seconds at 0.5 m/s gain, so that it stands and turns in front of gaps that it could pass.
    #[default]
    Outline,
    /// The greatest at the footprint's middle.
    Middle,
}

/// When a [`Dwa`] with no admissible trajectory left backs up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Escape {
    /// If nothing is marked twice the distance back.
    #[default]
    IfFree,
    /// In any case, as `base_local_planner` has it ("if the trajectory failed because the footprint hits something, we're
    /// still going to back up"). It gets out of places where it would else stand, and hits what a lidar that looks ahead no longer
    /// sees; and it never waits long enough to recover.
    Always,
}

/// How a [`Dwa`] drives, as data.
///
/// The default is the one published with the BARN challenge (Perille et al. 2020), which drives at up to 0.5 m/s. To drive
/// faster, raise `max_speed` and choose `sim_time` such that the way driven in thought stays within what scans mark: at 2 m/s,
/// a `sim_time` of 1 s and a window of 6 m. To get through more gaps, and sooner, let [`ObstacleCost::Middle`] count.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DwaSpec {
    /// What trajectories are checked in; its `map.max_size` does not count, `window` does.
    pub costmap: CostmapSpec,
    /// Side of the window around the vehicle that is looked at, metres: at least twice `max_speed * sim_time` and
    /// 2 m more, at most 1000 cells.
    pub window: f64,
    /// Lowest forward speed other than 0, m/s.
    pub min_speed: f64,
    /// Highest forward speed, m/s, if the vehicle's is not lower.
    pub max_speed: f64,
    /// Highest yaw rate, rad/s, if the vehicle's is not lower.
    pub max_yaw_rate: f64,
    /// Lowest yaw rate of a turn on the spot, rad/s.
    pub min_turn_rate: f64,
    /// Change of speed to count with, m/s^2, if the vehicle's is not lower.
    pub max_acceleration: f64,
    /// Change of yaw rate to count with, rad/s^2, if the vehicle's is not lower.
    pub max_yaw_acceleration: f64,
    /// Speeds tried; 1 to 100.
    pub n_speeds: usize,
    /// Yaw rates tried with each, beside straight on; 2 to 200.
    pub n_yaw_rates: usize,
    /// Time that each pair is driven in thought, seconds.
    pub sim_time: f64,
    /// Distance between two checks on the way, metres at most.
    pub sim_granularity: f64,
    /// Angle between two checks on the way, radians at most.
    pub angular_sim_granularity: f64,
    /// What a cell, or with `meter_scoring` a metre, of distance to the route costs.
    pub path_distance_bias: f64,
    /// What a cell, or with `meter_scoring` a metre, of distance to the local goal costs.
    pub goal_distance_bias: f64,
    /// Whether the two biases are per metre rather than per cell.
    ///
    /// BARN's file says `true`. `base_local_planner` of ROS Melodic never gives the member that remembers it a value, and
    /// reads it when the parameters are applied, so that what ran there cannot be told. Per metre, obstacles weigh twenty
    /// times more.
    pub meter_scoring: bool,
    /// What a unit of the costmap's cost costs.
    pub occdist_scale: f64,
    /// Which cost that is.
    pub obstacle_cost: ObstacleCost,
    /// How far ahead of it a turn on the spot looks for the local goal, metres.
    pub heading_lookahead: f64,
    /// Distance after which turns on the spot are forgotten, metres.
    pub oscillation_reset_distance: f64,
    /// Distance to the goal at which it stops, metres.
    pub goal_tolerance: f64,
    /// Speed at which it backs up where nothing else is left, m/s, if the vehicle's is not lower; 0 for never.
    pub escape_speed: f64,
    /// When it does.
    pub escape: Escape,
    /// Distance after which backing up is over, metres.
    pub escape_reset_distance: f64,
    /// Turn after which backing up is over, radians.
    pub escape_reset_angle: f64,
    /// Time without an admissible trajectory after which it recovers, seconds (`controller_patience` of ROS's `move_base`).
    pub patience: f64,
    /// Distance beyond which a recovery forgets what is marked, metres; half of it the second time in a row, and so on.
    pub reset_distance: f64,
    /// Whether a recovery turns the vehicle once around, at 1 rad/s at most, as far as there is room.
    pub clearing_rotation: bool,
}

impl Default for DwaSpec {
    fn default() -> Self {
        Self {
            costmap: CostmapSpec::default(),
            // Published: 10 m, of which nothing beyond 3 m is ever seen.
            window: 5.0,
            min_speed: 0.1,
            max_speed: 0.5,
            max_yaw_rate: 1.57,
            min_turn_rate: 0.314,
            max_acceleration: 10.0,
            max_yaw_acceleration: 20.0,
            n_speeds: 6,
            n_yaw_rates: 20,
            sim_time: 2.0,
            // Published: 0.02 and 0.02, which take more than three times as long and find the same.
            sim_granularity: 0.05,
            angular_sim_granularity: 0.1,
            path_distance_bias: 0.75,
            goal_distance_bias: 1.0,
            meter_scoring: false,
            occdist_scale: 0.1,
            obstacle_cost: ObstacleCost::Outline,
            heading_lookahead: 0.325,
            oscillation_reset_distance: 0.05,
            goal_tolerance: 0.25,
            escape_speed: 0.5,
            escape: Escape::default(),
            escape_reset_distance: 0.1,
            escape_reset_angle: 0.1,
            patience: 15.0,
            reset_distance: 3.0,
            clearing_rotation: true,
        }
    }
}

impl DwaSpec {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn check(&self) -> Result<(), FieldError> {
        self.costmap.check().map_err(|e| e.under("costmap"))?;
        positive("max_speed", self.max_speed)?;
        within("min_speed", self.min_speed, 0.0, self.max_speed)?;
        positive("max_yaw_rate", self.max_yaw_rate)?;
        within("min_turn_rate", self.min_turn_rate, 0.0, self.max_yaw_rate)?;
        positive("max_acceleration", self.max_acceleration)?;
        positive("max_yaw_acceleration", self.max_yaw_acceleration)?;
        within("n_speeds", self.n_speeds as f64, 1.0, 100.0)?;
        within("n_yaw_rates", self.n_yaw_rates as f64, 2.0, 200.0)?;
        positive("sim_time", self.sim_time)?;
        within("sim_granularity", self.sim_granularity, 1e-3, 1.0)?;
        within("angular_sim_granularity", self.angular_sim_granularity, 1e-3, 1.0)?;
        self.check_scores()?;
        let (least, most) = (2.0 * self.max_speed * self.sim_time + 2.0, 1000.0 * self.costmap.map.cell);
        if (least..=most).contains(&self.window) {
            return Ok(());
        }
        let allowed = format!("from {least} (twice max_speed * sim_time, and 2 m) to {most} (1000 cells)");
        Err(FieldError::new("window", self.window, allowed))
    }

    /// What a cell of distance to the route and one to the local goal cost.
    pub(super) fn biases(&self) -> [f64; 2] {
        let scale = if self.meter_scoring { self.costmap.map.cell } else { 1.0 };
        [self.path_distance_bias, self.goal_distance_bias].map(|bias| bias * scale)
    }

    /// The map of marks that it drives by.
    fn window_spec(&self) -> ScanMapSpec {
        ScanMapSpec { max_size: self.window, ..self.costmap.map }
    }

    fn check_scores(&self) -> Result<(), FieldError> {
        for (field, number) in [
            ("path_distance_bias", self.path_distance_bias),
            ("goal_distance_bias", self.goal_distance_bias),
            ("occdist_scale", self.occdist_scale),
            ("heading_lookahead", self.heading_lookahead),
            ("oscillation_reset_distance", self.oscillation_reset_distance),
            ("goal_tolerance", self.goal_tolerance),
            ("escape_speed", self.escape_speed),
            ("escape_reset_distance", self.escape_reset_distance),
            ("escape_reset_angle", self.escape_reset_angle),
            ("patience", self.patience),
            ("reset_distance", self.reset_distance),
        ] {
            non_negative(field, number)?;
        }
        Ok(())
    }

    /// Checks the numbers and makes a driver that has seen nothing.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn build(&self) -> Result<Dwa, FieldError> {
        self.check()?;
        Ok(Dwa {
            spec: self.clone(),
            costmap: CostmapSpec { map: self.window_spec(), ..self.costmap.clone() }.build()?.around_vehicle(),
            grid: MapGrid::default(),
            outline: OutlinePoints::default(),
            turns: Turns::default(),
            escape: None,
            recovery: Recovery::default(),
        })
    }
}
