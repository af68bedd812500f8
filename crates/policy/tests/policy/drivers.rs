//! Drivers: for which robots, and against the environment that their policy was made for.

use std::sync::Arc;

use headway_env::{ActionSpec, Control, EnvSpec, NavSpec, Navigator};
use headway_planning::Controller;
use headway_policy::{Driver, Header, Layer, Policy, PolicyError};

use crate::common::policy;

#[test]
fn another_robot_is_refused_with_the_differences() {
    let policy = policy();
    let (mut vehicle, mut lidar) = (policy.header().vehicle.clone(), policy.header().lidar.clone());
    (vehicle.n_substeps, lidar.noise, lidar.dropout) = (9, 0.1, 0.1);
    policy.check(&vehicle, &lidar).unwrap();
    vehicle.footprint = headway_sim::Shape::Box { length: 0.5, width: 0.4 };
    lidar.n_beams = 24;
    assert_eq!(
        policy.check(&vehicle, &lidar).unwrap_err().to_string(),
        "this policy was made for another robot: \
         lidar.n_beams is 36 in the policy, 24 here; \
         vehicle.footprint.length is absent in the policy, 0.5 here; \
         vehicle.footprint.radius is 0.25 in the policy, absent here; \
         vehicle.footprint.type is \"disc\" in the policy, \"box\" here; \
         vehicle.footprint.width is absent in the policy, 0.4 here"
    );
}

/// `Driver::new` used to see no robot at all.
#[test]
fn a_driver_is_refused_to_another_robot() {
    let policy = Arc::new(policy());
    let (vehicle, mut lidar) = (policy.header().vehicle.clone(), policy.header().lidar.clone());
    Driver::new(Arc::clone(&policy), &vehicle, &lidar).unwrap();
    lidar.n_beams = 24;
    let error = Driver::new(policy, &vehicle, &lidar).unwrap_err();
    assert!(matches!(&error, PolicyError::Mismatch { .. }));
    assert_eq!(error.to_string(), "this policy was made for another robot: lidar.n_beams is 36 in the policy, 24 here");
}

#[test]
#[should_panic(expected = "one range per beam")]
fn a_driver_panics_at_a_scan_of_another_lidar() {
    let policy = Arc::new(policy());
    let spec = NavSpec::default();
    let mut driver = Driver::new(policy, &spec.vehicle, &spec.lidar).unwrap();
    let navigator = Navigator::new(spec.build().unwrap(), 1, 0).unwrap();
    let mut sensed = navigator.sensed();
    sensed.scan = &sensed.scan[1..];
    let _ = driver.command(&sensed);
}

#[test]
fn without_a_route_a_speed_only_driver_steers_straight_at_the_goal() {
    let control = Control::SpeedOnly { pursuit: Default::default() };
    let actions = ActionSpec::SetPoints { speeds: vec![0.6], yaw_rates: vec![0.0], lateral_speeds: vec![0.0] };
    let layer = Layer { weight: vec![0.0; 42], bias: vec![0.0] };
    let policy = Policy::new(Header { control, actions, ..Header::default() }, vec![layer]).unwrap();
    let spec = NavSpec::default();
    let mut driver = Driver::new(Arc::new(policy), &spec.vehicle, &spec.lidar).unwrap();
    let navigator = Navigator::new(spec.build().unwrap(), 1, 0).unwrap();
    let mut sensed = navigator.sensed();
    assert!(sensed.route.is_none());
    sensed.goal = sensed.pose * headway_sim::Point::new(4.0, 0.0);
    let command = driver.command(&sensed);
    assert!((command.speed - 0.6).abs() < 1e-12 && command.yaw_rate.abs() < 1e-9, "{command:?}");
}

#[test]
fn the_driver_commands_what_the_chosen_action_does_in_the_environment() {
    for control in [r#"type = "full""#, r#"type = "speed_only""#] {
        let is_full = control.contains("full");
        let yaw_rates = if is_full { "[-1.5, 0.0, 1.5]" } else { "[0.0]" };
        let env: EnvSpec = toml::from_str(&format!(
            "route = {{ type = \"true_map\" }}\ncontrol = {{ {control} }}\nactions = {{ type = \"set_points\", speeds = [0.3, 0.6, 1.0, 1.5], yaw_rates = {yaw_rates} }}"
        ))
        .unwrap();
        let n_actions = if is_full { 12 } else { 4 };
        let header = Header { control: env.control, actions: env.actions.clone(), ..Header::default() };
        let mut layers = policy().layers().to_vec();
        layers[1].weight.truncate(16 * n_actions);
        layers[1].bias.truncate(n_actions);
        let spec = NavSpec { env, ..NavSpec::default() };
        let policy = Arc::new(Policy::new(header, layers).unwrap());
        let mut driver = Driver::new(policy, &spec.vehicle, &spec.lidar).unwrap();
        let mdp = spec.build().unwrap();
        for index in 0..5 {
            let mut by_action = Navigator::new(Arc::clone(&mdp), 1, index).unwrap();
            let mut by_command = by_action.clone();
            driver.reset();
            for _ in 0..30 {
                let mut obs = [0.0; 42];
                by_action.observe(&mut obs);
                let end = by_action.act(driver.act(&obs)).unwrap();
                let command = driver.command(&by_command.sensed());
                assert_eq!(by_command.drive(command).unwrap(), end);
                assert_eq!(by_command.vehicle(), by_action.vehicle());
            }
        }
    }
}
