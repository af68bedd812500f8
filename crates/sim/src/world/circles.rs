//! The circles around all solids, as arrays of numbers.

use super::buckets::Buckets;
use super::kernel::{self, Block, LANES};
use super::solid::Solid;
use crate::{Point, Room};

/// Up to so many circles, looking at all of them costs less than finding out which are near.
const FEW: usize = u32::BITS as usize;

/// By how much a circle is larger than it need be, metres: more than rounding can make of a contact.
const SLACK: f64 = 1e-9;

/// A circle around each solid, in blocks of x, y and radius; beyond [`FEW`], a grid tells which are near.
///
/// The circles are bounds, a nanometre too large: who is asked whether it touches decides.
#[derive(Debug, Clone)]
pub(super) struct Circles {
    blocks: Vec<Block>,
    len: usize,
    /// Whether every circle is, but for the slack, the solid's own outline.
    are_exact: bool,
    buckets: Option<Buckets>,
}

impl Circles {
    /// No circles yet, for up to `n` of them, most of them centred in an area.
    pub(super) fn new(area: &Room, n: usize) -> Self {
        let buckets = (n > FEW).then(|| Buckets::new(area, n));
        Self { blocks: Vec::with_capacity(n.div_ceil(LANES)), len: 0, are_exact: true, buckets }
    }

    /// Adds the circle around a solid.
    pub(super) fn push_solid(&mut self, solid: &Solid) {
        let (center, radius) = solid.bounding_circle();
        self.push(&center, radius, matches!(solid, Solid::Disc { .. }));
    }

    /// Adds the circle around a solid, whose index is the number of those before it; `is_exact` if the solid fills it.
    fn push(&mut self, center: &Point, radius: f64, is_exact: bool) {
        self.are_exact &= is_exact;
        let radius = radius + SLACK;
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

    /// Whether `n` circles can be told apart as these are: many need the grid.
    pub(super) fn suits(&self, n: usize) -> bool {
        n <= FEW || self.buckets.is_some()
    }

    /// Moves the circle around a solid.
    pub(super) fn relocate(&mut self, index: usize, center: &Point) {
        let (block, lane) = (&mut self.blocks[index / LANES], index % LANES);
        let from = Point::new(block.x[lane], block.y[lane]);
        (block.x[lane], block.y[lane]) = (center.x, center.y);
        if let Some(buckets) = &mut self.buckets {
            buckets.relocate(index, &from, center);
        }
    }

    /// The circles that come within `reach` of a point, in no particular order.
    pub(super) fn near(&self, point: &Point, reach: f64) -> impl Iterator<Item = usize> + use<'_> {
        let point = *point;
        let chosen = self.buckets.as_ref().map(|buckets| buckets.near(&point, reach));
        let few = if chosen.is_some() { 0 } else { kernel::near(&self.blocks, &point, reach) };
        let is_near = move |index: &usize| self.is_near(*index, &point, reach);
        bits(few).chain(chosen.into_iter().flatten().filter(is_near))
    }

    /// Whether something is true of any circle that comes within `reach` of a point.
    pub(super) fn any_near(&self, point: &Point, reach: f64, is_true: impl FnMut(usize) -> bool) -> bool {
        match &self.buckets {
            Some(buckets) => buckets.near(point, reach).filter(|index| self.is_near(*index, point, reach)).any(is_true),
            None => bits(kernel::near(&self.blocks, point, reach)).any(is_true),
        }
    }

    /// As [`Self::near`], with a reach that shrinks once something near is found: `visit` returns it.
    pub(super) fn visit_near(&self, point: &Point, mut reach: f64, mut visit: impl FnMut(usize) -> f64) {
        let few = if self.buckets.is_some() { 0 } else { self.len };
        if few > 0 && !(self.are_exact && self.blocks.len() <= 2) {
            return self.visit_likely_first(point, reach, visit);
        }
        let chosen = self.buckets.as_ref().map(|buckets| buckets.near(point, reach));
        for index in (0..few).chain(chosen.into_iter().flatten()) {
            if self.is_near(index, point, reach) {
                reach = visit(index);
            }
        }
    }

    /// Visits the likely nearest of few circles first, so that hardly another is left to be visited: pays where there are
    /// more than a dozen, or where a visit is dear since the circle is only a bound.
    fn visit_likely_first(&self, point: &Point, mut reach: f64, mut visit: impl FnMut(usize) -> f64) {
        let first = kernel::likely_nearest(&self.blocks, point);
        if let Some(first) = first {
            reach = reach.min(visit(first));
        }
        for index in bits(kernel::near(&self.blocks, point, reach)) {
            if Some(index) != first && self.is_near(index, point, reach) {
                reach = visit(index);
            }
        }
    }

    #[inline]
    fn is_near(&self, index: usize, point: &Point, reach: f64) -> bool {
        self.blocks[index / LANES].is_near(index % LANES, point, reach)
    }

    /// A first guess of how far one must look to find something, metres: a thousand kilometres where that is no effort.
    pub(super) fn first_reach(&self) -> f64 {
        self.buckets.as_ref().map_or(1e6, Buckets::cell_size)
    }
}

/// The places of the bits that are set, from the lowest on.
fn bits(mut of: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = of.trailing_zeros();
        of &= of.wrapping_sub(1);
        (place < u32::BITS).then_some(place as usize)
    })
}
