//! A world whose movers were moved against one built anew with the movers there.

use headway_sim::{Footprint, Obstacle, Point, Pose, Room, Shape, SimError, Surface, World};
use proptest::prelude::*;

const ROOM: Room = Room::new(12.0, 9.0);

fn obstacle() -> impl Strategy<Value = Obstacle> {
    let triangle = vec![[0.3, -0.1], [0.1, 0.4], [-0.3, 0.0]];
    let shape = prop_oneof![
        (0.05..0.5).prop_map(|radius| Shape::Disc { radius }),
        (0.1..0.7, 0.1..0.7).prop_map(|(length, width)| Shape::Box { length, width }),
        Just(Shape::Polygon { vertices: triangle }),
    ];
    (shape, place()).prop_map(|(shape, [x, y, yaw])| Obstacle { shape, x, y, yaw })
}

fn place() -> impl Strategy<Value = [f64; 3]> {
    (0.6..11.4, 0.6..8.4, -3.1..3.1).prop_map(|(x, y, yaw)| [x, y, yaw])
}

/// Without and with buckets, and with those that only movers make necessary.
fn obstacles() -> impl Strategy<Value = Vec<Obstacle>> {
    prop_oneof![prop::collection::vec(obstacle(), 0..34), prop::collection::vec(obstacle(), 34..80)]
}

fn pose() -> impl Strategy<Value = Pose> {
    (-1.0..13.0, -1.0..10.0, -3.1..3.1).prop_map(|(x, y, yaw)| Pose::new([x, y].into(), yaw))
}

fn sorted(indices: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut indices: Vec<_> = indices.collect();
    indices.sort_unstable();
    indices
}

/// Asks two worlds everything at a pose.
fn compare(a: &World, b: &World, pose: &Pose) {
    let point = Point::from(pose.translation.vector);
    for shape in [Shape::Disc { radius: 0.25 }, Shape::Box { length: 0.5, width: 0.3 }] {
        let footprint = Footprint::new(&shape).unwrap();
        assert_eq!(a.proximity(&footprint, pose), b.proximity(&footprint, pose));
        assert_eq!(a.collides(&footprint, pose), b.collides(&footprint, pose));
    }
    for reach in [0.1, 1.0, 5.0] {
        assert_eq!(sorted(a.obstacles_near(&point, reach)), sorted(b.obstacles_near(&point, reach)));
    }
    let direction = pose.rotation * nalgebra::Vector2::x();
    assert_eq!(a.cast_ray(&point, &direction, 30.0), b.cast_ray(&point, &direction, 30.0));
    assert_eq!(a.sector_range(pose, 0.4), b.sector_range(pose, 0.4));
    assert_eq!(a.is_free(&point, &Point::new(6.0, 4.5), 0.1), b.is_free(&point, &Point::new(6.0, 4.5), 0.1));
    for index in 0..a.obstacles().len() {
        let surface = Surface::Obstacle(index);
        assert_eq!(a.outline(surface), b.outline(surface));
        assert_eq!(a.distance_to(surface, &point), b.distance_to(surface, &point));
    }
}

proptest! {
    #[test]
    fn moved_worlds_are_as_those_built_anew(
        obstacles in obstacles(),
        movers in prop::collection::vec((obstacle(), prop::collection::vec(place(), 1..4)), 1..12),
        poses in prop::collection::vec(pose(), 8),
    ) {
        let mut world = World::new(ROOM, obstacles.clone()).unwrap();
        world.add_movers(movers.iter().map(|(mover, _)| mover.clone()).collect()).unwrap();
        for round in 0..3 {
            for (i, (_, places)) in movers.iter().enumerate() {
                if let Some([x, y, yaw]) = places.get(round) {
                    world.set_pose(obstacles.len() + i, &Pose::new([*x, *y].into(), *yaw)).unwrap();
                }
            }
            let anew = World::new(ROOM, world.obstacles().to_vec()).unwrap();
            prop_assert_eq!(world.static_obstacles(), &obstacles);
            poses.iter().for_each(|pose| compare(&world, &anew, pose));
        }
        let back: World = toml::from_str(&toml::to_string(&world).unwrap()).unwrap();
        prop_assert_eq!(back.movers(), world.movers());
        prop_assert_eq!(back.static_obstacles(), &obstacles);
        poses.iter().for_each(|pose| compare(&world, &back, pose));
    }
}

#[test]
fn movers_stay_in_the_room_and_as_they_are_where_they_would_not() {
    let post = Obstacle { shape: Shape::Disc { radius: 0.5 }, x: 6.0, y: 5.0, yaw: 0.0 };
    let cart = Obstacle { shape: Shape::Box { length: 1.0, width: 0.2 }, x: 2.0, y: 2.0, yaw: 0.0 };
    let mut world = World::new(ROOM, vec![post]).unwrap();
    world.add_movers(vec![cart.clone()]).unwrap();
    world.set_pose(1, &Pose::new([0.2, 2.0].into(), std::f64::consts::FRAC_PI_2)).unwrap();
    let before = world.clone();
    for place in [[0.2, 2.0, 0.0], [f64::NAN, 2.0, 0.0], [2.0, 2.0, f64::NAN], [11.9, f64::INFINITY, 0.0]] {
        let pose = Pose::new([place[0], place[1]].into(), place[2]);
        assert!(matches!(world.set_pose(1, &pose), Err(SimError::OutsideRoom { index: 1, .. })));
        compare(&world, &before, &Pose::translation(0.5, 2.6));
        assert_eq!(world.movers(), before.movers());
    }
    let flat = Obstacle { shape: Shape::Box { length: 1.0, width: 0.0 }, ..cart.clone() };
    let error = world.add_movers(vec![cart.clone(), flat]).unwrap_err();
    assert!(error.to_string().starts_with("movers.1.shape.width = 0"), "{error}");
    assert!(world.add_movers(vec![Obstacle { x: 11.9, ..cart }]).is_err());
    assert_eq!(world.movers().len(), 1);
}

#[test]
fn worlds_without_movers_are_written_as_ever() {
    let world = World::new(ROOM, vec![]).unwrap();
    assert!(!toml::to_string(&world).unwrap().contains("movers"));
}
