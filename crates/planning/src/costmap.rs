//! What it costs to be near what the scans have marked.

mod inflation;

use std::collections::VecDeque;

use headway_sim::check::{non_negative, positive, within};
use headway_sim::{FieldError, Footprint, Point, Pose, Shape};
use serde::{Deserialize, Serialize};

use crate::outline::Outline;
use crate::scan_map::{Area, Window};
use crate::{ScanMap, ScanMapSpec, Sensed};
use inflation::Kernel;

/// The cost of a marked cell.
pub const LETHAL: u8 = 254;
/// The cost of a cell in which the vehicle's middle cannot be without touching what is marked.
pub const INSCRIBED: u8 = 253;

/// How a [`Costmap`] is made, as data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CostmapSpec {
    /// The map of marks below.
    pub map: ScanMapSpec,
    /// The outline to plan with, no point of it farther than 100 m away; the vehicle's own where there is none.
    pub footprint: Option<Shape>,
    /// By how much that is made larger, metres, from 0 to 10.
    pub padding: f64,
    /// Distance from marks within which a cell costs something, metres; never less than the padded footprint's
    /// inscribed radius. At most 200 cells.
    pub inflation_radius: f64,
    /// How fast costs fall beyond the inscribed radius, 1/m.
    pub cost_scaling: f64,
    /// Whether what lies within the padded footprint counts as free (`footprint_clearing_enabled` of ROS's obstacle layer).
    pub footprint_clearing: bool,
    /// Time between two updates, seconds; 0 for one at each call.
    pub update_period: f64,
    /// Age at which a scan arrives, seconds, with the pose at which it was made; less than 10.
    pub latency: f64,
}

impl Default for CostmapSpec {
    /// The costmaps of the BARN challenge (Perille et al. 2020), and ROS's `cost_scaling_factor` of 10.
    fn default() -> Self {
        Self {
            map: ScanMapSpec::default(),
            footprint: None,
            padding: 0.1,
            inflation_radius: 0.3,
            cost_scaling: 10.0,
            footprint_clearing: true,
            update_period: 0.0,
            latency: 0.0,
        }
    }
}

impl CostmapSpec {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn check(&self) -> Result<(), FieldError> {
        self.map.check().map_err(|e| e.under("map"))?;
        if let Some(shape) = &self.footprint {
            let footprint = Footprint::new(shape).map_err(|e| e.under("footprint"))?;
            within("footprint (its circumradius)", footprint.circumradius(), 0.0, 100.0)?;
        }
        within("padding", self.padding, 0.0, 10.0)?;
        within("inflation_radius", self.inflation_radius, 0.0, 200.0 * self.map.cell)?;
        positive("cost_scaling", self.cost_scaling)?;
        non_negative("update_period", self.update_period)?;
        within("latency", self.latency, 0.0, 10.0)
    }

    /// Checks the numbers and makes an empty costmap.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn build(&self) -> Result<Costmap, FieldError> {
        self.check()?;
        Ok(Costmap {
            spec: self.clone(),
            map: self.map.build()?,
            window: Window::default(),
            costs: Vec::new(),
            vehicle: None,
            clock: Clock::default(),
            late: VecDeque::new(),
        })
    }

    /// The cost of a cell whose centre is `distance` metres from the nearest marked one's, for a vehicle whose padded
    /// footprint has the given inscribed radius: 254 at 0, 253 within that radius, `252 exp(-cost_scaling (distance - inscribed))`
    /// beyond, rounded down, and 0 beyond the inflation radius (`costmap_2d::InflationLayer::computeCost`).
    ///
    /// ```
    /// use headway_planning::CostmapSpec;
    /// let costs = [0.0, 0.2, 0.28, 0.31].map(|distance| CostmapSpec::default().cost(distance, 0.265));
    /// assert_eq!(costs, [254, 253, 216, 0]); // 252 exp(-0.15) = 216.9
    /// ```
    #[must_use]
    pub fn cost(&self, distance: f64, inscribed: f64) -> u8 {
        if distance == 0.0 {
            LETHAL
        } else if distance <= inscribed {
            INSCRIBED
        } else if distance <= self.inflation_radius {
            (f64::from(INSCRIBED - 1) * (-self.cost_scaling * (distance - inscribed)).exp()) as u8
        } else {
            0
        }
    }
}

/// A [`ScanMap`] and what it costs a vehicle to be in each of its cells, as ROS's `costmap_2d` has it.
///
/// The distance that counts is the Euclidean one between centres of cells, exactly.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Costmap {
    spec: CostmapSpec,
    map: ScanMap,
    /// Of the costs.
    window: Window,
    /// Row by row, and a kernel's row more.
    costs: Vec<u8>,
    vehicle: Option<Inflated>,
    clock: Clock,
    /// Scans on their way.
    late: VecDeque<Late>,
}

/// What depends on the vehicle's footprint.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Inflated {
    shape: Shape,
    outline: Outline,
    kernel: Kernel,
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Clock {
    now: f64,
    next_update: f64,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Late {
    made_at: f64,
    pose: Pose,
    scan: Vec<f32>,
}

/// Times are sums of control periods: this much apart, seconds, they are the same.
const SAME_TIME: f64 = 1e-6;

impl Costmap {
    /// The data it was built from.
    #[must_use]
    pub fn spec(&self) -> &CostmapSpec {
        &self.spec
    }

    /// What is marked.
    #[must_use]
    pub fn map(&self) -> &ScanMap {
        &self.map
    }

    /// The same, with a window of its greatest extent around the vehicle.
    pub(crate) fn around_vehicle(mut self) -> Self {
        self.map.follow_vehicle();
        self
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.map.reset();
        (self.window, self.clock) = (Window::default(), Clock::default());
        self.costs.clear();
        self.late.clear();
    }

    /// Takes in what is sensed, once per control period: whether an update was due and made.
    pub fn update(&mut self, sensed: &Sensed<'_>) -> bool {
        self.know(&sensed.vehicle.footprint);
        let now = self.clock.now;
        self.clock.now += sensed.vehicle.control_period;
        if self.spec.latency > 0.0 {
            self.send(sensed, now);
        }
        if now < self.clock.next_update - SAME_TIME {
            return false;
        }
        let own = if self.spec.footprint_clearing { self.vehicle.as_ref().map(|v| &v.outline) } else { None };
        if self.spec.latency > 0.0 {
            let has_come = |late: &Late| late.made_at <= now - self.spec.latency + SAME_TIME;
            while self.late.len() > 1 && has_come(&self.late[1]) {
                self.late.pop_front();
            }
            let Some(late) = self.late.front().filter(|late| has_come(late)) else { return false };
            self.map.enter(&Sensed { pose: late.pose, scan: &late.scan, ..*sensed }, own);
        } else {
            self.map.enter(sensed, own);
        }
        self.clock.next_update += self.spec.update_period;
        self.clock.next_update = self.clock.next_update.max(now);
        self.inflate();
        true
    }

    fn send(&mut self, sensed: &Sensed<'_>, made_at: f64) {
        self.late.push_back(Late { made_at, pose: sensed.pose, scan: sensed.scan.to_vec() });
    }

    /// Forgets what is marked farther than `distance` metres from a point.
    pub fn clear_beyond(&mut self, point: &Point, distance: f64) {
        self.map.clear_beyond(point, distance);
        self.inflate();
    }

    /// Makes the kernel of a footprint not met before.
    fn know(&mut self, vehicle: &Shape) {
        let shape = self.spec.footprint.as_ref().unwrap_or(vehicle);
        if self.vehicle.as_ref().is_none_or(|vehicle| vehicle.shape != *shape) {
            let outline = Outline::padded(shape, self.spec.padding);
            let kernel = Kernel::new(&self.spec, outline.inradius());
            self.vehicle = Some(Inflated { shape: shape.clone(), outline, kernel });
            self.window = Window::default();
        }
    }

    /// Brings the costs up to date with the marks.
    fn inflate(&mut self) {
        let Some(Inflated { kernel, .. }) = &self.vehicle else { return };
        let window = *self.map.window();
        let mut changed = self.map.take_changed();
        if window != self.window {
            self.window = window;
            self.costs.clear();
            self.costs.resize(window.n_x * window.n_y + kernel.stride(), 0);
            changed = Area::whole(&window);
        }
        if let Some(area) = changed {
            kernel.inflate(&self.map, area, &mut self.costs);
        }
    }

    /// The cost of the cell that holds a point: 0 to 254, 0 outside the window.
    #[must_use]
    pub fn cost_at(&self, point: &Point) -> u8 {
        self.window.cell_of(point).map_or(0, |cell| self.costs[self.window.index(cell)])
    }

    /// Row by row, and more beyond the last.
    pub(crate) fn costs(&self) -> &[u8] {
        &self.costs
    }

    pub(crate) fn window(&self) -> &Window {
        &self.window
    }

    /// The padded footprint, once something was sensed.
    pub(crate) fn outline(&self) -> Option<&Outline> {
        self.vehicle.as_ref().map(|vehicle| &vehicle.outline)
    }
}

#[cfg(test)]
mod tests;
