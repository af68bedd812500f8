//! What drives: a vehicle with its sensors.

use headway_sensors::{Lidar, LidarSpec, OdometrySpec};
use headway_sim::{FieldError, Vehicle, VehicleSpec};

/// A checked vehicle with its checked sensors.
#[derive(Debug)]
pub(crate) struct Robot {
    pub(crate) vehicle: Vehicle,
    pub(crate) lidar: Lidar,
    pub(crate) odometry: OdometrySpec,
}

impl Robot {
    /// Checks all numbers; errors name the table.
    pub(crate) fn build(vehicle: &VehicleSpec, lidar: &LidarSpec, odometry: &OdometrySpec) -> Result<Self, FieldError> {
        odometry.check().map_err(|e| e.under("odometry"))?;
        Ok(Self {
            vehicle: vehicle.build().map_err(|e| e.under("vehicle"))?,
            lidar: lidar.build().map_err(|e| e.under("lidar"))?,
            odometry: *odometry,
        })
    }
}
