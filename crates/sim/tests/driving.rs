//! Vehicles on closed forms, within limits, and never through things.

use headway_sim::{
    Command, Obstacle, Point, Pose, Room, Shape, Vehicle, VehicleSpec, VehicleState, World, WorldSpec, stream,
};
use proptest::prelude::*;
use rand::RngExt;

const HALL: Room = Room::new(200.0, 200.0);

fn middle(yaw: f64) -> VehicleState {
    VehicleState::at_rest(Pose::new([100.0, 100.0].into(), yaw))
}

fn vehicle(spec: VehicleSpec) -> Vehicle {
    spec.build().expect("valid")
}

#[test]
fn constant_yaw_rate_drives_a_circle() {
    let world = World::new(HALL, vec![]).unwrap();
    let vehicle = vehicle(VehicleSpec::default());
    let mut state = middle(0.3);
    let command = Command::new(1.0, 0.5);
    for _ in 0..10 {
        vehicle.step(&world, &mut state, command); // reach 1 m/s and 0.5 rad/s
    }
    // The circle's centre is v / w = 2 m to the left; it must stay there.
    let center = |s: &VehicleState| s.pose * Point::new(0.0, 2.0);
    let before = center(&state);
    for _ in 0..100 {
        let motion = vehicle.step(&world, &mut state, command);
        assert!((motion.distance - 0.2).abs() < 1e-12);
        assert!((center(&state) - before).norm() < 1e-9);
    }
}

#[test]
fn acceleration_from_rest_covers_half_a_t_squared() {
    let world = World::new(HALL, vec![]).unwrap();
    let vehicle = vehicle(VehicleSpec::default());
    let mut state = middle(0.0);
    let command = Command::new(1.5, 0.0);
    let distance: f64 = (0..3).map(|_| vehicle.step(&world, &mut state, command).distance).sum();
    assert!((distance - 0.5 * 2.0 * 0.6 * 0.6).abs() < 1e-12);
    assert!((state.twist.x - 1.2).abs() < 1e-12);
}

#[test]
fn a_collision_ends_where_the_vehicle_first_touches() {
    let post = Obstacle { shape: Shape::Disc { radius: 0.5 }, x: 105.0, y: 100.0, yaw: 0.0 };
    let world = World::new(HALL, vec![post]).unwrap();
    let vehicle = vehicle(VehicleSpec::default());
    let mut state = middle(0.0);
    let mut driven = 0.0;
    loop {
        let motion = vehicle.step(&world, &mut state, Command::new(1.5, 0.0));
        driven += motion.distance;
        if motion.collided {
            assert!(motion.proximity.clearance() <= 0.0);
            break;
        }
    }
    // 5 m to the middle of the post, less both radii.
    assert!((state.pose.translation.x - 104.25).abs() < 2e-3);
    assert!((driven - 4.25).abs() < 2e-3);
}

#[test]
fn a_fast_vehicle_does_not_pass_through_a_thin_wall() {
    let sheet = |x| Obstacle { shape: Shape::Box { length: 0.01, width: 20.0 }, x, y: 100.0, yaw: 0.0 };
    let world = World::new(HALL, vec![sheet(103.0)]).unwrap();
    for footprint in [Shape::Disc { radius: 0.25 }, Shape::Box { length: 0.5, width: 0.4 }] {
        let spec =
            VehicleSpec { footprint, max_speed: 50.0, max_acceleration: 1e4, n_substeps: 1, ..Default::default() };
        let mut state = middle(0.0);
        let motion = vehicle(spec).step(&world, &mut state, Command::new(50.0, 0.0));
        assert!(motion.collided);
        assert!((state.pose.translation.x - (103.0 - 0.255)).abs() < 2e-3);
    }
}

#[test]
fn a_long_vehicle_sweeps_what_it_turns_into() {
    // The period turns it by 0.5 rad; the post stands half-way and overlaps it neither before nor after.
    let (sin, cos) = 0.25_f64.sin_cos();
    let (x, y) = (100.0 + 0.85 * cos, 100.0 + 0.85 * sin);
    let post = Obstacle { shape: Shape::Disc { radius: 0.02 }, x, y, yaw: 0.0 };
    let world = World::new(HALL, vec![post]).unwrap();
    let footprint = Shape::Box { length: 2.0, width: 0.1 };
    let spec =
        VehicleSpec { footprint, max_yaw_rate: 5.0, max_yaw_acceleration: 1e4, n_substeps: 1, ..Default::default() };
    let (vehicle, command) = (vehicle(spec), Command::new(0.0, 5.0));
    let mut unhindered = middle(0.0);
    vehicle.step(&World::new(HALL, vec![]).unwrap(), &mut unhindered, command);
    assert!((unhindered.pose.rotation.angle() - 0.5).abs() < 1e-9);
    for state in [middle(0.0), unhindered] {
        assert!(!world.collides(vehicle.footprint(), &state.pose));
    }
    assert!(vehicle.step(&world, &mut middle(0.0), command).collided);
}

#[test]
fn what_is_not_a_number_brakes() {
    let world = World::new(HALL, vec![]).unwrap();
    let vehicle = vehicle(VehicleSpec::default());
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (mut state, mut expected) = (middle(0.3), middle(0.3));
        for state in [&mut state, &mut expected] {
            state.twist.x = 1.0;
            state.twist.z = -1.5;
        }
        vehicle.step(&world, &mut state, Command::new(broken, 0.5));
        vehicle.step(&world, &mut expected, Command::new(0.0, 0.5));
        assert_eq!(state, expected);
        vehicle.step(&world, &mut state, Command::new(1.5, broken));
        vehicle.step(&world, &mut expected, Command::new(1.5, 0.0));
        assert_eq!(state, expected);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn driving_at_random_keeps_the_limits_and_stays_outside_of_things(seed in 0..u64::MAX, boxy: bool) {
        let footprint = if boxy { Shape::Box { length: 0.5, width: 0.43 } } else { Shape::Disc { radius: 0.25 } };
        let vehicle = vehicle(VehicleSpec { footprint, max_reverse_speed: 0.5, ..Default::default() });
        let spec = vehicle.spec().clone();
        let mut rng = stream(seed, "commands", 0);
        let source = WorldSpec::default().build(vehicle.footprint()).unwrap();
        let scenario = source.scenario(seed, 0).unwrap();
        let mut state = VehicleState::at_rest(scenario.start);
        for _ in 0..200 {
            let command = Command::new(rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0));
            let before = state.clone();
            let motion = vehicle.step(&scenario.world, &mut state, command);
            prop_assert!((-spec.max_reverse_speed..=spec.max_speed).contains(&state.twist.x));
            prop_assert!(state.twist.z.abs() <= spec.max_yaw_rate);
            let dv = (state.twist.x - before.twist.x).abs();
            prop_assert!(dv <= spec.max_acceleration * spec.control_period + 1e-12);
            let dw = (state.twist.z - before.twist.z).abs();
            prop_assert!(dw <= spec.max_yaw_acceleration * spec.control_period + 1e-12);
            prop_assert_eq!(scenario.world.collides(vehicle.footprint(), &state.pose), motion.collided);
            if motion.collided {
                let depth = scenario.world.clearance(vehicle.footprint(), &state.pose);
                prop_assert!(depth > -2.0 * Vehicle::CONTACT_TOLERANCE);
                break;
            }
        }
    }
}

#[test]
fn refusals_name_the_field() {
    let cases = [
        (VehicleSpec { max_speed: -1.0, ..Default::default() }, "max_speed = -1: must be a finite number above 0"),
        (VehicleSpec { n_substeps: 0, ..Default::default() }, "n_substeps = 0: must be from 1 to 1000"),
        (
            VehicleSpec { footprint: Shape::Disc { radius: f64::NAN }, ..Default::default() },
            "footprint.radius = NaN: must be a finite number above 0",
        ),
    ];
    for (spec, message) in cases {
        assert_eq!(spec.build().unwrap_err().to_string(), message);
    }
}

#[test]
fn absurd_limits_are_refused() {
    // Some of these made a step run for ever.
    let base = VehicleSpec::default;
    let long = Shape::Box { length: 201.0, width: 1.0 };
    let cases = [
        (VehicleSpec { footprint: long, ..base() }, "footprint (its circumradius) = 100.5"),
        (VehicleSpec { max_speed: 101.0, ..base() }, "max_speed = 101: must be from 0 to 100"),
        (VehicleSpec { max_reverse_speed: 101.0, ..base() }, "max_reverse_speed = 101: must be from 0 to 100"),
        (VehicleSpec { max_yaw_rate: 1e18, ..base() }, "max_yaw_rate = 1000000000000000000: must be from 0 to 100"),
        (VehicleSpec { max_acceleration: 2e4, ..base() }, "max_acceleration = 20000: must be from 0 to 10000"),
        (VehicleSpec { max_yaw_acceleration: 2e4, ..base() }, "max_yaw_acceleration = 20000: must be from 0 to 10000"),
        (VehicleSpec { control_period: 11.0, ..base() }, "control_period = 11: must be from 0.001 to 10"),
        (VehicleSpec { control_period: 1e-4, ..base() }, "control_period = 0.0001: must be from 0.001 to 10"),
        (VehicleSpec { n_substeps: 1001, ..base() }, "n_substeps = 1001: must be from 1 to 1000"),
    ];
    for (spec, message) in cases {
        let refusal = spec.build().unwrap_err().to_string();
        assert!(refusal.starts_with(message), "{refusal}");
    }
}
