//! The dynamic window approach.

mod map_grid;
mod recovery;
mod rollout;
mod spec;
mod window;

use headway_sim::{Command, Point, Pose};

use crate::{Controller, Costmap, Sensed};
use map_grid::MapGrid;
use recovery::Recovery;
use rollout::{Score, Scorer};
pub use spec::{DwaSpec, Escape, ObstacleCost};
use window::DynamicWindow;

/// The dynamic window approach (Fox, Burgard, Thrun 1997) with the scores of ROS's `base_local_planner`.
///
/// Each command is the best of the speeds and yaw rates that can be reached within a control period. A pair is driven in
/// thought for `sim_time`; it is out of the question if on the way the padded footprint touches a marked cell, the middle enters a
/// closed one, or the way leaves the window. Of the others the one of least
///
/// ```text
/// path_distance_bias * p + goal_distance_bias * g + occdist_scale * c
/// ```
///
/// is driven: p and g are the distances, in cells, from where it ends to the route and to the local goal, the last point of the route
/// within the window; c is the greatest cost met on the way. p and g are counted along free cells from one to its four
/// neighbours, spread as waves over the window (`MapGrid`): unlike straight distances they have no minimum behind an
/// obstacle. With `sensed.route` absent, the route is the straight line to the goal.
///
/// A turn on the spot is preferred where driving on would cost as much or more; it is made towards the side whose cells ahead are
/// nearer to the local goal, and reversed once at most before the vehicle has moved on.
/// Where nothing is left, it backs up a little if it can, stops, and in the end recovers: see [`DwaSpec`].
///
/// Deliberate differences to `base_local_planner`: arcs are exact, at the speed that was sampled; both ends of the window are
/// sampled; straight on only if that lies within the window; the pose at which the vehicle is costs what it costs, but excludes no trajectory;
/// backing up is checked for collisions.
///
/// ```
/// use headway_planning::{Controller, DwaSpec, Sensed};
/// use headway_sim::{Point, Pose, Twist, VehicleSpec};
///
/// let vehicle = VehicleSpec { control_period: 0.1, max_acceleration: 2.0, ..VehicleSpec::default() };
/// let mut dwa = DwaSpec::default().build()?;
/// let (scan, beam_angles) = ([5.0; 3], [-1.0, 0.0, 1.0]);
/// let (pose, twist, goal) = (Pose::identity(), Twist::zeros(), Point::new(4.0, 0.0));
/// let sensed =
///     Sensed { vehicle: &vehicle, scan: &scan, beam_angles: &beam_angles, max_range: 5.0, pose, twist, goal, route: None, last_command: headway_sim::Command::default(), movers: &[] };
/// let command = dwa.command(&sensed);
/// assert_eq!((command.speed, command.yaw_rate), (0.2, 0.0)); // as fast as 2 m/s^2 allow within 0.1 s
/// # Ok::<(), headway_sim::FieldError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Dwa {
    spec: DwaSpec,
    costmap: Costmap,
    grid: MapGrid,
    /// The padded footprint's outline as a scorer wants it.
    outline: rollout::OutlinePoints,
    turns: Turns,
    /// Where it began to back up.
    escape: Option<Pose>,
    recovery: Recovery,
}

/// Which ways the vehicle turned on the spot since it last moved on, and which it may not turn again.
#[derive(Debug, Clone, Copy, Default)]
struct Turns {
    /// To the right, to the left.
    made: [bool; 2],
    barred: [bool; 2],
    at: Option<Point>,
}

impl Turns {
    fn side(yaw_rate: f64) -> usize {
        usize::from(yaw_rate > 0.0)
    }

    /// Takes note of a turn: after one to the other side, that other side is barred.
    fn turn(&mut self, yaw_rate: f64, here: &Point) {
        let side = Self::side(yaw_rate);
        self.barred[1 - side] |= self.made[1 - side];
        self.made[side] = true;
        self.at = Some(*here);
    }

    fn forget_beyond(&mut self, distance: f64, here: &Point) {
        if self.at.is_some_and(|at| (at - here).norm() > distance) {
            *self = Self::default();
        }
    }
}

impl Dwa {
    /// The data it was built from.
    #[must_use]
    pub fn spec(&self) -> &DwaSpec {
        &self.spec
    }

    /// The window around the vehicle that trajectories are checked in.
    #[must_use]
    pub fn costmap(&self) -> &Costmap {
        &self.costmap
    }

    /// The best of the trajectories, if any is admissible.
    fn best(&mut self, sensed: &Sensed<'_>) -> Option<Command> {
        let scorer = Scorer::new(&self.spec, &self.costmap, &self.grid, &self.outline, &sensed.pose);
        let window = DynamicWindow::new(&self.spec, sensed.vehicle, &sensed.twist);
        let mut best: Option<(f64, Command)> = None;
        if self.escape.is_none() {
            for command in window.arcs(&self.spec) {
                if let Some(Score { cost, .. }) = scorer.score(command)
                    && best.is_none_or(|(least, _)| cost < least)
                {
                    best = Some((cost, command));
                }
            }
        }
        let mut least_ahead = u16::MAX;
        for command in window.turns(&self.spec) {
            if self.turns.barred[Turns::side(command.yaw_rate)] {
                continue;
            }
            if let Some(Score { cost, ahead }) = scorer.score(command)
                && best.is_none_or(|(least, _)| cost <= least)
                && ahead < least_ahead
            {
                (best, least_ahead) = (Some((cost, command)), ahead);
            }
        }
        best.map(|(_, command)| command)
    }

    /// Backing up at `escape_speed`, if the vehicle can and the way is free, or need not be.
    fn back_up(&self, sensed: &Sensed<'_>) -> Option<Command> {
        let speed = self.spec.escape_speed.min(sensed.vehicle.max_reverse_speed);
        let scorer = Scorer::new(&self.spec, &self.costmap, &self.grid, &self.outline, &sensed.pose);
        let command = Command::new(-speed, 0.0);
        // Twice the way, so that it does not end against what is there.
        let time = 2.0 * self.spec.escape_reset_distance / speed;
        let is_allowed = || self.spec.escape == Escape::Always || scorer.is_free(command, time);
        (speed > 0.0 && is_allowed()).then_some(command)
    }

    fn end_escape(&mut self, pose: &Pose) {
        let DwaSpec { escape_reset_distance, escape_reset_angle, .. } = self.spec;
        let is_over = |from: &Pose| {
            (from.translation.vector - pose.translation.vector).norm() > escape_reset_distance
                || from.rotation.angle_to(&pose.rotation).abs() > escape_reset_angle
        };
        if self.escape.as_ref().is_some_and(is_over) {
            self.escape = None;
        }
    }

    /// What to do where no trajectory is admissible.
    fn recover(&mut self, sensed: &Sensed<'_>) -> Command {
        if let Some(command) = self.back_up(sensed) {
            self.escape.get_or_insert(sensed.pose);
            return command;
        }
        if let Some(distance) = self.recovery.wait(&self.spec, sensed.vehicle.control_period) {
            self.costmap.clear_beyond(&sensed.pose.translation.vector.into(), distance);
        }
        Command::default()
    }

    /// Goes on with a clearing rotation, if there is one and the way is free.
    fn rotate(&mut self, sensed: &Sensed<'_>) -> Option<Command> {
        let rate = self.spec.max_yaw_rate.min(sensed.vehicle.max_yaw_rate).min(1.0);
        let command = Command::new(0.0, rate);
        if !self.recovery.is_rotating() {
            return None;
        }
        let scorer = Scorer::new(&self.spec, &self.costmap, &self.grid, &self.outline, &sensed.pose);
        let stays_free = scorer.is_free(command, 0.3 / rate + sensed.vehicle.control_period);
        self.recovery.rotate(sensed.pose.rotation.angle(), stays_free).then_some(command)
    }
}

impl Controller for Dwa {
    fn reset(&mut self) {
        self.costmap.reset();
        (self.turns, self.escape, self.recovery) = (Turns::default(), None, Recovery::default());
    }

    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        self.costmap.update(sensed);
        let here = Point::from(sensed.pose.translation.vector);
        if (sensed.goal - here).norm() <= self.spec.goal_tolerance {
            return Command::default();
        }
        let Some(outline) = self.costmap.outline() else { return Command::default() };
        let cell = self.spec.costmap.map.cell;
        self.outline.set(outline, cell);
        if self.costmap.window().cell_of(&here).is_none() {
            return Command::default(); // no scan has come yet
        }
        if let Some(command) = self.rotate(sensed) {
            return command;
        }
        self.grid.set(&self.costmap, &sensed.pose, &sensed.route_or_straight());
        self.end_escape(&sensed.pose);
        self.turns.forget_beyond(self.spec.oscillation_reset_distance, &here);
        let Some(command) = self.best(sensed) else { return self.recover(sensed) };
        self.recovery.succeed();
        if command.speed == 0.0 {
            self.turns.turn(command.yaw_rate, &here);
        }
        command
    }
}

#[cfg(test)]
mod tests;
