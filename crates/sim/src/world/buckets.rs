//! Which of many solids may be near a place.

use crate::{Point, Room};

/// The end of a chain.
const NONE: u32 = u32::MAX;

/// A grid of cells over an area, each with a chain of the solids whose centres lie in it; those outside are in the nearest cell.
///
/// With about as many cells as solids, a question about a small neighbourhood takes the same time in a
/// room of a hundred obstacles and of ten thousand.
#[derive(Debug, Clone)]
pub(super) struct Buckets {
    n: usize,
    corner: Point,
    per_metre: [f64; 2],
    /// Of each cell: its newest solid.
    first: Vec<u32>,
    /// Of each solid: the next older one in its cell.
    next: Vec<u32>,
    largest_radius: f64,
}

impl Buckets {
    /// An empty grid for about `n_solids`.
    pub(super) fn new(area: &Room, n_solids: usize) -> Self {
        let n = n_solids.isqrt().clamp(1, 128);
        let per_metre = [n as f64 / area.width, n as f64 / area.height];
        let corner = Point::new(area.x, area.y);
        Self { n, corner, per_metre, first: vec![NONE; n * n], next: Vec::with_capacity(n_solids), largest_radius: 0.0 }
    }

    /// Adds the solid number `index`, one more than the last, with its bounding circle.
    pub(super) fn insert(&mut self, index: usize, center: &Point, radius: f64) {
        let [i, j] = self.cell(center.x, center.y);
        let first = &mut self.first[i * self.n + j];
        self.next.push(std::mem::replace(first, index as u32));
        self.largest_radius = self.largest_radius.max(radius);
    }

    /// Moves a solid from the cell of one centre to that of another.
    pub(super) fn relocate(&mut self, index: usize, from: &Point, to: &Point) {
        let [old, new] = [from, to].map(|center| {
            let [i, j] = self.cell(center.x, center.y);
            i * self.n + j
        });
        if old == new {
            return;
        }
        let after = self.next[index];
        let mut link = &mut self.first[old];
        while *link != index as u32 {
            let before = *link as usize;
            link = &mut self.next[before];
        }
        *link = after;
        self.next[index] = std::mem::replace(&mut self.first[new], index as u32);
    }

    /// Every solid whose bounding circle comes within `reach` of `point`, and perhaps others.
    pub(super) fn near(&self, point: &Point, reach: f64) -> impl Iterator<Item = usize> + use<'_> {
        let reach = reach + self.largest_radius;
        let [first_i, first_j] = self.cell(point.x - reach, point.y - reach);
        let [last_i, last_j] = self.cell(point.x + reach, point.y + reach);
        let cells = (first_i..=last_i).flat_map(move |i| &self.first[i * self.n + first_j..=i * self.n + last_j]);
        let link = |index: u32| (index != NONE).then_some(index);
        let chain = move |first: &u32| {
            std::iter::successors(link(*first), move |index| link(self.next[*index as usize])).map(|i| i as usize)
        };
        cells.flat_map(chain)
    }

    /// The longer side of a cell, metres.
    pub(super) fn cell_size(&self) -> f64 {
        1.0 / self.per_metre[0].min(self.per_metre[1])
    }

    /// The cell of a place, or the nearest one for a place outside.
    fn cell(&self, x: f64, y: f64) -> [usize; 2] {
        // A cast to an integer saturates, and makes 0 of what is not a number.
        [(x - self.corner.x) * self.per_metre[0], (y - self.corner.y) * self.per_metre[1]]
            .map(|along| (along as usize).min(self.n - 1))
    }
}
