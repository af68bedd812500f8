//! Action sets: what the numbers that an agent chooses mean.

use headway_sim::check::within;
use headway_sim::{Command, FieldError, VehicleSpec};
use serde::{Deserialize, Serialize};

use crate::{Control, Side};

/// A set of actions as data. Actions are numbered speed by speed, and within a speed turn by turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum ActionSpec {
    /// Every pair of a speed and a yaw rate to approach.
    SetPoints {
        /// Speeds, m/s.
        speeds: Vec<f64>,
        /// Yaw rates, rad/s, positive to the left. Just `[0.0]` where the agent controls the speed only.
        yaw_rates: Vec<f64>,
    },
    /// Brake, keep the speed or accelerate, as hard as the vehicle can for one control period, with every
    /// yaw rate.
    Accelerate {
        /// Yaw rates, as in `set_points`.
        yaw_rates: Vec<f64>,
    },
}

impl Default for ActionSpec {
    /// Twelve set-points: 0, 0.5, 1 and 1.5 m/s, turning right, not, and left at 1.5 rad/s.
    fn default() -> Self {
        Self::SetPoints { speeds: vec![0.0, 0.5, 1.0, 1.5], yaw_rates: vec![-1.5, 0.0, 1.5] }
    }
}

impl ActionSpec {
    fn yaw_rates(&self) -> &[f64] {
        match self {
            Self::SetPoints { yaw_rates, .. } | Self::Accelerate { yaw_rates } => yaw_rates,
        }
    }

    /// Checks the set against the vehicle that is to act and builds it.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed: speeds and yaw rates within the vehicle's limits, a
    /// mirror image of every yaw rate if observations are mirrored, `[0.0]` if the agent does not steer.
    pub fn build(&self, vehicle: &VehicleSpec, control: &Control, is_mirrored: bool) -> Result<ActionSet, FieldError> {
        let yaw_rates = self.yaw_rates();
        check_list("yaw_rates", yaw_rates, -vehicle.max_yaw_rate, vehicle.max_yaw_rate)?;
        if matches!(control, Control::SpeedOnly { .. }) && yaw_rates != [0.0] {
            let allowed = "[0.0] under speed_only control, where pure pursuit steers";
            return Err(FieldError::new("yaw_rates", format!("{yaw_rates:?}"), allowed));
        }
        let slowest = match control {
            Control::Full {} => 0.0 - vehicle.max_reverse_speed,
            Control::SpeedOnly { .. } => 0.0, // pure pursuit drives forward
        };
        let speeds = match self {
            Self::SetPoints { speeds, .. } => {
                check_list("speeds", speeds, slowest, vehicle.max_speed)?;
                speeds.iter().map(|speed| SpeedRule::To(*speed)).collect()
            }
            Self::Accelerate { .. } => {
                let change = vehicle.max_acceleration * vehicle.control_period;
                [-change, 0.0, change].map(SpeedRule::By).to_vec()
            }
        };
        let mirror = if is_mirrored { mirror_images(yaw_rates)? } else { (0..yaw_rates.len()).collect() };
        Ok(ActionSet { speeds, yaw_rates: yaw_rates.to_vec(), mirror, range: (slowest, vehicle.max_speed) })
    }
}

fn check_list(field: &str, values: &[f64], low: f64, high: f64) -> Result<(), FieldError> {
    if values.is_empty() {
        return Err(FieldError::new(field, "[]", "one number or more"));
    }
    within(&format!("{field}.len"), values.len() as f64, 1.0, 1000.0)?;
    values.iter().enumerate().try_for_each(|(i, value)| {
        within(&format!("{field}.{i}"), *value, low, high).map_err(|mut error| {
            error.allowed += ", the vehicle's limits";
            error
        })
    })
}

/// Where the negative of each number stands in the list.
fn mirror_images(yaw_rates: &[f64]) -> Result<Vec<usize>, FieldError> {
    let image = |rate: &f64| yaw_rates.iter().position(|other| *other == -rate);
    yaw_rates.iter().map(image).collect::<Option<_>>().ok_or_else(|| {
        let allowed = "symmetric, w and -w alike, because observation.mirror is on";
        FieldError::new("yaw_rates", format!("{yaw_rates:?}"), allowed)
    })
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum SpeedRule {
    /// Approach this speed, m/s.
    To(f64),
    /// Change the speed by this much, m/s.
    By(f64),
}

/// A checked action set.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionSet {
    speeds: Vec<SpeedRule>,
    yaw_rates: Vec<f64>,
    mirror: Vec<usize>,
    range: (f64, f64),
}

impl ActionSet {
    /// How many actions there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.speeds.len() * self.yaw_rates.len()
    }

    /// Whether there are none, which never happens.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The command that an action means for a vehicle at `speed` (m/s), chosen on an observation of the
    /// given side.
    ///
    /// # Panics
    /// If there is no such action.
    #[must_use]
    pub fn command(&self, action: u32, speed: f64, side: Side) -> Command {
        let n_turns = self.yaw_rates.len();
        let (row, turn) = (action as usize / n_turns, action as usize % n_turns);
        let turn = if side == Side::Mirrored { self.mirror[turn] } else { turn };
        let speed = match self.speeds[row] {
            SpeedRule::To(target) => target,
            SpeedRule::By(change) => (speed + change).clamp(self.range.0, self.range.1),
        };
        Command::new(speed, self.yaw_rates[turn])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn build(spec: &ActionSpec) -> ActionSet {
        spec.build(&VehicleSpec::default(), &Control::Full {}, true).unwrap()
    }

    #[test]
    fn actions_count_turns_within_speeds() {
        let actions = build(&ActionSpec::default());
        assert_eq!(actions.len(), 12);
        let command = |action, side| actions.command(action, 0.0, side);
        assert_eq!(command(5, Side::AsSeen), Command::new(0.5, 1.5));
        assert_eq!(command(5, Side::Mirrored), Command::new(0.5, -1.5));
        assert_eq!(command(10, Side::Mirrored), Command::new(1.5, 0.0));
    }

    #[test]
    fn brake_keep_and_accelerate_change_the_speed_within_limits() {
        let actions = build(&ActionSpec::Accelerate { yaw_rates: vec![-1.0, 0.0, 1.0] });
        let speed = |action, from| actions.command(action, from, Side::AsSeen).speed;
        assert!((speed(0, 1.0) - 0.6).abs() < 1e-12); // 2 m/s^2 for 0.2 s
        assert_eq!(speed(4, 1.0), 1.0);
        assert_eq!(speed(8, 1.3), 1.5);
        assert_eq!(speed(2, 0.1), 0.0);
    }

    #[test]
    fn refusals_name_the_field() {
        let refused =
            |spec: &ActionSpec, control| spec.build(&VehicleSpec::default(), &control, true).unwrap_err().to_string();
        let set = |speeds: &[f64], yaw_rates: &[f64]| ActionSpec::SetPoints {
            speeds: speeds.to_vec(),
            yaw_rates: yaw_rates.to_vec(),
        };
        assert_eq!(
            refused(&set(&[0.0, 2.0], &[0.0]), Control::Full {}),
            "speeds.1 = 2: must be from 0 to 1.5, the vehicle's limits"
        );
        assert_eq!(
            refused(&set(&[1.0], &[0.0, 1.0]), Control::Full {}),
            "yaw_rates = [0.0, 1.0]: must be symmetric, w and -w alike, because observation.mirror is on"
        );
        assert_eq!(refused(&set(&[], &[0.0]), Control::Full {}), "speeds = []: must be one number or more");
        let speed_only = Control::SpeedOnly { pursuit: Default::default() };
        assert!(refused(&set(&[1.0], &[-1.0, 1.0]), speed_only).contains("under speed_only control"));
    }
}
