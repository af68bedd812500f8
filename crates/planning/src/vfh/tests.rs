use super::*;
use crate::trial::{End, Lidar, Trial};
use crate::{GridMap, ShieldSpec, plan};
use headway_sim::{Pose, Shape, Twist, Vehicle, VehicleSpec, VehicleState, WorldSpec};

fn driver() -> Vfh {
    VfhSpec::default().build().unwrap()
}

/// The first command at the origin towards a goal 5 m ahead, with these beams: angles in degrees, ranges in metres.
fn command_with(driver: &mut Vfh, beams: &[(f64, f32)], speed: f64) -> Command {
    let vehicle = VehicleSpec::default().build().unwrap();
    let (angles, scan): (Vec<_>, Vec<_>) = beams.iter().map(|(angle, range)| (angle.to_radians(), *range)).unzip();
    let lidar = Lidar { angles, max_range: 10.0 };
    let state = VehicleState { twist: Twist::new(speed, 0.0, 0.0), ..VehicleState::at_rest(Pose::identity()) };
    let goal = Point::new(5.0, 0.0);
    driver.command(&Sensed { goal, ..lidar.sensed(&vehicle, &scan, &state) })
}

#[test]
fn drives_straight_where_nothing_is_in_the_way() {
    assert_eq!(command_with(&mut driver(), &[(90.0, 3.0)], 0.0), Command::new(1.0, 0.0));
}

#[test]
fn passes_one_obstacle_on_the_cheaper_side() {
    // 1 m away, 10 degrees to the left, blocking asin(0.35) = 20.5 degrees to both sides: sectors -10 to 30 degrees.
    // The valley's edge to the right is -15 degrees, its candidate 8 sectors inside: -55 degrees, more than 45: a turn
    // on the spot.
    let command = command_with(&mut driver(), &[(10.0, 1.0)], 0.0);
    assert_eq!(command, Command::new(0.0, -1.5));
    // Mirrored.
    assert_eq!(command_with(&mut driver(), &[(-10.0, 1.0)], 0.0), Command::new(0.0, 1.5));
}

#[test]
fn a_gap_is_driven_through_in_its_middle() {
    // Two posts 1 m away at 30 degrees to both sides block 10 to 50 degrees: one narrow valley from -5 to 5 degrees,
    // and a wide one behind.
    let command = command_with(&mut driver(), &[(30.0, 1.0), (-30.0, 1.0)], 0.0);
    assert!(command.yaw_rate.abs() < 1e-9 && command.speed > 0.9, "{command:?}");
}

#[test]
fn blocked_sectors_stay_blocked_until_things_are_farther() {
    let mut driver = driver();
    let at = |driver: &mut Vfh, range: f32| command_with(driver, &[(0.0, range)], 0.0).speed;
    assert!(at(&mut driver, 1.3) > 0.5);
    assert_eq!(at(&mut driver, 1.1), 0.0);
    assert_eq!(at(&mut driver, 1.3), 0.0);
    assert!(at(&mut driver, 1.5) > 0.5);
    driver.reset();
    assert!(at(&mut driver, 1.3) > 0.5);
}

#[test]
fn brakes_for_what_is_ahead() {
    // Free ahead: 0.8 - 0.25 - 0.1 = 0.45 m, but blocked all round so that it goes straight on to the farthest.
    let mut beams: Vec<(f64, f32)> = (0..36).map(|k| (f64::from(k) * 10.0, 0.5)).collect();
    beams.retain(|(angle, _)| (60.0..=300.0).contains(angle));
    beams.push((0.0, 0.8));
    beams.extend([(40.0, 0.79), (-40.0, 0.79)]);
    let command = command_with(&mut driver(), &beams, 0.0);
    assert!(command.speed <= (2.0 * 0.45_f64).sqrt() + 1e-6 && command.speed > 0.0, "{command:?}");
}

/// How many of 20 scenarios end in an arrival, and in a collision.
fn ends(vehicle: &Vehicle, has_route: bool, driver: &mut dyn Controller) -> (usize, usize) {
    let source = WorldSpec::Room10x15 {}.build(vehicle.footprint()).unwrap();
    let radius = vehicle.footprint().circumradius();
    let end = |index: u64| {
        let scenario = source.scenario(11, index).unwrap();
        let map = GridMap::from_world(&scenario.world, 0.1, radius + 0.1);
        let start = Point::from(scenario.start.translation.vector);
        let route = plan(&map, &start, &scenario.goal).filter(|_| has_route);
        let trial = Trial::new(&scenario.world, vehicle, scenario.start, scenario.goal);
        Trial { lidar: Lidar::new(360, 5.0), route: route.as_ref(), ..trial }.drive(driver)
    };
    let ends: Vec<End> = (0..20).map(end).collect();
    let count = |wanted: fn(&End) -> bool| ends.iter().filter(|end| wanted(end)).count();
    (count(|end| matches!(end, End::Arrived(_))), count(|end| *end == End::Collided))
}

#[test]
fn finds_its_way_without_a_map_and_along_routes() {
    let disc = VehicleSpec::default().build().unwrap();
    assert_eq!(ends(&disc, false, &mut driver()), (20, 0));
    assert_eq!(ends(&disc, true, &mut driver()), (20, 0));
}

#[test]
fn a_box_finds_its_way_with_a_shield() {
    let footprint = Shape::Box { length: 0.6, width: 0.4 };
    let boxed = VehicleSpec { footprint, ..VehicleSpec::default() }.build().unwrap();
    assert_eq!(ends(&boxed, false, &mut ShieldSpec::default().build(driver()).unwrap()), (20, 0));
}

#[test]
fn refusals_name_the_field() {
    let refusal = |spec: VfhSpec| spec.build().unwrap_err().field;
    let spec = VfhSpec::default();
    assert_eq!(refusal(VfhSpec { n_sectors: 4, ..spec }), "n_sectors");
    assert_eq!(refusal(VfhSpec { n_wide: 100, ..spec }), "n_wide");
    assert_eq!(refusal(VfhSpec { heading_weight: -1.0, ..spec }), "heading_weight");
}
