//! Pure pursuit.

use std::f64::consts::PI;

use headway_sim::check::{positive, within};
use headway_sim::{Command, FieldError, Point, Pose};
use serde::{Deserialize, Serialize};

use crate::{Controller, Route, Sensed};

/// Steering towards a point ahead on a route (Coulter 1992), turning on the spot towards one that lies too far aside
/// (Macenski et al. 2023, "rotate to heading").
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PurePursuit {
    /// How far ahead on the route that point lies, metres.
    pub lookahead: f64,
    /// Forward speed when it drives on its own, m/s.
    pub cruise_speed: f64,
    /// Bearing of that point beyond which the vehicle turns on the spot, radians, from 0.1 to pi.
    pub turn_angle: f64,
    /// Yaw rate of a turn on the spot, rad/s.
    pub turn_rate: f64,
}

impl Default for PurePursuit {
    fn default() -> Self {
        Self { lookahead: 0.8, cruise_speed: 1.0, turn_angle: 0.785, turn_rate: 1.5 }
    }
}

impl PurePursuit {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn check(&self) -> Result<(), FieldError> {
        positive("lookahead", self.lookahead)?;
        positive("cruise_speed", self.cruise_speed)?;
        within("turn_angle", self.turn_angle, 0.1, PI)?;
        positive("turn_rate", self.turn_rate)
    }

    /// The command that leads a vehicle along an arc to the point ahead, at `speed`.
    ///
    /// The arc through a point at distance `l` and bearing `a` has the curvature `2 sin(a) / l`. Beyond the turn angle the
    /// vehicle turns on the spot instead, whatever the speed asked for; one that cannot, whose tightest turn has a
    /// `turning_radius` above 0 ([`headway_sim::Drive::turning_radius`]), drives its tightest turn.
    #[must_use]
    pub fn follow(&self, route: &Route, pose: &Pose, speed: f64, turning_radius: f64) -> Command {
        let here = Point::from(pose.translation.vector);
        let target = route.at(route.project(&here) + self.lookahead);
        let to_target = pose.inverse_transform_point(&target).coords;
        let (distance, bearing) = (to_target.norm(), to_target.y.atan2(to_target.x));
        if turning_radius == 0.0 && bearing.abs() > self.turn_angle {
            return Command::new(0.0, self.turn_rate.copysign(bearing));
        }
        Command::new(speed, speed * steered(bearing, distance, self.turn_angle, turning_radius))
    }
}

/// The curvature towards a point for a vehicle whose tightest turn has a radius of `turning_radius` metres, 1/m: that of the arc
/// to the point as far as the vehicle can, and if the point lies beyond `turn_angle` aside, that of its tightest turn.
pub(crate) fn steered(bearing: f64, distance: f64, turn_angle: f64, turning_radius: f64) -> f64 {
    if turning_radius == 0.0 {
        return arc(bearing, distance);
    }
    let sharpest = 1.0 / turning_radius;
    if bearing.abs() > turn_angle {
        sharpest.copysign(bearing)
    } else {
        arc(bearing, distance).clamp(-sharpest, sharpest)
    }
}

/// The curvature of the arc to a point, 1/m.
fn arc(bearing: f64, distance: f64) -> f64 {
    if distance > 1e-9 { 2.0 * bearing.sin() / distance } else { 0.0 }
}

impl Controller for PurePursuit {
    fn reset(&mut self) {}

    /// Follows the route at cruise speed, or a straight line to the goal where there is no route.
    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        let turning_radius = sensed.vehicle.drive.turning_radius();
        self.follow(&sensed.route_or_straight(), &sensed.pose, self.cruise_speed, turning_radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_sim::{Room, VehicleSpec, VehicleState, World};

    #[test]
    fn an_arc_to_a_point_abeam_by_hand() {
        // A point 0.8 m ahead on a line that lies 0.4 m to the left: sin(a) = 0.4 / l, w = 2 v 0.4 / l^2.
        let route = Route::new(vec![Point::new(-5.0, 0.4), Point::new(5.0, 0.4)]);
        let Command { speed, yaw_rate, .. } = PurePursuit::default().follow(&route, &Pose::identity(), 0.5, 0.0);
        assert_eq!(speed, 0.5);
        assert!((yaw_rate - 2.0 * 0.5 * 0.4 / (0.8 * 0.8 + 0.4 * 0.4)).abs() < 1e-12);
    }

    #[test]
    fn turns_on_the_spot_towards_what_lies_aside() {
        let route = Route::new(vec![Point::origin(), Point::new(-5.0, -1.0)]);
        let command = PurePursuit::default().follow(&route, &Pose::identity(), 1.0, 0.0);
        assert_eq!(command, Command::new(0.0, -1.5));
    }

    #[test]
    fn what_cannot_turn_on_the_spot_turns_as_tightly_as_it_can() {
        let behind = Route::new(vec![Point::origin(), Point::new(-5.0, -1.0)]);
        let command = PurePursuit::default().follow(&behind, &Pose::identity(), 0.6, 1.2);
        assert_eq!(command, Command::new(0.6, -0.5));
        // An arc of curvature 2 sin(a) / l = 1 / m, where 1.2 m is the tightest.
        let ahead = Route::new(vec![Point::new(-5.0, 0.4), Point::new(5.0, 0.4)]);
        let command = PurePursuit::default().follow(&ahead, &Pose::identity(), 0.6, 1.2);
        assert!((command.yaw_rate - 0.5).abs() < 1e-12);
    }

    #[test]
    fn follows_a_bent_route_to_its_end() {
        let world = World::new(Room::new(20.0, 20.0), vec![]).unwrap();
        let vehicle = VehicleSpec { control_period: 0.05, ..VehicleSpec::default() }.build().unwrap();
        let corners = [[2.0, 2.0], [10.0, 2.0], [10.0, 10.0], [3.0, 14.0]];
        let route = Route::new(corners.map(Point::from).into());
        // It starts with its back to the route.
        let mut state = VehicleState::at_rest(Pose::new([2.0, 2.0].into(), 3.0));
        let mut driver = PurePursuit::default();
        let mut worst = 0.0_f64;
        for _ in 0..2000 {
            let here = Point::from(state.pose.translation.vector);
            if (here - Point::new(3.0, 14.0)).norm() < 0.3 {
                assert!(worst < 0.5, "strayed {worst} m");
                return;
            }
            worst = worst.max((route.at(route.project(&here)) - here).norm());
            let sensed = Sensed {
                vehicle: vehicle.spec(),
                scan: &[],
                beam_angles: &[],
                max_range: 5.0,
                pose: state.pose,
                twist: state.twist,
                goal: Point::new(3.0, 14.0),
                route: Some(&route),
                last_command: headway_sim::Command::default(),
                movers: &[],
            };
            vehicle.step(&world, &mut state, driver.command(&sensed));
        }
        panic!("never arrived: {}", state.pose);
    }
}
