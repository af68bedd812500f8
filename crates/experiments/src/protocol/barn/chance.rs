//! Whether runs of the same world can differ.

use headway_env::NavSpec;
use headway_sensors::{LidarSpec, OdometrySpec};
use headway_sim::ActuationSpec;

/// Whether anything under these conditions is drawn at random. Where nothing is, all runs of a world are the same: the protocol
/// fixes its start and its goal, and drivers draw nothing.
///
/// ```
/// use headway_env::NavSpec;
/// use headway_experiments::protocol::barn::is_random;
/// let mut conditions = NavSpec::default();
/// assert!(!is_random(&conditions));
/// conditions.vehicle.actuation.latency = 0.1; // always the same
/// assert!(!is_random(&conditions));
/// conditions.vehicle.actuation.noise = 0.05;
/// assert!(is_random(&conditions));
/// ```
#[must_use]
pub fn is_random(conditions: &NavSpec) -> bool {
    // Every field by its name: whoever adds one decides whether it is drawn.
    let LidarSpec { noise: range, dropout, n_beams: _, field_of_view: _, min_range: _, max_range: _, grazing_angle: _ } =
        conditions.lidar;
    let ActuationSpec { noise: motion, latency: _, speed_lag: _, yaw_rate_lag: _, yaw_rate_gain: _ } =
        conditions.vehicle.actuation;
    let OdometrySpec { distance_bias, turn_bias, yaw_rate_bias, distance_noise, yaw_walk } = conditions.odometry;
    let deviations = [range, dropout, motion, distance_bias, turn_bias, yaw_rate_bias, distance_noise, yaw_walk];
    !conditions.randomize.is_empty() || deviations.iter().any(|deviation| *deviation > 0.0)
}
