//! How episodes go and end: goals, collisions, time limits, new goals.

use std::sync::Arc;

use headway_env::{ActionSpec, Control, EnvSpec, Event, GoalHandling, Mdp, NavSpec, Navigator, RouteSource, StepEnd};
use headway_sim::{Command, GoalRule, Obstacle, Point, Pose, Room, Scenario, Shape, World};

const STRAIGHT: Command = Command::new(1.0, 0.0);

fn mdp(env: EnvSpec) -> Arc<Mdp> {
    NavSpec { env, ..NavSpec::default() }.build().unwrap()
}

/// A vehicle at (2, 5) facing +x in a 20 x 10 m room, with a goal and perhaps a post on its way.
fn navigator(env: EnvSpec, goal_x: f64, post_x: Option<f64>) -> Navigator {
    let post = |x| Obstacle { shape: Shape::Disc { radius: 0.2 }, x, y: 5.0, yaw: 0.0 };
    let world = World::new(Room::new(20.0, 10.0), post_x.map(post).into_iter().collect()).unwrap();
    let scenario = Scenario {
        world,
        start: Pose::translation(2.0, 5.0),
        goal: Point::new(goal_x, 5.0),
        goal_rule: GoalRule { distance: 4.0, clearance: 0.2 },
        crowd: None,
    };
    Navigator::in_scenario(mdp(env), scenario, 0, 0).unwrap()
}

fn drive_until(navigator: &mut Navigator, stop: impl Fn(&Navigator, StepEnd) -> bool) -> StepEnd {
    for _ in 0..1000 {
        let end = navigator.drive(STRAIGHT).unwrap();
        if stop(navigator, end) {
            return end;
        }
    }
    panic!("nothing happened");
}

#[test]
fn reaching_terminates_and_is_paid_100_by_r() {
    let mut vehicle = navigator(EnvSpec::default(), 5.0, None);
    assert_eq!(
        vehicle.drive(STRAIGHT).unwrap(),
        StepEnd { reward: 10.0, event: None, terminated: false, truncated: false }
    );
    let end = drive_until(&mut vehicle, |_, end| end.terminated);
    assert_eq!(end, StepEnd { reward: 100.0, event: Some(Event::Reach), terminated: true, truncated: false });
    assert_eq!(vehicle.transition().event, Some(Event::Reach));
    assert!(vehicle.transition().after.goal_distance <= 0.5);
    assert!(vehicle.transition().before.goal_distance > 0.5);
}

#[test]
fn a_collision_wins_over_a_goal_within_reach() {
    // Touching the post, the vehicle is 0.45 m from the goal in its middle: within the reach radius of 0.5,
    // which it enters in the same period, at 1 m/s and 0.2 m a period.
    for start in 0..20 {
        let mut vehicle =
            navigator(EnvSpec::default(), 5.0 + f64::from(start) * 0.01, Some(5.0 + f64::from(start) * 0.01));
        let end = drive_until(&mut vehicle, |_, end| end.terminated);
        let transition = vehicle.transition();
        if transition.event == Some(Event::Collision) && transition.after.goal_distance <= 0.5 {
            assert!(transition.before.goal_distance > 0.5);
            assert_eq!(end.reward, -100.0);
            return;
        }
    }
    panic!("no start led to both in one period");
}

#[test]
fn the_time_limit_truncates_and_does_not_terminate() {
    let env = EnvSpec { time_limit: 1.0, ..EnvSpec::default() };
    let mut vehicle = navigator(env, 15.0, None);
    let ends: Vec<_> = (0..5).map(|_| vehicle.drive(STRAIGHT).unwrap()).collect();
    assert!(ends.iter().all(|end| !end.terminated && end.reward == 10.0));
    let truncated: Vec<_> = ends.iter().map(|end| end.truncated).collect();
    assert_eq!(truncated, [false, false, false, false, true]);
}

#[test]
fn a_goal_reached_at_the_time_limit_terminates() {
    let mut vehicle = navigator(EnvSpec::default(), 5.0, None);
    let mut n_steps = 1;
    while !vehicle.drive(STRAIGHT).unwrap().terminated {
        n_steps += 1;
    }
    let env = EnvSpec { time_limit: 0.2 * f64::from(n_steps), ..EnvSpec::default() };
    let mut vehicle = navigator(env, 5.0, None);
    let end = drive_until(&mut vehicle, |_, end| end.terminated || end.truncated);
    assert!(end.terminated && !end.truncated);
}

#[test]
fn under_new_goal_reaching_is_paid_for_the_old_goal_and_shows_the_new_one() {
    let env = EnvSpec { goal: GoalHandling::NewGoal, time_limit: 4.0, ..EnvSpec::default() };
    let mut vehicle = navigator(env, 5.0, None);
    let end = drive_until(&mut vehicle, |v, _| v.transition().event == Some(Event::Reach));
    assert_eq!(end, StepEnd { reward: 100.0, event: Some(Event::Reach), terminated: false, truncated: false });
    // The step looks back at the old goal, 3 m from the start, in both of its states.
    let step = vehicle.transition();
    assert!((step.progress() - 0.2).abs() < 1e-9);
    assert!(step.after.goal_distance <= 0.5);
    // The next observation and the next step's states refer to the new one.
    let here = Point::from(vehicle.vehicle().pose.translation.vector);
    let to_new = nalgebra::distance(&here, &vehicle.goal());
    assert!(to_new >= 4.0);
    assert!((vehicle.sensed().goal_polar().0 - to_new).abs() < 1e-12);
    let mut obs = [0.0; 42];
    vehicle.observe(&mut obs);
    assert!((f64::from(obs[36]) - to_new / (to_new + 3.0)).abs() < 1e-6);
    vehicle.drive(STRAIGHT).unwrap();
    assert!((vehicle.transition().before.goal_distance - to_new).abs() < 1e-12);
}

#[test]
fn under_new_goal_the_time_limit_counts_from_the_last_goal() {
    let env = EnvSpec { goal: GoalHandling::NewGoal, time_limit: 4.0, ..EnvSpec::default() };
    let mut vehicle = navigator(env, 5.0, None);
    drive_until(&mut vehicle, |v, _| v.transition().event == Some(Event::Reach));
    let stand = Command::default();
    let n_more = (1..).find(|_| vehicle.drive(stand).unwrap().truncated);
    assert_eq!(n_more, Some(20)); // 4 s of 0.2 s
}

#[test]
fn under_new_goal_a_collision_still_terminates() {
    let env = EnvSpec { goal: GoalHandling::NewGoal, ..EnvSpec::default() };
    let mut vehicle = navigator(env, 15.0, Some(6.0));
    let end = drive_until(&mut vehicle, |_, end| end.terminated);
    assert_eq!(end.reward, -100.0);
    assert_eq!(vehicle.transition().event, Some(Event::Collision));
}

#[test]
fn speed_only_control_steers_round_what_is_in_the_way() {
    let env = EnvSpec {
        control: Control::SpeedOnly { pursuit: Default::default() },
        route: RouteSource::TrueMap(Default::default()),
        actions: ActionSpec::SetPoints { speeds: vec![0.3, 0.8, 1.5], yaw_rates: vec![0.0], lateral_speeds: vec![0.0] },
        ..EnvSpec::default()
    };
    let mut vehicle = navigator(env, 12.0, Some(6.0));
    assert!(vehicle.sensed().route.is_some_and(|route| route.length() > 10.0));
    let end = (0..300).map(|_| vehicle.act(1).unwrap()).find(|end| end.terminated || end.truncated);
    assert_eq!(end.map(|end| end.reward), Some(100.0));
}

#[test]
fn refusals_name_table_and_field() {
    let refused = |spec: NavSpec| spec.build().unwrap_err().to_string();
    let env = EnvSpec { reach_radius: -1.0, ..EnvSpec::default() };
    assert_eq!(
        refused(NavSpec { env, ..NavSpec::default() }),
        "env.reach_radius = -1: must be a finite number above 0"
    );
    let mut spec = NavSpec::default();
    spec.vehicle.footprint = Shape::Disc { radius: -0.25 };
    assert_eq!(refused(spec), "vehicle.footprint.radius = -0.25: must be a finite number above 0");
    let actions = ActionSpec::SetPoints { speeds: vec![9.0], yaw_rates: vec![0.0], lateral_speeds: vec![0.0] };
    let env = EnvSpec { actions, ..EnvSpec::default() };
    assert_eq!(
        refused(NavSpec { env, ..NavSpec::default() }),
        "env.actions.speeds.0 = 9: must be from 0 to 1.5, the vehicle's limits"
    );
}
