//! A simulated loop for tests of drivers.

use headway_sim::{Obstacle, Point, Pose, Shape, VehicleSpec, VehicleState, World};
use nalgebra::Vector2;

use crate::{Controller, Sensed};

pub(crate) fn boxed(x: f64, y: f64, length: f64, width: f64) -> Obstacle {
    Obstacle { shape: Shape::Box { length, width }, x, y, yaw: 0.0 }
}

/// The robot of the BARN challenge, in simulation.
pub(crate) fn jackal() -> VehicleSpec {
    VehicleSpec {
        footprint: Shape::Box { length: 0.46, width: 0.42 },
        max_speed: 2.0,
        max_yaw_rate: 2.0,
        max_acceleration: 10.0,
        max_yaw_acceleration: 20.0,
        control_period: 0.05,
        ..VehicleSpec::default()
    }
}

pub(crate) const MAX_RANGE: f64 = 10.0;

/// Beams all around.
pub(crate) fn beam_angles(n: usize) -> Vec<f64> {
    (0..n).map(|k| (k as f64 / n as f64 - 0.5) * std::f64::consts::TAU).collect()
}

/// What a lidar in the middle of the vehicle measures.
pub(crate) fn scan(world: &World, pose: &Pose, angles: &[f64]) -> Vec<f32> {
    let cast = |angle: &f64| {
        let direction = pose.rotation * Vector2::new(angle.cos(), angle.sin());
        world.cast_ray(&pose.translation.vector.into(), &direction, MAX_RANGE) as f32
    };
    angles.iter().map(cast).collect()
}

/// How a drive ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// After so many seconds.
    Arrived(f64),
    Collided,
    /// Where the vehicle was when the time was over.
    OutOfTime(Point),
}

/// Drives until the vehicle is within 0.3 m of the goal.
pub(crate) fn drive(
    world: &World,
    vehicle: &VehicleSpec,
    driver: &mut impl Controller,
    start: Pose,
    goal: Point,
    most_seconds: f64,
) -> End {
    let (vehicle, angles) = (vehicle.build().unwrap(), beam_angles(240));
    let mut state = VehicleState::at_rest(start);
    driver.reset();
    let period = vehicle.spec().control_period;
    for k in 0..(most_seconds / period) as usize {
        let scan = scan(world, &state.pose, &angles);
        let sensed = Sensed {
            vehicle: vehicle.spec(),
            scan: &scan,
            beam_angles: &angles,
            max_range: MAX_RANGE,
            pose: state.pose,
            twist: state.twist,
            goal,
            route: None,
            last_command: headway_sim::Command::default(),
            movers: &[],
        };
        let command = driver.command(&sensed);
        if vehicle.step(world, &mut state, command).collided {
            return End::Collided;
        }
        if (state.pose.translation.vector - goal.coords).norm() < 0.3 {
            return End::Arrived((k + 1) as f64 * period);
        }
    }
    End::OutOfTime(state.pose.translation.vector.into())
}
