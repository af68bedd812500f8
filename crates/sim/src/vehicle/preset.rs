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
    /// F1TENTH (RoboRacer), the racing car of one tenth the size, as `f1tenth_gym` describes it: Ackermann drive.
    F1tenth,
    /// Clearpath Ridgeback: Mecanum wheels, which move it sideways too.
    Ridgeback,
}

impl VehiclePreset {
    /// All presets with their names in specs.
    pub const ALL: [(&str, Self); 7] = [
        ("default", Self::Default),
        ("turtlebot3_burger", Self::Turtlebot3Burger),
        ("turtlebot3_waffle", Self::Turtlebot3Waffle),
        ("jackal", Self::Jackal),
        ("jackal_gazebo", Self::JackalGazebo),
        ("f1tenth", Self::F1tenth),
        ("ridgeback", Self::Ridgeback),
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
            Self::Default => default_robot(),
            Self::Turtlebot3Burger => turtlebot3_burger(),
            Self::Turtlebot3Waffle => turtlebot3_waffle(),
            Self::Jackal => jackal(),
            Self::JackalGazebo => jackal_gazebo(),
            Self::F1tenth => f1tenth(),
            Self::Ridgeback => ridgeback(),
        }
    }
}

fn default_robot() -> VehicleSpec {
    VehicleSpec {
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
    }
}

/// Speeds: ROBOTIS e-Manual, TurtleBot3 specifications. Outlines around the axle and accelerations (acc_lim_x,
/// acc_lim_theta): turtlebot3_navigation, costmap_common_params_* and dwa_local_planner_params_*.
fn turtlebot3_burger() -> VehicleSpec {
    VehicleSpec {
        footprint: rectangle([-0.105, 0.041], 0.105),
        max_speed: 0.22,
        max_reverse_speed: 0.22,
        max_yaw_rate: 2.84,
        max_acceleration: 2.5,
        max_yaw_acceleration: 3.2,
        ..default_robot()
    }
}

fn turtlebot3_waffle() -> VehicleSpec {
    VehicleSpec {
        footprint: rectangle([-0.205, 0.077], 0.155),
        max_speed: 0.26,
        max_reverse_speed: 0.26,
        max_yaw_rate: 1.82,
        max_acceleration: 2.5,
        max_yaw_acceleration: 3.2,
        ..default_robot()
    }
}

/// Outline: jackal.urdf.xacro, wheels of radius 0.098 m and width 0.04 m at 0.131 m ahead and 0.18780 m aside, which
/// hold the body of 0.42 x 0.31 m between them. Speeds and yaw acceleration: jackal_control, control.yaml. That
/// asks for 20 m/s^2, but tyres of the URDF's friction coefficient of 0.5 pass on no more than 0.5 g = 4.9 m/s^2.
fn jackal() -> VehicleSpec {
    VehicleSpec {
        footprint: Shape::Box { length: 0.458, width: 0.4156 },
        max_speed: 2.0,
        max_reverse_speed: 2.0,
        max_yaw_rate: 4.0,
        max_acceleration: 4.9,
        max_yaw_acceleration: 25.0,
        control_period: 0.1,
        ..default_robot()
    }
}

/// Fitted, not measured: such that the published DWA takes the published time in half of BARN's public worlds;
/// docs/results.md has the other half, and what each number does. Commands pass move_base (20 Hz), a multiplexer and a
/// controller; to turn, four wheels must skid, so that a part of the yaw rate is lost.
fn jackal_gazebo() -> VehicleSpec {
    VehicleSpec {
        control_period: 0.05,
        actuation: ActuationSpec { latency: 0.2, yaw_rate_gain: 0.5, noise: 0.05, ..ActuationSpec::default() },
        ..jackal()
    }
}

/// f1tenth_gym, f110_env.py, the default parameters: lf 0.15875 m and lr 0.17145 m from the centre of gravity to the
/// axles, s_max 0.4189 rad, sv_max 3.2 rad/s, a_max 9.51 m/s^2, length 0.58 m and width
/// 0.31 m around the centre of gravity. No yaw rate there: tyres of that file's friction coefficient, mu = 1.0489,
/// pass on sqrt(mu g / 0.742 m) = 3.72 rad/s in the tightest turn, of 0.742 m at the rear axle, which is 2.76 m/s. That
/// file goes on to 20 m/s; there tyres slide, which is not modelled here. Its time step of 0.01 s is a substep, of
/// which a command holds for four.
fn f1tenth() -> VehicleSpec {
    VehicleSpec {
        footprint: rectangle([0.17145 - 0.29, 0.17145 + 0.29], 0.155),
        drive: Drive::Ackermann { wheelbase: 0.15875 + 0.17145, max_steering_angle: 0.4189, max_steering_rate: 3.2 },
        max_speed: 2.76,
        max_reverse_speed: 2.76,
        max_yaw_rate: 3.72,
        max_acceleration: 9.51,
        control_period: 0.04,
        ..default_robot()
    }
}

/// Outline: Clearpath's data sheet, 960 x 793 mm. Speeds and accelerations ahead, aside and of the yaw:
/// ridgeback_control, control.yaml.
fn ridgeback() -> VehicleSpec {
    VehicleSpec {
        footprint: Shape::Box { length: 0.96, width: 0.793 },
        drive: Drive::Omnidirectional { max_lateral_speed: 1.1 },
        max_speed: 1.1,
        max_reverse_speed: 1.1,
        max_yaw_rate: 2.0,
        max_acceleration: 2.5,
        max_yaw_acceleration: 1.0,
        control_period: 0.1,
        ..default_robot()
    }
}

/// An outline from `x[0]` behind to `x[1]` ahead of the axle, and `half_width` to both sides.
fn rectangle([back, front]: [f64; 2], half_width: f64) -> Shape {
    let corners = [[back, -half_width], [front, -half_width], [front, half_width], [back, half_width]];
    Shape::Polygon { vertices: corners.into() }
}
