//! Closed forms for discs and convex polygons: distances and ray casts.

mod hull;

use nalgebra::Vector2;

use crate::{Point, Pose};
use hull::Hull;

/// A convex polygon with its edges' outward normals.
#[derive(Debug, Clone)]
pub(crate) struct Polygon {
    vertices: Vec<Point>,
    normals: Vec<Vector2<f64>>,
    /// The lengths of the edges.
    lengths: Vec<f64>,
    center: Point,
    radius: f64,
    hull: Hull,
}

impl Polygon {
    /// From a checked shape's corners: strictly convex, counter-clockwise.
    pub(crate) fn new(vertices: Vec<Point>) -> Self {
        let edges = || vertices.iter().zip(vertices.iter().cycle().skip(1));
        let normals = edges().map(|(a, b)| Vector2::new(b.y - a.y, a.x - b.x).normalize()).collect();
        let lengths = edges().map(|(a, b)| (b - a).norm()).collect();
        let sum: Vector2<f64> = vertices.iter().map(|v| v.coords).sum();
        let center = Point::from(sum / vertices.len() as f64);
        let radius = vertices.iter().map(|v| (v - center).norm()).fold(0.0, f64::max);
        let hull = Hull::new(&vertices);
        Self { normals, lengths, center, radius, hull, vertices }
    }

    /// Moves the polygon, made of these corners, to `pose`: what [`Self::at`] makes of the one in its own frame.
    pub(crate) fn place(&mut self, corners: &[Point], pose: &Pose) {
        let sum: Vector2<f64> = corners.iter().map(|v| v.coords).sum();
        self.center = pose * Point::from(sum / corners.len() as f64);
        let edges = corners.iter().zip(corners.iter().cycle().skip(1));
        for (((a, b), vertex), normal) in edges.zip(&mut self.vertices).zip(&mut self.normals) {
            *vertex = pose * a;
            *normal = pose.rotation * Vector2::new(b.y - a.y, a.x - b.x).normalize();
        }
        self.hull.place(pose);
    }

    /// The same polygon moved to `pose`.
    pub(crate) fn at(&self, pose: &Pose) -> Self {
        Self {
            vertices: self.vertices.iter().map(|v| pose * v).collect(),
            normals: self.normals.iter().map(|n| pose.rotation * n).collect(),
            lengths: self.lengths.clone(),
            center: pose * self.center,
            radius: self.radius,
            hull: self.hull.at(pose),
        }
    }

    pub(crate) fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// The centre of a circle that holds the polygon.
    pub(crate) fn center(&self) -> Point {
        self.center
    }

    /// The radius of that circle, metres.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// The same polygon as parry sees it.
    pub(crate) fn hull(&self) -> &Hull {
        &self.hull
    }

    /// Distance from a point to the outline, negative inside.
    ///
    /// Outside, the nearest point lies on an edge that faces the point: `height` above it, and beside it if it is one of
    /// its ends.
    pub(crate) fn signed_distance(&self, point: &Point) -> f64 {
        let (mut highest, mut least_squared) = (f64::NEG_INFINITY, f64::INFINITY);
        for ((vertex, normal), length) in self.vertices.iter().zip(&self.normals).zip(&self.lengths) {
            let to = point - vertex;
            let height = normal.dot(&to);
            highest = highest.max(height);
            if height > 0.0 {
                let along = normal.perp(&to);
                let beside = along - along.clamp(0.0, *length);
                least_squared = least_squared.min(height * height + beside * beside);
            }
        }
        if highest <= 0.0 { highest } else { least_squared.sqrt() }
    }

    /// The point of the outline nearest to an outside point.
    pub(crate) fn nearest(&self, point: &Point) -> Point {
        let next = self.vertices.iter().cycle().skip(1);
        let candidates = self.vertices.iter().zip(next).map(|(a, b)| nearest_on_segment(a, b, point));
        nearest_of(candidates, point).unwrap_or(self.center)
    }

    /// Where a ray from `origin` along the unit vector `direction` meets the solid: the distance, 0
    /// from inside, `None` where it misses (Cyrus and Beck 1978).
    pub(crate) fn cast(&self, origin: &Point, direction: &Vector2<f64>) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for (vertex, normal) in self.vertices.iter().zip(&self.normals) {
            let (height, rate) = (normal.dot(&(vertex - origin)), normal.dot(direction));
            if rate < 0.0 {
                enter = enter.max(height / rate);
            } else if rate > 0.0 {
                leave = leave.min(height / rate);
            } else if height < 0.0 {
                return None;
            }
        }
        (enter <= leave).then_some(enter)
    }

    /// The distance from the origin, which is inside, to the outline along a unit vector.
    pub(crate) fn exit(&self, direction: &Vector2<f64>) -> f64 {
        let planes = self.vertices.iter().zip(&self.normals);
        planes
            .filter_map(|(v, n)| {
                let rate = n.dot(direction);
                (rate > 0.0).then(|| n.dot(&v.coords) / rate)
            })
            .fold(f64::INFINITY, f64::min)
    }
}

fn nearest_of(candidates: impl Iterator<Item = Point>, point: &Point) -> Option<Point> {
    let square = |candidate: &Point| (candidate - point).norm_squared();
    candidates.min_by(|a, b| square(a).total_cmp(&square(b)))
}

/// The point of the segment from `a` to `b` nearest to `point`.
pub(crate) fn nearest_on_segment(a: &Point, b: &Point, point: &Point) -> Point {
    let ab = b - a;
    let t = (ab.dot(&(point - a)) / ab.norm_squared()).clamp(0.0, 1.0);
    a + ab * t
}

/// Where a ray along the unit vector `direction` meets a disc whose centre lies at `to_center` from
/// the ray's origin: the distance, 0 from inside, `None` where it misses.
///
/// Written as `c / (b + sqrt(b^2 - c))` with `c = |to_center|^2 - r^2`, which does not cancel for
/// distant or grazed discs.
pub(crate) fn ray_disc(to_center: &Vector2<f64>, radius: f64, direction: &Vector2<f64>) -> Option<f64> {
    let along = to_center.dot(direction);
    let c = to_center.norm_squared() - radius * radius;
    if c <= 0.0 {
        return Some(0.0);
    }
    let aside = to_center.perp(direction);
    let half_chord_squared = radius * radius - aside * aside;
    (along > 0.0 && half_chord_squared >= 0.0).then(|| c / (along + half_chord_squared.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn square() -> Polygon {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        Polygon::new(corners.map(Point::from).into())
    }

    #[test]
    fn distances_to_a_square_by_hand() {
        let distance = |x, y| square().signed_distance(&Point::new(x, y));
        assert!((distance(3.0, 0.0) - 2.0).abs() < 1e-12);
        assert!((distance(4.0, 5.0) - 5.0).abs() < 1e-12); // corner (1, 1)
        assert!((distance(0.0, 0.4) + 0.6).abs() < 1e-12);
    }

    #[test]
    fn rays_at_a_square_by_hand() {
        let cast = |x, y, dx, dy| square().cast(&Point::new(x, y), &Vector2::new(dx, dy));
        assert_eq!(cast(-3.0, 0.5, 1.0, 0.0), Some(2.0));
        assert_eq!(cast(-3.0, 1.5, 1.0, 0.0), None);
        assert_eq!(cast(-3.0, 0.5, -1.0, 0.0), None);
        assert_eq!(cast(0.0, 0.0, 1.0, 0.0), Some(0.0));
    }

    proptest! {
        #[test]
        fn a_cast_ends_on_the_outline(x in -5.0..5.0, y in -5.0..5.0, angle in -3.2..3.2_f64) {
            let (origin, direction) = (Point::new(x, y), Vector2::new(angle.cos(), angle.sin()));
            let disc = Vector2::new(0.3, -0.2);
            if let Some(range) = square().cast(&origin, &direction).filter(|r| *r > 0.0) {
                prop_assert!(square().signed_distance(&(origin + direction * range)).abs() < 1e-9);
            }
            if let Some(range) = ray_disc(&(disc - origin.coords), 0.7, &direction).filter(|r| *r > 0.0) {
                let end = origin + direction * range;
                prop_assert!(((end.coords - disc).norm() - 0.7).abs() < 1e-9);
            }
        }
    }
}
