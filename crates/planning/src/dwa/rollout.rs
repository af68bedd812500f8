//! Driving in thought.

use headway_sim::{Command, Pose};
use nalgebra::{UnitComplex, Vector2};

use super::map_grid::MapGrid;
use super::{DwaSpec, ObstacleCost};
use crate::costmap::{Costmap, INSCRIBED, LETHAL};
use crate::outline::Outline;

/// Points along a padded footprint's outline, in units of cells.
#[derive(Debug, Clone, Default)]
pub(super) struct OutlinePoints {
    x: Vec<f32>,
    y: Vec<f32>,
    /// Distance from the middle to the farthest of them.
    reach: f64,
}

impl OutlinePoints {
    /// Takes over an outline, of which there are points no farther apart than a cell.
    pub(super) fn set(&mut self, outline: &Outline, cell: f64) {
        let points = outline.points(cell);
        self.x.clear();
        self.y.clear();
        self.x.extend(points.iter().map(|point| (point.x / cell) as f32));
        self.y.extend(points.iter().map(|point| (point.y / cell) as f32));
        self.reach = outline.circumradius() / cell;
    }
}

/// What a trajectory is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Score {
    /// The less, the better.
    pub(super) cost: f64,
    /// Steps to the local goal from the cell ahead of its end.
    pub(super) ahead: u16,
}

/// Scores trajectories from one pose.
pub(super) struct Scorer<'a> {
    spec: &'a DwaSpec,
    costmap: &'a Costmap,
    grid: &'a MapGrid,
    outline: &'a OutlinePoints,
    /// In units of cells, from the window's corner.
    start: Vector2<f64>,
    heading: Vector2<f64>,
    /// The cost where the vehicle is, which all trajectories have in common.
    here: u8,
}

impl<'a> Scorer<'a> {
    pub(super) fn new(
        spec: &'a DwaSpec,
        costmap: &'a Costmap,
        grid: &'a MapGrid,
        outline: &'a OutlinePoints,
        pose: &Pose,
    ) -> Self {
        let start = costmap.window().in_cells(&pose.translation.vector.into());
        let heading = Vector2::new(pose.rotation.re, pose.rotation.im);
        let mut scorer = Self { spec, costmap, grid, outline, start, heading, here: 0 };
        scorer.here = scorer.cell(&start).map_or(0, |cell| scorer.cost_at(cell, &start, &heading).min(INSCRIBED));
        scorer
    }

    /// What a command is worth if it is kept up for `sim_time`; nothing if it is not admissible.
    pub(super) fn score(&self, command: Command) -> Option<Score> {
        let spec = self.spec;
        let (mut worst, mut last) = (self.here, (0, 0));
        let (end, heading) = self.drive(command, spec.sim_time, |at, heading| {
            let cell = self.cell(at)?;
            worst = worst.max(self.cost(cell, at, heading)?);
            last = self.grid.distances(cell)?;
            Some(())
        })?;
        let [to_route, to_goal] = spec.biases();
        let cost = to_route * f64::from(last.0) + to_goal * f64::from(last.1) + spec.occdist_scale * f64::from(worst);
        let ahead = end + heading * (spec.heading_lookahead / spec.costmap.map.cell);
        let ahead = self.cell(&ahead).map_or(u16::MAX, |cell| self.grid.to_goal(cell));
        Some(Score { cost, ahead })
    }

    /// Whether the footprint touches nothing marked while a command is kept up for a time.
    pub(super) fn is_free(&self, command: Command, time: f64) -> bool {
        self.drive(command, time, |at, heading| self.cost(self.cell(at)?, at, heading).map(|_| ())).is_some()
    }

    /// Calls `check` with place and heading all along an arc, until it refuses; the end of the arc.
    fn drive(
        &self,
        command: Command,
        time: f64,
        mut check: impl FnMut(&Vector2<f64>, &Vector2<f64>) -> Option<()>,
    ) -> Option<(Vector2<f64>, Vector2<f64>)> {
        let spec = self.spec;
        let (length, angle) = (command.speed * time, command.yaw_rate * time);
        let n = (length.abs() / spec.sim_granularity).max(angle.abs() / spec.angular_sim_granularity).ceil().max(1.0);
        let turn = UnitComplex::new(angle / n);
        // Each step is an arc; its chord points half a step's turn aside.
        let half = angle / n / 2.0;
        let sinc = if half.abs() > 1e-9 { half.sin() / half } else { 1.0 };
        let mut chord = UnitComplex::new(half) * self.heading * (length / n * sinc / spec.costmap.map.cell);
        let (mut at, mut heading) = (self.start, self.heading);
        for _ in 0..n as usize {
            at += chord;
            chord = turn * chord;
            heading = turn * heading;
            check(&at, &heading)?;
        }
        Some((at, heading))
    }

    /// The cell of a place at which the whole footprint lies within the window.
    #[inline]
    fn cell(&self, at: &Vector2<f64>) -> Option<usize> {
        let (window, reach) = (self.costmap.window(), self.outline.reach + 1.0);
        let is_within = |x: f64, n: usize| x >= reach && x <= n as f64 - reach;
        (is_within(at.x, window.n_x) && is_within(at.y, window.n_y)).then(|| at.y as usize * window.n_x + at.x as usize)
    }

    /// What it costs to be somewhere; none if the footprint touches something marked.
    #[inline]
    fn cost(&self, cell: usize, at: &Vector2<f64>, heading: &Vector2<f64>) -> Option<u8> {
        let cost = self.cost_at(cell, at, heading);
        if cost >= LETHAL {
            return None;
        }
        Some(match self.spec.obstacle_cost {
            ObstacleCost::Outline => cost,
            ObstacleCost::Middle => self.costmap.costs()[cell],
        })
    }

    /// The greatest cost on the footprint's outline and at its middle.
    #[inline]
    fn cost_at(&self, cell: usize, at: &Vector2<f64>, heading: &Vector2<f64>) -> u8 {
        let (costs, n_x) = (self.costmap.costs(), self.costmap.window().n_x as i32);
        let (x, y, cos, sin) = (at.x as f32, at.y as f32, heading.x as f32, heading.y as f32);
        let mut worst = costs[cell];
        for (along, across) in self.outline.x.iter().zip(&self.outline.y) {
            let column = (x + cos * along - sin * across) as i32;
            let row = (y + sin * along + cos * across) as i32;
            worst = worst.max(costs[(row * n_x + column) as usize]);
        }
        worst
    }
}
