//! The lattice on which paths are searched.

use crate::{Point, Room};

/// Points `step` apart, as many as fit between the walls.
pub(super) struct Lattice {
    pub(super) step: f64,
    first: Point,
    n_x: usize,
    n_y: usize,
}

impl Lattice {
    /// A lattice without a node.
    pub(super) const EMPTY: Self = Self { step: 0.0, first: Point::new(0.0, 0.0), n_x: 0, n_y: 0 };

    /// The longest step but in the largest rooms, metres.
    const STEP: f64 = 0.1;
    /// The most nodes: some seconds of searching.
    const MOST_NODES: f64 = 1e7;

    /// The step, metres, at which a room has nearly the most nodes: inside, and a tenth of it along its rim.
    fn shortest_step(room: &Room) -> f64 {
        let Room { width, height, .. } = room;
        let inside = (width * height / (0.9 * Self::MOST_NODES)).sqrt();
        inside.max((width + height) / (0.09 * Self::MOST_NODES))
    }

    /// The least clearance of starts and goals with which paths in a room can be found, metres: with less,
    /// the lattice has too many nodes. Rounded up to a millimetre.
    pub(super) fn least_clearance(room: &Room) -> f64 {
        (2.0 * Self::shortest_step(room) * 1e3).ceil() / 1e3
    }

    /// The lattice of a room, or `None` if it has too many nodes or the clearance is not above 0.
    pub(super) fn new(room: &Room, clearance: f64) -> Option<Self> {
        let step = Self::STEP.max(Self::shortest_step(room)).min(clearance / 2.0);
        let count = |extent: f64| (extent / step).floor() + 1.0;
        let (n_x, n_y) = (count(room.width), count(room.height));
        if !(clearance > 0.0 && n_x * n_y <= Self::MOST_NODES) {
            return None;
        }
        let first = |low: f64, extent: f64, n: f64| low + (extent - (n - 1.0) * step) / 2.0;
        let first = Point::new(first(room.x, room.width, n_x), first(room.y, room.height, n_y));
        Some(Self { step, first, n_x: n_x as usize, n_y: n_y as usize })
    }

    pub(super) fn n_nodes(&self) -> usize {
        self.n_x * self.n_y
    }

    /// Where its columns are along x, and its rows along y.
    pub(super) fn coordinates(&self) -> [Vec<f64>; 2] {
        let columns = (0..self.n_x).map(|i| self.point(i).x).collect();
        [columns, (0..self.n_y).map(|j| self.point(j * self.n_x).y).collect()]
    }

    pub(super) fn point(&self, node: usize) -> Point {
        let (i, j) = (node % self.n_x, node / self.n_x);
        self.first + nalgebra::Vector2::new(i as f64, j as f64) * self.step
    }

    /// The nodes next to a node, up to four.
    pub(super) fn neighbours(&self, node: usize) -> impl Iterator<Item = usize> + use<> {
        let (n_x, n_y, i, j) = (self.n_x, self.n_y, node % self.n_x, node / self.n_x);
        let aside = [(i > 0).then(|| node - 1), (i + 1 < n_x).then_some(node + 1)];
        let ahead = [(j > 0).then(|| node - n_x), (j + 1 < n_y).then_some(node + n_x)];
        aside.into_iter().chain(ahead).flatten()
    }

    /// The nodes within a step of a point.
    pub(super) fn around(&self, point: &Point) -> Vec<usize> {
        let to = (point - self.first) / self.step;
        // A cast to an integer saturates, and makes 0 of what is not a number.
        let nodes = |at: f64, n: usize| (at.floor() as usize).saturating_sub(1)..(at as usize).saturating_add(3).min(n);
        let all = nodes(to.y, self.n_y).flat_map(|j| nodes(to.x, self.n_x).map(move |i| j * self.n_x + i));
        all.filter(|node| (self.point(*node) - point).norm() <= self.step).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattices_are_bounded() {
        for (width, height) in [(0.1, 0.1), (10.0, 15.0), (1000.0, 1000.0), (1000.0, 0.1), (1e6, 1.0)] {
            let room = Room::new(width, height);
            let least = Lattice::least_clearance(&room);
            let lattice = Lattice::new(&room, least).unwrap();
            assert!(lattice.n_nodes() as f64 <= Lattice::MOST_NODES);
        }
        for extent in [10.0, 1000.0] {
            let room = Room::new(extent, extent);
            assert!(Lattice::new(&room, 0.9 * Lattice::least_clearance(&room)).is_none());
        }
    }
}
