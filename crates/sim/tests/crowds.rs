//! Questions about many obstacles at once against the same question about each alone.

use headway_sim::{Footprint, Obstacle, Point, Pose, Room, Shape, World};
use proptest::prelude::*;

const ROOM: Room = Room { width: 12.0, height: 9.0 };

fn obstacle() -> impl Strategy<Value = Obstacle> {
    let shape = prop_oneof![
        (0.05..0.5).prop_map(|radius| Shape::Disc { radius }),
        (0.1..0.7, 0.1..0.7).prop_map(|(length, width)| Shape::Box { length, width }),
    ];
    (shape, 0.6..11.4, 0.6..8.4, -3.1..3.1).prop_map(|(shape, x, y, yaw)| Obstacle { shape, x, y, yaw })
}

/// Few and many, discs alone and mixed: each is answered in another way.
fn crowd() -> impl Strategy<Value = Vec<Obstacle>> {
    let only_discs = |obstacles: Vec<Obstacle>| {
        let is_disc = |o: &Obstacle| matches!(o.shape, Shape::Disc { .. });
        obstacles.into_iter().filter(is_disc).collect::<Vec<_>>()
    };
    let any = || prop_oneof![prop::collection::vec(obstacle(), 0..34), prop::collection::vec(obstacle(), 34..120)];
    prop_oneof![any(), any().prop_map(only_discs)]
}

/// Within the room, among the obstacles, and outside.
fn pose() -> impl Strategy<Value = Pose> {
    (-3.0..15.0, -3.0..12.0, -3.1..3.1).prop_map(|(x, y, yaw)| Pose::new([x, y].into(), yaw))
}

fn footprint() -> impl Strategy<Value = Footprint> {
    let shapes = [Shape::Disc { radius: 0.25 }, Shape::Box { length: 0.5, width: 0.3 }, Shape::Disc { radius: 2.0 }];
    prop::sample::select(shapes.to_vec()).prop_map(|shape| Footprint::new(&shape).unwrap())
}

proptest! {
    #[test]
    fn the_nearest_is_the_nearest_of_each_alone(obstacles in crowd(), pose in pose(), footprint in footprint()) {
        let world = World::new(ROOM, obstacles.clone()).unwrap();
        let alone = |obstacle: Obstacle| {
            let world = World::new(ROOM, vec![obstacle]).unwrap();
            world.proximity(&footprint, &pose).obstacle.unwrap().1
        };
        let expected = obstacles.into_iter().map(alone).min_by(f64::total_cmp);
        prop_assert_eq!(world.proximity(&footprint, &pose).obstacle.map(|(_, clearance)| clearance), expected);
    }

    #[test]
    fn a_collision_is_a_clearance_below_zero(obstacles in crowd(), pose in pose(), footprint in footprint()) {
        let world = World::new(ROOM, obstacles).unwrap();
        let clearance = world.clearance(&footprint, &pose);
        // Parry's test and its distance of two polygons may differ by rounding where these just touch.
        prop_assume!(clearance.abs() > 1e-9);
        prop_assert_eq!(world.collides(&footprint, &pose), clearance < 0.0);
    }

    #[test]
    fn what_comes_near_is_found(obstacles in crowd(), pose in pose(), reach in 0.0..6.0) {
        let world = World::new(ROOM, obstacles).unwrap();
        let point = Point::from(pose.translation.vector);
        let mut found: Vec<usize> = world.obstacles_near(&point, reach).collect();
        found.sort_unstable();
        let circle = |o: &Obstacle| (nalgebra::distance(&Point::new(o.x, o.y), &point) - o.shape.circumradius()) < reach;
        let expected: Vec<usize> =
            world.obstacles().iter().enumerate().filter(|(_, o)| circle(o)).map(|(index, _)| index).collect();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn rays_end_at_the_first_of_all(obstacles in crowd(), pose in pose(), angle in -3.1..3.1_f64) {
        let world = World::new(ROOM, obstacles.clone()).unwrap();
        let (origin, direction) = (Point::from(pose.translation.vector), [angle.cos(), angle.sin()].into());
        let alone = |obstacle| World::new(ROOM, vec![obstacle]).unwrap().cast_ray(&origin, &direction, 30.0);
        let walls = World::new(ROOM, vec![]).unwrap().cast_ray(&origin, &direction, 30.0);
        let expected = obstacles.into_iter().map(alone).fold(walls, f64::min);
        prop_assert_eq!(world.cast_ray(&origin, &direction, 30.0), expected);
    }
}
