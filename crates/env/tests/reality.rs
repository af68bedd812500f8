//! What makes a simulated robot more like a real one: crowds, faults of actuators and sensors, numbers that are drawn, routes
//! from scans. All of it at once, for what must hold whatever is switched on.

use std::sync::Arc;

use headway_env::{
    ActionSpec, Distribution, Env, EnvSpec, Event, GoalHandling, NavEnv, NavSpec, Navigator, ObservationSpec,
    RouteSource, Step,
};
use headway_planning::ScanPlannerSpec;
use headway_sensors::{LidarSpec, OdometrySpec};
use headway_sim::{ActuationSpec, Command, CrowdMotion, CrowdSpec, Interval, RoomSpec, VehicleSpec, WorldSpec, stream};
use proptest::prelude::*;
use rand::RngExt;

fn spec(motion: CrowdMotion) -> NavSpec {
    let crowd = CrowdSpec { n_movers: Interval::Fixed(4.0), motion, ..CrowdSpec::default() };
    let actuation = ActuationSpec { latency: 0.15, noise: 0.1, speed_lag: 0.1, ..ActuationSpec::default() };
    let odometry = OdometrySpec { distance_bias: 0.02, yaw_rate_bias: 0.01, yaw_walk: 0.01, ..OdometrySpec::default() };
    let observation = ObservationSpec {
        n_sectors: 12,
        look_ahead: vec![0.5, 1.5],
        trail: vec![0.4, 2.0],
        last_command: true,
        n_movers: 3,
        ..ObservationSpec::default()
    };
    let randomize = [
        ("vehicle.actuation.latency", Distribution::Uniform([0.0, 0.3])),
        ("vehicle.max_acceleration", Distribution::Normal([2.0, 0.2])),
        ("lidar.noise", Distribution::Choice(vec![0.0, 0.03])),
    ];
    NavSpec {
        world: WorldSpec::Room(RoomSpec { crowd: Some(crowd), ..RoomSpec::default() }),
        vehicle: VehicleSpec { actuation, ..VehicleSpec::default() },
        lidar: LidarSpec { n_beams: 72, dropout: 0.02, grazing_angle: 0.1, ..LidarSpec::default() },
        odometry,
        randomize: randomize.map(|(path, distribution)| (path.to_owned(), distribution)).into(),
        env: EnvSpec {
            goal: GoalHandling::NewGoal,
            time_limit: 10.0,
            route: RouteSource::Scans(ScanPlannerSpec::default()),
            observation,
            ..EnvSpec::default()
        },
        ..NavSpec::default()
    }
}

fn motion() -> impl Strategy<Value = CrowdMotion> {
    prop_oneof![
        Just(CrowdMotion::Waypoints { n_points: 3, loops: vec![] }),
        Just(CrowdMotion::RandomWalk { turning: 0.7 }),
        Just(CrowdMotion::Reciprocal { horizon: 2.0, obstacle_horizon: 1.0 }),
    ]
}

fn start(spec: &NavSpec, n_envs: usize, seed: u64) -> (NavEnv, Step) {
    let mut env = NavEnv::new(spec.build().unwrap(), n_envs);
    let mut step = Step::new(n_envs, env.obs_dim());
    env.reset(seed, &mut step.obs).unwrap();
    (env, step)
}

fn roll(env: &mut NavEnv, step: &mut Step, n_steps: u64, first: u64) -> Vec<Step> {
    let mut taken = Vec::new();
    for k in first..first + n_steps {
        let act = |i| stream(9, "actions", 1000 * k + i as u64).random_range(0..12);
        let actions: Vec<u32> = (0..env.n_envs()).map(act).collect();
        env.step(&actions, step).unwrap();
        taken.push(step.clone());
    }
    taken
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn saved_states_go_on_and_observations_are_bounded(motion in motion(), seed in 0..u64::MAX, n_before in 0..60_u64) {
        let spec = spec(motion);
        let (mut whole, mut step) = start(&spec, 2, seed);
        roll(&mut whole, &mut step, n_before, 0);
        let mut bytes = Vec::new();
        whole.save(&mut bytes).unwrap();
        let (mut resumed, _) = start(&spec, 2, seed ^ 1);
        resumed.load(&mut bytes.as_slice()).unwrap();
        let mut again = step.clone();
        let steps = roll(&mut whole, &mut step, 60, n_before);
        prop_assert_eq!(&steps, &roll(&mut resumed, &mut again, 60, n_before));
        for step in &steps {
            // Actuators that are noisy may exceed a limit of the spec, by which speeds are scaled, where it is drawn.
            prop_assert!(step.next_obs.iter().chain(&step.obs).all(|x| (-1.1..=1.1).contains(x)));
            prop_assert!(step.rewards.iter().all(|reward| reward.is_finite()));
        }
    }

    /// A vehicle that restarts in its old memory is like a new one, planner, trail and crowd included.
    #[test]
    fn a_restart_is_a_new_start(motion in motion(), seed in 0..1000_u64, n_before in 0..40) {
        let mdp = spec(motion).build().unwrap();
        let mut used = Navigator::new(Arc::clone(&mdp), seed, 0).unwrap();
        for _ in 0..n_before {
            used.act(10).unwrap();
        }
        used.restart(seed, 1).unwrap();
        let mut new = Navigator::new(Arc::clone(&mdp), seed, 1).unwrap();
        let [mut a, mut b] = [vec![0.0; mdp.obs_dim()], vec![0.0; mdp.obs_dim()]];
        for _ in 0..20 {
            used.observe(&mut a);
            new.observe(&mut b);
            prop_assert_eq!(&a, &b);
            prop_assert_eq!(used.act(7).unwrap(), new.act(7).unwrap());
        }
    }
}

#[test]
fn episodes_draw_numbers_of_their_own_and_tell_them() {
    let mdp = spec(CrowdMotion::default()).build().unwrap();
    let drawn = |index| Navigator::new(Arc::clone(&mdp), 3, index).unwrap().drawn().collect::<Vec<_>>();
    let (first, second) = (drawn(0), drawn(1));
    let paths: Vec<&str> = first.iter().map(|(path, _)| path.as_str()).collect();
    assert_eq!(paths, ["lidar.noise", "vehicle.actuation.latency", "vehicle.max_acceleration"]);
    assert_eq!(first, drawn(0));
    assert_ne!(first, second);
}

/// Who does not look where it goes walks into a vehicle that stands, and that is a collision.
#[test]
fn a_crowd_that_does_not_regard_the_vehicle_runs_into_it() {
    let crowd = CrowdSpec {
        n_movers: Interval::Fixed(12.0),
        speed: Interval::Fixed(1.0),
        motion: CrowdMotion::RandomWalk { turning: 0.5 },
        ..CrowdSpec::default()
    };
    let hit_within_60_s = |avoids_vehicle| {
        let crowd = CrowdSpec { avoids_vehicle: Some(avoids_vehicle), ..crowd.clone() };
        let world = WorldSpec::Room(RoomSpec { crowd: Some(crowd), ..RoomSpec::default() });
        let mdp = NavSpec { world, ..NavSpec::default() }.build().unwrap();
        let is_hit = |index: &u64| {
            let mut vehicle = Navigator::new(Arc::clone(&mdp), 0, *index).unwrap();
            (0..300).any(|_| vehicle.drive(Command::default()).unwrap().event == Some(Event::Collision))
        };
        (0..20).filter(is_hit).count()
    };
    assert!(hit_within_60_s(false) >= 10);
    assert_eq!(hit_within_60_s(true), 0);
}

/// With a drifting odometry the vehicle believes to be elsewhere, and is shown the crowd relative to where it really is.
#[test]
fn beliefs_drift_and_what_is_seen_stays_where_it_is() {
    let odometry = OdometrySpec { distance_bias: 0.2, ..OdometrySpec::default() };
    let spec = NavSpec { odometry, ..spec(CrowdMotion::default()) };
    let mdp = spec.build().unwrap();
    let mut vehicle = Navigator::new(mdp, 5, 0).unwrap();
    for _ in 0..10 {
        vehicle.drive(Command::new(0.5, 0.1)).unwrap();
    }
    let sensed = vehicle.sensed();
    let believed = sensed.pose.translation.vector - vehicle.scenario().start.translation.vector;
    let moved = vehicle.vehicle().pose.translation.vector - vehicle.scenario().start.translation.vector;
    assert!((believed - moved).norm() > 1e-3);
    let crowd = vehicle.scenario().crowd.as_ref().unwrap().movers();
    for (seen, mover) in sensed.movers.iter().zip(crowd) {
        let [seen, real] = [
            sensed.pose.inverse_transform_point(&seen.position),
            vehicle.vehicle().pose.inverse_transform_point(&mover.position),
        ];
        assert!((seen - real).norm() < 1e-9);
    }
}

/// What "faster" means was decided by the true speed in training, and on a robot by the one that odometry tells.
#[test]
fn actions_start_from_what_is_sensed() {
    let odometry = OdometrySpec { distance_bias: 0.2, ..OdometrySpec::default() };
    let actions = ActionSpec::Accelerate { yaw_rates: vec![0.0] };
    let spec = NavSpec { odometry, env: EnvSpec { actions, ..EnvSpec::default() }, ..NavSpec::default() };
    let mut vehicle = Navigator::new(spec.build().unwrap(), 3, 0).unwrap();
    let [_, keep, faster] = [0, 1, 2];
    vehicle.act(faster).unwrap();
    let believed = vehicle.sensed().twist.x;
    assert_ne!(believed, vehicle.vehicle().twist.x);
    vehicle.act(keep).unwrap();
    assert_eq!(vehicle.sensed().last_command, Command::new(believed, 0.0));
}
