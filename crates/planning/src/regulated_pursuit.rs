//! Regulated pure pursuit.

use std::f64::consts::PI;

use headway_sim::check::{non_negative, positive, within};
use headway_sim::{Command, FieldError, Point, Stretch, Twist};
use serde::{Deserialize, Serialize};

use crate::outline::Outline;
use crate::pure_pursuit::steered;
use crate::sweep::{Front, Surroundings, Unseen, echoes};
use crate::{Controller, Sensed};

/// The parameters of [`RegulatedPursuit`], under the names that Nav2's controller of that name gives them.
///
/// Defaults are Nav2's (release Jazzy), but for the speed: 1 m/s instead of 0.5.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RegulatedPursuitSpec {
    /// Speed where nothing slows it down, m/s.
    pub desired_linear_vel: f64,
    /// The look-ahead distance in seconds at the present speed.
    pub lookahead_time: f64,
    /// Least look-ahead distance, metres.
    pub min_lookahead_dist: f64,
    /// Greatest look-ahead distance, metres, from the least one to 1000.
    pub max_lookahead_dist: f64,
    /// Radius of the arc ahead below which it slows down, metres.
    pub regulated_linear_scaling_min_radius: f64,
    /// Speed below which neither curves nor obstacles slow it down, m/s.
    pub regulated_linear_scaling_min_speed: f64,
    /// Clearance below which it slows down, metres.
    pub cost_scaling_dist: f64,
    /// How much of the speed is left there, from above 0 to 1.
    pub cost_scaling_gain: f64,
    /// Bearing of the point ahead beyond which it turns on the spot, or as tightly as it can, radians, from 0.1 to pi.
    pub rotate_to_heading_min_angle: f64,
    /// Yaw rate of a turn on the spot, rad/s.
    pub rotate_to_heading_angular_vel: f64,
    /// Distance to the end of the route within which it slows down, metres; 0 for never.
    pub approach_velocity_scaling_dist: f64,
    /// Least speed there, m/s.
    pub min_approach_linear_velocity: f64,
    /// How far ahead in time the arc must be free, seconds; 0 for no look.
    pub max_allowed_time_to_collision: f64,
    /// Distance from what the scan shows that counts as a collision there, metres, from 0.001 to 10. Not in Nav2, whose
    /// costmap has cells of some size.
    pub collision_margin: f64,
}

impl Default for RegulatedPursuitSpec {
    fn default() -> Self {
        Self {
            desired_linear_vel: 1.0,
            lookahead_time: 1.5,
            min_lookahead_dist: 0.3,
            max_lookahead_dist: 0.9,
            regulated_linear_scaling_min_radius: 0.9,
            regulated_linear_scaling_min_speed: 0.25,
            cost_scaling_dist: 0.6,
            cost_scaling_gain: 1.0,
            rotate_to_heading_min_angle: 0.785,
            rotate_to_heading_angular_vel: 1.8,
            approach_velocity_scaling_dist: 0.6,
            min_approach_linear_velocity: 0.05,
            max_allowed_time_to_collision: 1.0,
            collision_margin: 0.02,
        }
    }
}

impl RegulatedPursuitSpec {
    /// Checks the numbers and builds the driver.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    ///
    /// ```
    /// use headway_planning::RegulatedPursuitSpec;
    /// let spec = RegulatedPursuitSpec { lookahead_time: 0.0, ..RegulatedPursuitSpec::default() };
    /// assert_eq!(spec.build().unwrap_err().to_string(), "lookahead_time = 0: must be a finite number above 0");
    /// ```
    pub fn build(&self) -> Result<RegulatedPursuit, FieldError> {
        for (field, value) in [
            ("desired_linear_vel", self.desired_linear_vel),
            ("lookahead_time", self.lookahead_time),
            ("min_lookahead_dist", self.min_lookahead_dist),
            ("regulated_linear_scaling_min_radius", self.regulated_linear_scaling_min_radius),
            ("cost_scaling_dist", self.cost_scaling_dist),
            ("cost_scaling_gain", self.cost_scaling_gain),
            ("rotate_to_heading_angular_vel", self.rotate_to_heading_angular_vel),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("regulated_linear_scaling_min_speed", self.regulated_linear_scaling_min_speed),
            ("approach_velocity_scaling_dist", self.approach_velocity_scaling_dist),
            ("min_approach_linear_velocity", self.min_approach_linear_velocity),
        ] {
            non_negative(field, value)?;
        }
        within("max_lookahead_dist", self.max_lookahead_dist, self.min_lookahead_dist, 1e3)?;
        within("cost_scaling_gain", self.cost_scaling_gain, 0.0, 1.0)?;
        within("rotate_to_heading_min_angle", self.rotate_to_heading_min_angle, 0.1, PI)?;
        within("max_allowed_time_to_collision", self.max_allowed_time_to_collision, 0.0, 10.0)?;
        within("collision_margin", self.collision_margin, 1e-3, 10.0)?;
        Ok(RegulatedPursuit { spec: *self })
    }
}

/// Pure pursuit whose speed falls where the way bends, where things are near and where it ends (Macenski, Singh, Martin
/// and Gines 2023, "Regulated Pure Pursuit for Robot Path Tracking").
///
/// It steers for the point of the route (of the straight line to the goal, where there is none) that lies the
/// look-ahead distance beyond the vehicle's place on it, `L = v t` within its bounds. The arc there has the curvature
/// `k = 2 sin(a) / L` and the speed is the least of
///
/// - `v_d / (k r_min)` where the arc's radius is below `r_min`,
/// - `v_d gain d / d_prox` where the clearance `d` is below `d_prox`, neither below the least regulated speed,
/// - `v_d s / s_approach` where `s` metres are left, not below the least approach speed;
///
/// changed by no more than the vehicle's acceleration allows within a period, and such that the yaw rate is one it has.
/// A point too far aside is turned to on the spot; by a vehicle that cannot, in its tightest turn (Nav2's
/// `use_rotate_to_heading = false`), and no arc is tighter. Where the arc of the next second, or up to the point ahead, touches
/// what the scan shows, it stops, and turns towards the point if it can: Nav2 gives such a way up and leaves it to its
/// recoveries. It never reverses.
#[derive(Debug, Clone)]
pub struct RegulatedPursuit {
    spec: RegulatedPursuitSpec,
}

/// The point to steer for as seen from the vehicle.
#[derive(Debug, Clone, Copy)]
struct Carrot {
    /// Metres.
    distance: f64,
    /// Radians.
    bearing: f64,
    /// From the vehicle's place on the route to its end, metres.
    remaining: f64,
}

impl RegulatedPursuit {
    /// The data it was built from.
    #[must_use]
    pub fn spec(&self) -> &RegulatedPursuitSpec {
        &self.spec
    }

    /// How far ahead on the route the point lies that it steers for at this speed, metres.
    #[must_use]
    pub fn lookahead(&self, speed: f64) -> f64 {
        let spec = &self.spec;
        (speed.abs() * spec.lookahead_time).clamp(spec.min_lookahead_dist, spec.max_lookahead_dist)
    }

    /// The speed on an arc of some curvature (1/m), with some clearance and some distance left (metres), m/s.
    #[must_use]
    pub fn regulated_speed(&self, curvature: f64, clearance: f64, remaining: f64) -> f64 {
        let spec = &self.spec;
        let bend = 1.0 / (curvature.abs() * spec.regulated_linear_scaling_min_radius).max(1.0);
        let is_near = clearance < spec.cost_scaling_dist;
        let proximity =
            if is_near { spec.cost_scaling_gain * clearance.max(0.0) / spec.cost_scaling_dist } else { 1.0 };
        let desired = spec.desired_linear_vel;
        let least = spec.regulated_linear_scaling_min_speed.min(desired);
        let regulated = (desired * bend.min(proximity)).max(least);
        if remaining >= spec.approach_velocity_scaling_dist {
            return regulated;
        }
        let approach = desired * remaining / spec.approach_velocity_scaling_dist;
        regulated.min(approach.max(spec.min_approach_linear_velocity))
    }

    fn carrot(&self, sensed: &Sensed<'_>) -> Carrot {
        let route = sensed.route_or_straight();
        let along = route.project(&Point::from(sensed.pose.translation.vector));
        let target = route.at(along + self.lookahead(sensed.twist.x));
        let to_target = sensed.pose.inverse_transform_point(&target).coords;
        let bearing = to_target.y.atan2(to_target.x);
        Carrot { distance: to_target.norm(), bearing, remaining: route.length() - along }
    }

    /// The nearest that anything is to the outline, as far as it matters, metres.
    fn clearance(&self, sensed: &Sensed<'_>) -> f64 {
        let outline = Outline::new(&sensed.vehicle.footprint);
        let reach = outline.circumradius() + self.spec.cost_scaling_dist;
        echoes(sensed, reach).map(|echo| outline.height(&echo.at)).fold(f64::INFINITY, f64::min)
    }

    /// An arc at that speed, as far as the vehicle's limits allow.
    fn limited(sensed: &Sensed<'_>, speed: f64, curvature: f64) -> Command {
        let vehicle = sensed.vehicle;
        let change = vehicle.max_acceleration * vehicle.control_period;
        let now = sensed.twist.x;
        let steerable = speed.min(vehicle.max_speed).min(vehicle.max_yaw_rate / curvature.abs().max(1e-9));
        let speed = steerable.clamp(now - change, now + change);
        Command::new(speed, (speed * curvature).clamp(-vehicle.max_yaw_rate, vehicle.max_yaw_rate))
    }

    /// A turn on the spot by an angle, that does not go beyond it within a period.
    fn turn(&self, sensed: &Sensed<'_>, angle: f64) -> Command {
        let vehicle = sensed.vehicle;
        let rate = self.spec.rotate_to_heading_angular_vel.min(vehicle.max_yaw_rate);
        let wanted = rate.min(angle.abs() / vehicle.control_period).copysign(angle);
        let change = vehicle.max_yaw_acceleration * vehicle.control_period;
        Command::new(0.0, wanted.clamp(sensed.twist.z - change, sensed.twist.z + change))
    }

    /// Whether a motion for `time` seconds stays off all that the scan shows.
    fn is_free(&self, sensed: &Sensed<'_>, command: Command, time: f64) -> bool {
        let surroundings =
            Surroundings::new(sensed, Unseen::Free, command.speed.abs() * time, self.spec.collision_margin, 0.0);
        let twist = Twist::new(command.speed, 0.0, command.yaw_rate);
        surroundings.is_free_along(&mut Front::new(), &Stretch { twist, time })
    }

    /// A turn on the spot to the point ahead, where the vehicle can and the next part of it is free, or else none: what to do
    /// where that point lies far aside, or where the way is blocked.
    fn blocked(&self, sensed: &Sensed<'_>, bearing: f64) -> Command {
        if sensed.vehicle.drive.turning_radius() > 0.0 {
            return Command::default();
        }
        let turn = self.turn(sensed, bearing);
        let until_there = bearing.abs() / turn.yaw_rate.abs().max(1e-9);
        let time = self.spec.max_allowed_time_to_collision.min(until_there).max(sensed.vehicle.control_period);
        if self.is_free(sensed, turn, time) { turn } else { Command::default() }
    }
}

impl Controller for RegulatedPursuit {
    fn reset(&mut self) {}

    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        let Carrot { distance, bearing, remaining } = self.carrot(sensed);
        let turn_angle = self.spec.rotate_to_heading_min_angle;
        let turning_radius = sensed.vehicle.drive.turning_radius();
        if turning_radius == 0.0 && bearing.abs() > turn_angle {
            return self.blocked(sensed, bearing);
        }
        let curvature = steered(bearing, distance, turn_angle, turning_radius);
        let speed = self.regulated_speed(curvature, self.clearance(sensed), remaining);
        let command = Self::limited(sensed, speed, curvature);
        let until_there = distance / command.speed.abs().max(1e-9);
        let time = self.spec.max_allowed_time_to_collision.min(until_there);
        if self.is_free(sensed, command, time) { command } else { self.blocked(sensed, bearing) }
    }
}

#[cfg(test)]
mod tests;
