use super::*;
use crate::trial::{End, Lidar, Trial};
use crate::{GridMap, Route, ShieldSpec, plan};
use headway_sim::{Drive, Pose, Room, Shape, Vehicle, VehicleSpec, VehicleState, World, WorldSpec};

fn driver() -> RegulatedPursuit {
    RegulatedPursuitSpec::default().build().unwrap()
}

/// The command on a route from a pose at the origin, at a speed, with one beam.
fn command_on(route: &Route, speed: f64, (angle, range): (f64, f32)) -> Command {
    let vehicle = VehicleSpec::default().build().unwrap();
    let lidar = Lidar { angles: vec![angle], max_range: 10.0 };
    let state = VehicleState { twist: Twist::new(speed, 0.0, 0.0), ..VehicleState::at_rest(Pose::identity()) };
    let (scan, goal) = ([range], route.at(route.length()));
    driver().command(&Sensed { goal, route: Some(route), ..lidar.sensed(&vehicle, &scan, &state) })
}

#[test]
fn looks_ahead_in_time_within_bounds() {
    for (speed, distance) in [(0.0, 0.3), (0.1, 0.3), (0.4, 0.6), (-0.4, 0.6), (0.6, 0.9), (2.0, 0.9)] {
        assert!((driver().lookahead(speed) - distance).abs() < 1e-12, "{speed}");
    }
}

#[test]
fn regulations_by_hand() {
    let speed = |curvature, clearance, remaining| driver().regulated_speed(curvature, clearance, remaining);
    let far = 9.0;
    for (found, expected) in [
        (speed(0.0, far, far), 1.0),
        (speed(1.0 / 0.9, far, far), 1.0),
        (speed(2.0, far, far), 1.0 / 1.8), // radius 0.5 m of 0.9
        (speed(-2.0, far, far), 1.0 / 1.8),
        (speed(10.0, far, far), 0.25), // 0.11, but no less than the least
        (speed(0.0, 0.3, far), 0.5),   // half of 0.6 m
        (speed(0.0, -0.1, far), 0.25),
        (speed(2.0, 0.4, far), 1.0 / 1.8), // the lesser of 0.56 and 0.67
        (speed(0.0, far, 0.3), 0.5),       // half of 0.6 m left
        (speed(0.0, far, 0.001), 0.05),
    ] {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn an_arc_by_hand() {
    // At 0.6 m/s the point lies 0.9 m along a line 0.3 m to the left: curvature 2 x 0.3 / (0.9^2 + 0.3^2) = 2/3, radius
    // 1.5 m: not slowed. It may speed up by 2 m/s^2 x 0.2 s to 1 m/s.
    let route = Route::new(vec![Point::new(-5.0, 0.3), Point::new(5.0, 0.3)]);
    let command = command_on(&route, 0.6, (3.0, 9.0));
    assert!((command.speed - 1.0).abs() < 1e-12 && (command.yaw_rate - 2.0 / 3.0).abs() < 1e-12, "{command:?}");
    // From rest it looks 0.3 m ahead, to the left of the angle of 0.785 rad by a hair: it turns.
    let aside = Route::new(vec![Point::new(-5.0, 0.301), Point::new(5.0, 0.301)]);
    let command = command_on(&aside, 0.0, (3.0, 9.0));
    assert_eq!(command.speed, 0.0);
    assert!((command.yaw_rate - 1.2).abs() < 1e-12); // 6 rad/s^2 x 0.2 s
}

#[test]
fn rotates_to_the_route_but_not_beyond() {
    let vehicle = VehicleSpec::default().build().unwrap();
    let world = World::new(Room::new(20.0, 20.0), vec![]).unwrap();
    let mut state = VehicleState::at_rest(Pose::new([10.0, 10.0].into(), 3.0));
    let route = Route::new(vec![Point::new(10.0, 10.0), Point::new(18.0, 10.0)]);
    let lidar = Lidar::new(36, 20.0);
    for _ in 0..10 {
        let scan = lidar.scan(&world, &state.pose);
        let sensed = Sensed { route: Some(&route), ..lidar.sensed(&vehicle, &scan, &state) };
        let command = driver().command(&sensed);
        if command.speed > 0.0 {
            let yaw = state.pose.rotation.angle();
            assert!(yaw > 0.0 && yaw <= 0.785, "{yaw}");
            return;
        }
        assert!(command.yaw_rate < 0.0);
        vehicle.step(&world, &mut state, command);
    }
    panic!("still turning");
}

#[test]
fn stops_before_what_the_arc_touches_within_a_second() {
    let route = Route::new(vec![Point::origin(), Point::new(5.0, 0.0)]);
    // At 0.4 m/s it would drive at 0.8 m/s, but the point ahead is 0.6 m away: the front gets to 0.85 m.
    assert!(command_on(&route, 0.4, (0.0, 0.9)).speed > 0.0);
    assert_eq!(command_on(&route, 0.4, (0.0, 0.8)).speed, 0.0);
}

#[test]
fn speeds_up_no_faster_than_the_vehicle_and_keeps_the_curvature() {
    let route = Route::new(vec![Point::origin(), Point::new(5.0, 0.0)]);
    assert!((command_on(&route, 0.0, (3.0, 9.0)).speed - 0.4).abs() < 1e-12);
    // Yaw rates beyond 1.5 rad/s are not to be had.
    let vehicle = VehicleSpec::default().build().unwrap();
    let state = VehicleState { twist: Twist::new(1.0, 0.0, 0.0), ..VehicleState::at_rest(Pose::identity()) };
    let lidar = Lidar::new(8, 9.0);
    let command = RegulatedPursuit::limited(&lidar.sensed(&vehicle, &[], &state), 1.0, 2.0);
    assert!((command.speed - 0.75).abs() < 1e-12 && (command.yaw_rate - 1.5).abs() < 1e-12);
}

fn n_arrivals(vehicle: &Vehicle, world: &WorldSpec, n_scenarios: u64, driver: &mut dyn Controller) -> u64 {
    let source = world.build(vehicle.footprint()).unwrap();
    let radius = vehicle.footprint().circumradius();
    let mut arrives = |index: u64| {
        let scenario = source.scenario(11, index).unwrap();
        let map = GridMap::from_world(&scenario.world, 0.1, radius + 0.1);
        let start = Point::from(scenario.start.translation.vector);
        let route = plan(&map, &start, &scenario.goal).expect("gaps are wide");
        let trial = Trial::new(&scenario.world, vehicle, scenario.start, scenario.goal);
        let end = Trial { lidar: Lidar::new(360, 5.0), route: Some(&route), ..trial }.drive(driver);
        assert_ne!(end, End::Collided, "scenario {index}");
        matches!(end, End::Arrived(_))
    };
    (0..n_scenarios).map(|index| u64::from(arrives(index))).sum()
}

/// With and without a shield, which must not keep it from arriving.
#[test]
fn drives_along_planned_routes() {
    let disc = VehicleSpec::default().build().unwrap();
    let footprint = Shape::Box { length: 0.46, width: 0.42 };
    let boxed = VehicleSpec { footprint, ..VehicleSpec::default() }.build().unwrap();
    let mut shielded = ShieldSpec::default().build(driver()).unwrap();
    for driver in [&mut driver() as &mut dyn Controller, &mut shielded] {
        assert_eq!(n_arrivals(&disc, &WorldSpec::Room10x15 {}, 20, driver), 20);
        assert_eq!(n_arrivals(&disc, &WorldSpec::Room25x25 {}, 4, driver), 4);
        assert_eq!(n_arrivals(&boxed, &WorldSpec::Room10x15 {}, 20, driver), 20);
    }
    assert!(shielded.interventions().n_vetoes * 20 < shielded.interventions().n_commands, "{shielded:?}");
}

fn car() -> VehicleSpec {
    let drive = Drive::Ackermann { wheelbase: 0.3, max_steering_angle: 0.6, max_steering_rate: 3.0 };
    VehicleSpec { drive, ..VehicleSpec::default() }
}

#[test]
fn what_cannot_turn_on_the_spot_turns_as_tightly_as_it_can() {
    let (vehicle, lidar) = (car().build().unwrap(), Lidar::new(36, 20.0));
    let radius = car().drive.turning_radius();
    let state = VehicleState { twist: Twist::new(0.3, 0.0, 0.0), ..VehicleState::at_rest(Pose::identity()) };
    for (aside, side) in [(3.0_f64, 1.0), (-3.0, -1.0), (0.25, 1.0)] {
        // Behind on that side, abeam, and an arc ahead that is too tight.
        let ahead = if aside.abs() > 1.0 { -1.0 } else { 0.3 };
        let route = Route::new(vec![Point::origin(), Point::new(ahead, aside)]);
        let command = driver().command(&Sensed { route: Some(&route), ..lidar.sensed(&vehicle, &[20.0; 36], &state) });
        assert!(command.speed > 0.0, "{command:?}");
        assert!((command.yaw_rate - side * command.speed / radius).abs() < 1e-12, "{command:?}");
    }
    // Where that is not free, it stands.
    let route = Route::new(vec![Point::origin(), Point::new(-1.0, 3.0)]);
    let command = driver().command(&Sensed { route: Some(&route), ..lidar.sensed(&vehicle, &[0.27; 36], &state) });
    assert_eq!(command, Command::default());
}

/// It starts facing anywhere and never reverses, so that it may have no room to turn round: then it stands.
#[test]
fn a_car_drives_along_planned_routes() {
    let n = n_arrivals(&car().build().unwrap(), &WorldSpec::Room10x15 {}, 20, &mut driver());
    assert!(n >= 12, "{n}");
}

#[test]
fn refusals_name_the_field() {
    let refusal = |spec: RegulatedPursuitSpec| spec.build().unwrap_err().field;
    let spec = RegulatedPursuitSpec::default();
    assert_eq!(refusal(RegulatedPursuitSpec { max_lookahead_dist: 0.1, ..spec }), "max_lookahead_dist");
    assert_eq!(refusal(RegulatedPursuitSpec { cost_scaling_gain: 1.5, ..spec }), "cost_scaling_gain");
    assert_eq!(refusal(RegulatedPursuitSpec { desired_linear_vel: f64::NAN, ..spec }), "desired_linear_vel");
}
