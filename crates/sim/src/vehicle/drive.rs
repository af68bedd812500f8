//! How wheels let a vehicle move.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use crate::FieldError;
use crate::check::{positive, within};

/// The kind of drive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Drive {
    /// Turns on the spot: two driven wheels, tracks, or skid steering. A unicycle.
    Differential {},
    /// Steers its front wheels: the kinematic bicycle around the middle of the rear axle, whose yaw rate is
    /// `v tan(steering) / wheelbase`. Commands ask for a yaw rate at a speed, which sets the steering angle; at speed 0 the
    /// wheels stay as they are. The vehicle's yaw acceleration is not used: the steering rate limits it.
    Ackermann {
        /// Distance between the axles, metres, from 0.01 to 100.
        wheelbase: f64,
        /// Greatest angle of the front wheels, radians, above 0 and below pi/2.
        max_steering_angle: f64,
        /// How fast that angle changes, rad/s, up to 1000.
        max_steering_rate: f64,
    },
    /// Moves sideways too: Mecanum wheels or swivelling ones.
    Omnidirectional {
        /// Highest speed to either side, m/s, up to 100.
        max_lateral_speed: f64,
    },
}

impl Default for Drive {
    fn default() -> Self {
        Self::Differential {}
    }
}

impl Drive {
    /// The tags of all kinds.
    pub const TYPES: [&str; 3] = ["differential", "ackermann", "omnidirectional"];

    pub(super) fn check(&self) -> Result<(), FieldError> {
        match *self {
            Self::Differential {} => Ok(()),
            Self::Ackermann { wheelbase, max_steering_angle, max_steering_rate } => {
                within("wheelbase", wheelbase, 0.01, 100.0)?;
                positive("max_steering_angle", max_steering_angle)?;
                within("max_steering_angle", max_steering_angle, 0.0, FRAC_PI_2 - 0.01)?;
                positive("max_steering_rate", max_steering_rate)?;
                within("max_steering_rate", max_steering_rate, 0.0, 1000.0)
            }
            Self::Omnidirectional { max_lateral_speed } => {
                positive("max_lateral_speed", max_lateral_speed)?;
                within("max_lateral_speed", max_lateral_speed, 0.0, 100.0)
            }
        }
    }

    /// Highest speed to either side, m/s.
    #[must_use]
    pub fn max_lateral_speed(&self) -> f64 {
        if let Self::Omnidirectional { max_lateral_speed } = self { *max_lateral_speed } else { 0.0 }
    }

    /// The tightest turn, metres from the vehicle's origin to the turn's centre; 0 for what turns on the spot.
    ///
    /// ```
    /// use headway_sim::Drive;
    /// let car = Drive::Ackermann { wheelbase: 0.5, max_steering_angle: 0.5, max_steering_rate: 2.0 };
    /// assert!((car.turning_radius() - 0.5 / 0.5_f64.tan()).abs() < 1e-12);
    /// assert_eq!(Drive::Differential {}.turning_radius(), 0.0);
    /// ```
    #[must_use]
    pub fn turning_radius(&self) -> f64 {
        match self {
            Self::Ackermann { wheelbase, max_steering_angle, .. } => wheelbase / max_steering_angle.tan(),
            _ => 0.0,
        }
    }

    /// What a turn at a speed and a yaw rate asks for: a steering angle, now `steering`, or else the yaw rate itself.
    pub(super) fn turn_target(&self, speed: f64, yaw_rate: f64, steering: f64) -> f64 {
        match *self {
            Self::Ackermann { .. } if speed == 0.0 => steering,
            Self::Ackermann { wheelbase, max_steering_angle, .. } => {
                (wheelbase * yaw_rate / speed).atan().clamp(-max_steering_angle, max_steering_angle)
            }
            _ => yaw_rate,
        }
    }
}
