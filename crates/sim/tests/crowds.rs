//! Questions about many obstacles at once against the same question about each alone.

use headway_sim::{Command, Footprint, Obstacle, Point, Pose, Room, Shape, Surface, VehicleSpec, VehicleState, World};
use proptest::prelude::*;

const ROOM: Room = Room::new(12.0, 9.0);

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
        let alone = |(index, obstacle): (usize, Obstacle)| {
            let world = World::new(ROOM, vec![obstacle]).unwrap();
            (index, world.proximity(&footprint, &pose).obstacle.unwrap().1)
        };
        let expected = obstacles.into_iter().enumerate().map(alone).min_by(|a, b| a.1.total_cmp(&b.1));
        prop_assert_eq!(world.proximity(&footprint, &pose).obstacle, expected);
    }

    #[test]
    fn a_collision_is_a_clearance_below_zero(obstacles in crowd(), pose in pose(), footprint in footprint()) {
        let world = World::new(ROOM, obstacles).unwrap();
        let clearance = world.clearance(&footprint, &pose);
        // Parry's test and its distance of two polygons may differ by rounding where these just touch.
        prop_assume!(clearance.abs() > 1e-9);
        prop_assert_eq!(world.collides(&footprint, &pose), clearance < 0.0);
    }

    /// Whether a disc that just touches is found decided rounding.
    #[test]
    fn a_contact_is_a_collision(angle in -3.1..3.1_f64, radius in 0.2..0.5, n_more in 0..50_usize) {
        let post = Obstacle { shape: Shape::Disc { radius }, x: 6.0, y: 5.0, yaw: 0.0 };
        let far = Obstacle { shape: Shape::Disc { radius: 0.1 }, x: 1.0, y: 1.0, yaw: 0.0 };
        let world = World::new(ROOM, [vec![post], vec![far; n_more]].concat()).unwrap();
        let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
        let contact = Pose::translation(6.0 + (radius + 0.25) * angle.cos(), 5.0 + (radius + 0.25) * angle.sin());
        prop_assert_eq!(world.collides(&vehicle, &contact), world.clearance(&vehicle, &contact) <= 0.0);
        let mut state = VehicleState::at_rest(Pose::new([3.0, 5.0].into(), 0.0));
        let spec = VehicleSpec { max_acceleration: 3.0 + radius, ..VehicleSpec::default() };
        let ahead = Command::new(1.5, 0.0);
        let motions = (0..30).map(|_| spec.build().unwrap().step(&world, &mut state, ahead));
        prop_assert!(motions.take_while(|motion| !motion.collided).count() < 30, "it drives into the post");
        prop_assert!(world.collides(&vehicle, &state.pose));
    }

    #[test]
    fn the_first_of_equals_is_the_nearest(x in 2..10, y in 2..7, dx in 1..10, dy in 0..10, n_more in 0..50_usize) {
        let [x, y, dx, dy] = [x, y, dx, dy].map(f64::from);
        let disc = |sign: f64| {
            let shape = Shape::Disc { radius: 0.1 };
            Obstacle { shape, x: x + sign * dx / 10.0, y: y + sign * dy / 10.0, yaw: 0.0 }
        };
        let far = Obstacle { shape: Shape::Disc { radius: 0.01 }, x: 0.02, y: 0.02, yaw: 0.0 };
        let world = World::new(ROOM, [vec![disc(1.0), disc(-1.0)], vec![far; n_more]].concat()).unwrap();
        let [first, second] = [0, 1].map(|i| world.distance_to(Surface::Obstacle(i), &Point::new(x, y)));
        let point = Footprint::new(&Shape::Disc { radius: 1e-3 }).unwrap();
        let nearest = world.proximity(&point, &Pose::translation(x, y)).obstacle.unwrap();
        prop_assert_eq!(nearest.0, usize::from(second - 1e-3 < first - 1e-3));
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
