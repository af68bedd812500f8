//! Pure pursuit.

use std::f64::consts::FRAC_PI_2;

use headway_sim::{Command, FieldError, Point, Pose, positive};
use serde::{Deserialize, Serialize};

use crate::{Controller, Route, Sensed};

/// Steering towards a point ahead on a route (Coulter 1992).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PurePursuit {
    /// How far ahead on the route that point lies, metres.
    pub lookahead: f64,
    /// Forward speed when it drives on its own, m/s.
    pub cruise_speed: f64,
    /// Yaw rate towards a point that lies behind, rad/s.
    pub turn_rate: f64,
}

impl Default for PurePursuit {
    fn default() -> Self {
        Self { lookahead: 0.8, cruise_speed: 1.0, turn_rate: 1.5 }
    }
}

impl PurePursuit {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field that is not a finite number above 0.
    pub fn check(&self) -> Result<(), FieldError> {
        positive("lookahead", self.lookahead)?;
        positive("cruise_speed", self.cruise_speed)?;
        positive("turn_rate", self.turn_rate)
    }

    /// The yaw rate that leads a vehicle at `speed` along an arc to the point ahead, rad/s.
    ///
    /// The arc through a point at distance `l` and bearing `a` has the curvature `2 sin(a) / l`. Towards a
    /// point that lies behind (`|a| > pi/2`) it turns at the turn rate, whatever the speed.
    #[must_use]
    pub fn yaw_rate(&self, route: &Route, pose: &Pose, speed: f64) -> f64 {
        let here = Point::from(pose.translation.vector);
        let target = route.at(route.project(&here) + self.lookahead);
        let to_target = pose.inverse_transform_point(&target).coords;
        let (distance, bearing) = (to_target.norm(), to_target.y.atan2(to_target.x));
        if distance < 1e-9 {
            0.0
        } else if bearing.abs() > FRAC_PI_2 {
            self.turn_rate.copysign(bearing)
        } else {
            2.0 * speed * bearing.sin() / distance
        }
    }
}

impl Controller for PurePursuit {
    fn reset(&mut self) {}

    /// Follows the route at cruise speed, or a straight line to the goal where there is no route; turns on
    /// the spot towards a point that lies behind.
    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        let here = Point::from(sensed.pose.translation.vector);
        let straight = Route::new(vec![here, sensed.goal]);
        let route = sensed.route.unwrap_or(&straight);
        let ahead = sensed.pose.inverse_transform_point(&route.at(route.project(&here) + self.lookahead));
        let speed = if ahead.x >= 0.0 { self.cruise_speed } else { 0.0 };
        Command { speed, yaw_rate: self.yaw_rate(route, &sensed.pose, speed) }
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
        let yaw_rate = PurePursuit::default().yaw_rate(&route, &Pose::identity(), 0.5);
        assert!((yaw_rate - 2.0 * 0.5 * 0.4 / (0.8 * 0.8 + 0.4 * 0.4)).abs() < 1e-12);
    }

    #[test]
    fn follows_a_bent_route_to_its_end() {
        let world = World::new(Room { width: 20.0, height: 20.0 }, vec![]).unwrap();
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
                scan: &[],
                beam_angles: &[],
                pose: state.pose,
                twist: state.twist,
                goal: Point::new(3.0, 14.0),
                route: Some(&route),
            };
            vehicle.step(&world, &mut state, driver.command(&sensed));
        }
        panic!("never arrived: {}", state.pose);
    }
}
