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
    const EMPTY: Self = Self { x: [f64::INFINITY; LANES], y: [0.0; LANES], radius: [0.0; LANES] };

    /// How much too far a circle is off to come within `reach` of a point, squared metres; no root is taken.
    fn excess(&self, lane: usize, point: &Point, reach: f64) -> f64 {
        let (x, y, reach) = (self.x[lane] - point.x, self.y[lane] - point.y, reach + self.radius[lane]);
        x * x + y * y - reach * reach
    }

    /// Whether any of the circles comes within `reach` of a point: written for the compiler to vectorise.
    fn is_any_near(&self, point: &Point, reach: f64) -> bool {
        let mut least = [f64::INFINITY; LANES / 2];
        for (lane, least) in least.iter_mut().enumerate() {
            let (a, b) = (self.excess(lane, point, reach), self.excess(lane + LANES / 2, point, reach));
            *least = if a < b { a } else { b };
        }
        least.iter().any(|excess| *excess <= 0.0)
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
        let point = *point;
        let chosen = self.buckets.as_ref().map(|buckets| buckets.near(&point, reach));
        let n_blocks = if chosen.is_some() { 0 } else { self.blocks.len() };
        let blocks = (0..n_blocks).filter(move |block| self.blocks[*block].is_any_near(&point, reach));
        let all = blocks.flat_map(|block| block * LANES..(block + 1) * LANES).chain(chosen.into_iter().flatten());
        all.filter(move |index| self.excess(*index, &point, reach) <= 0.0)
    }

    /// As [`Self::near`], with a reach that shrinks once something near is found: `visit` returns it.
    pub(super) fn visit_near(&self, point: &Point, mut reach: f64, mut visit: impl FnMut(usize) -> f64) {
        if let Some(buckets) = &self.buckets {
            for index in buckets.near(point, reach) {
                if self.excess(index, point, reach) <= 0.0 {
                    reach = visit(index);
                }
            }
            return;
        }
        for (b, block) in self.blocks.iter().enumerate() {
            if !block.is_any_near(point, reach) {
                continue;
            }
            for lane in 0..LANES {
                if block.excess(lane, point, reach) <= 0.0 {
                    reach = visit(b * LANES + lane);
                }
            }
        }
    }

    fn excess(&self, index: usize, point: &Point, reach: f64) -> f64 {
        self.blocks[index / LANES].excess(index % LANES, point, reach)
    }

    /// A first guess of how far one must look to find something, metres: a thousand kilometres where that is no effort.
    pub(super) fn first_reach(&self) -> f64 {
        self.buckets.as_ref().map_or(1e6, Buckets::cell_size)
    }
}
