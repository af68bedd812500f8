//! Vehicles that people have.

use serde::{Deserialize, Serialize};

use super::{ActuationSpec, Drive, VehicleSpec};
use crate::Shape;

/// A vehicle by name; [`VehiclePreset::spec`] has its numbers, each with its source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VehiclePreset {
    /// The vehicle of `specs/default.toml`, a disc of 0.25 m that turns on the spot: ours, made to be learned with.
    #[default]
    Default,
    /// ROBOTIS TurtleBot3 Burger.
    Turtlebot3Burger,
    /// ROBOTIS TurtleBot3 Waffle, and Waffle Pi.
    Turtlebot3Waffle,
    /// Clearpath Jackal, as its controller's limits and its Gazebo collision shapes describe it.
    Jackal,
    /// The Jackal as the BARN challenge's Gazebo simulates it: what lies between its commands and its motion is fitted.
    JackalGazebo,
}

impl VehiclePreset {
    /// All presets with their names in specs.
    pub const ALL: [(&str, Self); 5] = [
        ("default", Self::Default),
        ("turtlebot3_burger", Self::Turtlebot3Burger),
        ("turtlebot3_waffle", Self::Turtlebot3Waffle),
        ("jackal", Self::Jackal),
        ("jackal_gazebo", Self::JackalGazebo),
    ];

    /// The vehicle.
    ///
    /// ```
    /// use headway_sim::VehiclePreset;
    /// for (_, preset) in VehiclePreset::ALL {
    ///     assert!(preset.spec().build().is_ok());
    /// }
    /// assert_eq!(VehiclePreset::Turtlebot3Burger.spec().max_speed, 0.22);
    /// ```
    #[must_use]
    pub fn spec(self) -> VehicleSpec {
        match self {
            Self::Default => VehicleSpec {
                footprint: Shape::Disc { radius: 0.25 },
                drive: Drive::Differential {},
                max_speed: 1.5,
                max_reverse_speed: 0.0,
                max_yaw_rate: 1.5,
                max_acceleration: 2.0,
                max_yaw_acceleration: 6.0,
                control_period: 0.2,
                n_substeps: 4,
                actuation: ActuationSpec::default(),
            },
            // Speeds: ROBOTIS e-Manual, TurtleBot3 specifications. Outlines around the axle and accelerations (acc_lim_x,
            // acc_lim_theta): turtlebot3_navigation, costmap_common_params_* and dwa_local_planner_params_*.
            Self::Turtlebot3Burger => VehicleSpec {
                footprint: rectangle([-0.105, 0.041], 0.105),
                max_speed: 0.22,
                max_reverse_speed: 0.22,
                max_yaw_rate: 2.84,
                max_acceleration: 2.5,
                max_yaw_acceleration: 3.2,
                ..Self::Default.spec()
            },
            Self::Turtlebot3Waffle => VehicleSpec {
                footprint: rectangle([-0.205, 0.077], 0.155),
                max_speed: 0.26,
                max_reverse_speed: 0.26,
                max_yaw_rate: 1.82,
                max_acceleration: 2.5,
                max_yaw_acceleration: 3.2,
                ..Self::Default.spec()
            },
            // Outline: jackal.urdf.xacro, wheels of radius 0.098 m and width 0.04 m at 0.131 m ahead and 0.18780 m aside, which
            // hold the body of 0.42 x 0.31 m between them. Speeds and yaw acceleration: jackal_control, control.yaml. That
            // asks for 20 m/s^2, but tyres of the URDF's friction coefficient of 0.5 pass on no more than 0.5 g = 4.9 m/s^2.
            Self::Jackal => VehicleSpec {
                footprint: Shape::Box { length: 0.458, width: 0.4156 },
                max_speed: 2.0,
                max_reverse_speed: 2.0,
                max_yaw_rate: 4.0,
                max_acceleration: 4.9,
                max_yaw_acceleration: 25.0,
                control_period: 0.1,
                ..Self::Default.spec()
            },
            // Fitted, not measured: such that the published DWA takes the published time in half of BARN's public worlds;
            // docs/results.md has the other half, and what each number does. Commands pass move_base (20 Hz), a multiplexer and a
            // controller; to turn, four wheels must skid, so that a part of the yaw rate is lost.
            Self::JackalGazebo => VehicleSpec {
                control_period: 0.05,
                actuation: ActuationSpec { latency: 0.2, yaw_rate_gain: 0.5, noise: 0.05, ..ActuationSpec::default() },
                ..Self::Jackal.spec()
            },
        }
    }
}

/// An outline from `x[0]` behind to `x[1]` ahead of the axle, and `half_width` to both sides.
fn rectangle([back, front]: [f64; 2], half_width: f64) -> Shape {
    let corners = [[back, -half_width], [front, -half_width], [front, half_width], [back, half_width]];
    Shape::Polygon { vertices: corners.into() }
}
