use super::*;
use crate::PurePursuit;
use crate::trial::Lidar;
use headway_sim::rand::RngExt;
use headway_sim::{
    ActuationSpec, Interval, Kinds, Point, Pose, Room, RoomSpec, Shape, Twist, Vehicle, VehicleState, World, WorldSpec,
    stream,
};
use proptest::prelude::*;
use std::f64::consts::TAU;

fn sensed<'a>(vehicle: &'a Vehicle, lidar: &'a Lidar, scan: &'a [f32], state: &VehicleState) -> Sensed<'a> {
    lidar.sensed(vehicle, scan, state)
}

/// Drivers that care for nothing.
#[derive(Debug, Clone)]
enum Reckless {
    AlwaysThis(Command),
    AtRandom(u64),
    AtTheNearest,
}

impl Controller for Reckless {
    fn reset(&mut self) {}

    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        match self {
            Self::AlwaysThis(command) => *command,
            Self::AtRandom(count) => {
                *count += 1;
                let mut rng = stream(*count, "reckless", 0);
                let command = Command::new(rng.random_range(-1.0..=3.0), rng.random_range(-4.0..=4.0));
                Command { lateral_speed: rng.random_range(-1.0..=1.0), ..command }
            }
            Self::AtTheNearest => {
                let beams = sensed.scan.iter().zip(sensed.beam_angles);
                let (_, angle) = beams.min_by(|a, b| a.0.total_cmp(b.0)).expect("there are beams");
                Command { lateral_speed: 3.0 * angle.sin(), ..Command::new(10.0, 5.0 * headway_sim::wrap(*angle)) }
            }
        }
    }
}

fn reckless(seed: u64) -> Reckless {
    match seed % 6 {
        0 => Reckless::AlwaysThis(Command::new(10.0, 0.0)),
        1 => Reckless::AlwaysThis(Command::new(10.0, 10.0)),
        2 => Reckless::AlwaysThis(Command::new(10.0, -0.4)),
        3 => Reckless::AtRandom(seed * 1000),
        4 => Reckless::AlwaysThis(Command { lateral_speed: -2.0, ..Command::new(1.0, 0.5) }),
        _ => Reckless::AtTheNearest,
    }
}

/// The distance driven, or the pose of a collision.
fn drive<C: Controller>(
    world: &World,
    vehicle: &Vehicle,
    lidar: &Lidar,
    mut state: VehicleState,
    shield: &mut Shield<C>,
    n_steps: usize,
) -> Result<f64, Pose> {
    let mut distance = 0.0;
    for _ in 0..n_steps {
        let scan = lidar.scan(world, &state.pose);
        let command = shield.command(&sensed(vehicle, lidar, &scan, &state));
        let motion = vehicle.step(world, &mut state, command);
        distance += motion.distance;
        if motion.collided {
            return Err(state.pose);
        }
    }
    Ok(distance)
}

fn drive_of(kind: usize) -> Drive {
    match kind {
        0 => Drive::Differential {},
        1 => Drive::Ackermann { wheelbase: 0.35, max_steering_angle: 0.5, max_steering_rate: 2.0 },
        _ => Drive::Omnidirectional { max_lateral_speed: 1.0 },
    }
}

fn footprint(kind: usize) -> Shape {
    match kind {
        0 => Shape::Disc { radius: 0.25 },
        1 => Shape::Box { length: 0.6, width: 0.3 },
        _ => Shape::Polygon { vertices: vec![[-0.2, -0.2], [0.3, -0.15], [0.3, 0.15], [-0.2, 0.2]] },
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn nothing_is_ever_hit(
        seed in 0..10_000_u64,
        (kind, drive_kind) in (0..3_usize, 0..3_usize),
        n_beams in 360..=720_usize,
        (n_late, n_less, n_more) in (0..10_usize, 0..5_usize, 0..3_usize),
        (has_lags, speed_lag, yaw_rate_lag) in (any::<bool>(), 0.01..0.5, 0.01..0.5),
        confidence in 0.5..=1.0,
        (max_speed, max_acceleration, max_reverse_speed) in (0.5..3.0, 0.5..4.0, 0.0..1.0),
        control_period in 0.05..0.3,
    ) {
        let limits = VehicleSpec { max_speed, max_acceleration, max_reverse_speed, ..VehicleSpec::default() };
        let [least, latency, most] =
            [n_late.saturating_sub(n_less), n_late, n_late + n_more].map(|n| n as f64 * control_period / 4.0);
        let actuation = ActuationSpec { latency, ..ActuationSpec::default() };
        let actuation = if has_lags { ActuationSpec { speed_lag, yaw_rate_lag, ..actuation } } else { actuation };
        let (footprint, drive_spec) = (footprint(kind), drive_of(drive_kind));
        let spec = VehicleSpec { footprint, drive: drive_spec, control_period, actuation, ..limits };
        let vehicle = spec.build().unwrap();
        let kinds = Kinds { disc: 1.0, r#box: 1.0, polygon: 1.0 };
        let room = RoomSpec { kinds, obstacle_radius: Interval::Range([0.1, 0.5]), ..RoomSpec::default() };
        let scenario = WorldSpec::Room(room).build(vehicle.footprint()).unwrap().scenario(seed, 0).unwrap();
        // What is told holds the latency, as it holds one that is drawn.
        let latency = Interval::Range([least, most]);
        let mut shield = ShieldSpec { confidence, latency, ..ShieldSpec::default() }.build(reckless(seed)).unwrap();
        let start = VehicleState::at_rest(scenario.start);
        let driven = drive(&scenario.world, &vehicle, &Lidar::new(n_beams, 8.0), start, &mut shield, 100);
        prop_assert!(driven.is_ok(), "hit at {}", driven.unwrap_err());
    }

    /// Far from all things and with time to brake, commands pass as they are, whatever they ask.
    #[test]
    fn what_is_harmless_passes_unchanged(speed in -1.0..5.0, yaw_rate in -5.0..5.0, kind in 0..3_usize) {
        let world = World::new(Room::new(12.0, 12.0), vec![]).unwrap();
        let vehicle = VehicleSpec { footprint: footprint(kind), ..VehicleSpec::default() }.build().unwrap();
        let (lidar, state) = (Lidar::new(360, 8.0), VehicleState::at_rest(Pose::translation(6.0, 6.0)));
        let scan = lidar.scan(&world, &state.pose);
        let command = Command::new(speed, yaw_rate);
        let mut shield = ShieldSpec::default().build(Reckless::AlwaysThis(command)).unwrap();
        prop_assert_eq!(shield.command(&sensed(&vehicle, &lidar, &scan, &state)), command);
        prop_assert_eq!((shield.interventions().n_commands, shield.interventions().n_vetoes), (1, 0));
    }
}

#[test]
fn it_stops_a_margin_before_a_wall() {
    let world = World::new(Room::new(20.0, 2.0), vec![]).unwrap();
    let vehicle = VehicleSpec::default().build().unwrap();
    // Straight towards the wall; all that turns aside is vetoed or harmless: it comes to stand near a wall.
    let mut shield = ShieldSpec::default().build(Reckless::AlwaysThis(Command::new(1.5, 0.0))).unwrap();
    let mut state = VehicleState::at_rest(Pose::translation(2.0, 1.0));
    let lidar = Lidar::new(720, 8.0);
    for _ in 0..300 {
        let scan = lidar.scan(&world, &state.pose);
        let command = shield.command(&sensed(&vehicle, &lidar, &scan, &state));
        assert!(!vehicle.step(&world, &mut state, command).collided);
    }
    let clearance = world.clearance(vehicle.footprint(), &state.pose);
    assert!((0.02..0.3).contains(&clearance), "{clearance}");
    assert!(state.twist.x.abs() < 0.2 && shield.interventions().n_vetoes > 0, "{}", state.twist);
}

#[test]
fn a_free_hall_costs_no_speed() {
    let world = World::new(Room::new(60.0, 60.0), vec![]).unwrap();
    let vehicle = VehicleSpec::default().build().unwrap();
    let (lidar, goal) = (Lidar::new(360, 5.0), Point::new(50.0, 40.0));
    let time_of = |driver: &mut dyn Controller| {
        let mut state = VehicleState::at_rest(Pose::translation(10.0, 10.0));
        for step in 0..1000 {
            if (Point::from(state.pose.translation.vector) - goal).norm() < 0.5 {
                return step;
            }
            let scan = lidar.scan(&world, &state.pose);
            let command = driver.command(&Sensed { goal, ..sensed(&vehicle, &lidar, &scan, &state) });
            vehicle.step(&world, &mut state, command);
        }
        panic!("never arrived");
    };
    let plain = time_of(&mut PurePursuit::default());
    let mut shield = ShieldSpec::default().build(PurePursuit::default()).unwrap();
    assert_eq!(time_of(&mut shield), plain);
    assert_eq!(shield.interventions().n_vetoes, 0);
}

/// A shield that parks is safe, and useless.
#[test]
fn the_random_driver_still_gets_about() {
    let lagging = ActuationSpec { speed_lag: 0.2, yaw_rate_lag: 0.1, ..ActuationSpec::default() };
    for (kind, actuation, least) in [
        (0, ActuationSpec::default(), 0.3),
        (0, lagging, 0.3),
        (1, ActuationSpec::default(), 0.15),
        (2, ActuationSpec::default(), 0.3),
    ] {
        let spec = VehicleSpec { drive: drive_of(kind), actuation, max_reverse_speed: 0.5, ..VehicleSpec::default() };
        let vehicle = spec.build().unwrap();
        let source = WorldSpec::default().build(vehicle.footprint()).unwrap();
        let distance: f64 = (0..10)
            .map(|seed| {
                let scenario = source.scenario(seed, 0).unwrap();
                let mut shield = ShieldSpec::default().build(reckless(3 + 6 * seed)).unwrap();
                let start = VehicleState::at_rest(scenario.start);
                drive(&scenario.world, &vehicle, &Lidar::new(360, 5.0), start, &mut shield, 300).unwrap()
            })
            .sum();
        assert!(distance / (10.0 * 300.0 * 0.2) > least, "drive {kind}: mean speed {}", distance / 600.0);
    }
}

#[test]
fn what_is_seen_no_farther_than_braking_limits_the_speed() {
    // 1.5 m/s with 0.8 x 2 m/s^2 need 0.70 m and a period; 0.8 m of range less outline and margin leave 0.5 m.
    let world = World::new(Room::new(60.0, 60.0), vec![]).unwrap();
    let vehicle = VehicleSpec::default().build().unwrap();
    let mut shield = ShieldSpec::default().build(Reckless::AlwaysThis(Command::new(1.5, 0.0))).unwrap();
    let (lidar, mut state) = (Lidar::new(360, 0.8), VehicleState::at_rest(Pose::translation(20.0, 30.0)));
    let mut fastest = 0.0_f64;
    for _ in 0..50 {
        let scan = lidar.scan(&world, &state.pose);
        let command = shield.command(&sensed(&vehicle, &lidar, &scan, &state));
        vehicle.step(&world, &mut state, command);
        fastest = fastest.max(state.twist.x);
        assert!(state.twist.x * state.twist.x / (2.0 * 1.6) <= 0.5);
    }
    assert!(fastest > 0.6 && fastest < 1.3, "{fastest}");
}

#[test]
fn latency_is_braked_for() {
    // At 1 m/s, something 1 m before the front: 0.2 m for a period, 0.3125 m to brake at 1.6 m/s^2, 0.05 m margin.
    let vehicle = VehicleSpec { max_acceleration: 2.0, ..VehicleSpec::default() }.build().unwrap();
    let lidar = Lidar { angles: vec![0.0], max_range: 8.0 };
    let passes = |latency: f64, room: f64| {
        let spec = ShieldSpec { latency: Interval::Fixed(latency), ..ShieldSpec::default() };
        let mut shield = spec.build(Reckless::AlwaysThis(Command::new(1.0, 0.0))).unwrap();
        let state = VehicleState { twist: Twist::new(1.0, 0.0, 0.0), ..VehicleState::at_rest(Pose::identity()) };
        for _ in 0..3 {
            shield.command(&sensed(&vehicle, &lidar, &[7.0], &state));
        }
        let n_before = shield.interventions().n_vetoes;
        shield.command(&sensed(&vehicle, &lidar, &[(room + 0.25) as f32], &state));
        shield.interventions().n_vetoes == n_before
    };
    // Whole substeps of 0.05 s at their mean speed: 1 m/s goes down by 0.08 m/s a substep, 0.3125 m and a little.
    assert!(passes(0.0, 0.58) && !passes(0.0, 0.55));
    assert!(passes(0.3, 0.88) && !passes(0.3, 0.85));
    assert!(passes(0.4, 0.98) && !passes(0.4, 0.95));
}

#[test]
fn corners_are_looked_after_on_the_spot() {
    let vehicle = VehicleSpec { footprint: footprint(1), ..VehicleSpec::default() }.build().unwrap();
    let lidar = Lidar { angles: vec![TAU / 4.0], max_range: 8.0 };
    let state = VehicleState::at_rest(Pose::identity());
    let turn = Command::new(0.0, 1.5);
    let given = |range: f32| {
        let mut shield = ShieldSpec::default().build(Reckless::AlwaysThis(turn)).unwrap();
        // Turning for some periods, with something beside the flank.
        shield.command(&sensed(
            &vehicle,
            &lidar,
            &[range],
            &VehicleState { twist: Twist::new(0.0, 0.0, 1.5), ..state.clone() },
        ))
    };
    assert_eq!(given(0.5), turn);
    assert_ne!(given(0.22), turn);
}

#[test]
fn without_beams_all_passes() {
    let vehicle = VehicleSpec::default().build().unwrap();
    let (lidar, state) = (Lidar { angles: vec![], max_range: 5.0 }, VehicleState::at_rest(Pose::identity()));
    let command = Command { lateral_speed: 1.0, ..Command::new(9.0, 9.0) };
    let mut shield = ShieldSpec::default().build(Reckless::AlwaysThis(command)).unwrap();
    assert_eq!(shield.command(&sensed(&vehicle, &lidar, &[], &state)), command);
}

#[test]
fn refusals_name_the_field() {
    let refusal = |spec: ShieldSpec| spec.build(PurePursuit::default()).unwrap_err().field;
    assert_eq!(refusal(ShieldSpec { margin: 0.0, ..ShieldSpec::default() }), "margin");
    assert_eq!(refusal(ShieldSpec { confidence: f64::NAN, ..ShieldSpec::default() }), "confidence");
    assert_eq!(refusal(ShieldSpec { latency: Interval::Fixed(-1.0), ..ShieldSpec::default() }), "latency");
    assert_eq!(refusal(ShieldSpec { latency: Interval::Range([0.2, 0.1]), ..ShieldSpec::default() }), "latency");
}

/// What the tests above would find: a shield that knows nothing of a latency does not keep a vehicle safe from it.
#[test]
fn a_latency_that_is_not_told_is_not_braked_for() {
    let world = World::new(Room::new(20.0, 2.0), vec![]).unwrap();
    let actuation = ActuationSpec { latency: 0.6, ..ActuationSpec::default() };
    let vehicle = VehicleSpec { max_speed: 3.0, actuation, ..VehicleSpec::default() }.build().unwrap();
    let start = VehicleState::at_rest(Pose::translation(2.0, 1.0));
    let end = |latency: f64| {
        let spec = ShieldSpec { latency: Interval::Fixed(latency), confidence: 1.0, ..ShieldSpec::default() };
        let mut shield = spec.build(Reckless::AlwaysThis(Command::new(3.0, 0.0))).unwrap();
        drive(&world, &vehicle, &Lidar::new(360, 8.0), start.clone(), &mut shield, 150)
    };
    assert!(end(0.0).is_err() && end(0.6).is_ok());
}

/// A shield told the greatest latency only lets vehicles of lesser ones hit something: they turn sooner than it foresees.
#[test]
fn no_latency_is_the_worst_one() {
    let is_hit = |seed: u64, n_late: u32, told: Interval| {
        let limits = VehicleSpec { max_reverse_speed: 0.5, ..VehicleSpec::default() };
        let actuation = ActuationSpec { latency: f64::from(n_late) * 0.05, ..ActuationSpec::default() };
        let vehicle = VehicleSpec { actuation, ..limits }.build().unwrap();
        let scenario = WorldSpec::default().build(vehicle.footprint()).unwrap().scenario(seed, 0).unwrap();
        let mut shield = ShieldSpec { latency: told, ..ShieldSpec::default() }.build(reckless(3 + 6 * seed)).unwrap();
        let start = VehicleState::at_rest(scenario.start);
        drive(&scenario.world, &vehicle, &Lidar::new(360, 8.0), start, &mut shield, 100).is_err()
    };
    let n_hits = |told: Interval| (0..45).filter(|k| is_hit(u64::from(*k), k % 9, told)).count();
    assert!(n_hits(Interval::Fixed(0.4)) > 0);
    assert_eq!(n_hits(Interval::Range([0.0, 0.4])), 0);
}

/// Of more than a hundred possible latencies some are not looked at. Vehicles of such ones, halfway between two that are, hit
/// nothing either: nothing proves it, drives show it.
#[test]
fn latencies_that_are_not_looked_at_are_safe_too() {
    // Substeps of 5 ms and all latencies that a vehicle may have, 401: each of the hundred looked at is 20 ms from the next.
    let told = Interval::Range([0.0, 2.0]);
    let limits = VehicleSpec { max_reverse_speed: 0.5, n_substeps: 40, ..VehicleSpec::default() };
    let distances = (0..33_u32).map(|k| {
        let actuation = ActuationSpec { latency: f64::from(4 * k + 2) * 0.005, ..ActuationSpec::default() };
        let vehicle = VehicleSpec { actuation, drive: drive_of(k as usize % 3), ..limits.clone() }.build().unwrap();
        let seed = u64::from(k);
        let scenario = WorldSpec::default().build(vehicle.footprint()).unwrap().scenario(seed, 0).unwrap();
        let mut shield = ShieldSpec { latency: told, ..ShieldSpec::default() }.build(reckless(seed / 3)).unwrap();
        let start = VehicleState::at_rest(scenario.start);
        let driven = drive(&scenario.world, &vehicle, &Lidar::new(360, 8.0), start, &mut shield, 100);
        driven.unwrap_or_else(|pose| panic!("number {k} hit something at {pose}"))
    });
    let distance: f64 = distances.sum();
    assert!(distance > 100.0, "they get about: {distance} m");
}
