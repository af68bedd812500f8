//! Action sets: what the numbers that an agent chooses mean.

use headway_sim::check::within;
use headway_sim::{Command, FieldError, VehicleSpec};
use serde::{Deserialize, Serialize};

use crate::{Control, Side};

/// A set of actions as data. Actions are numbered speed by speed, within a speed turn by turn, and within a turn sideways speed by
/// sideways speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum ActionSpec {
    /// Every pair of a speed and a yaw rate to approach.
    SetPoints {
        /// Speeds, m/s.
        speeds: Vec<f64>,
        /// Yaw rates, rad/s, positive to the left. Just `[0.0]` where the agent controls the speed only.
        yaw_rates: Vec<f64>,
        /// Speeds to the left, m/s, with each of these pairs: for vehicles that move sideways.
        #[serde(default = "straight", skip_serializing_if = "is_straight")]
        lateral_speeds: Vec<f64>,
    },
    /// Brake, keep the speed or accelerate, as hard as the vehicle can for one control period, with every
    /// yaw rate.
    Accelerate {
        /// Yaw rates, as in `set_points`.
        yaw_rates: Vec<f64>,
    },
}

fn straight() -> Vec<f64> {
    vec![0.0]
}

fn is_straight(lateral_speeds: &[f64]) -> bool {
    lateral_speeds == straight()
}

impl Default for ActionSpec {
    /// Twelve set-points: 0, 0.5, 1 and 1.5 m/s, turning right, not, and left at 1.5 rad/s.
    fn default() -> Self {
        Self::SetPoints {
            speeds: vec![0.0, 0.5, 1.0, 1.5],
            yaw_rates: vec![-1.5, 0.0, 1.5],
            lateral_speeds: straight(),
        }
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
        let lateral_speeds = match self {
            Self::SetPoints { lateral_speeds, .. } => lateral_speeds.clone(),
            Self::Accelerate { .. } => straight(),
        };
        let most = vehicle.drive.max_lateral_speed();
        check_list("lateral_speeds", &lateral_speeds, 0.0 - most, most)?;
        let mirror = |field: &str, numbers: &[f64]| {
            if is_mirrored { mirror_images(field, numbers) } else { Ok((0..numbers.len()).collect()) }
        };
        Ok(ActionSet {
            speeds,
            yaw_rates: Mirrored { images: mirror("yaw_rates", yaw_rates)?, numbers: yaw_rates.to_vec() },
            lateral_speeds: Mirrored { images: mirror("lateral_speeds", &lateral_speeds)?, numbers: lateral_speeds },
            range: (slowest, vehicle.max_speed),
        })
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
fn mirror_images(field: &str, numbers: &[f64]) -> Result<Vec<usize>, FieldError> {
    let image = |number: &f64| numbers.iter().position(|other| *other == -number);
    numbers.iter().map(image).collect::<Option<_>>().ok_or_else(|| {
        let allowed = "symmetric, w and -w alike, because observation.mirror is on";
        FieldError::new(field, format!("{numbers:?}"), allowed)
    })
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum SpeedRule {
    /// Approach this speed, m/s.
    To(f64),
    /// Change the speed by this much, m/s.
    By(f64),
}

/// Numbers that change their sign in a mirror.
#[derive(Debug, Clone, PartialEq)]
struct Mirrored {
    numbers: Vec<f64>,
    /// Of each number: where its negative stands.
    images: Vec<usize>,
}

impl Mirrored {
    fn get(&self, index: usize, side: Side) -> f64 {
        self.numbers[if side == Side::Mirrored { self.images[index] } else { index }]
    }
}

/// A checked action set.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionSet {
    speeds: Vec<SpeedRule>,
    yaw_rates: Mirrored,
    lateral_speeds: Mirrored,
    range: (f64, f64),
}

impl ActionSet {
    /// How many actions there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.speeds.len() * self.yaw_rates.numbers.len() * self.lateral_speeds.numbers.len()
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
        let (n_turns, n_aside) = (self.yaw_rates.numbers.len(), self.lateral_speeds.numbers.len());
        let (pair, aside) = (action as usize / n_aside, action as usize % n_aside);
        let (row, turn) = (pair / n_turns, pair % n_turns);
        let speed = match self.speeds[row] {
            SpeedRule::To(target) => target,
            SpeedRule::By(change) => (speed + change).clamp(self.range.0, self.range.1),
        };
        let (yaw_rate, lateral_speed) = (self.yaw_rates.get(turn, side), self.lateral_speeds.get(aside, side));
        Command { speed, yaw_rate, lateral_speed }
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
    fn sideways_speeds_count_within_turns_and_change_sign_in_a_mirror() {
        let spec = ActionSpec::SetPoints {
            speeds: vec![0.0, 0.5],
            yaw_rates: vec![-1.0, 1.0],
            lateral_speeds: vec![-0.4, 0.0, 0.4],
        };
        let drive = headway_sim::Drive::Omnidirectional { max_lateral_speed: 0.5 };
        let vehicle = VehicleSpec { drive, ..VehicleSpec::default() };
        let actions = spec.build(&vehicle, &Control::Full {}, true).unwrap();
        assert_eq!(actions.len(), 12);
        // Speed 0.5, yaw rate -1, 0.4 to the left.
        assert_eq!(actions.command(8, 0.0, Side::AsSeen), Command { lateral_speed: 0.4, ..Command::new(0.5, -1.0) });
        assert_eq!(actions.command(8, 0.0, Side::Mirrored), Command { lateral_speed: -0.4, ..Command::new(0.5, 1.0) });
        let error = spec.build(&VehicleSpec::default(), &Control::Full {}, true).unwrap_err();
        assert_eq!(error.to_string(), "lateral_speeds.0 = -0.4: must be from 0 to 0, the vehicle's limits");
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
            lateral_speeds: straight(),
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
