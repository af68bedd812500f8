//! Kinds of drives and faults of actuators on closed forms.

use headway_sim::{
    ActuationSpec, Command, Drive, Point, Pose, Room, Vehicle, VehiclePreset, VehicleSpec, VehicleState, World, stream,
};
use proptest::prelude::*;

fn hall() -> World {
    World::new(Room::new(200.0, 200.0), vec![]).unwrap()
}

fn middle(yaw: f64) -> VehicleState {
    VehicleState::at_rest(Pose::new([100.0, 100.0].into(), yaw))
}

fn with_drive(drive: Drive) -> Vehicle {
    VehicleSpec { drive, ..VehicleSpec::default() }.build().unwrap()
}

fn with_actuation(actuation: ActuationSpec) -> Vehicle {
    VehicleSpec { actuation, ..VehicleSpec::default() }.build().unwrap()
}

const CAR: Drive = Drive::Ackermann { wheelbase: 0.5, max_steering_angle: 0.6, max_steering_rate: 1.0 };

#[test]
fn a_bicycle_drives_a_circle_of_wheelbase_over_tangent() {
    let (world, vehicle, mut state) = (hall(), with_drive(CAR), middle(0.4));
    // At 1 m/s, 0.8 rad/s is a circle of 1.25 m: the wheels stand at atan(0.5 / 1.25).
    let command = Command::new(1.0, 0.8);
    for _ in 0..10 {
        vehicle.step(&world, &mut state, command);
    }
    assert!((state.steering - 0.4_f64.atan()).abs() < 1e-12);
    assert!((state.twist.z - 0.8).abs() < 1e-12);
    let center = |state: &VehicleState| state.pose * Point::new(0.0, 1.25);
    let before = center(&state);
    for _ in 0..50 {
        vehicle.step(&world, &mut state, command);
        assert!((center(&state) - before).norm() < 1e-9);
    }
}

#[test]
fn a_bicycle_steers_at_its_rate_up_to_its_limit_and_cannot_turn_on_the_spot() {
    let (world, vehicle, mut state) = (hall(), with_drive(CAR), middle(0.0));
    vehicle.step(&world, &mut state, Command::new(0.0, 1.5));
    assert_eq!((state.steering, state.pose.rotation.angle()), (0.0, 0.0));
    for step in 1..=5 {
        vehicle.step(&world, &mut state, Command::new(0.1, 1.5)); // asks for atan(7.5) = 1.44
        let steered = (0.2 * f64::from(step)).min(0.6);
        assert!((state.steering - steered).abs() < 1e-12);
        assert!((state.twist.z - state.twist.x * steered.tan() / 0.5).abs() < 1e-12);
    }
}

#[test]
fn an_omnidirectional_vehicle_moves_aslant() {
    let world = hall();
    let (vehicle, mut state) = (with_drive(Drive::Omnidirectional { max_lateral_speed: 0.5 }), middle(0.3));
    let command = Command { speed: 0.4, lateral_speed: 0.9, yaw_rate: 0.0 };
    for _ in 0..5 {
        vehicle.step(&world, &mut state, command);
    }
    let before = state.pose;
    let motion = vehicle.step(&world, &mut state, command);
    // 0.4 m/s ahead and, limited, 0.5 m/s to the left.
    let moved = before.inverse_transform_point(&state.pose.translation.vector.into());
    assert!((moved - Point::new(0.08, 0.1)).norm() < 1e-12);
    assert!((motion.distance - 0.2 * 0.4_f64.hypot(0.5)).abs() < 1e-12);
}

#[test]
fn what_cannot_move_sideways_does_not() {
    for drive in [Drive::default(), CAR] {
        let (world, vehicle, mut state) = (hall(), with_drive(drive), middle(0.0));
        vehicle.step(&world, &mut state, Command { lateral_speed: 1.0, ..Command::default() });
        assert_eq!(state, middle(0.0));
    }
}

#[test]
fn a_lag_is_an_exponential() {
    // 2 m/s^2 for 0.2 s is more than 0.2 m/s asks for: only the lag limits.
    let actuation = ActuationSpec { speed_lag: 0.5, yaw_rate_lag: 0.25, ..ActuationSpec::default() };
    let (world, vehicle, mut state) = (hall(), with_actuation(actuation), middle(0.0));
    for step in 1..=10 {
        vehicle.step(&world, &mut state, Command::new(0.2, 0.3));
        let time = 0.2 * f64::from(step);
        assert!((state.twist.x - 0.2 * (1.0 - (-time / 0.5).exp())).abs() < 1e-12);
        assert!((state.twist.z - 0.3 * (1.0 - (-time / 0.25).exp())).abs() < 1e-12);
    }
}

#[test]
fn a_gain_scales_the_turn() {
    let actuation = ActuationSpec { yaw_rate_gain: 0.5, ..ActuationSpec::default() };
    let (world, vehicle, mut state) = (hall(), with_actuation(actuation), middle(0.0));
    for _ in 0..5 {
        vehicle.step(&world, &mut state, Command::new(0.0, 1.0));
    }
    assert_eq!(state.twist.z, 0.5);
}

#[test]
fn noise_scales_commands_by_its_size_and_draws_nothing_when_off() {
    let vehicle = with_actuation(ActuationSpec { noise: 0.1, ..ActuationSpec::default() });
    let mut rng = stream(0, "noise", 0);
    let n = 20_000;
    let factors: Vec<f64> = (0..n).map(|_| vehicle.disturb(Command::new(2.0, -1.0), &mut rng).speed / 2.0).collect();
    let mean = factors.iter().sum::<f64>() / f64::from(n);
    let deviation = (factors.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / f64::from(n)).sqrt();
    assert!((mean - 1.0).abs() < 3e-3 && (deviation - 0.1).abs() < 2e-3, "{mean} {deviation}");
    let (mut drawn, untouched) = (stream(0, "noise", 0), stream(0, "noise", 0));
    let exact = with_actuation(ActuationSpec::default()).disturb(Command::new(2.0, -1.0), &mut drawn);
    assert_eq!((exact, drawn), (Command::new(2.0, -1.0), untouched));
}

proptest! {
    /// Whatever the latency, in whole periods or parts of one, it shifts what would have happened.
    #[test]
    fn latency_shifts_a_drive_in_time(
        n_late in 0..12_usize,
        commands in prop::collection::vec((-0.5..1.5, -1.5..1.5), 8),
    ) {
        let spec = VehicleSpec { max_reverse_speed: 1.0, ..VehicleSpec::default() };
        let latency = 0.05 * n_late as f64;
        let late = VehicleSpec { actuation: ActuationSpec { latency, ..Default::default() }, ..spec.clone() };
        // In substeps of 0.05 s, so that what comes late by parts of a period can be compared.
        let fine = VehicleSpec { control_period: 0.05, n_substeps: 1, ..spec }.build().unwrap();
        let (world, late) = (hall(), late.build().unwrap());
        let (mut prompt, mut delayed) = (middle(0.2), middle(0.2));
        let mut history = vec![prompt.clone(); n_late + 1];
        for (speed, yaw_rate) in commands {
            let command = Command::new(speed, yaw_rate);
            for _ in 0..4 {
                fine.step(&world, &mut prompt, command);
                history.push(prompt.clone());
            }
            late.step(&world, &mut delayed, command);
            let then = &history[history.len() - 1 - n_late];
            prop_assert!((delayed.pose.translation.vector - then.pose.translation.vector).norm() < 1e-9);
            prop_assert!((delayed.twist - then.twist).norm() < 1e-12);
        }
    }
}

#[test]
fn presets_fill_in_what_a_table_leaves_out() {
    for (name, preset) in VehiclePreset::ALL {
        let read: VehicleSpec = toml::from_str(&format!("preset = '{name}'")).unwrap();
        assert_eq!(read, preset.spec());
        let again: VehicleSpec = toml::from_str(&toml::to_string(&read).unwrap()).unwrap();
        assert_eq!(again, read);
    }
    let error = toml::from_str::<VehicleSpec>("preset = 'husky'").unwrap_err().to_string();
    assert!(error.contains("`default`, `turtlebot3_burger`, `turtlebot3_waffle`, `jackal`"), "{error}");
    assert!(
        toml::from_str::<VehicleSpec>("max_sped = 1.0").unwrap_err().to_string().contains("unknown field `max_sped`")
    );
}

#[test]
fn refusals_name_the_field() {
    let refused = |spec: VehicleSpec| spec.build().unwrap_err().to_string();
    let drive = Drive::Ackermann { wheelbase: 0.0, max_steering_angle: 0.6, max_steering_rate: 1.0 };
    let message = refused(VehicleSpec { drive, ..VehicleSpec::default() });
    assert_eq!(message, "drive.wheelbase = 0: must be from 0.01 to 100");
    let actuation = ActuationSpec { latency: f64::NAN, ..ActuationSpec::default() };
    let message = refused(VehicleSpec { actuation, ..VehicleSpec::default() });
    assert_eq!(message, "actuation.latency = NaN: must be from 0 to 2");
}
