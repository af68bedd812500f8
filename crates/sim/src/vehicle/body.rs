//! How a vehicle's motion changes from substep to substep.

use super::{Drive, VehicleSpec, VehicleState};
use crate::motion::{arc, glide};
use crate::{Pose, Twist};

/// What moves: a vehicle's state without the commands on their way.
#[derive(Clone, Copy)]
pub(super) struct Body {
    pub(super) pose: Pose,
    pub(super) twist: Twist,
    pub(super) steering: f64,
}

impl Body {
    pub(super) fn of(state: &VehicleState) -> Self {
        Self { pose: state.pose, twist: state.twist, steering: state.steering }
    }

    pub(super) fn store(self, state: &mut VehicleState) {
        (state.pose, state.twist, state.steering) = (self.pose, self.twist, self.steering);
    }
}

/// A stretch of constant velocity in the body frame.
#[derive(Clone, Copy)]
pub(super) struct Stretch {
    pub(super) twist: Twist,
    /// Seconds.
    pub(super) time: f64,
}

impl Stretch {
    /// The speed of the vehicle's origin, m/s.
    #[inline]
    pub(super) fn speed(&self) -> f64 {
        if self.twist.y == 0.0 { self.twist.x.abs() } else { self.twist.x.hypot(self.twist.y) }
    }

    /// Where the vehicle is after `time` seconds.
    #[inline]
    pub(super) fn end(&self, pose: &Pose, time: f64) -> Pose {
        if self.twist.y == 0.0 { arc(pose, self.twist.x, self.twist.z, time) } else { glide(pose, &self.twist, time) }
    }
}

/// What a substep can change, worked out once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dynamics {
    /// Seconds.
    substep: f64,
    /// Greatest change of speed, m/s.
    speed_change: f64,
    /// Greatest change of the yaw rate, rad/s, or of the steering angle, radians.
    turn_change: f64,
    /// Share of what is missing to the target that a substep makes up for: 1 without lag.
    speed_share: f64,
    turn_share: f64,
    /// Latency in whole control periods, and the substeps left over.
    delay: (usize, usize),
}

impl Dynamics {
    pub(super) fn new(spec: &VehicleSpec) -> Self {
        let substep = spec.control_period / spec.n_substeps as f64;
        let turn_acceleration = match spec.drive {
            Drive::Ackermann { max_steering_rate, .. } => max_steering_rate,
            _ => spec.max_yaw_acceleration,
        };
        let share = |lag: f64| if lag > 0.0 { -(-substep / lag).exp_m1() } else { 1.0 };
        let n_late = (spec.actuation.latency / substep).round() as usize;
        Self {
            substep,
            speed_change: spec.max_acceleration * substep,
            turn_change: turn_acceleration * substep,
            speed_share: share(spec.actuation.speed_lag),
            turn_share: share(spec.actuation.yaw_rate_lag),
            delay: (n_late / spec.n_substeps, n_late % spec.n_substeps),
        }
    }

    /// Seconds.
    pub(super) fn substep(&self) -> f64 {
        self.substep
    }

    pub(super) fn delay(&self) -> (usize, usize) {
        self.delay
    }

    /// The next of the substeps that are left, at the mean velocity over it; all of them in one once the target
    /// is reached, since arcs of the same speed and yaw rate make one arc.
    #[inline]
    pub(super) fn next_stretch(
        &self,
        spec: &VehicleSpec,
        body: &mut Body,
        target: Twist,
        n_left: &mut usize,
    ) -> Stretch {
        let before = *body;
        let wheelbase = if let Drive::Ackermann { wheelbase, .. } = spec.drive { Some(wheelbase) } else { None };
        let turn_target = if wheelbase.is_some() { target.z } else { target.z * spec.actuation.yaw_rate_gain };
        let turn = if wheelbase.is_some() { body.steering } else { body.twist.z };
        if before.twist.x == target.x && before.twist.y == target.y && turn == turn_target {
            let n = std::mem::take(n_left);
            return Stretch { twist: before.twist, time: n as f64 * self.substep };
        }
        *n_left -= 1;
        body.twist.x = approach(before.twist.x, target.x, self.speed_share, self.speed_change);
        body.twist.y = approach(before.twist.y, target.y, self.speed_share, self.speed_change);
        let turned = approach(turn, turn_target, self.turn_share, self.turn_change);
        let mean = |a: f64, b: f64| (a + b) / 2.0;
        let (speed, lateral) = (mean(before.twist.x, body.twist.x), mean(before.twist.y, body.twist.y));
        let yaw_rate = if let Some(wheelbase) = wheelbase {
            body.steering = turned;
            body.twist.z = body.twist.x * turned.tan() / wheelbase;
            speed * mean(turn, turned).tan() / wheelbase
        } else {
            body.twist.z = turned;
            mean(turn, turned)
        };
        Stretch { twist: Twist::new(speed, lateral, yaw_rate), time: self.substep }
    }
}

/// `value` after it came nearer to `target` by a share of what is missing, but by no more than `most`.
fn approach(value: f64, target: f64, share: f64, most: f64) -> f64 {
    let change = (target - value) * share;
    if change.abs() > most {
        value + most.copysign(change)
    } else if share < 1.0 {
        value + change
    } else {
        target
    }
}
