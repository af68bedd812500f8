//! Where scripted drivers drive.

use std::f64::consts::TAU;
use std::sync::Arc;

use headway_env::Mdp;
use headway_sim::{Command, Drive, Point, Pose};

use super::ride::{DISC_RADIUS, Ride, is_settled};
use super::{Case, Steering};
use crate::Error;

/// The clearance with which the disc is passed and orbited, metres; more where the vehicle cannot turn so tightly.
const CLEARANCE: f64 = 0.5;
/// How much farther than the orbit the goal is at least, metres.
const BEYOND_ORBIT: f64 = 0.5;
/// The part of its speed at which a driver turns into the orbit.
const NEARLY: f64 = 0.95;
/// A goal that is never reached, metres.
const FAR: f64 = 5e3;

/// An open field: the vehicle at rest at its origin, the goal straight ahead, a disc to the left of the way, beside the start.
///
/// The disc stands in the middle of the circle on which the vehicle ends when it speeds up and turns left. So orbiting is
/// driving on by one command, and repeats exactly; the circle takes a whole number of steps. The way to the goal passes the
/// disc about as near as the circle does.
pub(super) struct Scene<'a> {
    pub(super) case: &'a Case,
    pub(super) mdp: Arc<Mdp>,
    /// How far the goal is: as the case says, or farther where the orbit would touch it.
    pub(super) goal_distance: f64,
    pub(super) disc: Point,
    pub(super) orbit: Orbit,
}

/// How to orbit the disc.
pub(super) struct Orbit {
    pub(super) speed: f64,
    /// Metres from the disc's centre.
    pub(super) radius: f64,
    /// How far from the start the turn begins, metres.
    pub(super) turn_at: f64,
    /// Steps all the way round; none if the vehicle does not come to drive in a circle.
    pub(super) n_steps: Option<usize>,
}

impl<'a> Scene<'a> {
    /// The scene of a case.
    ///
    /// # Errors
    /// If the agent cannot drive forward, or the process cannot be built.
    pub(super) fn new(case: &'a Case) -> Result<Self, Error> {
        if case.speeds[1] <= 0.0 {
            return Err(Error::Input("env.actions: no action drives forward, so no driver arrives".into()));
        }
        let mdp = case.process().build().map_err(Error::failure)?;
        let mut scene = Self { case, mdp, goal_distance: FAR, disc: Point::origin(), orbit: Orbit::new(case) };
        let mut ride = scene.ride_far()?;
        let speed = scene.orbit.speed;
        ride.drive_until(Command::new(speed, 0.0), |vehicle| vehicle.twist.x >= NEARLY * speed)?;
        scene.orbit.turn_at = ride.position().x;
        scene.disc = Point::new(scene.orbit.turn_at, scene.orbit.radius);
        let yaw_rate = speed / scene.orbit.radius;
        let settled = ride.drive_until(scene.turn(speed, yaw_rate), |vehicle| {
            is_settled(vehicle.twist.x, speed) && is_settled(vehicle.twist.z, yaw_rate)
        })?;
        if settled {
            let pose: Pose = ride.vehicle().pose;
            scene.disc = pose * Point::new(0.0, scene.orbit.radius);
        } else {
            scene.orbit.n_steps = None;
        }
        let beyond = scene.disc.x + scene.orbit.radius + case.reach_radius + BEYOND_ORBIT;
        scene.goal_distance = case.goal_distance.max(beyond);
        Ok(scene)
    }

    /// A vehicle in the scene.
    pub(super) fn ride(&self) -> Result<Ride, Error> {
        Ride::new(&self.mdp, self.goal_distance, Some(self.disc))
    }

    /// A vehicle in the open field, with a goal out of reach.
    pub(super) fn ride_far(&self) -> Result<Ride, Error> {
        Ride::new(&self.mdp, FAR, None)
    }

    /// The command that comes to turn at `yaw_rate` at a speed: wheels that skid are asked for more.
    pub(super) fn turn(&self, speed: f64, yaw_rate: f64) -> Command {
        Command::new(speed, yaw_rate / gain(self.case))
    }

    /// Steps and distance in which a vehicle comes to drive straight at `speed`; none if it does not.
    pub(super) fn run_up(&self, speed: f64) -> Result<Option<(usize, f64)>, Error> {
        let mut ride = self.ride_far()?;
        let settled = ride.drive_until(Command::new(speed, 0.0), |vehicle| is_settled(vehicle.twist.x, speed))?;
        Ok(settled.then(|| (ride.pays.len(), ride.position().x)))
    }
}

impl Orbit {
    /// At the desired speed, as near as the vehicle can turn: half as far it must be able to turn as well, so as to hit the disc.
    fn new(case: &Case) -> Self {
        let (speed, dt) = (case.desired_speed(), case.vehicle.control_period);
        let tightest = (2.0 * case.vehicle.drive.turning_radius()).max(speed / most_yaw_rate(case));
        let radius = (DISC_RADIUS + case.vehicle.footprint.circumradius() + CLEARANCE).max(tightest);
        let n_steps = (TAU * radius / (speed * dt)).ceil().max(1.0);
        Self { speed, radius: speed * n_steps * dt / TAU, turn_at: 0.0, n_steps: Some(n_steps as usize) }
    }
}

/// The part of the yaw rate asked for that is reached.
fn gain(case: &Case) -> f64 {
    match case.vehicle.drive {
        Drive::Ackermann { .. } => 1.0,
        _ => case.vehicle.actuation.yaw_rate_gain,
    }
}

/// The highest yaw rate that is reached; where the agent does not steer, that of the vehicle.
pub(super) fn most_yaw_rate(case: &Case) -> f64 {
    let steers = case.steering == Steering::Agent && case.yaw_rate > 0.0;
    let asked = if steers { case.yaw_rate } else { case.vehicle.max_yaw_rate };
    // Near the limit of the vehicle, wheels that skid cannot be asked for more.
    asked.min(case.vehicle.max_yaw_rate) * gain(case)
}
