//! What lies between a command and the wheels.

use serde::{Deserialize, Serialize};

use crate::FieldError;
use crate::check::{fraction, within};

/// How commands reach the wheels, as data: the defaults are actuators without faults.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ActuationSpec {
    /// Time from a command to its effect, seconds, up to 2; rounded to whole substeps. Until the first one arrives, the
    /// vehicle stands.
    pub latency: f64,
    /// Time constant with which the speed follows, seconds, up to 10: `dv/dt = (target - v) / lag`, within the acceleration.
    pub speed_lag: f64,
    /// Time constant with which the yaw rate follows, or under Ackermann drive the steering angle, seconds, up to 10.
    pub yaw_rate_lag: f64,
    /// Standard deviation of the factor on each number of every command, a fraction.
    pub noise: f64,
    /// Share of the yaw rate asked for that is reached, from 0.1 to 2: wheels that must skid to turn reach less than all.
    /// Not used under Ackermann drive, whose wheels roll.
    pub yaw_rate_gain: f64,
}

impl Default for ActuationSpec {
    fn default() -> Self {
        Self { latency: 0.0, speed_lag: 0.0, yaw_rate_lag: 0.0, noise: 0.0, yaw_rate_gain: 1.0 }
    }
}

impl ActuationSpec {
    pub(super) fn check(&self) -> Result<(), FieldError> {
        within("latency", self.latency, 0.0, 2.0)?;
        within("speed_lag", self.speed_lag, 0.0, 10.0)?;
        within("yaw_rate_lag", self.yaw_rate_lag, 0.0, 10.0)?;
        fraction("noise", self.noise)?;
        within("yaw_rate_gain", self.yaw_rate_gain, 0.1, 2.0)
    }
}
