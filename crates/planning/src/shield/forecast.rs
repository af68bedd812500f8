//! Where a vehicle goes, and where it can stop.

use headway_sim::{Command, Drive, Dynamics, VehicleSpec, Wheels};

use super::ShieldSpec;
use super::sent::{Phase, Sent};
use crate::Sensed;
use crate::sweep::{Front, Surroundings, Unseen};

/// A vehicle on its way.
#[derive(Clone, Copy)]
struct Moving {
    front: Front,
    wheels: Wheels,
}

/// A way to brake.
struct Braking {
    dynamics: Dynamics,
    /// Whether the yaw rate falls no faster than the speed.
    holds_curvature: bool,
}

/// Where the vehicle goes until a new command acts, whenever that may be, and what is around.
pub(super) struct Forecast {
    dynamics: Dynamics,
    n_substeps: usize,
    brakings: Vec<Braking>,
    surroundings: Surroundings,
    /// When the new command begins to act, for each latency that may be; `None` if a way up to there is not free.
    starts: Option<Vec<Moving>>,
}

impl Forecast {
    /// For `asked` and all commands that ask for no higher speed.
    pub(super) fn new(spec: &ShieldSpec, sensed: &Sensed<'_>, sent: &[Sent], asked: &Command) -> Self {
        let vehicle = sensed.vehicle;
        let dynamics = Dynamics::new(vehicle);
        let ways: Vec<Vec<Phase>> = sent.iter().map(|sent| sent.phases(sensed)).collect();
        let speed = |command: &Command| command.speed.hypot(command.lateral_speed);
        let sent_speeds = ways.iter().flatten().map(|(command, _)| speed(&dynamics.within_limits(*command)));
        let fastest = sent_speeds.fold(speed(asked).max(sensed.twist.xy().norm()), f64::max);
        let lag = vehicle.actuation.speed_lag / spec.confidence;
        let braking = fastest / (spec.confidence * vehicle.max_acceleration);
        let reach = fastest * (spec.latency.bounds().end() + vehicle.control_period * 2.0 + braking / 2.0 + lag);
        let surroundings = Surroundings::new(sensed, Unseen::Blocked, reach, spec.margin, spec.noise);
        let brakings = brakings(vehicle, spec.confidence, braking);
        let mut forecast = Self { dynamics, n_substeps: vehicle.n_substeps, brakings, surroundings, starts: None };
        let start = |(sent, phases): (&Sent, Vec<Phase>)| {
            let mut moving = Moving { front: Front::new(), wheels: sent.wheels(sensed) };
            phases.into_iter().all(|phase| forecast.carry_out(&mut moving, phase)).then_some(moving)
        };
        forecast.starts = sent.iter().zip(ways).map(start).collect();
        forecast
    }

    /// Whether the vehicle can stop after a period of carrying out a command, whenever that begins.
    pub(super) fn is_safe(&self, command: Command) -> bool {
        self.starts.as_ref().is_some_and(|starts| starts.iter().all(|start| self.can_stop_after(command, *start)))
    }

    fn can_stop_after(&self, command: Command, mut moving: Moving) -> bool {
        self.carry_out(&mut moving, (command, self.n_substeps))
            && self.brakings.iter().all(|braking| self.is_free_braking(moving, braking))
    }

    /// Moves on by a command as the vehicle does.
    fn carry_out(&self, moving: &mut Moving, (command, mut n_left): Phase) -> bool {
        let target = self.dynamics.target(command, moving.wheels.steering);
        while n_left > 0 {
            let stretch = self.dynamics.next_stretch(&mut moving.wheels, target, &mut n_left);
            if !self.surroundings.is_free_along(&mut moving.front, &stretch) {
                return false;
            }
        }
        true
    }

    /// Brakes until what is left of the way is sure to be free.
    fn is_free_braking(&self, mut moving: Moving, braking: &Braking) -> bool {
        let Moving { front, wheels } = &mut moving;
        let speed = wheels.twist.xy().norm();
        let curvature = if braking.holds_curvature && speed > 0.0 { wheels.twist.z / speed } else { 0.0 };
        let target = braking.dynamics.target(Command::default(), wheels.steering);
        loop {
            let (distance, turn) = braking.dynamics.braking(wheels);
            if self.surroundings.is_free_within(front, distance, turn.max(distance * curvature.abs())) {
                return true;
            }
            let before = wheels.twist.z;
            let mut stretch = braking.dynamics.next_stretch(wheels, target, &mut 1);
            let held = curvature * wheels.twist.xy().norm();
            if held.abs() > wheels.twist.z.abs() {
                wheels.twist.z = held;
                stretch.twist.z = (before + held) / 2.0;
            }
            if !self.surroundings.is_free_along(front, &stretch) {
                return false;
            }
        }
    }
}

/// The ways to brake: at best, weakly along the same curve, and weakly while it straightens.
///
/// `time` is the longest that the weak ones last without lags, seconds.
fn brakings(vehicle: &VehicleSpec, confidence: f64, time: f64) -> Vec<Braking> {
    // Vehicles with very short substeps are looked at in longer ones.
    const MAX_SUBSTEPS: f64 = 1000.0;
    let substep = (vehicle.control_period / vehicle.n_substeps as f64).max(time / MAX_SUBSTEPS);
    let braking = |shares: [f64; 2], holds_curvature| Braking {
        dynamics: Dynamics::weaker(vehicle, shares, substep),
        holds_curvature,
    };
    if matches!(vehicle.drive, Drive::Ackermann { .. }) {
        return vec![braking([confidence; 2], false)];
    }
    vec![braking([1.0; 2], false), braking([confidence; 2], true), braking([confidence, 1.0], false)]
}
