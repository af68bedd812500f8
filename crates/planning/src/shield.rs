//! A braking shield around any driver.

mod forecast;
mod gentler;
mod sent;

use headway_sim::check::within;
use headway_sim::{Command, Drive, Dynamics, FieldError, Interval, VehicleSpec};
use serde::{Deserialize, Serialize};

use crate::{Controller, Interventions, Sensed};
use forecast::Forecast;
use gentler::gentler;
use sent::Sent;

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
    /// Time until a command takes effect, seconds, from 0 to 10: a number, or a range `[low, high]` of what it may be, as long
    /// as it stays the same during a drive. Each whole number of substeps in the range is allowed for, at as many times the cost; of
    /// more than a hundred only a hundred, see [`Shield`].
    pub latency: Interval,
}

impl Default for ShieldSpec {
    /// 5 cm, two standard deviations and more of common lidars' ranges; a fifth of the brakes' force held back; no
    /// noise and no latency.
    fn default() -> Self {
        Self { margin: 0.05, confidence: 0.8, noise: 0.0, latency: Interval::Fixed(0.0) }
    }
}

impl ShieldSpec {
    /// Puts a shield around a driver.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    ///
    /// ```
    /// use headway_planning::{Controller, PurePursuit, ShieldSpec};
    /// let shield = ShieldSpec::default().build(PurePursuit::default())?;
    /// assert_eq!(shield.interventions().n_vetoes, 0);
    /// # Ok::<(), headway_sim::FieldError>(())
    /// ```
    pub fn build<C: Controller>(&self, driver: C) -> Result<Shield<C>, FieldError> {
        within("margin", self.margin, 1e-3, 10.0)?;
        within("confidence", self.confidence, 0.1, 1.0)?;
        within("noise", self.noise, 0.0, 1.0)?;
        self.latency.check("latency", |field, latency| within(field, latency, 0.0, 10.0))?;
        Ok(Shield { spec: *self, driver, sent: Vec::new(), interventions: Interventions::default() })
    }
}

/// A driver that another one drives through: it passes commands on only if the vehicle can still stop afterwards
/// without touching anything that the scan shows.
///
/// **What is looked at.** The commands under way until a new one acts, for each `latency` that may be, then the new one for a control period, as
/// [`headway_sim::Vehicle::step`] would carry them out: by its [`Dynamics`], whatever the drive and the lags of the actuators.
/// Then braking to a standstill, yaw rate included, in three ways that bound all others: as fast as the vehicle can, which is
/// what it will do; at `confidence` of that while its curvature stays as it is; and at `confidence` of that while its yaw rate
/// falls as fast as it can. What steers its wheels keeps them as they are while it brakes, so that all three are the second.
/// Over all this the outline, `margin` larger, must hold no echo. Turns on the spot are looked at in the same way: a box's
/// corners sweep.
///
/// **What happens otherwise.** Gentler commands are tried, the nearest first: slower along the same curve, turned by up
/// to half the greatest yaw rate, turning on the spot where the drive can. If none will do, it brakes.
///
/// **Why that is safe.** A vehicle at rest is safe. A command passes only with a way to stop behind it; if nothing
/// passes in the next period, braking goes exactly that way, of which a part is then behind it. By induction there is
/// such a way at all times, as long as the world stands still, the vehicle does what is expected of it (within
/// `noise`), its commands take a time that is one of `latency` and always the same, and the scan shows what is there (within
/// `margin`). Of several latencies none is the worst, since earlier turns lead elsewhere, and a vehicle's are whole numbers
/// of substeps: each of them has its own way to stop, whichever is the vehicle's.
///
/// **How far that goes.** All this holds for the numbers of substeps that are looked at, which are all of them up to a hundred. Of
/// more, a hundred are looked at, evenly spread from end to end, and for a vehicle of a number in between there is no such argument:
/// it goes other ways than those looked at, by what it drives and turns in half the time from one to the next. That tests find it safe
/// from 0 to 2 s, 20 ms apart, is measured, not proven; wider ranges or faster vehicles ask for a larger `margin`, or longer substeps.
///
/// **What is not seen.** The outline may not enter what is hidden behind something, nor leave the lidar's greatest
/// range: the border of what is seen counts as an echo all along, so that the vehicle can stop for whatever lies just
/// beyond. Directions in which no beam looks, as behind a lidar of 270 degrees, count as free: reversing is guarded by
/// beams that look back, or not at all. A scan without beams lets everything pass. The angle of steered wheels is what speed
/// and yaw rate tell; when the vehicle hardly moves, what the commands sent have made of it.
///
/// Gaps narrower than the outline and two margins are not driven through. A vehicle that starts nearer to something
/// than the margin may keep the distance, but come no nearer than half the margin; see [`ShieldSpec`].
#[derive(Debug, Clone)]
pub struct Shield<C> {
    spec: ShieldSpec,
    driver: C,
    /// For each latency that the vehicle may have; empty before the first command.
    sent: Vec<Sent>,
    interventions: Interventions,
}

impl<C> Shield<C> {
    /// The driver within.
    pub fn driver(&self) -> &C {
        &self.driver
    }

    /// The command itself, or what is sent instead.
    fn judge(&mut self, sensed: &Sensed<'_>, asked: Command) -> Command {
        let within_limits = Dynamics::new(sensed.vehicle).within_limits(asked);
        // Braking needs no leave: it is what was looked at a period ago.
        if sensed.scan.is_empty() || brakes(sensed.vehicle, &within_limits) {
            return asked;
        }
        let forecast = Forecast::new(&self.spec, sensed, &self.sent, &within_limits);
        if forecast.is_safe(within_limits) {
            return asked;
        }
        self.interventions.n_vetoes += 1;
        let found = gentler(sensed.vehicle, within_limits).find(|command| forecast.is_safe(*command));
        self.interventions.n_stops += u64::from(found.is_none());
        found.unwrap_or_default()
    }
}

/// Whether a command asks for a standstill.
fn brakes(vehicle: &VehicleSpec, command: &Command) -> bool {
    let is_steered = matches!(vehicle.drive, Drive::Ackermann { .. });
    command.speed == 0.0 && command.lateral_speed == 0.0 && (is_steered || command.yaw_rate == 0.0)
}

impl<C: Controller> Controller for Shield<C> {
    /// Forgets the commands under way; goes on counting.
    fn reset(&mut self) {
        self.sent.clear();
        self.driver.reset();
    }

    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        self.interventions.n_commands += 1;
        if self.sent.is_empty() {
            self.sent = Sent::nothing(self.spec.latency, sensed.vehicle);
        }
        let asked = self.driver.command(sensed);
        let given = self.judge(sensed, asked);
        self.sent.iter_mut().for_each(|sent| sent.push(sensed, given));
        given
    }

    fn interventions(&self) -> Interventions {
        self.interventions
    }
}

#[cfg(test)]
mod tests;
