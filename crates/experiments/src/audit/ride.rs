//! One scripted vehicle, driven by the environment's own rules.

use std::f64::consts::TAU;
use std::sync::Arc;

use headway_env::{Event, Mdp, Navigator};
use headway_sim::{Command, GoalRule, Obstacle, Point, Pose, Room, Scenario, Shape, VehicleState, World};

use super::Payments;
use crate::Error;

/// Radius of the disc, metres: the mean of those in the rooms of Liu et al.
pub(super) const DISC_RADIUS: f64 = 0.35;
/// Half the extent of the field, metres: its walls are beyond all that matters.
const FIELD: f64 = 1e4;
/// Steps after which a driver has not done what it was to do.
pub(super) const MAX_STEPS: usize = 100_000;
/// How nearly a velocity is what it was to become, as a part of it.
const SETTLED: f64 = 1e-9;
/// How nearly a cycle ends where it began, metres and radians.
const CLOSED: f64 = 1e-6;

/// A vehicle that starts at rest at the origin of an open field, facing along x, and what each of its steps was paid.
pub(super) struct Ride {
    navigator: Navigator,
    pub(super) pays: Vec<f64>,
    /// What the last step ended in.
    pub(super) event: Option<Event>,
}

impl Ride {
    /// With a goal straight ahead, and a disc, if there is to be one.
    pub(super) fn new(mdp: &Arc<Mdp>, goal_distance: f64, disc: Option<Point>) -> Result<Self, Error> {
        let disc = disc.map(|Point { coords }| Obstacle {
            shape: Shape::Disc { radius: DISC_RADIUS },
            x: coords.x,
            y: coords.y,
            yaw: 0.0,
        });
        let field = Room { x: -FIELD, y: -FIELD, width: 2.0 * FIELD, height: 2.0 * FIELD };
        let world = World::new(field, disc.into_iter().collect()).map_err(Error::failure)?;
        let rule = GoalRule { distance: 0.0, clearance: 1e3 };
        let goal = Point::new(goal_distance, 0.0);
        let scenario = Scenario::new(world, Pose::identity(), goal, rule).map_err(Error::failure)?;
        let navigator = Navigator::in_scenario(Arc::clone(mdp), scenario, 0, 0).map_err(Error::failure)?;
        Ok(Self { navigator, pays: Vec::new(), event: None })
    }

    /// Drives one step.
    ///
    /// # Errors
    /// If the reward pays what is no number.
    pub(super) fn drive(&mut self, command: Command) -> Result<(), Error> {
        let end = self.navigator.drive(command).map_err(Error::failure)?;
        if !end.reward.is_finite() {
            let after = self.navigator.transition().after;
            return Err(Error::Input(format!(
                "reward: pays {} for a step to a speed of {:.2} m/s, {:.2} m from the goal; must be finite",
                end.reward, after.speed, after.goal_distance
            )));
        }
        self.pays.push(end.reward);
        self.event = end.event;
        Ok(())
    }

    /// Drives by one command until `is_over`, or something happens: whether it came to be over.
    pub(super) fn drive_until(
        &mut self,
        command: Command,
        is_over: impl Fn(&VehicleState) -> bool,
    ) -> Result<bool, Error> {
        while self.event.is_none() && !is_over(self.vehicle()) && self.pays.len() < MAX_STEPS {
            self.drive(command)?;
        }
        Ok(self.event.is_none() && is_over(self.vehicle()))
    }

    /// Drives `n_steps` by one command, after which all is to be as before: what the vehicle is paid if it goes on so for ever,
    /// or none if not all is as before.
    pub(super) fn cycle(mut self, command: Command, n_steps: usize) -> Result<Option<Payments>, Error> {
        let (n_before, from) = (self.pays.len(), self.vehicle().pose);
        for _ in 0..n_steps {
            self.drive(command)?;
            if self.event.is_some() {
                return Ok(None);
            }
        }
        let off = from.inverse() * self.vehicle().pose;
        let is_closed = off.translation.vector.norm() < CLOSED && off.rotation.angle().abs() < CLOSED;
        let cycle = self.pays.split_off(n_before);
        Ok(is_closed.then_some(Payments { start: self.pays, cycle }))
    }

    pub(super) fn vehicle(&self) -> &VehicleState {
        self.navigator.vehicle()
    }

    /// Where the vehicle is.
    pub(super) fn position(&self) -> Point {
        self.vehicle().pose.translation.vector.into()
    }
}

/// Whether a number is as good as `target`.
pub(super) fn is_settled(number: f64, target: f64) -> bool {
    (number - target).abs() <= SETTLED * target.abs().max(1.0)
}

/// The number of steps of `dt` seconds in a turn at a yaw rate of at most `most`, and the yaw rate at which there are so many.
pub(super) fn turn(most: f64, dt: f64) -> (usize, f64) {
    let n_steps = (TAU / (most * dt) - 1e-9).ceil().max(1.0);
    (n_steps as usize, TAU / (n_steps * dt))
}
