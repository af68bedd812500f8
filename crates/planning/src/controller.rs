//! The seam between what a vehicle perceives and what it is told to do.

use std::borrow::Cow;

use headway_sim::{Command, Mover, Point, Pose, Twist, VehicleSpec};
use nalgebra::Vector2;

use crate::Route;

/// What a driver may know: all of it can be had on a robot.
#[derive(Debug, Clone, Copy)]
pub struct Sensed<'a> {
    /// The vehicle: its footprint, limits and control period.
    pub vehicle: &'a VehicleSpec,
    /// Lidar ranges, metres, one per beam; the lidar's greatest range where a beam met nothing.
    pub scan: &'a [f32],
    /// Directions of the beams in the vehicle's frame, radians.
    pub beam_angles: &'a [f64],
    /// The lidar's greatest range, metres.
    pub max_range: f64,
    /// Where the vehicle believes it is (odometry).
    pub pose: Pose,
    /// How it moves, in the body frame.
    pub twist: Twist,
    /// Where it is to go, in the frame of `pose`.
    pub goal: Point,
    /// The planned route to the goal, where there is one.
    pub route: Option<&'a Route>,
    /// The command sent a control period ago; none is a standing vehicle's.
    pub last_command: Command,
    /// Obstacles that move, as a tracker would report them, in the frame of `pose`; none if there is no tracker.
    pub movers: &'a [Mover],
}

impl Sensed<'_> {
    /// The goal as seen from the vehicle: `[ahead, left]` in metres.
    #[must_use]
    pub fn to_goal(&self) -> Vector2<f64> {
        self.pose.inverse_transform_point(&self.goal).coords
    }

    /// The planned route, or a straight line to the goal where there is none.
    #[must_use]
    pub fn route_or_straight(&self) -> Cow<'_, Route> {
        let straight = || Route::new(vec![self.pose.translation.vector.into(), self.goal]);
        self.route.map_or_else(|| Cow::Owned(straight()), Cow::Borrowed)
    }

    /// Distance to the goal, metres, and its bearing in the vehicle's frame, radians in (-pi, pi].
    #[must_use]
    pub fn goal_polar(&self) -> (f64, f64) {
        let to_goal = self.to_goal();
        (to_goal.norm(), to_goal.y.atan2(to_goal.x))
    }
}

/// A driver: a learned policy, a classical planner, a safety layer around another one.
pub trait Controller {
    /// Forgets all that belongs to the episode so far.
    fn reset(&mut self);

    /// The command for the next control period. Commands beyond the vehicle's limits are clamped by it.
    fn command(&mut self, sensed: &Sensed<'_>) -> Command;

    /// How often a safety layer stepped in since it was built; zeros where there is none.
    fn interventions(&self) -> Interventions {
        Interventions::default()
    }
}

/// How often a safety layer did not let a driver drive as it wished: counts of commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Interventions {
    /// Commands asked for.
    pub n_commands: u64,
    /// Those that were not passed on as they were.
    pub n_vetoes: u64,
    /// Those of the vetoed ones that no gentler command replaced, so that the vehicle brakes.
    pub n_stops: u64,
}

impl Interventions {
    /// Those since an earlier count of the same safety layer.
    ///
    /// ```
    /// use headway_planning::Interventions;
    /// let [before, now] = [(10, 2, 0), (25, 5, 1)]
    ///     .map(|(n_commands, n_vetoes, n_stops)| Interventions { n_commands, n_vetoes, n_stops });
    /// assert_eq!(now.since(before), Interventions { n_commands: 15, n_vetoes: 3, n_stops: 1 });
    /// ```
    #[must_use]
    pub fn since(self, earlier: Self) -> Self {
        Self {
            n_commands: self.n_commands - earlier.n_commands,
            n_vetoes: self.n_vetoes - earlier.n_vetoes,
            n_stops: self.n_stops - earlier.n_stops,
        }
    }
}

impl<C: Controller + ?Sized> Controller for Box<C> {
    fn reset(&mut self) {
        (**self).reset();
    }

    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        (**self).command(sensed)
    }

    fn interventions(&self) -> Interventions {
        (**self).interventions()
    }
}
