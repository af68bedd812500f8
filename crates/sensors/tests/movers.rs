//! Sensors see movers where they are.

use std::f64::consts::TAU;

use headway_sensors::{LidarSpec, ObstacleAngleSpec};
use headway_sim::{
    CrowdMotion, CrowdSpec, Footprint, Interval, Kinds, Mover, Obstacle, Pose, Room, Shape, Twist, World, stream,
};

#[test]
fn a_beam_ends_at_a_mover_where_it_went() {
    let lidar = LidarSpec { n_beams: 1, max_range: 10.0, ..LidarSpec::default() }.build().unwrap();
    let mut world = World::new(Room::new(10.0, 10.0), vec![]).unwrap();
    world.add_movers(vec![Obstacle { shape: Shape::Disc { radius: 0.5 }, x: 2.0, y: 8.0, yaw: 0.0 }]).unwrap();
    let range = |world: &World| {
        let mut ranges = [0.0];
        lidar.scan(world, &Pose::translation(1.0, 5.0), &mut stream(0, "noise", 0), &mut ranges);
        ranges[0]
    };
    assert!((range(&world) - 9.0).abs() < 1e-3); // the wall
    world.set_pose(0, &Pose::translation(6.0, 5.0)).unwrap();
    assert!((range(&world) - 4.5).abs() < 1e-3);
}

/// With few obstacles and with many, of which a grid of buckets tells the near ones.
#[test]
fn scans_and_angles_are_those_of_a_world_built_anew() {
    let lidar = LidarSpec { n_beams: 360, field_of_view: TAU, max_range: 8.0, ..LidarSpec::default() }.build().unwrap();
    let angle = ObstacleAngleSpec::default().build().unwrap();
    let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
    let scan = |world: &World, pose: &Pose| {
        let mut ranges = [0.0; 360];
        lidar.scan(world, pose, &mut stream(0, "noise", 0), &mut ranges);
        ranges
    };
    for n_movers in [10.0, 60.0] {
        let spec = CrowdSpec {
            n_movers: Interval::Fixed(n_movers),
            kinds: Kinds { disc: 1.0, r#box: 1.0, polygon: 1.0 },
            motion: CrowdMotion::RandomWalk { turning: 0.5 },
            avoids_vehicle: Some(true),
            ..CrowdSpec::default()
        };
        let post = |k: u32| {
            let (x, y) = (f64::from(3 * (k % 4) + 3), f64::from(4 * (k / 4) + 4));
            Obstacle { shape: Shape::Disc { radius: 0.3 }, x, y, yaw: 0.0 }
        };
        let mut world = World::new(Room::new(15.0, 15.0), (0..8).map(post).collect()).unwrap();
        let pose = Pose::new([7.5, 6.0].into(), 0.4);
        let seer = Mover { position: pose.translation.vector.into(), velocity: [0.0, 0.0].into(), radius: 0.25 };
        let mut crowd = spec.build(&mut world, &[(seer.position, 0.25)], &mut stream(4, "crowd", 0)).unwrap();
        let first = scan(&world, &pose);
        for _ in 0..40 {
            crowd.step(&mut world, 0.2, Some(&seer));
            let anew = World::new(world.room(), world.obstacles().to_vec()).unwrap();
            assert_eq!(scan(&world, &pose), scan(&anew, &pose));
            let twist = Twist::new(1.0, 0.0, 0.2);
            let angle = |world: &World| angle.measure(world, &pose, &twist, &world.proximity(&vehicle, &pose));
            assert_eq!(angle(&world), angle(&anew));
        }
        assert_ne!(scan(&world, &pose), first);
    }
}
