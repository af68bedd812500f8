//! A vehicle's outline, as it is or padded.

use std::f64::consts::TAU;

use headway_sim::{Point, Shape};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// An outline around the vehicle's origin, in the vehicle's frame.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Outline {
    /// The distance from the origin to the farthest point, metres: a disc's radius.
    circumradius: f64,
    /// Counter-clockwise; none for a disc.
    corners: Vec<Vector2<f64>>,
    /// Of the edge from each corner to the next: its outward unit normal and its line's distance from the origin, metres.
    edges: Vec<(Vector2<f64>, f64)>,
}

impl Outline {
    /// That of a shape.
    pub(crate) fn new(shape: &Shape) -> Self {
        Self::padded(shape, 0.0)
    }

    /// Padded as ROS does (`costmap_2d::padFootprint`): each corner moves away from both axes by `padding`, a disc's radius grows
    /// by it.
    pub(crate) fn padded(shape: &Shape, padding: f64) -> Self {
        let away = |x: f64| if x == 0.0 { 0.0 } else { x + padding.copysign(x) };
        let corners: Vec<_> =
            shape.vertices().iter().map(|corner| Vector2::new(away(corner.x), away(corner.y))).collect();
        let edge = |(a, b): (Vector2<f64>, Vector2<f64>)| {
            let normal = Vector2::new(b.y - a.y, a.x - b.x).normalize();
            (normal, normal.dot(&a))
        };
        let radius = if let Shape::Disc { radius } = shape { radius + padding } else { 0.0 };
        let circumradius = corners.iter().map(nalgebra::Matrix::norm).fold(radius, f64::max);
        Self { circumradius, edges: sides(&corners).map(edge).collect(), corners }
    }

    fn is_disc(&self) -> bool {
        self.corners.is_empty()
    }

    /// The distance from the origin to the farthest point of the outline, metres.
    pub(crate) fn circumradius(&self) -> f64 {
        self.circumradius
    }

    /// The distance from the origin to the nearest point of the outline, metres.
    pub(crate) fn inradius(&self) -> f64 {
        let distance = |(a, b): (Vector2<f64>, Vector2<f64>)| {
            let along = b - a;
            let share = (-a.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (a + along * share).norm()
        };
        sides(&self.corners).map(distance).fold(self.circumradius, f64::min)
    }

    /// How far a point of the outline moves per radian at most, metres.
    pub(crate) fn turning_radius(&self) -> f64 {
        if self.is_disc() { 0.0 } else { self.circumradius }
    }

    /// How far the outline reaches in a direction, metres: its support.
    pub(crate) fn support(&self, direction: &Vector2<f64>) -> f64 {
        if self.is_disc() {
            return self.circumradius;
        }
        self.corners.iter().map(|corner| corner.dot(direction)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The distance from a convex outline to a point, metres, negative inside; beside a corner the distance to the farther
    /// of its two edges' lines, which is less than that to the corner.
    pub(crate) fn height(&self, point: &Vector2<f64>) -> f64 {
        if self.is_disc() {
            return point.norm() - self.circumradius;
        }
        self.edges.iter().map(|(normal, distance)| normal.dot(point) - distance).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether a point lies within, be the outline convex or, padded, not: an odd number of edges lie to its right.
    pub(crate) fn contains(&self, point: &Point) -> bool {
        if self.is_disc() {
            return point.coords.norm() < self.circumradius;
        }
        let is_right = |(a, b): &(Vector2<f64>, Vector2<f64>)| {
            (a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
        };
        sides(&self.corners).filter(is_right).count() % 2 == 1
    }

    /// Points all along the outline, at most `spacing` metres apart.
    pub(crate) fn points(&self, spacing: f64) -> Vec<Vector2<f64>> {
        if self.is_disc() {
            let n = (self.circumradius * TAU / spacing).ceil().max(3.0) as usize;
            let at = |k: usize| (k as f64 / n as f64 * TAU).sin_cos();
            return (0..n).map(at).map(|(sin, cos)| Vector2::new(cos, sin) * self.circumradius).collect();
        }
        let mut points = Vec::new();
        for (a, b) in sides(&self.corners) {
            let n = ((b - a).norm() / spacing).ceil().max(1.0) as usize;
            points.extend((0..n).map(|k| a + (b - a) * (k as f64 / n as f64)));
        }
        points
    }
}

/// Each corner with the next one.
fn sides(corners: &[Vector2<f64>]) -> impl Iterator<Item = (Vector2<f64>, Vector2<f64>)> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jackal_of_barn_by_hand() {
        let outline = Outline::padded(&Shape::Box { length: 0.42, width: 0.33 }, 0.1);
        assert!((outline.inradius() - 0.265).abs() < 1e-12);
        assert!((outline.circumradius() - 0.31_f64.hypot(0.265)).abs() < 1e-12);
        assert!(outline.contains(&Point::new(0.309, -0.264)) && !outline.contains(&Point::new(0.311, 0.0)));
        // 13 + 11 stretches of at most 0.05 m, twice.
        assert_eq!(outline.points(0.05).len(), 48);
    }

    #[test]
    fn a_disc_grows() {
        let outline = Outline::padded(&Shape::Disc { radius: 0.25 }, 0.1);
        assert_eq!((outline.inradius(), outline.circumradius(), outline.turning_radius()), (0.35, 0.35, 0.0));
        assert!(outline.contains(&Point::new(0.0, 0.34)) && !outline.contains(&Point::new(0.3, 0.3)));
        assert!(outline.points(0.05).iter().all(|point| (point.norm() - 0.35).abs() < 1e-12));
        assert!((outline.height(&Vector2::new(0.3, 0.4)) - 0.15).abs() < 1e-12);
    }

    #[test]
    fn heights_above_a_box_by_hand() {
        let outline = Outline::new(&Shape::Box { length: 0.6, width: 0.4 });
        let height = |x, y| outline.height(&Vector2::new(x, y));
        assert!((height(1.0, 0.0) - 0.7).abs() < 1e-12);
        assert!((height(0.5, 0.3) - 0.2).abs() < 1e-12); // beside the corner: the farther of 0.2 and 0.1
        assert!((height(0.0, 0.1) + 0.1).abs() < 1e-12);
        assert!((outline.inradius() - 0.2).abs() < 1e-12);
        assert!((outline.support(&Vector2::x()) - 0.3).abs() < 1e-12);
        assert_eq!(outline.turning_radius(), outline.circumradius());
    }
}
