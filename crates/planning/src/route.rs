//! Routes: polylines with arc length.

use headway_sim::Point;
use serde::{Deserialize, Serialize};

/// A way through the plane: straight stretches from point to point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Route {
    points: Vec<Point>,
    /// Length of the way to each point, metres.
    lengths: Vec<f64>,
}

impl Route {
    /// A route through these points.
    ///
    /// # Panics
    /// If there are none.
    #[must_use]
    pub fn new(points: Vec<Point>) -> Self {
        assert!(!points.is_empty(), "a route has a point or more");
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
        }
        Self { points, lengths }
    }

    /// Its points.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Its length, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// The arc length at which the route comes nearest to `point`, metres.
    #[must_use]
    pub fn project(&self, point: &Point) -> f64 {
        let mut best = (f64::INFINITY, 0.0);
        for (pair, length) in self.points.windows(2).zip(&self.lengths) {
            let along = pair[1] - pair[0];
            let share = (along.dot(&(point - pair[0])) / along.norm_squared()).clamp(0.0, 1.0);
            let share = if share.is_nan() { 0.0 } else { share };
            let distance = (pair[0] + along * share - point).norm();
            if distance < best.0 {
                best = (distance, length + share * along.norm());
            }
        }
        best.1
    }

    /// The point at an arc length, clamped to the route's ends.
    ///
    /// ```
    /// use headway_planning::Route;
    /// use headway_sim::Point;
    /// let route = Route::new(vec![Point::new(0.0, 0.0), Point::new(4.0, 0.0), Point::new(4.0, 3.0)]);
    /// assert_eq!(route.length(), 7.0);
    /// assert_eq!(route.at(5.0), Point::new(4.0, 1.0));
    /// assert_eq!(route.project(&Point::new(3.0, -1.0)), 3.0);
    /// ```
    #[must_use]
    pub fn at(&self, length: f64) -> Point {
        let next = self.lengths.partition_point(|l| *l < length).clamp(1, self.points.len().max(2) - 1);
        let [Some(a), Some(b)] = [self.points.get(next - 1), self.points.get(next)] else {
            return self.points[0];
        };
        let (from, to) = (self.lengths[next - 1], self.lengths[next]);
        let share = if to > from { ((length - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        a + (b - a) * share
    }
}
