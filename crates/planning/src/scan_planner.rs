//! Planning over what the scans have shown, again and again.

mod search;
mod smooth;

use headway_sim::check::{non_negative, positive, within};
use headway_sim::{FieldError, Point};
use serde::{Deserialize, Serialize};

use crate::{Costmap, CostmapSpec, INSCRIBED, Route, Sensed};
use search::{Search, Weights};

/// How a [`ScanPlanner`] plans, as data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScanPlannerSpec {
    /// What is planned over.
    pub costmap: CostmapSpec,
    /// What a cell's length costs where nothing is near.
    pub neutral_cost: f64,
    /// How much more it costs per unit of the costmap's cost; at most the neutral cost.
    pub cost_factor: f64,
    /// Time after which a route is planned anew in any case, seconds; 0 for a plan at each call.
    pub replan_period: f64,
    /// Distance from the route beyond which it is planned anew, metres.
    pub stray: f64,
    /// Distance between points of the route, metres at most.
    pub spacing: f64,
    /// Time without a route to be found after which marks beyond `reset_distance` are forgotten, seconds
    /// (`planner_patience` of ROS's `move_base`).
    pub patience: f64,
    /// See `patience`, metres.
    pub reset_distance: f64,
}

impl Default for ScanPlannerSpec {
    /// The costs of ROS's `navfn` (50 and 0.8; `global_planner` has 50 and 3, and Zheng's tuning guide of 2017 advises 66
    /// and 0.55), the patience and reset distance of `move_base`.
    fn default() -> Self {
        Self {
            costmap: CostmapSpec::default(),
            neutral_cost: 50.0,
            cost_factor: 0.8,
            replan_period: 1.0,
            stray: 0.5,
            spacing: 0.1,
            patience: 5.0,
            reset_distance: 3.0,
        }
    }
}

impl ScanPlannerSpec {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn check(&self) -> Result<(), FieldError> {
        self.costmap.check().map_err(|e| e.under("costmap"))?;
        positive("neutral_cost", self.neutral_cost)?;
        within("cost_factor", self.cost_factor, 0.0, self.neutral_cost)?;
        non_negative("replan_period", self.replan_period)?;
        positive("stray", self.stray)?;
        within("spacing", self.spacing, 0.01, 100.0)?;
        positive("patience", self.patience)?;
        non_negative("reset_distance", self.reset_distance)
    }

    /// Checks the numbers and makes a planner that has seen nothing.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn build(&self) -> Result<ScanPlanner, FieldError> {
        self.check()?;
        Ok(ScanPlanner {
            spec: self.clone(),
            costmap: self.costmap.build()?,
            weights: Weights::new(self.neutral_cost, self.cost_factor),
            search: Search::default(),
            route: None,
            goal: Point::origin(),
            now: 0.0,
            next_plan: 0.0,
            lost_since: None,
        })
    }
}

/// A planner that owns a [`Costmap`] and keeps a route to the goal over it.
///
/// Ways are searched by A* over the eight neighbours of a cell; the length of a step costs `neutral_cost + cost_factor * c`, with
/// `c` the cost of the cell stepped into. Cells that cost 253 or more are closed, as in ROS's `navfn`; those within the
/// inscribed radius of the vehicle or of its goal are only dear, so that a vehicle too near to something finds its way out.
/// Unknown cells are free. The way found is pulled straight wherever that costs no more.
///
/// A route is kept until something marked closes it, the vehicle strays from it, the goal changes or the replan period is over. If
/// there is no way then, the last route stays, and a new one is looked for each half second, or each replan period if that is
/// longer.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ScanPlanner {
    spec: ScanPlannerSpec,
    costmap: Costmap,
    weights: Weights,
    #[serde(skip)]
    search: Search,
    route: Option<Route>,
    /// Of the route.
    goal: Point,
    /// Seconds since the reset.
    now: f64,
    next_plan: f64,
    /// When the search first failed, if it did last time.
    lost_since: Option<f64>,
}

/// Least time between two searches that fail, seconds.
const RETRY_PERIOD: f64 = 0.5;

impl ScanPlanner {
    /// The data it was built from.
    #[must_use]
    pub fn spec(&self) -> &ScanPlannerSpec {
        &self.spec
    }

    /// What it plans over.
    #[must_use]
    pub fn costmap(&self) -> &Costmap {
        &self.costmap
    }

    /// The present route; none before the first was found.
    #[must_use]
    pub fn route(&self) -> Option<&Route> {
        self.route.as_ref()
    }

    /// Whether no way to the goal was found when one was last looked for.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.lost_since.is_some()
    }

    /// Forgets the map and the route.
    pub fn reset(&mut self) {
        self.costmap.reset();
        (self.route, self.now, self.next_plan, self.lost_since) = (None, 0.0, 0.0, None);
    }

    /// Takes in what is sensed, once per control period: the route to follow now, from about where the vehicle is to
    /// [`Sensed::goal`]. `None` until a first way was found.
    pub fn update(&mut self, sensed: &Sensed<'_>) -> Option<&Route> {
        let now = self.now;
        self.now += sensed.vehicle.control_period;
        let is_updated = self.costmap.update(sensed);
        let is_due = now >= self.next_plan - 1e-6;
        if is_due || self.lost_since.is_none() && self.needs_plan(sensed, is_updated) {
            self.plan(sensed, now);
        }
        self.route.as_ref()
    }

    /// Whether the present route will not do.
    fn needs_plan(&self, sensed: &Sensed<'_>, is_updated: bool) -> bool {
        let Some(route) = &self.route else { return true };
        if (sensed.goal - self.goal).norm() > self.spec.costmap.map.cell / 2.0 {
            return true;
        }
        let here = Point::from(sensed.pose.translation.vector);
        let along = route.project(&here);
        (route.at(along) - here).norm() > self.spec.stray || is_updated && self.is_closed(route, along, &here)
    }

    /// Whether something marked closes a route beyond a length.
    fn is_closed(&self, route: &Route, along: f64, here: &Point) -> bool {
        let inradius = self.escape_radius();
        let is_closed = |point: &Point| {
            let is_dear = (point - here).norm() <= inradius || (point - self.goal).norm() <= inradius;
            !is_dear && self.costmap.cost_at(point) >= INSCRIBED
        };
        let cell = self.spec.costmap.map.cell;
        let n = ((route.length() - along) / cell).clamp(0.0, 1e6) as usize;
        // A single closed cell is a corner that the route clips; what closes a way is wider.
        let mut was_closed = false;
        (0..=n).any(|k| {
            let is_closed = is_closed(&route.at(along + k as f64 * cell));
            std::mem::replace(&mut was_closed, is_closed) && is_closed
        })
    }

    /// Distance from the vehicle or its goal within which no cell is closed, metres.
    fn escape_radius(&self) -> f64 {
        self.costmap.outline().map_or(0.0, crate::outline::Outline::inradius) + self.spec.costmap.map.cell
    }

    fn plan(&mut self, sensed: &Sensed<'_>, now: f64) {
        let here = Point::from(sensed.pose.translation.vector);
        let window = *self.costmap.window();
        if window.n_x == 0 {
            return; // no scan has come yet
        }
        let reach = self.escape_radius();
        let ends = [here, sensed.goal].map(|point| window.nearest_cell(&point));
        let grid = search::Grid::new(&self.costmap, &self.weights, ends, reach);
        if let Some(cells) = self.search.run(&grid, ends[0], ends[1]) {
            let goal = window.cell_of(&sensed.goal).map_or(window.center(ends[1]), |_| sensed.goal);
            let points = smooth::straighten(&grid, cells, &here, &goal);
            self.route = Some(Route::new(smooth::resample(&points, self.spec.spacing)));
            (self.goal, self.lost_since) = (sensed.goal, None);
            self.next_plan = now + self.spec.replan_period;
        } else {
            let since = *self.lost_since.get_or_insert(now);
            if now - since >= self.spec.patience {
                self.costmap.clear_beyond(&here, self.spec.reset_distance);
                self.lost_since = Some(now);
            }
            self.next_plan = now + self.spec.replan_period.max(RETRY_PERIOD);
        }
    }
}

#[cfg(test)]
mod tests;
