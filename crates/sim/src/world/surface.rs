//! What a vehicle can hit, and how near it is.

use crate::Point;

/// The outline of an obstacle or a wall in the world's frame, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outline<'a> {
    /// A disc.
    Disc {
        /// Its centre.
        center: Point,
        /// Its radius.
        radius: f64,
    },
    /// A convex polygon's corners, counter-clockwise.
    Polygon(&'a [Point]),
    /// A wall, from corner to corner.
    Wall([Point; 2]),
}

/// Something that a vehicle can hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// The wall at the least x, the least y, the greatest x or the greatest y, in this order.
    Wall(usize),
    /// An obstacle, by its index.
    Obstacle(usize),
}

/// How near a footprint is to things: signed distances, negative where they overlap, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proximity {
    /// The nearest wall, and the distance to it.
    pub wall: (usize, f64),
    /// The nearest obstacle, and the distance to it, where there is any.
    pub obstacle: Option<(usize, f64)>,
}

impl Proximity {
    /// The distance to whatever is nearest, metres.
    #[must_use]
    pub fn clearance(&self) -> f64 {
        self.obstacle.map_or(self.wall.1, |(_, clearance)| clearance.min(self.wall.1))
    }
}
