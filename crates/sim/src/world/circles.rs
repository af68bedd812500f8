//! The circles around all solids, as arrays of numbers.

use super::buckets::Buckets;
use crate::{Point, Room};

/// Circles a block: what the compiler works on at once.
const LANES: usize = 8;

/// Up to so many circles, looking at all of them costs less than finding out which are near.
const FEW: usize = 32;

/// A circle around each solid, in blocks of x, y and radius; beyond [`FEW`], a grid tells which are near.
#[derive(Debug, Clone)]
pub(super) struct Circles {
    blocks: Vec<Block>,
    len: usize,
    buckets: Option<Buckets>,
}

#[derive(Debug, Clone, Copy)]
struct Block {
    x: [f64; LANES],
    y: [f64; LANES],
    radius: [f64; LANES],
}

impl Block {
    /// Circles that are infinitely far from everything.
    const EMPTY: Self = Self { x: [0.0; LANES], y: [0.0; LANES], radius: [f64::NEG_INFINITY; LANES] };

    /// Whether a circle comes within `reach` of a point. No root is taken.
    fn is_near(&self, lane: usize, point: &Point, reach: f64) -> bool {
        let (x, y, reach) = (self.x[lane] - point.x, self.y[lane] - point.y, reach + self.radius[lane]);
        reach >= 0.0 && x * x + y * y <= reach * reach
    }
}

impl Circles {
    /// No circles yet, in a room for about `n` of them.
    pub(super) fn new(room: &Room, n: usize) -> Self {
        let buckets = (n > FEW).then(|| Buckets::new(room, n));
        Self { blocks: Vec::with_capacity(n.div_ceil(LANES)), len: 0, buckets }
    }

    /// Adds a circle, whose index is the number of those before it.
    pub(super) fn push(&mut self, center: &Point, radius: f64) {
        let lane = self.len % LANES;
        if lane == 0 {
            self.blocks.push(Block::EMPTY);
        }
        let block = &mut self.blocks[self.len / LANES];
        (block.x[lane], block.y[lane], block.radius[lane]) = (center.x, center.y, radius);
        if let Some(buckets) = &mut self.buckets {
            buckets.insert(self.len, center, radius);
        }
        self.len += 1;
    }

    /// The circles that come within `reach` of a point, in no particular order.
    pub(super) fn near(&self, point: &Point, reach: f64) -> impl Iterator<Item = usize> + use<'_> {
        let (candidates, point) = (self.candidates(point, reach), *point);
        candidates.filter(move |index| self.blocks[index / LANES].is_near(index % LANES, &point, reach))
    }

    /// As [`Self::near`], with a reach that shrinks once something near is found: `visit` returns it.
    pub(super) fn visit_near(&self, point: &Point, mut reach: f64, mut visit: impl FnMut(usize) -> f64) {
        for index in self.candidates(point, reach) {
            if self.blocks[index / LANES].is_near(index % LANES, point, reach) {
                reach = visit(index);
            }
        }
    }

    /// All circles within `reach` of a point, and others.
    fn candidates(&self, point: &Point, reach: f64) -> impl Iterator<Item = usize> + use<'_> {
        let chosen = self.buckets.as_ref().map(|buckets| buckets.near(point, reach));
        let all = if chosen.is_some() { 0..0 } else { 0..self.len };
        all.chain(chosen.into_iter().flatten())
    }

    /// A first guess of how far one must look to find something, metres: infinite where that is no effort.
    pub(super) fn first_reach(&self) -> f64 {
        self.buckets.as_ref().map_or(f64::INFINITY, Buckets::cell_size)
    }
}
