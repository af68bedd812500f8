use serde::{Deserialize, Serialize};

/// What a reward may know about one moment, in plain SI numbers.
///
/// Everything is relative to the vehicle: there is no position and no yaw, so no reward can tell where in the world, or
/// which way round, something happens. Lengths are in metres, angles in radians, right-handed (left is positive).
///
/// The values are the true ones of the world, free of sensor noise, except `scan`, which is what the lidar reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<'a> {
    /// Forward speed, m/s; negative in reverse.
    pub speed: f64,
    /// Yaw rate, rad/s; positive turns left.
    pub yaw_rate: f64,
    /// Straight-line distance from the vehicle's centre to the goal, m; never negative.
    pub goal_distance: f64,
    /// Angle from the driving direction to the goal, rad, in (-pi, pi]; positive when the goal lies on the left.
    pub goal_bearing: f64,
    /// Distance from the footprint to the nearest obstacle or wall, m; negative (the depth) when they overlap.
    pub clearance: f64,
    /// Unsigned angle between the driving direction and the nearest edge of the nearest obstacle (Liu et al., Fig. 1),
    /// rad, in [0, pi]; 0 when the obstacle lies across the driving direction, `None` when there is no obstacle near.
    pub obstacle_angle: Option<f64>,
    /// Lidar ranges `[n_beams]`, m; a beam that met nothing holds the lidar's maximum range.
    pub scan: &'a [f32],
    /// Directions of the beams `[n_beams]`, rad from the driving direction, in [-pi, pi]; positive on the left.
    pub beam_angles: &'a [f64],
}

impl Default for State<'_> {
    /// A vehicle at rest in the open, with a goal 5 m straight ahead, nothing within 10 m, and no lidar.
    fn default() -> Self {
        Self {
            speed: 0.0,
            yaw_rate: 0.0,
            goal_distance: 5.0,
            goal_bearing: 0.0,
            clearance: 10.0,
            obstacle_angle: None,
            scan: &[],
            beam_angles: &[],
        }
    }
}

/// What the vehicle can do: the bounds on its velocity and on the change of it, all positive.
///
/// A reward reads them to pay in shares of what is possible, or to know how far the vehicle needs to stop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Highest forward speed, m/s.
    pub max_speed: f64,
    /// Highest yaw rate to either side, rad/s.
    pub max_yaw_rate: f64,
    /// Highest acceleration and deceleration, m/s².
    pub max_acceleration: f64,
    /// Highest change of the yaw rate, rad/s².
    pub max_yaw_acceleration: f64,
}

impl Default for Limits {
    /// A small indoor robot: 1.5 m/s, 1.5 rad/s, 2 m/s², 6 rad/s².
    fn default() -> Self {
        Self { max_speed: 1.5, max_yaw_rate: 1.5, max_acceleration: 2.0, max_yaw_acceleration: 6.0 }
    }
}
