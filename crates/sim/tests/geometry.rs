//! Clearances and rays against parry2d, sectors against many rays.

use headway_sim::{Footprint, Obstacle, Point, Pose, Room, Shape, World};
use nalgebra::Vector2;
use parry2d::query;
use parry2d::shape::{Ball, ConvexPolygon, Shape as ParryShape};
use proptest::prelude::*;

/// A room whose walls are too far off to matter.
const HALL: Room = Room::new(200.0, 200.0);

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![1 => (0.1..1.0).prop_map(|radius| Shape::Disc { radius }), 2 => polygon()]
}

fn polygon() -> impl Strategy<Value = Shape> {
    prop_oneof![
        (0.2..2.0, 0.2..2.0).prop_map(|(length, width)| Shape::Box { length, width }),
        (0.3..1.0, 3..8_u32).prop_map(|(radius, n)| {
            let corner = |k| (f64::from(k) / f64::from(n) * std::f64::consts::TAU).sin_cos();
            Shape::Polygon { vertices: (0..n).map(corner).map(|(y, x)| [radius * x, radius * y]).collect() }
        }),
    ]
}

fn pose() -> impl Strategy<Value = Pose> {
    (98.0..102.0, 98.0..102.0, -3.1..3.1).prop_map(|(x, y, yaw)| Pose::new([x, y].into(), yaw))
}

fn world_with(shape: &Shape, pose: &Pose) -> World {
    let (x, y) = (pose.translation.x, pose.translation.y);
    let obstacle = Obstacle { shape: shape.clone(), x, y, yaw: pose.rotation.angle() };
    World::new(HALL, vec![obstacle]).expect("the hall is large")
}

/// The signed distance between two convex polygons, corners counter-clockwise. Overlapping, it is the least
/// overlap over the directions across all edges (separating axes); apart, the least distance of a corner of
/// one to an edge of the other.
fn polygons_apart(a: &[Point], b: &[Point]) -> f64 {
    let edges = |p: &[Point]| (0..p.len()).map(|i| (p[i], p[(i + 1) % p.len()])).collect::<Vec<_>>();
    let widest_gap = |p: &[Point], q: &[Point]| {
        let gap = |(from, to): (Point, Point)| {
            let outward = Vector2::new(to.y - from.y, from.x - to.x).normalize();
            q.iter().map(|corner| outward.dot(&(corner - from))).fold(f64::INFINITY, f64::min)
        };
        edges(p).into_iter().map(gap).fold(f64::NEG_INFINITY, f64::max)
    };
    let overlap = widest_gap(a, b).max(widest_gap(b, a));
    if overlap <= 0.0 {
        return overlap;
    }
    let from_corners = |p: &[Point], q: &[Point]| {
        let to_edge = |corner: &Point, (from, to): (Point, Point)| {
            let along = ((corner - from).dot(&(to - from)) / (to - from).norm_squared()).clamp(0.0, 1.0);
            (corner - (from + (to - from) * along)).norm()
        };
        let all = p.iter().flat_map(|corner| edges(q).into_iter().map(move |edge| to_edge(corner, edge)));
        all.fold(f64::INFINITY, f64::min)
    };
    from_corners(a, b).min(from_corners(b, a))
}

/// The shape in parry's terms, moved to `pose`.
fn parry(shape: &Shape, pose: &Pose) -> (Box<dyn ParryShape>, parry2d::math::Pose) {
    let to_vector = |p: Point| parry2d::math::Vector::new(p.x, p.y);
    match shape {
        Shape::Disc { radius } => {
            let center = to_vector(pose.translation.vector.into());
            (Box::new(Ball::new(*radius)), parry2d::math::Pose::from_translation(center))
        }
        _ => {
            let corners = shape.vertices().iter().map(|v| to_vector(pose * v)).collect();
            let polygon = ConvexPolygon::from_convex_polyline(corners).expect("strictly convex");
            (Box::new(polygon), parry2d::math::Pose::identity())
        }
    }
}

proptest! {
    #[test]
    fn clearance_agrees_with_parry(own in shape(), at in pose(), other in shape(), there in pose()) {
        let footprint = Footprint::new(&own).unwrap();
        let clearance = world_with(&other, &there).clearance(&footprint, &at);
        let ((a, pose_a), (b, pose_b)) = (parry(&own, &at), parry(&other, &there));
        let contact = query::contact(&pose_a, a.as_ref(), &pose_b, b.as_ref(), 100.0).unwrap();
        let expected = contact.expect("nearer than 100 m").dist;
        prop_assert!((clearance - expected).abs() < 1e-6, "{clearance} but parry {expected}");
    }

    #[test]
    fn clearance_of_polygons_agrees_with_separating_axes(
        own in polygon(), at in pose(), other in polygon(), there in pose(),
    ) {
        let clearance = world_with(&other, &there).clearance(&Footprint::new(&own).unwrap(), &at);
        let corners = |shape: &Shape, pose: &Pose| shape.vertices().iter().map(|v| pose * v).collect::<Vec<_>>();
        let expected = polygons_apart(&corners(&own, &at), &corners(&other, &there));
        prop_assert!((clearance - expected).abs() < 1e-6, "{clearance} but by separating axes {expected}");
    }

    #[test]
    fn clearance_changes_by_at_most_a_metre_a_metre(
        own in shape(), at in pose(), other in shape(), there in pose(), dx in -0.5..0.5, dy in -0.5..0.5,
    ) {
        let footprint = Footprint::new(&own).unwrap();
        let world = world_with(&other, &there);
        let moved = Pose::translation(dx, dy) * at;
        let change = world.clearance(&footprint, &moved) - world.clearance(&footprint, &at);
        prop_assert!(change.abs() <= f64::hypot(dx, dy) + 1e-6);
    }

    #[test]
    fn rays_agree_with_parry(other in shape(), there in pose(), from in pose(), angle in -3.1..3.1_f64) {
        let origin = Point::from(from.translation.vector);
        let direction = Vector2::new(angle.cos(), angle.sin());
        let range = world_with(&other, &there).cast_ray(&origin, &direction, 50.0);
        let (shape, pose) = parry(&other, &there);
        let ray = query::Ray::new(
            parry2d::math::Vector::new(origin.x, origin.y),
            parry2d::math::Vector::new(direction.x, direction.y),
        );
        // Parry's polygons are cast at with GJK, up to 2 mm off, and differ at grazes: compare where it hits.
        if let Some(expected) = shape.cast_ray(&pose, &ray, 50.0, true) {
            let grazes = shape.cast_ray_and_get_normal(&pose, &ray, 50.0, true)
                .is_some_and(|hit| hit.normal.dot(ray.dir).abs() < 0.05);
            prop_assert!(grazes || (range - expected).abs() < 5e-3, "{range} but parry {expected}");
        }
    }

    #[test]
    fn a_sector_sees_what_many_rays_see(other in shape(), there in pose(), from in pose(), half in 0.1..1.5_f64) {
        let world = world_with(&other, &there);
        prop_assume!(world.distance(&from.translation.vector.into()) > 0.05);
        let origin = Point::from(from.translation.vector);
        let cast = |k: i32| {
            let angle = from.rotation.angle() + half * f64::from(k) / 2000.0;
            world.cast_ray(&origin, &Vector2::new(angle.cos(), angle.sin()), f64::INFINITY)
        };
        let rays = (-2000..=2000).map(cast).fold(f64::INFINITY, f64::min);
        let sector = world.sector_range(&from, half);
        prop_assert!(sector <= rays + 1e-9);
        // Between two neighbouring rays the range of a thing at distance d changes little, unless the thing
        // is only just touched: then the sector may see an edge that every ray passes.
        prop_assert!(rays - sector < 0.2 || rays > 50.0, "sector {sector}, rays {rays}");
    }
}

#[test]
fn ranges_to_walls_by_hand() {
    let world = World::new(Room::new(10.0, 15.0), vec![]).unwrap();
    let origin = Point::new(4.0, 5.0);
    let cast = |x: f64, y: f64| world.cast_ray(&origin, &Vector2::new(x, y).normalize(), 100.0);
    assert_eq!(cast(1.0, 0.0), 6.0);
    assert_eq!(cast(-1.0, 0.0), 4.0);
    assert_eq!(cast(0.0, 1.0), 10.0);
    assert_eq!(cast(0.0, -1.0), 5.0);
    assert!((cast(-4.0, -5.0) - 41.0_f64.sqrt()).abs() < 1e-12);
    let facing_left = Pose::new(origin.coords, std::f64::consts::PI);
    assert!((world.sector_range(&facing_left, 0.5) - 4.0).abs() < 1e-12);
    // Facing 240 degrees, the sector spans 210 to 270. The foot of the wall 4 m to the left (180 degrees) lies
    // outside of it, so that wall is nearest at 210, 30 degrees aside; the foot of the wall 5 m below (270) is
    // on its edge. The nearer of the two is 4 / cos(30 degrees).
    let slanted = Pose::new(origin.coords, 60_f64.to_radians() - std::f64::consts::PI);
    let range = world.sector_range(&slanted, 30_f64.to_radians());
    assert!((range - 4.0 / 30_f64.to_radians().cos()).abs() < 1e-12);
}

#[test]
fn nothing_is_seen_from_outside_or_without_range() {
    let world = World::new(Room::new(10.0, 15.0), vec![]).unwrap();
    // From outside, what faces the room saw its far wall.
    for (x, y) in [(-1.0, 5.0), (11.0, 5.0), (5.0, -1.0), (5.0, 16.0), (f64::NAN, 5.0)] {
        for direction in [Vector2::x(), Vector2::y(), -Vector2::x(), -Vector2::y()] {
            assert_eq!(world.cast_ray(&Point::new(x, y), &direction, 30.0), 0.0);
        }
    }
    let cast = |max_range| world.cast_ray(&Point::new(4.0, 5.0), &Vector2::x(), max_range);
    assert_eq!(cast(f64::INFINITY), 6.0);
    assert_eq!(cast(2.0), 2.0);
    // These panicked.
    assert_eq!(cast(-1.0), 0.0);
    assert_eq!(cast(f64::NAN), 0.0);
}

#[test]
fn no_way_leads_to_what_is_not_a_number() {
    let world = World::new(Room::new(10.0, 15.0), vec![]).unwrap();
    let is_free = |x, y, radius| world.is_free(&Point::new(4.0, 5.0), &Point::new(x, y), radius);
    assert!(is_free(5.0, 5.0, 0.25));
    for (x, y, radius) in [(f64::NAN, 5.0, 0.25), (5.0, f64::INFINITY, 0.25), (5.0, 5.0, f64::NAN)] {
        assert!(!is_free(x, y, radius));
        assert!(!world.is_free(&Point::new(x, y), &Point::new(4.0, 5.0), radius));
    }
}

#[test]
fn a_pose_that_is_not_finite_collides() {
    let world = World::new(Room::new(10.0, 15.0), vec![]).unwrap();
    for shape in [Shape::Disc { radius: 0.25 }, Shape::Box { length: 0.5, width: 0.4 }] {
        let footprint = Footprint::new(&shape).unwrap();
        for (x, y, yaw) in [(f64::NAN, 5.0, 0.0), (5.0, f64::NAN, 0.0), (5.0, 5.0, f64::NAN), (5.0, f64::INFINITY, 0.0)]
        {
            let pose = Pose::new([x, y].into(), yaw);
            assert!(world.collides(&footprint, &pose));
            assert!(world.clearance(&footprint, &pose).is_nan());
        }
    }
}

#[test]
fn a_thin_polygon_is_no_disc() {
    // Where parry made no polygon of the corners, their bounding circles were taken: a collision from afar.
    let sliver = |y| Shape::Polygon { vertices: vec![[0.0, 0.0], [10.0, 0.0], [5.0, y]] };
    assert!(sliver(1e-8).check().is_err());
    let world = world_with(&sliver(0.02), &Pose::translation(95.0, 100.0));
    let vehicle = Footprint::new(&Shape::Box { length: 0.5, width: 0.4 }).unwrap();
    let clearance = world.clearance(&vehicle, &Pose::translation(100.0, 98.0));
    assert!((clearance - 1.8).abs() < 1e-6, "{clearance}");
}

#[test]
fn obstacles_outside_the_room_are_refused() {
    let obstacle = Obstacle { shape: Shape::Disc { radius: 1.0 }, x: 0.5, y: 5.0, yaw: 0.0 };
    let error = World::new(Room::new(10.0, 15.0), vec![obstacle]).unwrap_err();
    assert_eq!(error.to_string(), "obstacle 0 at (0.5, 5) reaches out of the 10 x 15 m room");
    // One coordinate that was not a number went unnoticed.
    for (x, y, yaw) in [(f64::NAN, 5.0, 0.0), (5.0, f64::NAN, 0.0), (5.0, 5.0, f64::NAN)] {
        let obstacle = Obstacle { shape: Shape::Disc { radius: 1.0 }, x, y, yaw };
        assert!(World::new(Room::new(10.0, 15.0), vec![obstacle]).is_err());
    }
    let flat = Obstacle { shape: Shape::Disc { radius: -1.0 }, x: 5.0, y: 5.0, yaw: 0.0 };
    let error = World::new(Room::new(10.0, 15.0), vec![flat]).unwrap_err();
    assert_eq!(error.to_string(), "obstacles.0.shape.radius = -1: must be a finite number above 0");
}

#[test]
fn a_world_survives_serialisation() {
    let world = world_with(&Shape::Box { length: 1.0, width: 0.5 }, &Pose::new([100.0, 90.0].into(), 0.3));
    let text = toml::to_string(&world).unwrap();
    let back: World = toml::from_str(&text).unwrap();
    assert_eq!(back.obstacles(), world.obstacles());
    let from = Point::new(95.0, 90.0);
    let cast = |w: &World| w.cast_ray(&from, &Vector2::x(), 50.0);
    assert_eq!(cast(&back), cast(&world));
}
