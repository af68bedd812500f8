//! Policy files, read back and refused; and the driver against the environment it was made for.

use std::sync::Arc;

use headway_env::{EnvSpec, NavSpec, Navigator};
use headway_planning::Controller;
use headway_policy::{Driver, Header, Layer, Policy};

/// A policy with weights that follow a rule.
fn policy() -> Policy {
    let rule = |n: usize, step: usize| (0..n).map(|k| 0.02 * ((k * step % 101) as f32 - 50.0)).collect::<Vec<_>>();
    let hidden = Layer { weight: rule(16 * 42, 37), bias: rule(16, 11) };
    let last = Layer { weight: rule(12 * 16, 53), bias: rule(12, 7) };
    Policy::new(Header::default(), vec![hidden, last]).unwrap()
}

#[test]
fn a_file_gives_the_policy_back_and_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("policy.safetensors");
    policy().save(&path).unwrap();
    let read = Policy::load(&path).unwrap();
    assert_eq!(read, policy());
    assert_eq!(read.to_bytes().unwrap(), std::fs::read(&path).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no partial file is left");
}

#[test]
fn bad_files_are_refused_with_a_reason() {
    let bytes = policy().to_bytes().unwrap();
    let refused = |bytes: &[u8]| Policy::from_bytes(bytes).unwrap_err().to_string();
    for end in [0, 4, 100, bytes.len() - 1] {
        assert!(refused(&bytes[..end]).starts_with("not a policy file: "), "{}", refused(&bytes[..end]));
    }
    let replaced = |from: &str, to: &str| {
        let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
        let mut other = bytes.clone();
        other[at..at + from.len()].copy_from_slice(to.as_bytes());
        other
    };
    assert_eq!(
        refused(&replaced("headway.policy", "another.policy")),
        "not a policy file: its metadata have no entry `headway.policy`"
    );
    assert_eq!(
        refused(&replaced(r#"\"format\":1"#, r#"\"format\":7"#)),
        "not a policy file: its format is version 7, this program reads version 1"
    );
    assert!(refused(&replaced("max_speed", "max_sqeed")).contains("unknown field `max_sqeed`"));
    assert!(refused(&replaced("layers.1.bias", "layers.7.bias")).contains("layers.1.bias"));
    let missing = Policy::load(std::path::Path::new("no/such.safetensors")).unwrap_err().to_string();
    assert!(missing.starts_with("no/such.safetensors: "), "{missing}");
}

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

#[test]
fn the_driver_commands_what_the_chosen_action_does_in_the_environment() {
    for control in [r#"type = "full""#, r#"type = "speed_only""#] {
        let is_full = control.contains("full");
        let yaw_rates = if is_full { "[-1.5, 0.0, 1.5]" } else { "[0.0]" };
        let env: EnvSpec = toml::from_str(&format!(
            "control = {{ {control} }}\nactions = {{ type = \"set_points\", speeds = [0.3, 0.6, 1.0, 1.5], yaw_rates = {yaw_rates} }}"
        ))
        .unwrap();
        let n_actions = if is_full { 12 } else { 4 };
        let header = Header { control: env.control, actions: env.actions.clone(), ..Header::default() };
        let mut layers = policy().layers().to_vec();
        layers[1].weight.truncate(16 * n_actions);
        layers[1].bias.truncate(n_actions);
        let mut driver = Driver::new(Arc::new(Policy::new(header, layers).unwrap())).unwrap();
        let mdp = NavSpec { env, ..NavSpec::default() }.build().unwrap();
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
