//! Vehicles as data.

use serde::{Deserialize, Serialize};

use super::body::Dynamics;
use super::{ActuationSpec, Drive, Vehicle, VehiclePreset};
use crate::check::{non_negative, positive, within};
use crate::{FieldError, Footprint, Shape};

/// A vehicle as data: outline, drive, limits, actuators, control period.
///
/// Read from a table that names a `preset`, all that the table leaves out is the preset's:
///
/// ```
/// use headway_sim::{VehiclePreset, VehicleSpec};
/// let slow: VehicleSpec = toml::from_str("preset = 'jackal'\nmax_speed = 0.5")?;
/// let jackal = VehiclePreset::Jackal.spec();
/// assert_eq!(slow, VehicleSpec { max_speed: 0.5, ..jackal });
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "Fields")]
pub struct VehicleSpec {
    /// The outline, around the middle of the axle, under Ackermann drive the rear one; no point of it farther than 100 m from
    /// there.
    pub footprint: Shape,
    /// How it moves.
    pub drive: Drive,
    /// Highest forward speed, m/s; up to 100.
    pub max_speed: f64,
    /// Highest backward speed, m/s; up to 100, 0 for a vehicle that does not reverse.
    pub max_reverse_speed: f64,
    /// Highest yaw rate to either side that a command can ask for, rad/s; up to 100.
    pub max_yaw_rate: f64,
    /// Highest change of speed, m/s^2, speeding up and braking, ahead and sideways; up to 10 000.
    pub max_acceleration: f64,
    /// Highest change of yaw rate, rad/s^2; up to 10 000.
    pub max_yaw_acceleration: f64,
    /// Time between two commands, seconds; from 0.001 to 10.
    pub control_period: f64,
    /// Integration steps per control period; from 1 to 1000.
    pub n_substeps: usize,
    /// How commands reach the wheels.
    pub actuation: ActuationSpec,
}

impl Default for VehicleSpec {
    fn default() -> Self {
        VehiclePreset::Default.spec()
    }
}

/// A [`VehicleSpec`] of which anything may be missing.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Fields {
    preset: VehiclePreset,
    footprint: Option<Shape>,
    drive: Option<Drive>,
    max_speed: Option<f64>,
    max_reverse_speed: Option<f64>,
    max_yaw_rate: Option<f64>,
    max_acceleration: Option<f64>,
    max_yaw_acceleration: Option<f64>,
    control_period: Option<f64>,
    n_substeps: Option<usize>,
    actuation: Option<ActuationSpec>,
}

impl From<Fields> for VehicleSpec {
    fn from(given: Fields) -> Self {
        let preset = given.preset.spec();
        Self {
            footprint: given.footprint.unwrap_or(preset.footprint),
            drive: given.drive.unwrap_or(preset.drive),
            max_speed: given.max_speed.unwrap_or(preset.max_speed),
            max_reverse_speed: given.max_reverse_speed.unwrap_or(preset.max_reverse_speed),
            max_yaw_rate: given.max_yaw_rate.unwrap_or(preset.max_yaw_rate),
            max_acceleration: given.max_acceleration.unwrap_or(preset.max_acceleration),
            max_yaw_acceleration: given.max_yaw_acceleration.unwrap_or(preset.max_yaw_acceleration),
            control_period: given.control_period.unwrap_or(preset.control_period),
            n_substeps: given.n_substeps.unwrap_or(preset.n_substeps),
            actuation: given.actuation.unwrap_or(preset.actuation),
        }
    }
}

impl VehicleSpec {
    /// Checks the numbers and builds the vehicle.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed.
    pub fn build(&self) -> Result<Vehicle, FieldError> {
        let footprint = Footprint::new(&self.footprint).map_err(|e| e.under("footprint"))?;
        within("footprint (its circumradius)", footprint.circumradius(), 0.0, 100.0)?;
        self.drive.check().map_err(|e| e.under("drive"))?;
        non_negative("max_reverse_speed", self.max_reverse_speed)?;
        within("max_reverse_speed", self.max_reverse_speed, 0.0, 100.0)?;
        for (field, limit, most) in [
            ("max_speed", self.max_speed, 100.0),
            ("max_yaw_rate", self.max_yaw_rate, 100.0),
            ("max_acceleration", self.max_acceleration, 1e4),
            ("max_yaw_acceleration", self.max_yaw_acceleration, 1e4),
        ] {
            positive(field, limit)?;
            within(field, limit, 0.0, most)?;
        }
        within("control_period", self.control_period, 1e-3, 10.0)?;
        within("n_substeps", self.n_substeps as f64, 1.0, 1000.0)?;
        self.actuation.check().map_err(|e| e.under("actuation"))?;
        Ok(Vehicle { dynamics: Dynamics::new(self), spec: self.clone(), footprint })
    }
}
