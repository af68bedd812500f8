//! What a vehicle perceives: lidar scans with noise and dropout, and the obstacle angle of Liu et al.
//! (Fig. 1).
//!
//! Sensors read a [`headway_sim::World`] at a pose; they know no reward and no learning. Ranges are
//! `f32`: a measurement is no better than its seven digits, and learning takes it as it is.
//!
//! # Example
//! ```
//! use headway_sensors::LidarSpec;
//! use headway_sim::{Pose, Room, World, stream};
//!
//! let world = World::new(Room::new(10.0, 15.0), vec![])?;
//! let lidar = LidarSpec { max_range: 20.0, ..LidarSpec::default() }.build()?;
//! let mut scan = vec![0.0; lidar.beam_angles().len()];
//! lidar.scan(&world, &Pose::translation(4.0, 5.0), &mut stream(0, "noise", 0), &mut scan);
//! assert_eq!(lidar.beam_angles()[18], 0.0); // of 36 beams, this one looks ahead
//! assert_eq!(scan[18], 6.0);
//! # Ok::<(), headway_sim::SimError>(())
//! ```

mod beams;
mod grazing;
mod kernel;
mod lidar;
mod obstacle_angle;
mod odometry;

pub use lidar::{Lidar, LidarSpec, beam_angles};
pub use obstacle_angle::{ObstacleAngle, ObstacleAngleSpec, direction_of_motion};
pub use odometry::{Odometry, OdometrySpec};
