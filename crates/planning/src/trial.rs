//! Closed loops for the tests of drivers: a lidar all round, and drives from start to goal.

use std::f64::consts::TAU;

use headway_sim::{Point, Pose, Scenario, Twist, Vehicle, VehicleState, World};
use nalgebra::Vector2;

use crate::{Controller, Route, Sensed};

/// A lidar that looks all round.
pub(crate) struct Lidar {
    pub(crate) angles: Vec<f64>,
    pub(crate) max_range: f64,
}

impl Lidar {
    pub(crate) fn new(n: usize, max_range: f64) -> Self {
        Self { angles: (0..n).map(|k| TAU * k as f64 / n as f64).collect(), max_range }
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
            last_command: headway_sim::Command::default(),
            movers: &[],
        }
    }
}

/// How a drive ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    Arrived { n_steps: usize },
    Collided,
    TimeOut,
}

/// Drives a scenario, to within 0.3 m of its goal and for 600 steps at most.
pub(crate) fn drive(
    scenario: &Scenario,
    vehicle: &Vehicle,
    lidar: &Lidar,
    route: Option<&Route>,
    driver: &mut dyn Controller,
) -> End {
    driver.reset();
    let mut state = VehicleState::at_rest(scenario.start);
    for n_steps in 0..600 {
        if (Point::from(state.pose.translation.vector) - scenario.goal).norm() < 0.3 {
            return End::Arrived { n_steps };
        }
        let scan = lidar.scan(&scenario.world, &state.pose);
        let sensed = Sensed { goal: scenario.goal, route, ..lidar.sensed(vehicle, &scan, &state) };
        if vehicle.step(&scenario.world, &mut state, driver.command(&sensed)).collided {
            return End::Collided;
        }
    }
    End::TimeOut
}
