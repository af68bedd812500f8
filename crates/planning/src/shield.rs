//! A braking shield around any driver.

use std::collections::VecDeque;

use headway_sim::check::{non_negative, within};
use headway_sim::{Command, Drive, FieldError, Twist, VehicleSpec};
use serde::{Deserialize, Serialize};

use crate::sweep::{Front, Surroundings, Unseen};
use crate::{Controller, Sensed};

/// What a [`Shield`] allows for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShieldSpec {
    /// Distance to keep from what the scan shows, metres, from 0.001 to 10: for range noise and what is not modelled.
    /// Half the beams' spacing at their range is added to it.
    pub margin: f64,
    /// The share of the vehicle's greatest deceleration that braking is sure to give, from 0.1 to 1.
    pub confidence: f64,
    /// By how much the vehicle may stray per metre driven, from 0 to 1: for noise of the actuation.
    pub noise: f64,
    /// Time until a command takes effect, seconds, from 0 to 10.
    pub latency: f64,
}

impl Default for ShieldSpec {
    /// 5 cm, two standard deviations and more of common lidars' ranges; a fifth of the brakes' force held back; no
    /// noise and no latency.
    fn default() -> Self {
        Self { margin: 0.05, confidence: 0.8, noise: 0.0, latency: 0.0 }
    }
}

impl ShieldSpec {
    /// What [`Self::foresees`] asks for, in words.
    pub const FORESEEN: &'static str =
        "must be left out: it foresees latency, but neither lags of actuators nor a drive that steers";

    /// Whether a shield knows how a vehicle will go on: not with lags of its actuators, nor with [`Drive::Ackermann`].
    #[must_use]
    pub fn foresees(vehicle: &VehicleSpec) -> bool {
        let actuation = &vehicle.actuation;
        let lags = actuation.speed_lag > 0.0 || actuation.yaw_rate_lag > 0.0;
        !lags && !matches!(vehicle.drive, Drive::Ackermann { .. })
    }

    /// Puts a shield around a driver.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    ///
    /// ```
    /// use headway_planning::{PurePursuit, ShieldSpec};
    /// let shield = ShieldSpec::default().build(PurePursuit::default())?;
    /// assert_eq!(shield.n_vetoes(), 0);
    /// # Ok::<(), headway_sim::FieldError>(())
    /// ```
    pub fn build<C: Controller>(&self, driver: C) -> Result<Shield<C>, FieldError> {
        within("margin", self.margin, 1e-3, 10.0)?;
        within("confidence", self.confidence, 0.1, 1.0)?;
        within("noise", self.noise, 0.0, 1.0)?;
        non_negative("latency", self.latency)?;
        within("latency", self.latency, 0.0, 10.0)?;
        Ok(Shield { spec: *self, driver, under_way: VecDeque::new(), n_commands: 0, n_vetoes: 0, n_stops: 0 })
    }
}

/// A driver that another one drives through: it passes commands on only if the vehicle can still stop afterwards
/// without touching anything that the scan shows.
///
/// **What is looked at.** The commands under way for `latency` seconds, then the new one for a control period, as
/// [`headway_sim::Vehicle::step`] would carry them out; then braking to a standstill, yaw rate included, in three ways
/// that bound all others: as fast as the vehicle can, which is what it will do; at `confidence` of that while its
/// curvature stays as it is; and at `confidence` of that while its yaw rate falls as fast as it can. Over all this the
/// outline, `margin` larger, must hold no echo. Turns on the spot are looked at in the same way: a box's corners sweep.
///
/// **What happens otherwise.** Gentler commands are tried, the nearest first: slower along the same curve, turned by up
/// to half the greatest yaw rate, turning on the spot. If none will do, it brakes.
///
/// **Why that is safe.** A vehicle at rest is safe. A command passes only with a way to stop behind it; if nothing
/// passes in the next period, braking goes exactly that way, of which a part is then behind it. By induction there is
/// such a way at all times, as long as the world stands still, the vehicle does what is expected of it (within
/// `noise`), and the scan shows what is there (within `margin`).
///
/// **What is not seen.** The outline may not enter what is hidden behind something, nor leave the lidar's greatest
/// range: the border of what is seen counts as an echo all along, so that the vehicle can stop for whatever lies just
/// beyond. Directions in which no beam looks, as behind a lidar of 270 degrees, count as free: reversing is guarded by
/// beams that look back, or not at all. A scan without beams lets everything pass. Sideways speed is taken out of
/// commands: it is not foreseen.
///
/// Gaps narrower than the outline and two margins are not driven through. A vehicle that starts nearer to something
/// than the margin may keep the distance, but come no nearer than half the margin; see [`ShieldSpec`].
#[derive(Debug, Clone)]
pub struct Shield<C> {
    spec: ShieldSpec,
    driver: C,
    /// Commands sent that do not act in full yet, the oldest first.
    under_way: VecDeque<Command>,
    n_commands: u64,
    n_vetoes: u64,
    n_stops: u64,
}

/// Shares of the speed, and turns in shares of the greatest yaw rate added towards the straight, of the commands tried
/// instead of a vetoed one.
const GENTLER: [(f64, f64); 16] = [
    (0.75, 0.0),
    (1.0, 0.25),
    (1.0, -0.25),
    (0.5, 0.0),
    (0.75, 0.25),
    (0.75, -0.25),
    (1.0, 0.5),
    (1.0, -0.5),
    (0.5, 0.25),
    (0.5, -0.25),
    (0.25, 0.0),
    (0.5, 0.5),
    (0.5, -0.5),
    (0.25, 0.5),
    (0.25, -0.5),
    (0.1, 0.0),
];

impl<C> Shield<C> {
    /// The driver within.
    pub fn driver(&self) -> &C {
        &self.driver
    }

    /// How many commands were asked for since it was built.
    #[must_use]
    pub fn n_commands(&self) -> u64 {
        self.n_commands
    }

    /// How many of them were not passed on as they were.
    #[must_use]
    pub fn n_vetoes(&self) -> u64 {
        self.n_vetoes
    }

    /// How many of the vetoed ones no gentler command replaced, so that it braked.
    #[must_use]
    pub fn n_stops(&self) -> u64 {
        self.n_stops
    }

    /// The command itself, or what is sent instead.
    fn judge(&mut self, sensed: &Sensed<'_>, asked: Command) -> Command {
        let target = target(sensed.vehicle, asked);
        let forecast = Forecast::new(&self.spec, sensed, &self.under_way, &target);
        // Braking needs no leave: it is what was looked at a period ago.
        if sensed.scan.is_empty() || target == Twist::zeros() || forecast.is_safe(&target) {
            return Command { lateral_speed: 0.0, ..asked };
        }
        self.n_vetoes += 1;
        let found = gentler(sensed.vehicle, &within_limits(sensed.vehicle, asked))
            .find(|command| forecast.is_safe(&self::target(sensed.vehicle, *command)));
        self.n_stops += u64::from(found.is_none());
        found.unwrap_or_default()
    }
}

impl<C: Controller> Controller for Shield<C> {
    /// Forgets the commands under way; goes on counting.
    fn reset(&mut self) {
        self.under_way.clear();
        self.driver.reset();
    }

    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        self.n_commands += 1;
        let n_under_way = n_under_way(self.spec.latency, sensed.vehicle.control_period);
        while self.under_way.len() < n_under_way {
            self.under_way.push_front(Command::default());
        }
        let asked = self.driver.command(sensed);
        let given = self.judge(sensed, asked);
        self.under_way.push_back(given);
        while self.under_way.len() > n_under_way {
            self.under_way.pop_front();
        }
        given
    }
}

/// How many commands sent before act, in part or in full, before the next one does.
fn n_under_way(latency: f64, period: f64) -> usize {
    (latency / period - 1e-9).ceil().max(0.0) as usize
}

/// The twist that a command makes the vehicle approach: with wheels that skid, less than all of the yaw rate.
fn target(vehicle: &VehicleSpec, command: Command) -> Twist {
    let asked = within_limits(vehicle, command);
    Twist::new(asked.x, 0.0, asked.z * vehicle.actuation.yaw_rate_gain)
}

/// The speed and the yaw rate of a command as far as the vehicle's limits allow.
fn within_limits(vehicle: &VehicleSpec, command: Command) -> Twist {
    let finite = |number: f64| if number.is_finite() { number } else { 0.0 };
    Twist::new(
        finite(command.speed).clamp(-vehicle.max_reverse_speed, vehicle.max_speed),
        0.0,
        finite(command.yaw_rate).clamp(-vehicle.max_yaw_rate, vehicle.max_yaw_rate),
    )
}

/// What to try instead of a command, the nearest first.
fn gentler(vehicle: &VehicleSpec, target: &Twist) -> impl Iterator<Item = Command> + use<> {
    let (speed, yaw_rate) = (target.x, target.z);
    let towards_straight = vehicle.max_yaw_rate * if yaw_rate > 0.0 { -1.0 } else { 1.0 };
    let along =
        move |(share, turn): (f64, f64)| Command::new(speed * share, yaw_rate * share + turn * towards_straight);
    let on_the_spot = [yaw_rate, 0.5 * towards_straight, -0.5 * towards_straight].map(|turn| Command::new(0.0, turn));
    GENTLER.into_iter().map(along).chain(on_the_spot)
}

/// How fast speed and yaw rate change at most: m/s^2 and rad/s^2.
type Rates = (f64, f64);

/// Where the vehicle goes until a new command acts, and what is around.
struct Forecast<'a> {
    vehicle: &'a VehicleSpec,
    confidence: f64,
    surroundings: Surroundings,
    /// When the new command begins to act; `None` if that way is not free.
    start: Option<(Front, Twist)>,
}

impl<'a> Forecast<'a> {
    fn new(spec: &ShieldSpec, sensed: &Sensed<'a>, under_way: &VecDeque<Command>, asked: &Twist) -> Self {
        let vehicle = sensed.vehicle;
        let targets: Vec<Twist> = under_way.iter().map(|command| target(vehicle, *command)).collect();
        let fastest = targets.iter().chain([asked, &sensed.twist]).map(|twist| twist.xy().norm()).fold(0.0, f64::max);
        let braking = fastest / (spec.confidence * vehicle.max_acceleration);
        let reach = fastest * (spec.latency + vehicle.control_period * 2.0 + braking / 2.0);
        let surroundings = Surroundings::new(sensed, Unseen::Blocked, reach, spec.margin, spec.noise);
        let mut forecast = Self { vehicle, confidence: spec.confidence, surroundings, start: None };
        let mut state = (Front::new(), sensed.twist);
        let mut time = spec.latency - targets.len().saturating_sub(1) as f64 * vehicle.control_period;
        let is_free = targets.iter().all(|target| {
            let is_free = forecast.approach(&mut state, target, forecast.rates(), time);
            time = vehicle.control_period;
            is_free
        });
        forecast.start = is_free.then_some(state);
        forecast
    }

    /// Whether the vehicle can stop after a period of approaching a target.
    fn is_safe(&self, target: &Twist) -> bool {
        let Some(mut state) = self.start else { return false };
        self.approach(&mut state, target, self.rates(), self.vehicle.control_period)
            && self.brakings(&state.1).into_iter().all(|rates| self.is_free_braking(state, rates))
    }

    fn rates(&self) -> Rates {
        (self.vehicle.max_acceleration, self.vehicle.max_yaw_acceleration)
    }

    /// The ways to brake: at best, weakly along the same curve, and weakly while it straightens.
    fn brakings(&self, twist: &Twist) -> [Rates; 3] {
        let (acceleration, yaw_acceleration) = self.rates();
        let weak = self.confidence * acceleration;
        let time = twist.xy().norm() / weak;
        let same_curve = if time > 0.0 { twist.z.abs() / time } else { f64::INFINITY };
        let slow_turn = same_curve.min(self.confidence * yaw_acceleration);
        [(acceleration, yaw_acceleration), (weak, slow_turn), (weak, yaw_acceleration)]
    }

    fn is_free_braking(&self, mut state: (Front, Twist), rates: Rates) -> bool {
        let twist = state.1;
        let rotation = if twist.z == 0.0 { 0.0 } else { twist.z.abs() / rates.1 };
        let time = rotation.max(twist.xy().amax() / rates.0);
        // Whole substeps, as the vehicle makes them.
        let substep = self.vehicle.control_period / self.vehicle.n_substeps as f64;
        self.approach(&mut state, &Twist::zeros(), rates, (time / substep - 1e-9).ceil() * substep)
    }

    /// Moves on for `time` seconds in substeps as the vehicle does: each an arc at its mean twist.
    fn approach(&self, (front, twist): &mut (Front, Twist), target: &Twist, rates: Rates, time: f64) -> bool {
        let substep = self.vehicle.control_period / self.vehicle.n_substeps as f64;
        // Vehicles with very short substeps are looked at in longer ones.
        let n = (time / substep - 1e-9).ceil().min(1000.0);
        let step = time / n.max(1.0);
        let most = Twist::new(rates.0, rates.0, rates.1) * step;
        for _ in 0..n as usize {
            let before = *twist;
            *twist = before + (target - before).zip_map(&most, |change, most| change.clamp(-most, most));
            if !self.surroundings.is_free_along(front, &((before + *twist) / 2.0), step) {
                return false;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests;
