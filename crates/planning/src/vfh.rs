//! VFH+: a vector field histogram.

mod histogram;

use std::f64::consts::PI;

use headway_sim::check::{non_negative, positive, within};
use headway_sim::{Command, FieldError, Point, wrap};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::outline::Outline;
use crate::sweep::echoes;
use crate::{Controller, Sensed};
use histogram::{Polar, Sectors};

/// The parameters of [`Vfh`]; those that Ulrich and Borenstein (1998) name have their values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VfhSpec {
    /// Number of sectors all round, from 8 to 720: 72 of 5 degrees.
    pub n_sectors: usize,
    /// Distance to keep beside the vehicle, metres.
    pub safety_distance: f64,
    /// Distance within which something blocks its sectors, metres.
    pub blocked_within: f64,
    /// Distance beyond which sectors that were blocked are free again, metres; from `blocked_within` to 1000.
    pub free_beyond: f64,
    /// Sectors of free directions from which on a valley is wide: 16, 80 degrees.
    pub n_wide: usize,
    /// mu1: weight of the angle between a direction and the target's.
    pub target_weight: f64,
    /// mu2: weight of the angle between a direction and the vehicle's heading.
    pub heading_weight: f64,
    /// mu3: weight of the angle between a direction and the one chosen before.
    pub previous_weight: f64,
    /// How far ahead on a route the target lies, metres.
    pub lookahead: f64,
    /// Highest speed, m/s.
    pub cruise_speed: f64,
    /// Bearing of the direction chosen beyond which it turns on the spot, radians, from 0.1 to pi.
    pub turn_angle: f64,
    /// Highest yaw rate, rad/s.
    pub turn_rate: f64,
    /// Yaw rate per radian to the direction chosen, 1/s.
    pub turn_gain: f64,
}

impl Default for VfhSpec {
    fn default() -> Self {
        Self {
            n_sectors: 72,
            safety_distance: 0.1,
            blocked_within: 1.2,
            free_beyond: 1.4,
            n_wide: 16,
            target_weight: 5.0,
            heading_weight: 2.0,
            previous_weight: 2.0,
            lookahead: 1.5,
            cruise_speed: 1.0,
            turn_angle: 0.785,
            turn_rate: 1.5,
            turn_gain: 2.0,
        }
    }
}

impl VfhSpec {
    /// Checks the numbers and builds the driver.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    ///
    /// ```
    /// use headway_planning::VfhSpec;
    /// let spec = VfhSpec { free_beyond: 1.0, ..VfhSpec::default() };
    /// assert_eq!(spec.build().unwrap_err().field, "free_beyond");
    /// ```
    pub fn build(&self) -> Result<Vfh, FieldError> {
        within("n_sectors", self.n_sectors as f64, 8.0, 720.0)?;
        within("n_wide", self.n_wide as f64, 1.0, self.n_sectors as f64)?;
        for (field, value) in [
            ("blocked_within", self.blocked_within),
            ("lookahead", self.lookahead),
            ("cruise_speed", self.cruise_speed),
            ("turn_rate", self.turn_rate),
            ("turn_gain", self.turn_gain),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("safety_distance", self.safety_distance),
            ("target_weight", self.target_weight),
            ("heading_weight", self.heading_weight),
            ("previous_weight", self.previous_weight),
        ] {
            non_negative(field, value)?;
        }
        within("free_beyond", self.free_beyond, self.blocked_within, 1e3)?;
        within("turn_angle", self.turn_angle, 0.1, PI)?;
        let blocked = vec![false; self.n_sectors];
        Ok(Vfh { spec: *self, blocked, previous: None })
    }
}

/// A driver that picks a free direction near the goal's (Ulrich and Borenstein 1998, "VFH+: Reliable Obstacle Avoidance
/// for Fast Mobile Robots"), from the scan alone and without a map.
///
/// 1. *Polar histogram*, over directions of the world: every echo within reach blocks the directions in which the
///    vehicle, grown by the safety distance to a disc of radius `r`, would touch it: `asin(r / d)` to both sides. Here
///    a sector holds the distance of its nearest echo: with exact ranges the paper's magnitude, `a - b d^2` per echo,
///    says the same, but its sum depends on the number of beams. What lies beyond the target does not count.
/// 2. *Binary histogram*: sectors are blocked from `blocked_within` on, and free again from `free_beyond` on.
/// 3. *Masked histogram*: directions behind things that the vehicle, which turns no tighter than `|v|` / greatest yaw
///    rate, would touch while turning there are blocked too. Slower than 5 cm/s it turns on the spot, and nothing is
///    masked.
/// 4. *Candidates*: the middle of a narrow valley; of a wide one its two edges, half of `n_wide` sectors inside, and
///    the target's direction where it lies between. The cheapest is taken, by `mu1 D(c, target) + mu2 D(c, heading) +
///    mu3 D(c, previous)`. If all is blocked: the direction whose nearest echo is the farthest.
///
/// The vehicle turns towards the direction `b` in proportion, on the spot beyond `turn_angle`, and otherwise drives at
/// `cruise_speed (1 - |b| / turn_angle)`, but no faster than it can brake with half its greatest deceleration to the
/// safety distance before what lies in the strip ahead that it is going to sweep, and to the goal: `v^2 <= a s`.
///
/// The target is the point `lookahead` metres along on the route, or the goal.
///
/// For a box the disc's radius is half its width: it drives through what it fits through head-on. In turns its corners
/// reach farther out than the disc and may touch: put a [`crate::Shield`] around it.
#[derive(Debug, Clone)]
pub struct Vfh {
    spec: VfhSpec,
    /// The binary histogram: sector `k` is the direction `k` 2 pi / n of the world.
    blocked: Vec<bool>,
    /// The direction chosen before, radians.
    previous: Option<f64>,
}

/// Where to go, as seen from the vehicle.
struct Target {
    /// Metres.
    distance: f64,
    /// In the world, radians.
    direction: f64,
}

impl Vfh {
    /// The data it was built from.
    #[must_use]
    pub fn spec(&self) -> &VfhSpec {
        &self.spec
    }

    fn target(&self, sensed: &Sensed<'_>) -> Target {
        let here = Point::from(sensed.pose.translation.vector);
        let target = sensed.route.map_or(sensed.goal, |route| route.at(route.project(&here) + self.spec.lookahead));
        let to_target = target - here;
        Target { distance: to_target.norm(), direction: to_target.y.atan2(to_target.x) }
    }

    /// The direction to drive in, in the world, radians.
    fn direction(&mut self, sensed: &Sensed<'_>, target: &Target, grown: f64) -> f64 {
        let yaw = sensed.pose.rotation.angle();
        let sectors = Sectors(self.spec.n_sectors);
        let reach = self.spec.free_beyond.min(target.distance) + grown;
        let around: Vec<Polar> = echoes(sensed, reach).map(|echo| Polar::of(&echo.at)).collect();
        let distances = histogram::distances(sectors, around.iter().map(|echo| echo.turned(yaw)), grown);
        for (blocked, distance) in self.blocked.iter_mut().zip(&distances) {
            *blocked = *distance < if *blocked { self.spec.free_beyond } else { self.spec.blocked_within };
        }
        let speed = sensed.twist.x.abs();
        let turning_radius = if speed < 0.05 { None } else { Some(speed / sensed.vehicle.max_yaw_rate) };
        let [right, left] = turning_radius.map_or([-PI, PI], |radius| histogram::reachable(&around, radius, grown));
        let is_free = |sector: usize| {
            let bearing = wrap(sectors.direction(sector) - yaw);
            !self.blocked[sector] && right <= bearing && bearing <= left
        };
        let free: Vec<bool> = (0..self.spec.n_sectors).map(is_free).collect();
        let candidates = histogram::candidates(sectors, &free, self.spec.n_wide, target.direction);
        let cost = |candidate: &f64| {
            let apart = |weight: f64, direction: f64| weight * wrap(candidate - direction).abs();
            apart(self.spec.target_weight, target.direction)
                + apart(self.spec.heading_weight, yaw)
                + apart(self.spec.previous_weight, self.previous.unwrap_or(yaw))
        };
        let best = candidates.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
        best.unwrap_or_else(|| sectors.direction(histogram::farthest(&distances)))
    }

    /// How far the strip ahead is free, metres.
    fn room_ahead(&self, sensed: &Sensed<'_>, outline: &Outline) -> f64 {
        let front = outline.support(&Vector2::x());
        let aside = outline.support(&Vector2::y()).max(outline.support(&-Vector2::y()));
        let half_width = aside + self.spec.safety_distance / 2.0;
        let is_ahead = |at: &Vector2<f64>| at.x > 0.0 && at.y.abs() < half_width;
        let nearest = echoes(sensed, sensed.max_range).filter(|echo| is_ahead(&echo.at)).map(|echo| echo.at.x);
        nearest.fold(sensed.max_range, f64::min) - front - self.spec.safety_distance
    }
}

impl Controller for Vfh {
    fn reset(&mut self) {
        self.blocked.fill(false);
        self.previous = None;
    }

    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        let outline = Outline::new(&sensed.vehicle.footprint);
        let target = self.target(sensed);
        let direction = self.direction(sensed, &target, outline.inradius() + self.spec.safety_distance);
        self.previous = Some(direction);
        let bearing = wrap(direction - sensed.pose.rotation.angle());
        if bearing.abs() > self.spec.turn_angle {
            return Command::new(0.0, self.spec.turn_rate.copysign(bearing));
        }
        let brakes_within = |room: f64| (sensed.vehicle.max_acceleration * room.max(0.0)).sqrt();
        let speed = (self.spec.cruise_speed * (1.0 - bearing.abs() / self.spec.turn_angle))
            .min(brakes_within(self.room_ahead(sensed, &outline)))
            .min(brakes_within(sensed.goal_polar().0));
        Command::new(speed, (self.spec.turn_gain * bearing).clamp(-self.spec.turn_rate, self.spec.turn_rate))
    }
}

#[cfg(test)]
mod tests;
