//! How a vehicle's motion changes from substep to substep.

use super::{Command, Drive, VehicleSpec, VehicleState};
use crate::motion::{arc, glide};
use crate::{Pose, Twist};

/// How a vehicle moves, wherever it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheels {
    /// Velocity in the body frame.
    pub twist: Twist,
    /// Angle of the front wheels, radians, positive to the left; 0 without [`Drive::Ackermann`].
    pub steering: f64,
}

/// What moves: a vehicle's state without the commands on their way.
#[derive(Clone, Copy)]
pub(super) struct Body {
    pub(super) pose: Pose,
    pub(super) wheels: Wheels,
}

impl Body {
    pub(super) fn of(state: &VehicleState) -> Self {
        Self { pose: state.pose, wheels: Wheels { twist: state.twist, steering: state.steering } }
    }

    pub(super) fn store(self, state: &mut VehicleState) {
        (state.pose, state.twist, state.steering) = (self.pose, self.wheels.twist, self.wheels.steering);
    }
}

/// A stretch of constant velocity in the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// That velocity.
    pub twist: Twist,
    /// How long it lasts, seconds.
    pub time: f64,
}

impl Stretch {
    /// The speed of the vehicle's origin, m/s.
    #[must_use]
    #[inline]
    pub fn speed(&self) -> f64 {
        if self.twist.y == 0.0 { self.twist.x.abs() } else { self.twist.x.hypot(self.twist.y) }
    }

    /// Where a vehicle is that starts the stretch at `pose`, after `time` seconds.
    #[must_use]
    #[inline]
    pub fn end(&self, pose: &Pose, time: f64) -> Pose {
        if self.twist.y == 0.0 { arc(pose, self.twist.x, self.twist.z, time) } else { glide(pose, &self.twist, time) }
    }
}

/// How a vehicle carries out commands, substep by substep: its drive, limits and actuators, without outline, noise or world.
///
/// [`crate::Vehicle::step`] moves by it, and whoever wants to know where a command would lead can ask it.
///
/// ```
/// use headway_sim::{Command, Dynamics, Twist, VehicleSpec, Wheels};
/// // 2 m/s^2 for four substeps of 0.05 s: 0.4 m/s, at a mean of 0.2 m/s.
/// let dynamics = Dynamics::new(&VehicleSpec::default());
/// let mut wheels = Wheels { twist: Twist::zeros(), steering: 0.0 };
/// let target = dynamics.target(Command::new(1.0, 0.0), wheels.steering);
/// let (mut n_left, mut distance) = (4, 0.0);
/// while n_left > 0 {
///     let stretch = dynamics.next_stretch(&mut wheels, target, &mut n_left);
///     distance += stretch.speed() * stretch.time;
/// }
/// assert!((wheels.twist.x - 0.4).abs() < 1e-12 && (distance - 0.04).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Dynamics {
    drive: Drive,
    max_speed: f64,
    max_reverse_speed: f64,
    max_yaw_rate: f64,
    yaw_rate_gain: f64,
    /// Seconds.
    substep: f64,
    /// Greatest change of speed, m/s.
    speed_change: f64,
    /// Greatest change of the yaw rate, rad/s, or of the steering angle, radians.
    turn_change: f64,
    /// Share of what is missing to the target that a substep makes up for: 1 without lag.
    speed_share: f64,
    turn_share: f64,
    n_substeps: usize,
}

impl Dynamics {
    /// Of a vehicle whose numbers were checked.
    #[must_use]
    pub fn new(spec: &VehicleSpec) -> Self {
        Self::weaker(spec, [1.0; 2], spec.control_period / spec.n_substeps as f64)
    }

    /// As [`Self::new`], but with shares of the greatest changes of speed and of yaw rate or steering angle, above 0, with lags
    /// longer in proportion, and in substeps of another length, seconds.
    #[must_use]
    pub fn weaker(spec: &VehicleSpec, [of_speed, of_turn]: [f64; 2], substep: f64) -> Self {
        let turn_acceleration = match spec.drive {
            Drive::Ackermann { max_steering_rate, .. } => max_steering_rate,
            _ => spec.max_yaw_acceleration,
        };
        let made_up = |lag: f64, share: f64| if lag > 0.0 { -(-substep * share / lag).exp_m1() } else { 1.0 };
        Self {
            drive: spec.drive,
            max_speed: spec.max_speed,
            max_reverse_speed: spec.max_reverse_speed,
            max_yaw_rate: spec.max_yaw_rate,
            yaw_rate_gain: spec.actuation.yaw_rate_gain,
            substep,
            speed_change: of_speed * spec.max_acceleration * substep,
            turn_change: of_turn * turn_acceleration * substep,
            speed_share: made_up(spec.actuation.speed_lag, of_speed),
            turn_share: made_up(spec.actuation.yaw_rate_lag, of_turn),
            n_substeps: spec.n_substeps,
        }
    }

    /// Length of a substep, seconds.
    #[must_use]
    pub fn substep(&self) -> f64 {
        self.substep
    }

    /// A latency, seconds, as vehicles have it: in whole control periods, and the substeps left over.
    #[must_use]
    pub fn delay(&self, latency: f64) -> (usize, usize) {
        let n_late = (latency / self.substep).round() as usize;
        (n_late / self.n_substeps, n_late % self.n_substeps)
    }

    /// What a command makes the wheels approach: forward and leftward speed, m/s, and the yaw rate, rad/s, or under
    /// [`Drive::Ackermann`] the steering angle, radians, which is now `steering`.
    ///
    /// A number that is infinite or not a number counts as 0.
    #[must_use]
    pub fn target(&self, command: Command, steering: f64) -> Twist {
        let command = self.within_limits(command);
        let turn = self.drive.turn_target(command.speed, command.yaw_rate, steering);
        let is_steered = matches!(self.drive, Drive::Ackermann { .. });
        let turn = if is_steered { turn } else { turn * self.yaw_rate_gain };
        Twist::new(command.speed, command.lateral_speed, turn)
    }

    /// A command as far as the vehicle's limits allow; a number that is infinite or not a number counts as 0.
    #[must_use]
    pub fn within_limits(&self, command: Command) -> Command {
        let finite = |number: f64| if number.is_finite() { number } else { 0.0 };
        let most_lateral = self.drive.max_lateral_speed();
        Command {
            speed: finite(command.speed).clamp(-self.max_reverse_speed, self.max_speed),
            yaw_rate: finite(command.yaw_rate).clamp(-self.max_yaw_rate, self.max_yaw_rate),
            lateral_speed: finite(command.lateral_speed).clamp(-most_lateral, most_lateral),
        }
    }

    /// The next of the substeps that are left on the way to a [`Self::target`], at the mean velocity over it; all of them in
    /// one once the target is reached, since arcs of the same speed and yaw rate make one arc.
    #[inline]
    pub fn next_stretch(&self, wheels: &mut Wheels, target: Twist, n_left: &mut usize) -> Stretch {
        let before = *wheels;
        let wheelbase = if let Drive::Ackermann { wheelbase, .. } = self.drive { Some(wheelbase) } else { None };
        let turn = if wheelbase.is_some() { before.steering } else { before.twist.z };
        if before.twist.x == target.x && before.twist.y == target.y && turn == target.z {
            let n = std::mem::take(n_left);
            return Stretch { twist: before.twist, time: n as f64 * self.substep };
        }
        *n_left -= 1;
        wheels.twist.x = approach(before.twist.x, target.x, self.speed_share, self.speed_change);
        wheels.twist.y = approach(before.twist.y, target.y, self.speed_share, self.speed_change);
        let turned = approach(turn, target.z, self.turn_share, self.turn_change);
        let mean = |a: f64, b: f64| (a + b) / 2.0;
        let (speed, lateral) = (mean(before.twist.x, wheels.twist.x), mean(before.twist.y, wheels.twist.y));
        let yaw_rate = if let Some(wheelbase) = wheelbase {
            wheels.steering = turned;
            wheels.twist.z = wheels.twist.x * turned.tan() / wheelbase;
            speed * mean(turn, turned).tan() / wheelbase
        } else {
            wheels.twist.z = turned;
            mean(turn, turned)
        };
        Stretch { twist: Twist::new(speed, lateral, yaw_rate), time: self.substep }
    }

    /// How long a way, metres, and how large a turn, radians, a vehicle may still make while it brakes: not less than
    /// [`Self::next_stretch`] towards a target of zeros does.
    ///
    /// At the greatest deceleration `a` a speed `v` needs `v^2 / 2a`, and where it falls by a share `s` of itself each substep
    /// `h`, `v h / s`; a substep for the rounding is added.
    #[must_use]
    pub fn braking(&self, wheels: &Wheels) -> (f64, f64) {
        let way = |v: f64, change: f64, share: f64| v * self.substep * (0.5 * v / change + 1.0 / share + 0.5);
        let twist = &wheels.twist;
        let along = |v: f64| if v == 0.0 { 0.0 } else { way(v.abs(), self.speed_change, self.speed_share) };
        let distance = along(twist.x) + along(twist.y);
        let turn = match self.drive {
            Drive::Ackermann { wheelbase, .. } => distance * wheels.steering.tan().abs() / wheelbase,
            _ => way(twist.z.abs(), self.turn_change, self.turn_share),
        };
        (distance, turn)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ActuationSpec;
    use proptest::prelude::*;

    proptest! {
        /// The bound on what is left of a braking vehicle's way, against driving it.
        #[test]
        fn braking_takes_no_longer_a_way_than_is_said(
            (x, y, z, steering) in (-3.0..3.0, -1.0..1.0, -4.0..4.0, -0.5..0.5),
            (speed_lag, yaw_rate_lag) in (0.0..0.5, 0.0..0.5),
            (is_steered, share) in (any::<bool>(), 0.2..=1.0),
            control_period in 0.05..0.3,
        ) {
            let car = Drive::Ackermann { wheelbase: 0.4, max_steering_angle: 0.5, max_steering_rate: 2.0 };
            let drive = if is_steered { car } else { Drive::Omnidirectional { max_lateral_speed: 1.0 } };
            let actuation = ActuationSpec { speed_lag, yaw_rate_lag, ..ActuationSpec::default() };
            let spec = VehicleSpec { drive, actuation, control_period, ..VehicleSpec::default() };
            let dynamics = Dynamics::weaker(&spec, [share; 2], control_period / 4.0);
            let twist = if is_steered { Twist::new(x, 0.0, 0.0) } else { Twist::new(x, y, z) };
            let mut wheels = Wheels { twist, steering: if is_steered { steering } else { 0.0 } };
            let (most_way, most_turn) = dynamics.braking(&wheels);
            let target = dynamics.target(Command::default(), wheels.steering);
            let (mut way, mut turn) = (0.0, 0.0);
            for _ in 0..2000 {
                let stretch = dynamics.next_stretch(&mut wheels, target, &mut 1);
                way += stretch.speed() * stretch.time;
                turn += stretch.twist.z.abs() * stretch.time;
            }
            prop_assert!(way <= most_way + 1e-9 && turn <= most_turn + 1e-9, "{way} {most_way} {turn} {most_turn}");
            // And not by much: what stands in a sum there is the least that each of the limits allows by itself, and forward and
            // leftward ways are added that are one diagonal.
            let diagonal = if twist.y == 0.0 { 1.0 } else { std::f64::consts::SQRT_2 };
            let a_substep = (twist.x.abs() + twist.y.abs()) * dynamics.substep();
            prop_assert!(most_way <= 2.0 * diagonal * way + a_substep + 1e-9, "{way} {most_way}");
        }
    }
}
