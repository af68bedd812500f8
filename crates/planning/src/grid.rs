//! Occupancy grids.

use headway_sim::{Point, Room, Surface, World};
use nalgebra::Vector2;

/// A grid of square cells over a room, each free or blocked.
#[derive(Debug, Clone)]
pub struct GridMap {
    /// The corner of least x and y.
    corner: Point,
    cell: f64,
    n_x: usize,
    n_y: usize,
    blocked: Vec<bool>,
}

/// Column and row of a cell.
pub(crate) type Cell = (usize, usize);

impl GridMap {
    /// Whether a map of a room in cells of `cell` metres has at most 2^28 cells.
    #[must_use]
    pub fn fits(room: &Room, cell: f64) -> bool {
        let [n_x, n_y] = Self::counts(room, cell);
        cell > 0.0 && n_x.saturating_mul(n_y) <= 1 << 28
    }

    fn counts(room: &Room, cell: f64) -> [usize; 2] {
        [room.width, room.height].map(|extent| (extent / cell).ceil().max(1.0) as usize)
    }

    /// A map of a world in cells of `cell` metres: a cell is blocked if its centre is less than `inflation`
    /// metres from a surface. With the circumradius of a footprint as inflation, a footprint may turn
    /// freely wherever the map is free.
    ///
    /// # Panics
    /// If `cell` is not above 0, or so small that the map would have more than 2^28 cells.
    #[must_use]
    pub fn from_world(world: &World, cell: f64, inflation: f64) -> Self {
        let room = world.room();
        assert!(Self::fits(&room, cell), "cells have a size and fit in memory");
        let [n_x, n_y] = Self::counts(&room, cell);
        let corner = Point::new(room.x, room.y);
        let mut map = Self { corner, cell, n_x, n_y, blocked: vec![false; n_x * n_y] };
        let strip = |n: usize| ((inflation.max(0.0) / cell).ceil() as usize).saturating_add(1).min(n);
        let (low, high) = (|n: usize| 0..strip(n), |n: usize| n - strip(n)..n);
        // As the walls are numbered: least x, least y, greatest x, greatest y.
        let strips = [(low(n_x), 0..n_y), (0..n_x, low(n_y)), (high(n_x), 0..n_y), (0..n_x, high(n_y))];
        for (index, cells) in strips.into_iter().enumerate() {
            map.block(world, Surface::Wall(index), cells, inflation);
        }
        for (index, obstacle) in world.static_obstacles().iter().enumerate() {
            let reach = obstacle.shape.circumradius() + inflation;
            let span = |middle: f64, n: usize| {
                let low = ((middle - reach) / cell).floor().max(0.0) as usize;
                low.min(n)..(((middle + reach) / cell).ceil().max(0.0) as usize).min(n)
            };
            map.block(
                world,
                Surface::Obstacle(index),
                (span(obstacle.x - room.x, n_x), span(obstacle.y - room.y, n_y)),
                inflation,
            );
        }
        map
    }

    fn block(
        &mut self,
        world: &World,
        surface: Surface,
        (columns, rows): (std::ops::Range<usize>, std::ops::Range<usize>),
        inflation: f64,
    ) {
        for row in rows {
            for column in columns.clone() {
                if world.distance_to(surface, &self.center((column, row))) < inflation {
                    self.blocked[row * self.n_x + column] = true;
                }
            }
        }
    }

    /// Whether a point lies in a free cell of the map.
    #[must_use]
    pub fn is_free(&self, point: &Point) -> bool {
        let place = |x: f64, n: usize| (x >= 0.0 && x < n as f64 * self.cell).then(|| (x / self.cell) as usize);
        let cell = place(point.x - self.corner.x, self.n_x).zip(place(point.y - self.corner.y, self.n_y));
        cell.is_some_and(|cell| !self.is_blocked(cell))
    }

    /// Whether all cells that the straight line from `a` to `b` passes through are free; points outside the map see nothing.
    ///
    /// Walks from cell border to cell border (Amanatides and Woo 1987); where the line passes exactly
    /// through a corner, one of the two cells beside it is looked at.
    #[must_use]
    pub fn sees(&self, a: &Point, b: &Point) -> bool {
        if !self.is_free(a) || !self.is_free(b) {
            return false;
        }
        let (mut here, end) = (self.cell_of(a), self.cell_of(b));
        let d = b - a;
        let advance = |rate: f64| if rate > 0.0 { 1 } else { -1 };
        let border = |position: f64, index: usize, rate: f64| {
            let next = if rate > 0.0 { index + 1 } else { index };
            if rate == 0.0 { f64::INFINITY } else { (next as f64 * self.cell - position) / rate }
        };
        let a = a - self.corner;
        let (mut to_x, mut to_y) = (border(a.x, here.0, d.x), border(a.y, here.1, d.y));
        let n_borders = here.0.abs_diff(end.0) + here.1.abs_diff(end.1);
        for _ in 0..n_borders {
            if self.is_blocked(here) {
                return false;
            }
            if to_x < to_y {
                here.0 = here.0.saturating_add_signed(advance(d.x)).min(self.n_x - 1);
                to_x = border(a.x, here.0, d.x);
            } else {
                here.1 = here.1.saturating_add_signed(advance(d.y)).min(self.n_y - 1);
                to_y = border(a.y, here.1, d.y);
            }
        }
        !self.is_blocked(here)
    }

    /// Columns and rows.
    pub(crate) fn size(&self) -> (usize, usize) {
        (self.n_x, self.n_y)
    }

    pub(crate) fn is_blocked(&self, (column, row): Cell) -> bool {
        self.blocked[row * self.n_x + column]
    }

    /// The middle of a cell.
    pub(crate) fn center(&self, (column, row): Cell) -> Point {
        self.corner + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * self.cell
    }

    /// The cell that holds a point, or the nearest one to it.
    pub(crate) fn cell_of(&self, point: &Point) -> Cell {
        let index = |x: f64, n: usize| ((x / self.cell).max(0.0) as usize).min(n - 1);
        (index(point.x - self.corner.x, self.n_x), index(point.y - self.corner.y, self.n_y))
    }

    /// The free cell whose centre is nearest to a point, if there is any free cell.
    pub(crate) fn nearest_free(&self, point: &Point) -> Option<Cell> {
        let here = self.cell_of(point);
        if !self.is_blocked(here) {
            return Some(here);
        }
        let cells = (0..self.n_y).flat_map(|row| (0..self.n_x).map(move |column| (column, row)));
        let distance = |cell: &Cell| (self.center(*cell) - point).norm_squared();
        cells.filter(|cell| !self.is_blocked(*cell)).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_sim::{Obstacle, Shape};
    use proptest::prelude::*;

    fn world() -> World {
        let disc = |x, y, radius| Obstacle { shape: Shape::Disc { radius }, x, y, yaw: 0.0 };
        let shape = Shape::Box { length: 2.0, width: 0.4 };
        let boxed = Obstacle { shape, x: 3.0, y: 7.0, yaw: 0.6 };
        World::new(Room::new(10.0, 9.93), vec![disc(5.0, 4.0, 0.8), boxed]).unwrap()
    }

    #[test]
    fn cells_are_blocked_where_the_centre_is_too_near() {
        let (world, map) = (world(), GridMap::from_world(&world(), 0.1, 0.3));
        for row in 0..map.n_y {
            for column in 0..map.n_x {
                let center = map.center((column, row));
                assert_eq!(map.is_blocked((column, row)), world.distance(&center) < 0.3, "{center}");
            }
        }
    }

    /// Rooms smaller than the inflation, or no whole number of cells wide, and inflations of any size.
    #[test]
    fn walls_block_wherever_they_are_near() {
        for (width, height) in [(10.0, 9.93), (0.35, 4.0), (1.0, 1.0)] {
            let world = World::new(Room::new(width, height), vec![]).unwrap();
            for inflation in [-0.1, 0.0, 0.13, 0.3, 2.0, 1e300] {
                let map = GridMap::from_world(&world, 0.1, inflation);
                for cell in (0..map.n_y).flat_map(|row| (0..map.n_x).map(move |column| (column, row))) {
                    let center = map.center(cell);
                    assert_eq!(map.is_blocked(cell), world.distance(&center) < inflation, "{center} {inflation}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn what_is_seen_is_free_all_along(ax in 0.0..10.0, ay in 0.0..9.9, bx in 0.0..10.0, by in 0.0..9.9) {
            let map = GridMap::from_world(&world(), 0.1, 0.3);
            let (a, b) = (Point::new(ax, ay), Point::new(bx, by));
            let along = (0..=5000).map(|k| a + (b - a) * (f64::from(k) / 5000.0));
            let n_blocked = along.filter(|p| !map.is_free(p)).count();
            if map.sees(&a, &b) {
                // Sampled points may round into a cell that the line only touches.
                prop_assert!(n_blocked <= 2);
            } else {
                prop_assert!(n_blocked > 0 || (b - a).norm() < 1e-6 || grazes(&map, &a, &b));
            }
        }
    }

    /// Whether the line comes within a hair of a blocked cell, which samples along it may miss.
    fn grazes(map: &GridMap, a: &Point, b: &Point) -> bool {
        let side = nalgebra::Vector2::new(a.y - b.y, b.x - a.x).normalize() * 5e-3;
        (0..=5000)
            .map(|k| a + (b - a) * (f64::from(k) / 5000.0))
            .any(|p| !map.is_free(&(p + side)) || !map.is_free(&(p - side)))
    }
}
