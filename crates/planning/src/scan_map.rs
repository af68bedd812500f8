//! An occupancy grid that a robot fills from its own scans.

mod trace;
mod window;

use headway_sim::check::{positive, within};
use headway_sim::{FieldError, Point};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::Sensed;
use crate::outline::Outline;
pub(crate) use window::{Area, Window};

/// How a [`ScanMap`] is made, as data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScanMapSpec {
    /// Side of a cell, metres; from 0.005 to 10.
    pub cell: f64,
    /// Distance within which the ends of beams are marked, metres.
    pub obstacle_range: f64,
    /// Distance up to which beams clear the cells that they pass through, metres.
    pub raytrace_range: f64,
    /// Greatest extent along x and along y, metres; a larger trip is seen through a window around the vehicle. At
    /// most 20 000 cells.
    pub max_size: f64,
}

impl Default for ScanMapSpec {
    /// The costmaps of the BARN challenge (Perille et al. 2020): cells of 0.05 m, marked within 2.5 m, cleared up to 3 m.
    fn default() -> Self {
        Self { cell: 0.05, obstacle_range: 2.5, raytrace_range: 3.0, max_size: 50.0 }
    }
}

impl ScanMapSpec {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn check(&self) -> Result<(), FieldError> {
        within("cell", self.cell, 0.005, 10.0)?;
        positive("obstacle_range", self.obstacle_range)?;
        positive("raytrace_range", self.raytrace_range)?;
        within("max_size", self.max_size, 10.0 * self.cell, 20_000.0 * self.cell)
    }

    /// Checks the numbers and makes an empty map.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn build(&self) -> Result<ScanMap, FieldError> {
        self.check()?;
        Ok(ScanMap {
            spec: *self,
            reach: self.raytrace_range,
            window: Window::default(),
            cells: Vec::new(),
            hits: Vec::new(),
            beams: Beams::default(),
            changed: None,
        })
    }
}

/// What a map knows about a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellState {
    /// No beam has been there. Planners take it for free.
    Unknown,
    /// A beam passed through it, and none has ended there since.
    Free,
    /// A beam ended there.
    Marked,
}

/// An occupancy grid in the frame of odometry, filled from scans as ROS's `costmap_2d` fills its obstacle layer.
///
/// Each scan clears the cells that its beams pass through, up to the raytrace range, and then marks the cells in which they
/// end, up to the obstacle range. The cell in which a beam ends is never cleared by that beam. The grid covers the
/// vehicle and its goal, and a raytrace range around both; it grows by blocks of about a metre as they move.
///
/// ```
/// use headway_planning::{CellState, ScanMapSpec, Sensed};
/// use headway_sim::{Point, Pose, Twist, VehicleSpec};
///
/// let vehicle = VehicleSpec::default();
/// let sensed = Sensed {
///     vehicle: &vehicle,
///     scan: &[1.02],
///     beam_angles: &[0.0],
///     max_range: 5.0,
///     pose: Pose::translation(0.01, 0.01),
///     twist: Twist::zeros(),
///     goal: Point::new(4.0, 0.0),
///     route: None,
///     last_command: Default::default(),
///     movers: &[],
/// };
/// let mut map = ScanMapSpec::default().build()?;
/// map.update(&sensed);
/// assert_eq!(map.at(&Point::new(0.5, 0.01)), CellState::Free);
/// assert_eq!(map.at(&Point::new(1.03, 0.01)), CellState::Marked);
/// assert_eq!(map.at(&Point::new(1.20, 0.01)), CellState::Unknown);
/// # Ok::<(), headway_sim::FieldError>(())
/// ```
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ScanMap {
    spec: ScanMapSpec,
    /// How far around the vehicle and its goal the window reaches, metres.
    reach: f64,
    window: Window,
    /// One of the states below for each cell of the window, row by row.
    cells: Vec<u8>,
    /// Cells marked by the scan at hand.
    hits: Vec<usize>,
    beams: Beams,
    /// Around all cells that were marked or unmarked since this was last taken.
    changed: Option<Area>,
}

const UNKNOWN: u8 = 0;
const FREE: u8 = 1;
const MARKED: u8 = 2;
/// Marked by the scan at hand, which may not clear it.
const HIT: u8 = 3;

/// The directions of a lidar's beams in the vehicle's frame, kept from scan to scan.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Beams {
    angles: Vec<f64>,
    directions: Vec<Vector2<f64>>,
}

impl Beams {
    fn set(&mut self, angles: &[f64]) {
        if self.angles != angles {
            self.angles = angles.to_vec();
            self.directions = angles.iter().map(|angle| Vector2::new(angle.cos(), angle.sin())).collect();
        }
    }
}

impl ScanMap {
    /// The data it was built from.
    #[must_use]
    pub fn spec(&self) -> &ScanMapSpec {
        &self.spec
    }

    /// Has the window always be of its greatest extent, with the vehicle within half a block of its middle.
    pub(crate) fn follow_vehicle(&mut self) {
        self.reach = self.spec.max_size;
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        (self.window, self.changed) = (Window::default(), None);
        self.cells.clear();
    }

    /// Enters a scan. Ranges that are not finite, beams without a direction, and poses that are none are passed over.
    pub fn update(&mut self, sensed: &Sensed<'_>) {
        self.enter(sensed, None);
    }

    /// Enters a scan; what lies within `own`, the vehicle's outline, is taken for free.
    pub(crate) fn enter(&mut self, sensed: &Sensed<'_>, own: Option<&Outline>) {
        let place = sensed.pose.translation.vector;
        if !(place.x.abs().max(place.y.abs()) < 1e9 && sensed.pose.rotation.angle().is_finite()) {
            return;
        }
        self.cover(&place.into(), &sensed.goal);
        self.beams.set(sensed.beam_angles);
        self.mark(sensed, own);
        self.clear(sensed);
        for hit in self.hits.drain(..) {
            self.cells[hit] = MARKED;
        }
        if let Some(own) = own {
            self.clear_within(sensed, own);
        }
    }

    /// Marks the cells in which beams end.
    fn mark(&mut self, sensed: &Sensed<'_>, own: Option<&Outline>) {
        let most = self.spec.obstacle_range.min(sensed.max_range);
        for (&range, direction) in sensed.scan.iter().zip(&self.beams.directions) {
            let range = f64::from(range);
            if !(0.0..most).contains(&range) {
                continue;
            }
            let end = Point::from(direction * range);
            if own.is_some_and(|own| range < own.circumradius() && own.contains(&end)) {
                continue;
            }
            let Some((column, row)) = self.window.cell_of(&(sensed.pose * end)) else { continue };
            let index = self.window.index((column, row));
            match std::mem::replace(&mut self.cells[index], HIT) {
                HIT => {}
                before => {
                    self.hits.push(index);
                    if before != MARKED {
                        Area::add(&mut self.changed, (column, row));
                    }
                }
            }
        }
    }

    /// Clears the cells that beams pass through.
    fn clear(&mut self, sensed: &Sensed<'_>) {
        let Self { spec, window, cells, changed, .. } = self;
        let origin = window.in_cells(&sensed.pose.translation.vector.into());
        for (&range, direction) in sensed.scan.iter().zip(&self.beams.directions) {
            let range = f64::from(range);
            if range.is_nan() || range < 0.0 {
                continue;
            }
            let is_cut = range >= spec.raytrace_range || range >= sensed.max_range;
            let length = range.min(spec.raytrace_range) / spec.cell;
            let direction = sensed.pose.rotation * direction;
            let within = window.ray_length(&origin, &direction);
            let end = origin + direction * length.min(within);
            let last = if is_cut || within < length { usize::MAX } else { window.index_at(&end) };
            trace::walk(&origin, &end, window.n_x, |index| {
                let Some(cell) = cells.get_mut(index) else { return };
                if *cell != FREE && *cell != HIT && index != last {
                    if *cell == MARKED {
                        Area::add(changed, (index % window.n_x, index / window.n_x));
                    }
                    *cell = FREE;
                }
            });
        }
    }

    /// Clears the cells whose centres lie within the vehicle's outline.
    fn clear_within(&mut self, sensed: &Sensed<'_>, own: &Outline) {
        let here = sensed.pose.translation.vector.into();
        let reach = own.circumradius();
        for row in self.window.rows_near(&here, reach) {
            for column in self.window.columns_near(&here, reach) {
                let body = sensed.pose.inverse_transform_point(&self.window.center((column, row)));
                if own.contains(&body) {
                    self.free((column, row));
                }
            }
        }
    }

    /// Forgets what is marked farther than `distance` metres from a point, as a conservative reset of ROS's `move_base`.
    pub fn clear_beyond(&mut self, point: &Point, distance: f64) {
        for row in 0..self.window.n_y {
            for column in 0..self.window.n_x {
                if (self.window.center((column, row)) - point).norm() > distance {
                    self.free((column, row));
                }
            }
        }
    }

    fn free(&mut self, cell: (usize, usize)) {
        let state = &mut self.cells[self.window.index(cell)];
        if std::mem::replace(state, FREE) == MARKED {
            Area::add(&mut self.changed, cell);
        }
    }

    /// What is known about the cell that holds a point; nothing outside the window.
    #[must_use]
    pub fn at(&self, point: &Point) -> CellState {
        let cell = self.window.cell_of(point);
        match cell.map_or(UNKNOWN, |cell| self.cells[self.window.index(cell)]) {
            UNKNOWN => CellState::Unknown,
            FREE => CellState::Free,
            _ => CellState::Marked,
        }
    }

    /// The corner of least x and y of the part of the plane that is covered.
    #[must_use]
    pub fn corner(&self) -> Point {
        self.window.corner()
    }

    /// Columns and rows, 0 before the first scan.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.window.n_x, self.window.n_y)
    }

    /// The centres of all marked cells, row by row.
    pub fn marked(&self) -> impl Iterator<Item = Point> + '_ {
        let cells = self.cells.iter().enumerate().filter(|(_, state)| **state == MARKED);
        cells.map(|(index, _)| self.window.center((index % self.window.n_x, index / self.window.n_x)))
    }

    pub(crate) fn window(&self) -> &Window {
        &self.window
    }

    /// Whether the cells of a stretch of a row are marked.
    pub(crate) fn marks(&self, row: usize, columns: std::ops::Range<usize>) -> impl Iterator<Item = usize> + '_ {
        let start = row * self.window.n_x;
        let cells = &self.cells[start + columns.start..start + columns.end];
        cells.iter().zip(columns).filter(|(state, _)| **state == MARKED).map(|(_, column)| column)
    }

    /// The cells around all that changed since this was last asked.
    pub(crate) fn take_changed(&mut self) -> Option<Area> {
        self.changed.take()
    }

    /// Makes the window cover the vehicle and its goal.
    fn cover(&mut self, here: &Point, goal: &Point) {
        let next = self.window.grown(&self.spec, self.reach, here, goal);
        if next != self.window {
            let old = std::mem::replace(&mut self.window, next);
            let before = std::mem::take(&mut self.cells);
            self.cells.resize(next.n_x * next.n_y, UNKNOWN);
            next.copy_from(&mut self.cells, &old, &before);
            self.changed = None; // whoever follows the changes sees that the window is another one
        }
    }
}

#[cfg(test)]
mod tests;
