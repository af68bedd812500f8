//! A footprint with something added all around.

use headway_sim::{Point, Shape};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// A padded footprint in the vehicle's frame.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Outline {
    /// Of a disc, or 0.
    radius: f64,
    /// Of a polygon, or none.
    corners: Vec<Vector2<f64>>,
}

impl Outline {
    /// Pads as ROS does (`costmap_2d::padFootprint`): each corner moves away from both axes by `padding`, a disc's radius grows
    /// by it.
    pub(crate) fn new(shape: &Shape, padding: f64) -> Self {
        let away = |x: f64| if x == 0.0 { 0.0 } else { x + padding.copysign(x) };
        let corners = shape.vertices().iter().map(|corner| Vector2::new(away(corner.x), away(corner.y))).collect();
        let radius = if let Shape::Disc { radius } = shape { radius + padding } else { 0.0 };
        Self { radius, corners }
    }

    fn edges(&self) -> impl Iterator<Item = (Vector2<f64>, Vector2<f64>)> + '_ {
        let n = self.corners.len();
        (0..n).map(move |k| (self.corners[k], self.corners[(k + 1) % n]))
    }

    /// The distance from the origin to the nearest point of the outline, metres.
    pub(crate) fn inradius(&self) -> f64 {
        let distance = |(a, b): (Vector2<f64>, Vector2<f64>)| {
            let along = b - a;
            let share = (-a.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (a + along * share).norm()
        };
        if self.corners.is_empty() { self.radius } else { self.edges().map(distance).fold(f64::INFINITY, f64::min) }
    }

    /// The distance from the origin to the farthest point of the outline, metres.
    pub(crate) fn circumradius(&self) -> f64 {
        self.corners.iter().map(nalgebra::Matrix::norm).fold(self.radius, f64::max)
    }

    /// Whether a point of the vehicle's frame lies within: an odd number of edges lie to its right.
    pub(crate) fn contains(&self, point: &Point) -> bool {
        if self.corners.is_empty() {
            return point.coords.norm() < self.radius;
        }
        let is_right = |(a, b): &(Vector2<f64>, Vector2<f64>)| {
            (a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
        };
        self.edges().filter(is_right).count() % 2 == 1
    }

    /// Points all along the outline, at most `spacing` metres apart.
    pub(crate) fn points(&self, spacing: f64) -> Vec<Vector2<f64>> {
        if self.corners.is_empty() {
            let n = (self.radius * std::f64::consts::TAU / spacing).ceil().max(3.0) as usize;
            let at = |k: usize| (k as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
            return (0..n).map(at).map(|(sin, cos)| Vector2::new(cos, sin) * self.radius).collect();
        }
        let mut points = Vec::new();
        for (a, b) in self.edges() {
            let n = ((b - a).norm() / spacing).ceil().max(1.0) as usize;
            points.extend((0..n).map(|k| a + (b - a) * (k as f64 / n as f64)));
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jackal_of_barn_by_hand() {
        let outline = Outline::new(&Shape::Box { length: 0.42, width: 0.33 }, 0.1);
        assert!((outline.inradius() - 0.265).abs() < 1e-12);
        assert!((outline.circumradius() - 0.31_f64.hypot(0.265)).abs() < 1e-12);
        assert!(outline.contains(&Point::new(0.309, -0.264)) && !outline.contains(&Point::new(0.311, 0.0)));
        // 13 + 11 stretches of at most 0.05 m, twice.
        assert_eq!(outline.points(0.05).len(), 48);
    }

    #[test]
    fn a_disc_grows() {
        let outline = Outline::new(&Shape::Disc { radius: 0.25 }, 0.1);
        assert_eq!((outline.inradius(), outline.circumradius()), (0.35, 0.35));
        assert!(outline.contains(&Point::new(0.0, 0.34)) && !outline.contains(&Point::new(0.3, 0.3)));
        assert!(outline.points(0.05).iter().all(|point| (point.norm() - 0.35).abs() < 1e-12));
    }
}
