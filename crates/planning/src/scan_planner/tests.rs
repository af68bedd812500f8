use super::*;
use crate::trial::{End, Lidar, MAX_RANGE, Trial, boxed, jackal};
use crate::{Planned, PurePursuit};
use headway_sim::{Pose, Room, VehicleState, World};

/// What the vehicle senses at a place, handed to a planner.
fn update(planner: &mut ScanPlanner, world: &World, pose: Pose, goal: Point) -> Option<Route> {
    let scan = Lidar::new(360, MAX_RANGE).scan(world, &pose);
    sense(planner, &scan, pose, goal)
}

fn sense(planner: &mut ScanPlanner, scan: &[f32], pose: Pose, goal: Point) -> Option<Route> {
    let (vehicle, lidar) = (jackal().build().unwrap(), Lidar::new(360, MAX_RANGE));
    planner.update(&Sensed { goal, ..lidar.sensed(&vehicle, scan, &VehicleState::at_rest(pose)) }).cloned()
}

/// A U of walls open towards -x, whose bottom stands between the vehicle and the goal.
fn pocket() -> World {
    let bars = vec![boxed(5.0, 5.0, 0.2, 3.2), boxed(4.0, 6.5, 2.0, 0.2), boxed(4.0, 3.5, 2.0, 0.2)];
    World::new(Room::new(10.0, 10.0), bars).unwrap()
}

#[test]
fn a_free_way_is_a_straight_line_of_points_not_far_apart() {
    let world = World::new(Room::new(20.0, 20.0), vec![]).unwrap();
    let mut planner = ScanPlannerSpec::default().build().unwrap();
    let (start, goal) = (Pose::translation(4.0, 10.0), Point::new(14.03, 11.21));
    let route = update(&mut planner, &world, start, goal).unwrap();
    assert!((route.length() - 10.03_f64.hypot(1.21)).abs() < 1e-9);
    assert!(route.points().windows(2).all(|pair| (pair[1] - pair[0]).norm() < 0.1 + 1e-9));
    assert_eq!((route.at(0.0), route.at(99.0)), (Point::new(4.0, 10.0), goal));
}

#[test]
fn what_is_seen_to_close_the_route_makes_another() {
    let world = pocket();
    let mut planner = ScanPlannerSpec { replan_period: 1e3, ..ScanPlannerSpec::default() }.build().unwrap();
    let goal = Point::new(8.0, 5.0);
    // From 3.4 m away the bottom is not marked yet.
    let first = update(&mut planner, &world, Pose::translation(1.5, 5.0), goal).unwrap();
    assert!((first.length() - 6.5).abs() < 1e-9);
    let same = update(&mut planner, &world, Pose::translation(1.6, 5.0), goal).unwrap();
    assert_eq!(first, same);
    let other = update(&mut planner, &world, Pose::translation(3.0, 5.0), goal).unwrap();
    assert!(other.length() > 6.0, "{}", other.length());
    let is_clear = |point: &Point| planner.costmap().cost_at(point) < INSCRIBED;
    assert!(other.points().iter().all(is_clear));
}

#[test]
fn straying_and_another_goal_make_another_route() {
    let world = World::new(Room::new(20.0, 20.0), vec![]).unwrap();
    let mut planner = ScanPlannerSpec { replan_period: 1e3, ..ScanPlannerSpec::default() }.build().unwrap();
    let goal = Point::new(14.0, 10.0);
    let mut length = |y: f64, goal: Point| {
        (update(&mut planner, &world, Pose::translation(4.0, y), goal).unwrap().length() * 1e6).round() / 1e6
    };
    assert_eq!(length(10.0, goal), 10.0);
    assert_eq!(length(10.4, goal), 10.0);
    assert_eq!(length(10.0, Point::new(12.0, 10.0)), 8.0);
    assert_eq!(length(10.6, Point::new(12.0, 10.0)), 8.022_468);
}

#[test]
fn from_within_the_inflation_there_is_a_way_out() {
    // The middle is 0.28 m from the wall, and the inscribed radius is 0.31 m.
    let world = World::new(Room::new(10.0, 10.0), vec![]).unwrap();
    let costmap = CostmapSpec { footprint_clearing: false, ..CostmapSpec::default() };
    let mut planner = ScanPlannerSpec { costmap, ..ScanPlannerSpec::default() }.build().unwrap();
    let start = Pose::translation(5.0, 0.28);
    let route = update(&mut planner, &world, start, Point::new(8.0, 5.0)).unwrap();
    assert!(planner.costmap().cost_at(&start.translation.vector.into()) >= INSCRIBED);
    assert!(route.length() < 5.8);
    // A goal next to a wall is reached as well.
    assert!(update(&mut planner, &world, Pose::translation(7.0, 0.6), Point::new(9.0, 0.1)).is_some());
}

#[test]
fn where_there_is_no_way_the_last_route_stays_until_the_map_is_forgotten() {
    let mut planner =
        ScanPlannerSpec { patience: 1.0, reset_distance: 0.5, ..ScanPlannerSpec::default() }.build().unwrap();
    let (pose, goal) = (Pose::identity(), Point::new(4.0, 0.0));
    let mut sense = |ranges: f32| {
        let route = sense(&mut planner, &[ranges; 360], pose, goal);
        (route, planner.is_lost(), planner.costmap().map().marked().count() > 0)
    };
    let (first, ..) = sense(9.9);
    assert!(first.is_some());
    // Walled in all around, and then nothing is seen any more.
    assert_eq!(sense(1.0), (first.clone(), true, true));
    for _ in 0..15 {
        assert_eq!(sense(f32::NAN), (first.clone(), true, true));
    }
    let later: Vec<_> = (0..30).map(|_| sense(f32::NAN)).collect();
    assert!(later.iter().any(|(_, _, marked)| !marked));
    assert!(!later.last().unwrap().1);
}

#[test]
fn drives_out_of_a_pocket_and_round_it() {
    let spec =
        ScanPlannerSpec { costmap: CostmapSpec { padding: 0.15, ..CostmapSpec::default() }, ..Default::default() };
    let pursuit = PurePursuit { lookahead: 0.4, cruise_speed: 0.8, ..PurePursuit::default() };
    let mut driver = Planned::new(spec.build().unwrap(), pursuit);
    let (start, goal) = (Pose::translation(1.0, 5.0), Point::new(8.0, 5.0));
    let (world, vehicle) = (pocket(), jackal().build().unwrap());
    let trial = Trial { most_seconds: 40.0, ..Trial::new(&world, &vehicle, start, goal) };
    assert_eq!(trial.drive(&mut pursuit.clone()), End::Collided);
    let end = trial.drive(&mut driver);
    assert!(matches!(end, End::Arrived(_)), "{end:?}");
    // The same again, after a reset, to the bit.
    let route = driver.route().cloned();
    assert_eq!(trial.drive(&mut driver), end);
    assert_eq!(driver.route().cloned(), route);
    crate::Controller::reset(&mut driver);
    assert!(driver.route().is_none() && driver.planner().costmap().map().size() == (0, 0));
}

#[test]
fn specs_are_checked() {
    let costmap = CostmapSpec { latency: 11.0, ..CostmapSpec::default() };
    let error = ScanPlannerSpec { costmap, ..ScanPlannerSpec::default() }.build().unwrap_err();
    assert_eq!(error.to_string(), "costmap.latency = 11: must be from 0 to 10");
    assert!(ScanPlannerSpec { cost_factor: 60.0, ..ScanPlannerSpec::default() }.build().is_err());
}
