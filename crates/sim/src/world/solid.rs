//! Obstacles in the world's frame.

use nalgebra::Vector2;

use crate::geometry::{Polygon, nearest_on_segment, ray_disc};
use crate::{Footprint, Obstacle, Point, Pose, Shape};

/// An obstacle in the world's frame.
#[derive(Debug, Clone)]
pub(crate) enum Solid {
    Disc { center: Point, radius: f64 },
    Polygon(Box<Polygon>),
}

impl Solid {
    /// The solid of a checked obstacle.
    pub(super) fn new(obstacle: &Obstacle) -> Self {
        match &obstacle.shape {
            Shape::Disc { radius } => Self::Disc { center: Point::new(obstacle.x, obstacle.y), radius: *radius },
            shape => Self::Polygon(Box::new(Polygon::new(shape.vertices()).at(&obstacle.pose()))),
        }
    }

    /// Centre and radius of a circle that holds the solid.
    pub(super) fn bounding_circle(&self) -> (Point, f64) {
        match self {
            Self::Disc { center, radius } => (*center, *radius),
            Self::Polygon(polygon) => (polygon.center(), polygon.radius()),
        }
    }

    /// The distance from a point to the solid, negative inside.
    pub(super) fn distance(&self, point: &Point) -> f64 {
        match self {
            Self::Disc { center, radius } => (point - center).norm() - radius,
            Self::Polygon(polygon) => polygon.signed_distance(point),
        }
    }

    /// The signed distance from a footprint to the solid.
    pub(super) fn clearance(&self, footprint: &Footprint, pose: &Pose) -> f64 {
        match (self, footprint.polygon()) {
            (_, None) => self.distance(&pose.translation.vector.into()) - footprint.circumradius(),
            (Self::Disc { center, radius }, Some(own)) => {
                own.signed_distance(&pose.inverse_transform_point(center)) - radius
            }
            (Self::Polygon(polygon), Some(own)) => polygon.hull().signed_distance(own.hull(), pose),
        }
    }

    /// Whether a footprint touches or overlaps the solid: as [`Self::clearance`] says, but cheaper for two polygons.
    pub(super) fn touches(&self, footprint: &Footprint, pose: &Pose) -> bool {
        match (self, footprint.polygon()) {
            (Self::Polygon(polygon), Some(own)) => polygon.hull().touches(own.hull(), pose),
            _ => self.clearance(footprint, pose) <= 0.0,
        }
    }

    /// The signed distance to another solid.
    pub(super) fn gap(&self, other: &Self) -> f64 {
        match (self, other) {
            (solid, Self::Disc { center, radius }) | (Self::Disc { center, radius }, solid) => {
                solid.distance(center) - radius
            }
            (Self::Polygon(polygon), Self::Polygon(other)) => {
                polygon.hull().signed_distance(other.hull(), &Pose::identity())
            }
        }
    }

    /// Where a ray along a unit vector meets the solid.
    pub(crate) fn cast(&self, origin: &Point, direction: &Vector2<f64>) -> Option<f64> {
        match self {
            Self::Disc { center, radius } => ray_disc(&(center - origin), *radius, direction),
            Self::Polygon(polygon) => polygon.cast(origin, direction),
        }
    }

    /// The point of the surface nearest to an outside point.
    pub(crate) fn nearest(&self, point: &Point) -> Point {
        match self {
            Self::Disc { center, radius } => center + (point - center).normalize() * *radius,
            Self::Polygon(polygon) => polygon.nearest(point),
        }
    }
}

/// The point of a wall nearest to `point`.
pub(crate) fn nearest_on_wall(wall: &[Point; 2], point: &Point) -> Point {
    nearest_on_segment(&wall[0], &wall[1], point)
}
