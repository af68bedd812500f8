//! Ways through points.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use super::Mover;
use super::gait::TRIES;
use super::ground::{GAP, Ground};
use crate::Point;

/// A way through points, in a ring or to and fro.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Tour {
    points: Vec<Point>,
    is_ring: bool,
    next: usize,
    is_forward: bool,
}

impl Tour {
    /// From where the mover is, through points to which the straight way is free of what stands still; in a ring where the
    /// way from the last to the first is free, too. Where no further point is found, there are fewer.
    pub(super) fn new(n_points: usize, mover: &Mover, ground: &Ground<'_>, rng: &mut impl RngExt) -> Self {
        let mut points = vec![mover.position];
        let still = ground.without_movers();
        let is_free = |a: &Point, b: &Point| still.is_free(a, b, mover.radius + GAP);
        for _ in 1..n_points {
            let last = points[points.len() - 1];
            let mut draws = (0..TRIES).map(|_| still.room().sample(rng));
            points.extend(draws.find(|point| is_free(&last, point)));
        }
        let is_ring = points.len() > 2 && is_free(&points[points.len() - 1], &points[0]);
        Self { next: usize::from(points.len() > 1), points, is_ring, is_forward: true }
    }

    /// Round a given loop of two points or more.
    pub(super) fn round(points: &[[f64; 2]], next: usize) -> Self {
        Self { points: points.iter().copied().map(Point::from).collect(), is_ring: true, next, is_forward: true }
    }

    /// Where it goes.
    pub(super) fn next(&self) -> Point {
        self.points[self.next]
    }

    /// Whether what was read has a place to go to.
    pub(super) fn has_next(&self) -> bool {
        self.next < self.points.len()
    }

    /// Goes on to the point after the next one.
    fn go_on(&mut self) {
        let n = self.points.len();
        if !self.is_ring {
            self.is_forward = if self.is_forward { self.next + 1 < n } else { self.next == 0 };
        }
        let step = if self.is_forward { 1 } else { n - 1 };
        self.next = if n > 1 { (self.next + step) % n } else { 0 };
    }

    fn turn_back(&mut self) {
        let n = self.points.len();
        self.is_forward = !self.is_forward;
        let step = if self.is_forward { 1 } else { n - 1 };
        self.next = (self.next + step) % n;
    }

    /// Walks a length along the tour; turns back where something is in the way.
    pub(super) fn walk(&mut self, own: usize, mover: &Mover, mut length: f64, ground: &Ground<'_>) -> Point {
        let mut position = mover.position;
        // More points than these lie no way apart.
        for _ in 0..=self.points.len() {
            let next = self.points[self.next];
            let to = next - position;
            let (apart, is_reached) = (to.norm(), to.norm() <= length);
            let end = if is_reached { next } else { position + to * (length / apart) };
            if let Some(contact) = ground.first_contact(own, mover.radius, &position, &end) {
                self.turn_back();
                return position + to * (contact.distance / apart);
            }
            position = end;
            if !is_reached {
                break;
            }
            length -= apart;
            self.go_on();
        }
        position
    }
}
