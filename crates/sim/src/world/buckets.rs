//! Which solids may be near a place.

use crate::{Point, Room};

/// A grid of cells over a room, each of which knows the solids whose centres lie in it.
///
/// With about as many cells as solids, a question about a small neighbourhood takes the same time in a
/// room of ten obstacles and of ten thousand.
#[derive(Debug, Clone)]
pub(super) struct Buckets {
    n: usize,
    per_metre: [f64; 2],
    cells: Vec<Vec<usize>>,
    largest_radius: f64,
}

impl Buckets {
    /// An empty grid for about `n_solids`.
    pub(super) fn new(room: &Room, n_solids: usize) -> Self {
        let n = n_solids.isqrt().clamp(1, 128);
        let per_metre = [n as f64 / room.width, n as f64 / room.height];
        Self { n, per_metre, cells: vec![Vec::new(); n * n], largest_radius: 0.0 }
    }

    /// Adds the solid number `index` with its bounding circle.
    pub(super) fn insert(&mut self, index: usize, center: &Point, radius: f64) {
        let [i, j] = self.cell(center.x, center.y);
        self.cells[i * self.n + j].push(index);
        self.largest_radius = self.largest_radius.max(radius);
    }

    /// Every solid whose bounding circle comes within `reach` of `point`, and perhaps others.
    pub(super) fn near(&self, point: &Point, reach: f64) -> impl Iterator<Item = usize> {
        let reach = reach + self.largest_radius;
        let [first_i, first_j] = self.cell(point.x - reach, point.y - reach);
        let [last_i, last_j] = self.cell(point.x + reach, point.y + reach);
        let cells = (first_i..=last_i).flat_map(move |i| &self.cells[i * self.n + first_j..=i * self.n + last_j]);
        cells.flatten().copied()
    }

    /// The cell of a place, or the nearest one for a place outside.
    fn cell(&self, x: f64, y: f64) -> [usize; 2] {
        // A cast to an integer saturates, and makes 0 of what is not a number.
        [x * self.per_metre[0], y * self.per_metre[1]].map(|along| (along as usize).min(self.n - 1))
    }
}
