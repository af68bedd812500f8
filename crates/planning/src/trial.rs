//! Closed loops for the tests of drivers: a lidar all round, and drives from start to goal.

use std::f64::consts::TAU;

use headway_sim::{Command, Obstacle, Point, Pose, Shape, Twist, Vehicle, VehicleSpec, VehicleState, World};
use nalgebra::Vector2;

use crate::{Controller, Route, Sensed};

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

/// How far lidars see, metres, where a test does not say otherwise.
pub(crate) const MAX_RANGE: f64 = 10.0;

/// A lidar that looks all round.
pub(crate) struct Lidar {
    pub(crate) angles: Vec<f64>,
    pub(crate) max_range: f64,
}

impl Lidar {
    pub(crate) fn new(n: usize, max_range: f64) -> Self {
        Self { angles: (0..n).map(|k| (k as f64 / n as f64 - 0.5) * TAU).collect(), max_range }
    }

    pub(crate) fn scan(&self, world: &World, pose: &Pose) -> Vec<f32> {
        let origin = Point::from(pose.translation.vector);
        let beam = |angle: &f64| pose.rotation * Vector2::new(angle.cos(), angle.sin());
        self.angles.iter().map(|angle| world.cast_ray(&origin, &beam(angle), self.max_range) as f32).collect()
    }

    /// What a vehicle with this lidar perceives.
    pub(crate) fn sensed<'a>(&'a self, vehicle: &'a Vehicle, scan: &'a [f32], state: &VehicleState) -> Sensed<'a> {
        let (pose, twist, goal): (Pose, Twist, Point) = (state.pose, state.twist, Point::new(1.0, 1.0));
        let (vehicle, beam_angles, max_range) = (vehicle.spec(), &self.angles[..], self.max_range);
        Sensed {
            vehicle,
            scan,
            beam_angles,
            max_range,
            pose,
            twist,
            goal,
            route: None,
            last_command: Command::default(),
            movers: &[],
        }
    }
}

/// A drive from a start to within 0.3 m of a goal.
pub(crate) struct Trial<'a> {
    pub(crate) world: &'a World,
    pub(crate) vehicle: &'a Vehicle,
    pub(crate) lidar: Lidar,
    pub(crate) route: Option<&'a Route>,
    pub(crate) start: Pose,
    pub(crate) goal: Point,
    pub(crate) most_seconds: f64,
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

impl<'a> Trial<'a> {
    /// With 240 beams, no route, and two minutes.
    pub(crate) fn new(world: &'a World, vehicle: &'a Vehicle, start: Pose, goal: Point) -> Self {
        let lidar = Lidar::new(240, MAX_RANGE);
        Self { world, vehicle, lidar, route: None, start, goal, most_seconds: 120.0 }
    }

    pub(crate) fn drive(&self, driver: &mut dyn Controller) -> End {
        driver.reset();
        let mut state = VehicleState::at_rest(self.start);
        let period = self.vehicle.spec().control_period;
        for k in 0..(self.most_seconds / period) as usize {
            let scan = self.lidar.scan(self.world, &state.pose);
            let sensed = self.lidar.sensed(self.vehicle, &scan, &state);
            let command = driver.command(&Sensed { goal: self.goal, route: self.route, ..sensed });
            if self.vehicle.step(self.world, &mut state, command).collided {
                return End::Collided;
            }
            if (state.pose.translation.vector - self.goal.coords).norm() < 0.3 {
                return End::Arrived((k + 1) as f64 * period);
            }
        }
        End::OutOfTime(state.pose.translation.vector.into())
    }
}
