//! World geometry, vehicle kinematics with limits, collision and seeded scenarios.
//!
//! The crate answers four questions and knows nothing else: where things are ([`World`]), how a
//! vehicle moves ([`Vehicle`]), how others move ([`Crowd`]), and which worlds to drive in ([`WorldSpec`]). It
//! knows no sensor, no reward and no learning.
//! The crate answers three questions and knows nothing else: where things are ([`World`]), how a
//! vehicle moves ([`Vehicle`]), and which worlds to drive in ([`WorldSpec`] makes them, [`files`]
//! brings them from elsewhere). It knows no sensor, no reward and no learning.
//!
//! Conventions: SI units, radians, right-handed axes, yaw in (-pi, pi]. A room lies
//! wherever its corner is put. Poses, points and twists are nalgebra types; the
//! distance of two polygons is parry2d's (its f64 build), converted at one place.
//!
//! # Example
//! ```
//! use headway_sim::{Command, Pose, Room, Shape, Vehicle, VehicleSpec, VehicleState, World};
//!
//! let world = World::new(Room::new(10.0, 15.0), vec![])?;
//! let vehicle = VehicleSpec::default().build()?;
//! let mut state = VehicleState::at_rest(Pose::new([5.0, 5.0].into(), 0.0));
//! let motion = vehicle.step(&world, &mut state, Command::new(1.0, 0.0));
//! assert!(!motion.collided);
//! assert!((state.twist.x - 0.4).abs() < 1e-12); // 2 m/s^2 for 0.2 s
//! # Ok::<(), headway_sim::SimError>(())
//! ```

mod angle;
pub mod check;
mod crowd;
mod error;
pub mod files;
mod footprint;
mod geometry;
mod motion;
mod ray;
mod rng;
mod scenario;
mod shape;
mod vehicle;
mod world;

pub use angle::wrap;
pub use check::FieldError;
pub use crowd::{Crowd, CrowdMotion, CrowdSpec, Mover};
pub use error::SimError;
pub use footprint::Footprint;
pub use motion::{arc, glide};
pub use rng::{stream, stream_seed};
pub use scenario::{
    BarnSpec, FilePart, FilesSpec, GoalRule, Interval, Kinds, Quantity, RoomSpec, Scenario, WeightedWorld, WorldSource,
    WorldSpec,
};
pub use shape::{Obstacle, Room, Shape};
pub use vehicle::{
    ActuationSpec, Command, Drive, Dynamics, Motion, Stretch, Vehicle, VehiclePreset, VehicleSpec, VehicleState, Wheels,
};
pub use world::{Outline, Proximity, Surface, World};

/// The linear algebra of our signatures ([`Pose`], [`Point`], [`Twist`]), so that callers use the same version.
pub use nalgebra;
/// The random numbers of our signatures ([`stream`], [`Interval::sample`]), so that callers use the same version.
pub use rand;

/// A position and yaw in the plane: translation in metres, rotation in radians.
pub type Pose = nalgebra::Isometry2<f64>;
/// A point in the plane, metres.
pub type Point = nalgebra::Point2<f64>;
/// A velocity in the body frame: forward and leftward speed in m/s, yaw rate in rad/s.
pub type Twist = nalgebra::Vector3<f64>;
