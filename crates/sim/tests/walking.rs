//! Crowds in random rooms: nobody overlaps, nobody jumps, and the same seed walks the same way.

use headway_sim::{
    Crowd, CrowdMotion, CrowdSpec, Footprint, Interval, Kinds, Mover, Point, Quantity, RoomSpec, Scenario, Shape,
    SimError, World, WorldSpec, stream,
};
use nalgebra::Vector2;
use proptest::prelude::*;

const DT: f64 = 0.2;
const SPEEDS: [f64; 2] = [0.3, 1.5];

fn motion() -> impl Strategy<Value = CrowdMotion> {
    prop_oneof![
        (2..6_usize).prop_map(|n_points| CrowdMotion::Waypoints { n_points, loops: vec![] }),
        (0.0..2.0).prop_map(|turning| CrowdMotion::RandomWalk { turning }),
        (0.5..4.0, 0.2..2.0)
            .prop_map(|(horizon, obstacle_horizon)| CrowdMotion::Reciprocal { horizon, obstacle_horizon }),
    ]
}

fn all_kinds() -> Kinds {
    Kinds { disc: 1.0, r#box: 1.0, polygon: 1.0 }
}

fn room(n_obstacles: usize) -> Scenario {
    let room = RoomSpec { kinds: all_kinds(), obstacles: Quantity::Count(n_obstacles), ..RoomSpec::default() };
    let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
    WorldSpec::Room(RoomSpec { min_gap: 0.3, ..room }).build(&vehicle).unwrap().scenario(3, 0).unwrap()
}

fn crowd(motion: CrowdMotion, avoids_vehicle: Option<bool>, seed: u64, scenario: &Scenario) -> (World, Crowd) {
    let (n_movers, speed) = (Interval::Range([4.0, 12.0]), Interval::Range(SPEEDS));
    let spec = CrowdSpec { n_movers, speed, kinds: all_kinds(), avoids_vehicle, motion, ..CrowdSpec::default() };
    let mut world = scenario.world.clone();
    let ends = [scenario.start.translation.vector.into(), scenario.goal].map(|end| (end, 0.25));
    let crowd = spec.build(&mut world, &ends, &mut stream(seed, "crowd", 0)).unwrap();
    (world, crowd)
}

/// A vehicle that stands at the start.
fn standing(scenario: &Scenario) -> Mover {
    Mover { position: scenario.start.translation.vector.into(), velocity: Vector2::zeros(), radius: 0.25 }
}

/// Asserts that nobody overlaps anything.
fn assert_apart(world: &World, crowd: &Crowd, still: &World, vehicle: Option<&Mover>) {
    for (i, mover) in crowd.movers().iter().enumerate() {
        assert!(still.distance(&mover.position) >= mover.radius + 1e-4);
        assert_eq!(mover.position, Point::new(world.movers()[i].x, world.movers()[i].y));
        for other in crowd.movers()[..i].iter().chain(vehicle) {
            assert!((mover.position - other.position).norm() >= mover.radius + other.radius + 1e-4);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn nobody_overlaps_nor_jumps(motion in motion(), seed in 0..1000_u64, many in any::<bool>(), avoids in any::<bool>()) {
        let scenario = room(if many { 30 } else { 10 });
        let (mut world, mut crowd) = crowd(motion, Some(avoids), seed, &scenario);
        let vehicle = standing(&scenario);
        let regarded = avoids.then_some(&vehicle);
        assert_apart(&world, &crowd, &scenario.world, regarded);
        let mut walked = 0.0;
        for _ in 0..200 {
            let before = crowd.movers().to_vec();
            crowd.step(&mut world, DT, Some(&vehicle));
            assert_apart(&world, &crowd, &scenario.world, regarded);
            for (mover, before) in crowd.movers().iter().zip(&before) {
                let way = mover.position - before.position;
                prop_assert!(way.norm() <= SPEEDS[1] * DT + 1e-9);
                prop_assert!((way / DT - mover.velocity).norm() < 1e-9);
                walked += way.norm();
            }
        }
        let mean_speed = walked / (200.0 * DT * crowd.movers().len() as f64);
        prop_assert!(mean_speed > 0.15, "they walk: {mean_speed} m/s");
    }

    #[test]
    fn a_crowd_goes_on_from_what_is_written_of_it(motion in motion(), seed in 0..1000_u64, n in 0..60_usize) {
        let scenario = room(24);
        let vehicle = standing(&scenario);
        let (mut world, mut crowd) = crowd(motion.clone(), None, seed, &scenario);
        let (mut same_world, mut same) = self::crowd(motion, None, seed, &scenario);
        for _ in 0..n {
            crowd.step(&mut world, DT, Some(&vehicle));
            same.step(&mut same_world, DT, Some(&vehicle));
        }
        prop_assert_eq!(&same, &crowd);
        let bytes = rmp_serde::to_vec(&(&world, &crowd)).unwrap();
        let (mut read_world, mut read): (World, Crowd) = rmp_serde::from_slice(&bytes).unwrap();
        read.check(&read_world).unwrap();
        for _ in 0..60 {
            crowd.step(&mut world, DT, Some(&vehicle));
            read.step(&mut read_world, DT, Some(&vehicle));
        }
        prop_assert_eq!(&read, &crowd);
        prop_assert_eq!(read_world.obstacles(), world.obstacles());
    }
}

#[test]
fn who_does_not_regard_the_vehicle_walks_as_if_there_were_none() {
    for motion in [CrowdMotion::default(), CrowdMotion::RandomWalk { turning: 0.3 }] {
        let scenario = room(8);
        let (mut world, mut crowd) = crowd(motion.clone(), None, 1, &scenario);
        let (mut alone_world, mut alone) = self::crowd(motion, None, 1, &scenario);
        assert!(!crowd.regards_vehicle());
        for _ in 0..100 {
            crowd.step(&mut world, DT, Some(&standing(&scenario)));
            alone.step(&mut alone_world, DT, None);
        }
        assert_eq!(crowd, alone);
    }
}

#[test]
fn waypoints_are_walked_at_constant_speed() {
    let spec = CrowdSpec {
        n_movers: Interval::Fixed(1.0),
        speed: Interval::Fixed(0.7),
        motion: CrowdMotion::Waypoints { n_points: 5, loops: vec![] },
        ..CrowdSpec::default()
    };
    let mut world = room(10).world;
    let mut crowd = spec.build(&mut world, &[], &mut stream(2, "crowd", 0)).unwrap();
    let first = crowd.movers()[0].position;
    assert!((crowd.movers()[0].velocity.norm() - 0.7).abs() < 1e-12);
    let (mut has_left, mut is_back) = (false, false);
    for _ in 0..4000 {
        let from = crowd.movers()[0].position;
        crowd.step(&mut world, 0.05, None);
        let way = (crowd.movers()[0].position - from).norm();
        assert!(way <= 0.035 + 1e-12);
        has_left |= (crowd.movers()[0].position - first).norm() > 1.0;
        is_back |= has_left && (crowd.movers()[0].position - first).norm() < 0.04;
    }
    assert!(is_back, "it goes round");
}

#[test]
fn a_room_too_full_is_refused_and_left_as_it_was() {
    let mut world = room(10).world;
    let spec = CrowdSpec { n_movers: Interval::Fixed(500.0), ..CrowdSpec::default() };
    let error = spec.build(&mut world, &[], &mut stream(0, "crowd", 0)).unwrap_err();
    assert!(matches!(error, SimError::CannotPlace { .. }));
    assert!(world.movers().is_empty());
}

#[test]
fn bad_numbers_are_named() {
    let base = CrowdSpec::default();
    let reciprocal = CrowdMotion::Reciprocal { horizon: 0.0, obstacle_horizon: 1.0 };
    for (field, spec) in [
        ("n_movers", CrowdSpec { n_movers: Interval::Fixed(1.5), ..base.clone() }),
        ("n_movers", CrowdSpec { n_movers: Interval::Range([3.0, 1.0]), ..base.clone() }),
        ("radius", CrowdSpec { radius: Interval::Fixed(0.0), ..base.clone() }),
        ("speed", CrowdSpec { speed: Interval::Fixed(f64::NAN), ..base.clone() }),
        ("min_gap", CrowdSpec { min_gap: 0.0, ..base.clone() }),
        ("kinds (their sum)", CrowdSpec { kinds: Kinds { disc: 0.0, ..Kinds::default() }, ..base.clone() }),
        (
            "motion.n_points",
            CrowdSpec { motion: CrowdMotion::Waypoints { n_points: 1, loops: vec![] }, ..base.clone() },
        ),
        ("motion.horizon", CrowdSpec { motion: reciprocal, ..base.clone() }),
    ] {
        assert_eq!(spec.check().unwrap_err().field, field);
    }
    let read: CrowdSpec = toml::from_str("n_movers = 3\nmotion = { type = 'random_walk', turning = 0.2 }").unwrap();
    assert_eq!(
        read,
        CrowdSpec { n_movers: Interval::Fixed(3.0), motion: CrowdMotion::RandomWalk { turning: 0.2 }, ..base }
    );
    assert!(toml::from_str::<CrowdSpec>("n_mover = 3").is_err());
}

#[test]
fn a_room_with_a_crowd_is_the_room_without_and_a_crowd() {
    let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
    let motion = CrowdMotion::Reciprocal { horizon: 2.0, obstacle_horizon: 0.5 };
    let spec = CrowdSpec { n_movers: Interval::Range([2.0, 6.0]), motion, ..CrowdSpec::default() };
    let still = WorldSpec::Room(RoomSpec::default()).build(&vehicle).unwrap();
    let room = RoomSpec { crowd: Some(spec.clone()), ..RoomSpec::default() };
    let lively = WorldSpec::Room(room.clone()).build(&vehicle).unwrap();
    for index in 0..20 {
        let (a, b) = (still.scenario(5, index).unwrap(), lively.scenario(5, index).unwrap());
        assert_eq!(a.world.obstacles(), b.world.static_obstacles());
        assert_eq!((a.start, a.goal, a.crowd.is_none()), (b.start, b.goal, true));
        let crowd = b.crowd.as_ref().unwrap();
        assert_eq!(Some(crowd), lively.scenario(5, index).unwrap().crowd.as_ref());
        assert!(crowd.movers().iter().all(|m| {
            [a.start.translation.vector.into(), a.goal]
                .iter()
                .all(|end| (m.position - *end).norm() >= m.radius + 0.25 + spec.min_gap)
        }));
        let (mut rng, mut same_rng) = (stream(1, "goals", 0), stream(1, "goals", 0));
        assert_eq!(
            a.new_goal(&a.goal, &vehicle, &mut rng),
            b.new_goal(&b.goal, &vehicle, &mut same_rng),
            "movers do not count"
        );
    }
    assert!(!toml::to_string(&RoomSpec::default()).unwrap().contains("crowd"));
    let read: RoomSpec = toml::from_str(&toml::to_string(&room).unwrap()).unwrap();
    assert_eq!(read, room);
    let refused =
        WorldSpec::Room(RoomSpec { crowd: Some(CrowdSpec { min_gap: -1.0, ..spec }), ..room }).build(&vehicle);
    assert!(refused.unwrap_err().to_string().starts_with("crowd.min_gap = -1"));
}

#[test]
fn scenarios_are_read_back_with_their_crowds_and_only_with_their_own() {
    let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
    let room = RoomSpec { crowd: Some(CrowdSpec::default()), ..RoomSpec::default() };
    let mut scenario = WorldSpec::Room(room).build(&vehicle).unwrap().scenario(0, 0).unwrap();
    for _ in 0..50 {
        scenario.crowd.as_mut().unwrap().step(&mut scenario.world, DT, None);
    }
    let read: Scenario = rmp_serde::from_slice(&rmp_serde::to_vec(&scenario).unwrap()).unwrap();
    assert_eq!(read.crowd, scenario.crowd);
    assert_eq!(read.world.obstacles(), scenario.world.obstacles());
    scenario.crowd.as_mut().unwrap().step(&mut scenario.world.clone(), DT, None);
    let error = rmp_serde::from_slice::<Scenario>(&rmp_serde::to_vec(&scenario).unwrap()).unwrap_err();
    assert!(error.to_string().contains("crowd.movers.0"), "{error}");
    scenario.crowd = None;
    let plain: Scenario = rmp_serde::from_slice(&rmp_serde::to_vec(&scenario).unwrap()).unwrap();
    assert!(plain.crowd.is_none());
}
