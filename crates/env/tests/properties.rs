//! What holds for every episode: equal seeds, saved states, batches, symmetries.

use std::sync::Arc;

use headway_env::{
    ActionSpec, Distribution, Env, EnvSpec, GoalHandling, NavEnv, NavSpec, Navigator, ObservationSpec, RouteSource,
    Step, TrueMapSpec,
};
use headway_planning::ScanPlannerSpec;
use headway_reward::{Heading, Progress, Proximity, RCouple, Sum};
use headway_sensors::LidarSpec;
use headway_sim::{
    Command, GoalRule, Interval, Kinds, Obstacle, Point, Pose, Quantity, Room, RoomSpec, Scenario, Shape, VehicleSpec,
    World, WorldSpec, stream,
};
use proptest::prelude::*;
use rand::RngExt;

fn spec(goal: GoalHandling) -> NavSpec {
    let reward = Sum::default()
        .with(1.0, RCouple::default())
        .with(40.0, Progress::default())
        .with(5.0, Heading::default())
        .with(-5.0, Proximity::default());
    NavSpec {
        lidar: LidarSpec { noise: 0.02, dropout: 0.02, ..LidarSpec::default() },
        env: EnvSpec { goal, time_limit: 8.0, ..EnvSpec::default() },
        reward: Arc::new(reward),
        ..NavSpec::default()
    }
}

fn env(goal: GoalHandling, n_envs: usize, seed: u64) -> (NavEnv, Step) {
    let mut env = NavEnv::new(spec(goal).build().unwrap(), n_envs);
    let mut step = Step::new(n_envs, env.obs_dim());
    env.reset(seed, &mut step.obs).unwrap();
    (env, step)
}

/// The steps that follow when every copy acts at random, by a stream of its own.
fn roll(env: &mut NavEnv, step: &mut Step, n_steps: u64, first: u64) -> Vec<Step> {
    (first..first + n_steps)
        .map(|k| {
            let act = |i| stream(9, "actions", 1000 * k + i as u64).random_range(0..12);
            let actions: Vec<u32> = (0..env.n_envs()).map(act).collect();
            env.step(&actions, step).unwrap();
            step.clone()
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn equal_seeds_give_equal_episodes(seed in 0..u64::MAX, new_goal: bool) {
        let goal = if new_goal { GoalHandling::NewGoal } else { GoalHandling::Terminate };
        let ((mut a, mut step_a), (mut b, mut step_b)) = (env(goal, 3, seed), env(goal, 3, seed));
        prop_assert_eq!(&step_a, &step_b);
        prop_assert_eq!(roll(&mut a, &mut step_a, 60, 0), roll(&mut b, &mut step_b, 60, 0));
        let (_, other) = env(goal, 3, seed.wrapping_add(1));
        prop_assert_ne!(env(goal, 3, seed).1, other);
    }

    #[test]
    fn a_saved_environment_goes_on_as_if_nothing_had_happened(seed in 0..u64::MAX, n_before in 0..90_u64) {
        let (mut whole, mut step) = env(GoalHandling::NewGoal, 2, seed);
        roll(&mut whole, &mut step, n_before, 0);
        let mut bytes = Vec::new();
        whole.save(&mut bytes).unwrap();
        let (mut resumed, _) = env(GoalHandling::NewGoal, 2, seed ^ 1);
        resumed.load(&mut bytes.as_slice()).unwrap();
        let mut again = step.clone();
        prop_assert_eq!(
            roll(&mut whole, &mut step, 90, n_before),
            roll(&mut resumed, &mut again, 90, n_before)
        );
    }

    #[test]
    fn observations_are_finite_and_within_bounds(seed in 0..u64::MAX) {
        let (mut env, mut step) = env(GoalHandling::Terminate, 4, seed);
        for step in roll(&mut env, &mut step, 80, 0) {
            prop_assert!(step.next_obs.iter().chain(&step.obs).all(|x| (-1.0..=1.0).contains(x)));
            prop_assert!(step.rewards.iter().all(|r| r.is_finite()));
            prop_assert!(step.terminated.iter().zip(&step.truncated).all(|(a, b)| !(a & b)));
        }
    }

    /// The same scene turned, moved, or seen in a mirror is worth the same, and mirrored drivers choose the
    /// same actions on the same observations.
    #[test]
    fn symmetries(
        posts in prop::collection::vec((-3.0..3.0, -3.0..3.0, 0.1..0.4), 0..5),
        goal in (2.0..4.0, -4.0..4.0), turn in -3.0..3.0, shift in (-50.0..50.0, -50.0..50.0),
        actions in prop::collection::vec(0..12_u32, 20),
    ) {
        let clear = posts.iter().all(|(x, y, radius)| f64::hypot(*x, *y) > radius + 0.4);
        prop_assume!(clear);
        let here = Pose::translation(100.0, 100.0);
        let moved = Pose::new([100.0 + shift.0, 100.0 + shift.1].into(), turn);
        let mut plain = scene(&posts, goal, &here, 1.0);
        let mut turned = scene(&posts, goal, &moved, 1.0);
        let mut mirrored = scene(&posts, goal, &here, -1.0);
        for action in actions {
            let [a, b, c] = [&mut plain, &mut turned, &mut mirrored].map(|navigator| {
                let mut obs = [0.0; 42];
                navigator.observe(&mut obs);
                (obs, navigator.act(action).unwrap())
            });
            for ((x, y), z) in a.0.iter().zip(&b.0).zip(&c.0) {
                prop_assert!((x - y).abs() < 1e-3 && (x - z).abs() < 1e-3, "{x} {y} {z}");
            }
            prop_assert!((a.1.reward - b.1.reward).abs() < 1e-3, "{} {}", a.1.reward, b.1.reward);
            prop_assert!((a.1.reward - c.1.reward).abs() < 1e-3, "{} {}", a.1.reward, c.1.reward);
            if a.1.terminated {
                break;
            }
        }
    }
}

/// A vehicle among posts given in its own frame, at `at` in a hall whose walls are out of sight; `left` is
/// -1 for the mirror image.
fn scene(posts: &[(f64, f64, f64)], goal: (f64, f64), at: &Pose, left: f64) -> Navigator {
    let place = |(x, y, radius): &(f64, f64, f64)| {
        let point = at * Point::new(*x, left * y);
        Obstacle { shape: Shape::Disc { radius: *radius }, x: point.x, y: point.y, yaw: 0.0 }
    };
    let world = World::new(Room::new(200.0, 200.0), posts.iter().map(place).collect()).unwrap();
    let goal_rule = GoalRule { distance: 4.0, clearance: 0.2 };
    let scenario = Scenario { world, start: *at, goal: at * Point::new(goal.0, left * goal.1), goal_rule, crowd: None };
    let quiet = NavSpec { lidar: LidarSpec::default(), ..spec(GoalHandling::Terminate) };
    Navigator::in_scenario(quiet.build().unwrap(), scenario, 0, 0).unwrap()
}

#[test]
fn scenarios_do_not_depend_on_the_size_of_the_batch() {
    let (one, two) = (env(GoalHandling::Terminate, 1, 5).0, env(GoalHandling::Terminate, 4, 5).0);
    let start = |env: &NavEnv, i: usize| env.navigators()[i].scenario().start;
    assert_eq!(start(&one, 0), start(&two, 0));
    let third = Navigator::new(Arc::clone(two.mdp()), 5, 2).unwrap();
    assert_eq!(third.scenario().start, start(&two, 2));
}

#[test]
fn commands_and_the_actions_that_mean_them_do_the_same() {
    let unmirrored = NavSpec {
        env: EnvSpec { observation: ObservationSpec { mirror: false, ..Default::default() }, ..Default::default() },
        ..NavSpec::default()
    };
    let [mut a, mut b] = [0, 1].map(|_| NavEnv::new(unmirrored.build().unwrap(), 2));
    let mut step = Step::new(2, a.obs_dim());
    a.reset(3, &mut step.obs).unwrap();
    b.reset(3, &mut step.obs).unwrap();
    let mut other = step.clone();
    a.step(&[8, 10], &mut step).unwrap();
    let commands = [(1.0, 1.5), (1.5, 0.0)].map(|(speed, yaw_rate)| Command::new(speed, yaw_rate));
    b.step_commands(&commands, &mut other).unwrap();
    assert_eq!(step, other);
}

#[test]
fn misuse_is_an_error() {
    let (mut env, mut step) = env(GoalHandling::Terminate, 2, 0);
    let message = env.step(&[0, 12], &mut step).unwrap_err().to_string();
    assert_eq!(message, "action 12 in environment 1: there are 12 actions, 0 to 11");
    let message = env.step(&[0], &mut step).unwrap_err().to_string();
    assert_eq!(message, "actions holds 1 entries: must be 2");
    let mut bytes = Vec::new();
    env.save(&mut bytes).unwrap();
    let mut larger = NavEnv::new(Arc::clone(env.mdp()), 3);
    let message = larger.load(&mut bytes.as_slice()).unwrap_err().to_string();
    assert_eq!(message, "the saved state holds 2 environments, this environment 3");
    assert!(larger.load(&mut &bytes[..bytes.len() / 2]).is_err());
    assert!(larger.step(&[0; 3], &mut Step::new(3, 42)).is_err()); // not reset yet
}

#[test]
fn a_reset_that_fails_leaves_all_as_it_was() {
    let route = RouteSource::TrueMap(TrueMapSpec { cell: 0.02, ..TrueMapSpec::default() });
    let env_spec = EnvSpec { route, ..EnvSpec::default() };
    let mut env = NavEnv::new(NavSpec { env: env_spec, ..NavSpec::default() }.build().unwrap(), 2);
    let mut step = Step::new(2, env.obs_dim());
    env.reset(3, &mut step.obs).unwrap();
    let state = |env: &NavEnv| {
        let mut bytes = Vec::new();
        env.save(&mut bytes).unwrap();
        bytes
    };
    // A map of it would have 625 000 000 cells.
    let side = Interval::Fixed(500.0);
    let obstacles = Quantity::Count(0);
    let huge = RoomSpec { width: side, height: side, obstacles, start_goal_clearance: 0.5, ..RoomSpec::default() };
    env.set_world(&WorldSpec::Room(huge)).unwrap();
    let before = state(&env);
    let error = env.reset(4, &mut step.obs).unwrap_err().to_string();
    assert!(error.starts_with("a map of 500 x 500 m in cells of 0.02 m"), "{error}");
    assert_eq!(state(&env), before);
}

#[test]
fn a_state_of_other_rules_is_refused_by_name() {
    let planned = |planner: ScanPlannerSpec| {
        let env = EnvSpec { route: RouteSource::Scans(planner), ..EnvSpec::default() };
        NavSpec { env, ..NavSpec::default() }
    };
    let randomize = [("vehicle.actuation.latency".to_owned(), Distribution::Uniform([0.0, 0.1]))].into();
    let specs = [
        NavSpec::default(),
        NavSpec { randomize, ..NavSpec::default() },
        planned(ScanPlannerSpec::default()),
        planned(ScanPlannerSpec { stray: 0.7, ..ScanPlannerSpec::default() }),
    ];
    let start = |spec: &NavSpec| {
        let mut env = NavEnv::new(spec.build().unwrap(), 1);
        let mut step = Step::new(1, env.obs_dim());
        env.reset(0, &mut step.obs).unwrap();
        env
    };
    let load = |from: usize, into: usize| {
        let mut bytes = Vec::new();
        start(&specs[from]).save(&mut bytes).unwrap();
        start(&specs[into]).load(&mut bytes.as_slice()).map_err(|error| error.to_string())
    };
    for (from, into, expected) in [
        (0, 1, "the saved state holds 0 numbers drawn anew each episode, this environment 1"),
        (1, 0, "the saved state holds 1 numbers drawn anew each episode, this environment 0"),
        (0, 2, "the saved state holds 0 planners over scans, this environment 1"),
        (2, 0, "the saved state holds 1 planners over scans, this environment 0"),
        (2, 3, "the saved state's planner has other numbers than this environment's (env.route)"),
    ] {
        assert_eq!(load(from, into), Err(expected.to_owned()));
    }
    assert!((0..specs.len()).all(|k| load(k, k).is_ok()));
}

#[test]
fn specs_survive_toml() {
    let text = toml::to_string(&spec(GoalHandling::NewGoal)).unwrap();
    let back: NavSpec = toml::from_str(&text).unwrap();
    assert_eq!(toml::to_string(&back).unwrap(), text);
}

#[test]
fn threads_change_nothing() {
    // Neither a power of two nor a multiple of what a thread takes at a time; every copy acts on its own.
    let (mut alone, mut step) = env(GoalHandling::NewGoal, 150, 4);
    let expected = roll(&mut alone, &mut step, 60, 0);
    assert!(expected.iter().flat_map(|step| &step.terminated).filter(|ended| **ended).count() > 100, "many restarts");
    for n_threads in [2, 3] {
        let (sharded, mut step) = env(GoalHandling::NewGoal, 150, 4);
        let mut sharded = sharded.on_threads(n_threads.try_into().unwrap()).unwrap();
        assert_eq!(roll(&mut sharded, &mut step, 60, 0), expected);
    }
}

/// A failed restart took the navigator's memory along, and the next step panicked.
#[test]
fn a_failed_restart_leaves_all_as_it_was() {
    let kinds = Kinds { disc: 0.0, r#box: 1.0, polygon: 0.0 };
    let room = RoomSpec {
        width: Interval::Fixed(8.0),
        height: Interval::Fixed(8.0),
        obstacles: Quantity::Density(Interval::Fixed(0.35)),
        kinds,
        obstacle_radius: Interval::Range([0.3, 0.8]),
        min_gap: 0.05,
        start_goal_distance: 2.0,
        start_goal_clearance: 0.02,
        crowd: None,
    };
    let route = RouteSource::TrueMap(TrueMapSpec { cell: 0.5, ..Default::default() });
    let vehicle = VehicleSpec { footprint: Shape::Disc { radius: 0.02 }, ..VehicleSpec::default() };
    let actions = ActionSpec::SetPoints { speeds: vec![0.5, 1.0], yaw_rates: vec![0.0], lateral_speeds: vec![0.0] };
    let env = EnvSpec { route, actions, ..EnvSpec::default() };
    let mdp = NavSpec { world: WorldSpec::Room(room), vehicle, env, ..NavSpec::default() }.build().unwrap();
    let mut navigator = (0..).find_map(|index| Navigator::new(Arc::clone(&mdp), 1, index).ok()).unwrap();
    let mut before = vec![0.0; mdp.obs_dim()];
    navigator.observe(&mut before);
    let failed = (0..2000).find(|index| navigator.clone().restart(1, *index).is_err()).expect("one without a route");
    assert!(navigator.restart(1, failed).unwrap_err().to_string().starts_with("no route from"));
    let mut after = before.clone();
    navigator.observe(&mut after);
    assert_eq!(before, after);
}
