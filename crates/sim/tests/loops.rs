//! Movers on given loops, and movers too fast to be seen at the ends of their steps only.

use headway_sim::{
    Command, CrowdMotion, CrowdSpec, Interval, Obstacle, Point, Pose, Room, Shape, VehicleSpec, VehicleState, World,
    stream,
};

fn spec(n_movers: f64, speed: f64, loops: &[&[[f64; 2]]]) -> CrowdSpec {
    let loops = loops.iter().map(|points| points.to_vec()).collect();
    CrowdSpec {
        n_movers: Interval::Fixed(n_movers),
        radius: Interval::Fixed(0.25),
        speed: Interval::Fixed(speed),
        motion: CrowdMotion::Waypoints { n_points: 4, loops },
        ..CrowdSpec::default()
    }
}

fn hall(obstacles: Vec<Obstacle>) -> World {
    World::new(Room::new(30.0, 10.0), obstacles).unwrap()
}

#[test]
fn a_square_is_walked_round() {
    let mut world = hall(vec![]);
    let spec = spec(1.0, 1.0, &[&[[2.0, 2.0], [4.0, 2.0], [4.0, 4.0], [2.0, 4.0]]]);
    let mut crowd = spec.build(&mut world, &[], &mut stream(0, "crowd", 0)).unwrap();
    let places = [[2.0, 2.0], [3.0, 2.0], [4.0, 2.0], [4.0, 3.0], [4.0, 4.0], [3.0, 4.0], [2.0, 4.0], [2.0, 3.0]];
    for k in 0..17 {
        assert!((crowd.movers()[0].position - Point::from(places[k % 8])).norm() < 1e-9);
        crowd.step(&mut world, 1.0, None);
    }
}

#[test]
fn loops_are_shared_in_turn_and_begun_where_there_is_place() {
    let mut world = hall(vec![]);
    let spec = spec(4.0, 1.0, &[&[[2.0, 2.0], [12.0, 2.0]], &[[2.0, 6.0], [12.0, 6.0], [12.0, 8.0]]]);
    let vehicle = [(Point::new(2.0, 6.0), 0.3)];
    let crowd = spec.build(&mut world, &vehicle, &mut stream(0, "crowd", 0)).unwrap();
    let at = |k: usize| crowd.movers()[k].position;
    assert_eq!(at(0), Point::new(2.0, 2.0));
    assert!((at(2).y - 2.0).abs() < 1e-12 && at(2).x > 2.8, "the first point is taken");
    assert!(at(1).y >= 6.0 && (at(1) - vehicle[0].0).norm() >= 0.85, "the vehicle is there");
    let same = spec.build(&mut hall(vec![]), &vehicle, &mut stream(0, "crowd", 0)).unwrap();
    assert_eq!(same, crowd);
}

#[test]
fn refusals_name_the_loop() {
    let post = Obstacle { shape: Shape::Disc { radius: 0.5 }, x: 6.0, y: 2.2, yaw: 0.0 };
    let cases: [(&[[f64; 2]], &str); 6] = [
        (&[[1.0, 2.0]], "motion.loops.0 = 1 points: must be from 2 to 1000"),
        (&[[1.0, 2.0], [f64::NAN, 2.0]], "motion.loops.0.1 = NaN: must be from -1000000 to 1000000"),
        (&[[1.0, 2.0], [3.0, 2.0], [1.0, 2.0]], "motion.loops.0.0 = [1.0, 2.0]: must be another place than"),
        (&[[1.0, 4.0], [2.0, 2.0], [8.0, 2.0]], "motion.loops.0.1 = [2.0, 2.0]: must be a place from which a way free"),
        (&[[1.0, 4.0], [31.0, 4.0]], "motion.loops.0.0 = [1.0, 4.0]: must be a place from which a way free"),
        (&[[0.1, 4.0], [8.0, 4.0]], "motion.loops.0.0 = [0.1, 4.0]: must be a place from which a way free"),
    ];
    for (points, expected) in cases {
        let mut world = hall(vec![post.clone()]);
        let error = spec(1.0, 1.0, &[points]).build(&mut world, &[], &mut stream(0, "crowd", 0)).unwrap_err();
        assert!(error.to_string().starts_with(expected), "{error}");
        assert!(world.movers().is_empty());
    }
    let text = "motion = { type = 'waypoints', loops = [[[1.0, 2.0], [4.0, 2.0]]] }";
    let read: CrowdSpec = toml::from_str(text).unwrap();
    assert_eq!(read.motion, CrowdMotion::Waypoints { n_points: 4, loops: vec![vec![[1.0, 2.0], [4.0, 2.0]]] });
    assert!(!toml::to_string(&CrowdSpec::default()).unwrap().contains("loops"));
}

/// Movers that get farther in a substep than they and the vehicle are long once jumped across it.
#[test]
fn nobody_jumps_across_a_vehicle() {
    let one_substep = VehicleSpec { n_substeps: 1, ..VehicleSpec::default() };
    let vehicle = one_substep.build().unwrap();
    for speed in [0.5, 3.0, 12.0, 47.0, 100.0] {
        for (aside, is_hit) in [(0.0, true), (0.3, true), (0.48, true), (0.51, false)] {
            let mut world = hall(vec![]);
            let way = [[1.0, 5.0 + aside], [29.0, 5.0 + aside]];
            let mut crowd = spec(1.0, speed, &[&way]).build(&mut world, &[], &mut stream(0, "crowd", 0)).unwrap();
            let mut state = VehicleState::at_rest(Pose::translation(15.0, 5.0));
            let n_periods = (28.0 / speed / 0.2).ceil() as usize;
            let hit = (0..n_periods).any(|_| {
                let motion = vehicle.step_among(&mut world, &mut state, Command::default(), &mut crowd);
                assert!(!motion.collided || world.collides(vehicle.footprint(), &state.pose));
                motion.collided
            });
            assert_eq!(hit, is_hit, "{speed} m/s, {aside} m aside");
            assert!(crowd.check(&world).is_ok());
        }
    }
}
