//! Obstacles around points.

use nalgebra::Vector2;

use crate::{Obstacle, Point, Shape};

/// The least sine of the turn at a corner: ten times what a shape must have, so that rounding does not matter.
const LEAST_SINE: f64 = 1e-2;

/// The shortest edge, likewise, metres.
const SHORTEST: f64 = 1e-5;

/// The thinnest obstacle, metres.
const THINNEST: f64 = 1e-6;

/// By how much smoothing may let a polygon reach beyond the rectangle around it.
const REACH: f64 = 1.1;

/// The convex obstacle around points: their hull, but for corners that hardly turn, which are smoothed outwards, or the
/// rectangle around it where that would draw a sliver out; none around what is thinner than a micrometre.
pub(super) fn around(points: Vec<Point>) -> Option<Obstacle> {
    let hull = hull(points);
    if hull.len() < 3 {
        return None;
    }
    let bounds = rectangle(&hull)?;
    let center = Point::new(bounds.x, bounds.y);
    let corners = smoothed(hull.iter().map(|p| p - center).collect());
    let shape = Shape::Polygon { vertices: corners.iter().map(|p| [p.x, p.y]).collect() };
    let polygon = Obstacle { shape, x: center.x, y: center.y, yaw: 0.0 };
    let is_compact = polygon.shape.circumradius() <= REACH * bounds.shape.circumradius();
    Some(if is_compact && polygon.shape.check().is_ok() { polygon } else { bounds })
}

/// The convex hull, counter-clockwise, without corners that do not turn (Andrew 1979).
fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut chain: Vec<Point> = Vec::new();
    let turns_left = |a: &Point, b: &Point, c: &Point| (b - a).perp(&(c - b)) > 0.0;
    for pass in 0..2 {
        let start = chain.len();
        for point in &points {
            while chain.len() >= start + 2 && !turns_left(&chain[chain.len() - 2], &chain[chain.len() - 1], point) {
                chain.pop();
            }
            chain.push(*point);
        }
        chain.pop();
        if pass == 0 {
            points.reverse();
        }
    }
    chain
}

/// The rectangle around a hull along its longest edge; none if it is too thin.
fn rectangle(hull: &[Point]) -> Option<Obstacle> {
    let edges = hull.iter().zip(hull.iter().cycle().skip(1)).map(|(a, b)| b - a);
    let along = edges.max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))?.try_normalize(0.0)?;
    let aside = Vector2::new(-along.y, along.x);
    let extent = |axis: &Vector2<f64>| {
        let heights = || hull.iter().map(|p| axis.dot(&(p - hull[0])));
        (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max))
    };
    let ((back, front), (right, left)) = (extent(&along), extent(&aside));
    let (length, width) = (front - back, left - right);
    let center = hull[0] + along * ((front + back) / 2.0) + aside * ((left + right) / 2.0);
    let shape = Shape::Box { length, width };
    (length.min(width) >= THINNEST).then(|| Obstacle { shape, x: center.x, y: center.y, yaw: along.y.atan2(along.x) })
}

/// The outline with its flattest corners and shortest edges smoothed outwards: such an edge goes, and its neighbours
/// are drawn out until they meet. Gives up where they do not.
fn smoothed(mut corners: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    let mut i = 0;
    let mut n_kept = 0;
    while corners.len() > 3 && n_kept < corners.len() {
        let n = corners.len();
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| corners[(i + k) % n]);
        let (before, edge, after) = (b - a, c - b, d - c);
        let is_flat = |e: &Vector2<f64>, f: &Vector2<f64>| e.perp(f) < LEAST_SINE * e.norm() * f.norm();
        let goes = edge.norm() < SHORTEST
            || (is_flat(&before, &edge) && edge.norm() <= before.norm())
            || (is_flat(&edge, &after) && edge.norm() <= after.norm());
        let turn = before.perp(&after);
        if goes && turn > 1e-6 * before.norm() * after.norm() {
            corners[(i + 1) % n] = b + before * (edge.perp(&after) / turn);
            corners.remove((i + 2) % n);
            n_kept = 0;
            i = (i + n - 3) % (n - 1);
        } else {
            n_kept += 1;
            i = (i + 1) % n;
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Footprint, Room, World};
    use proptest::prelude::*;

    #[test]
    fn a_square_with_points_within_and_on_its_edges() {
        let points = [[0.0, 0.0], [1.0, 0.5], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0], [0.0, 1.0]];
        let square = around(points.map(Point::from).to_vec()).unwrap();
        assert_eq!((square.x, square.y, square.shape.vertices().len()), (1.0, 1.0, 4));
    }

    #[test]
    fn lines_and_points_are_nothing() {
        assert!(around(vec![]).is_none());
        assert!(around(vec![Point::new(1.0, 2.0); 5]).is_none());
        assert!(around((0..9).map(|k| Point::new(f64::from(k), f64::from(k))).collect()).is_none());
    }

    /// Its smoothed corners lay metres beyond the hull.
    #[test]
    fn a_sliver_is_not_drawn_out() {
        let sliver = [(0.0, -0.01205), (0.0, 0.0064), (4.625, 0.00172), (-4.428, -0.01278)];
        let obstacle = around(sliver.map(|(x, y)| Point::new(x, y)).to_vec()).unwrap();
        assert!(obstacle.shape.circumradius() < 4.6, "{obstacle:?}");
    }

    proptest! {
        #[test]
        fn the_obstacle_holds_all_points_and_little_else(
            points in prop::collection::vec((-5.0..5.0, -5.0..5.0_f64), 3..80),
            flatness in prop_oneof![Just(1.0), 1e-7..1e-1_f64],
        ) {
            let points: Vec<_> = points.iter().map(|(x, y)| Point::new(*x, y * flatness)).collect();
            if let Some(obstacle) = around(points.clone()) {
                prop_assert!(obstacle.shape.check().is_ok());
                let room = Room { x: -50.0, y: -50.0, width: 100.0, height: 100.0 };
                let world = World::new(room, vec![obstacle.clone()]).unwrap();
                for point in &points {
                    prop_assert!(world.distance(point) <= 1e-9);
                }
                let hull = hull(points);
                let reach = hull.iter().map(|p| (p - hull[0]).norm()).fold(0.0, f64::max);
                for corner in obstacle.shape.vertices() {
                    let corner = obstacle.pose() * corner;
                    let near = hull.iter().map(|p| (p - corner).norm()).fold(f64::INFINITY, f64::min);
                    prop_assert!(near <= reach);
                }
                prop_assert!(Footprint::of_obstacle(&obstacle.shape).circumradius() <= 2.0 * reach);
            }
        }
    }
}
