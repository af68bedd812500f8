//! Scenarios keep what their specs promise, and refuse what cannot be.

use std::collections::HashSet;
use std::time::{Duration, Instant};

use headway_sim::{
    Footprint, GoalRule, Interval, Kinds, Obstacle, Point, Pose, Quantity, Room, RoomSpec, Scenario, Shape,
    WeightedWorld, World, WorldSpec, stream,
};
use proptest::prelude::*;

fn disc(radius: f64) -> Footprint {
    Footprint::new(&Shape::Disc { radius }).expect("valid")
}

fn room() -> impl Strategy<Value = RoomSpec> {
    (8.0..14.0, 8.0..14.0, 0.0..0.12, 0.3..1.0, any::<(bool, bool)>()).prop_map(
        |(width, height, density, min_gap, (boxes, polygons))| RoomSpec {
            width: Interval::Fixed(width),
            height: Interval::Range([height, height + 2.0]),
            obstacles: Quantity::Density(Interval::Fixed(density)),
            kinds: Kinds { disc: 1.0, r#box: f64::from(u8::from(boxes)), polygon: f64::from(u8::from(polygons)) },
            min_gap,
            ..RoomSpec::default()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn scenarios_keep_their_promises(spec in room(), seed in 0..1000_u64) {
        let vehicle = disc(0.25);
        let source = WorldSpec::Room(spec.clone()).build(&vehicle).unwrap();
        let scenario = source.scenario(seed, 0).unwrap();
        let (world, start) = (&scenario.world, scenario.start.translation.vector.into());
        let expected = spec.obstacles;
        if let Quantity::Density(Interval::Fixed(density)) = expected {
            let area = world.room().width * world.room().height;
            prop_assert_eq!(world.obstacles().len(), (density * area).round() as usize);
        }
        prop_assert!(nalgebra::distance(&start, &scenario.goal) >= spec.start_goal_distance);
        for end in [start, scenario.goal] {
            prop_assert!(world.distance(&end) >= 0.25 + spec.start_goal_clearance);
        }
        for (index, obstacle) in world.obstacles().iter().enumerate() {
            let radius = obstacle.shape.circumradius();
            prop_assert!((0.2 - 1e-9..=0.5 + 1e-9).contains(&radius));
            let others = world.obstacles().iter().enumerate().filter(|(i, _)| *i != index);
            let others = World::new(world.room(), others.map(|(_, o)| o.clone()).collect()).unwrap();
            if let Ok(outline) = Footprint::new(&obstacle.shape) {
                prop_assert!(others.clearance(&outline, &obstacle.pose()) >= spec.min_gap - 1e-6);
            }
        }
        let again = source.scenario(seed, 0).unwrap();
        prop_assert_eq!(again.world.obstacles(), world.obstacles());
        prop_assert_eq!((again.start, again.goal), (scenario.start, scenario.goal));
    }

    #[test]
    fn specs_survive_toml(spec in room(), weight in 0.1..2.0) {
        let part = |world| WeightedWorld { weight, world };
        let spec = WorldSpec::Mixture { worlds: vec![part(WorldSpec::Room(spec)), part(WorldSpec::Room25x25 {})] };
        let text = toml::to_string(&spec).unwrap();
        prop_assert_eq!(toml::from_str::<WorldSpec>(&text).unwrap(), spec);
    }

    #[test]
    fn further_goals_are_joined_and_apart(seed in 0..1000_u64) {
        let vehicle = disc(0.25);
        let source = WorldSpec::default().build(&vehicle).unwrap();
        let scenario = source.scenario(seed, 0).unwrap();
        let goal = scenario.new_goal(&scenario.goal, &vehicle, &mut stream(seed, "goals", 0));
        prop_assert!(nalgebra::distance(&goal, &scenario.goal) >= 4.0);
        prop_assert!(scenario.world.distance(&goal) >= 0.45);
    }
}

/// The places that a disc can reach from a start, by a test that knows nothing of how scenarios are made: a
/// flood over points `FINE` apart, diagonals included. A path of the disc passes within `FINE / sqrt(2)` of
/// such points, which have that much less room than the disc has.
struct Flood {
    reached: HashSet<(i32, i32)>,
}

impl Flood {
    const FINE: f64 = 0.03;

    fn new(world: &World, start: Point, radius: f64) -> Self {
        let has_room = |(i, j): (i32, i32)| {
            let point = Point::new(f64::from(i), f64::from(j)) * Self::FINE;
            world.distance(&point) >= radius - Self::FINE / 2.0_f64.sqrt()
        };
        let first = Self::around(&start).find(|node| has_room(*node)).expect("the start has room");
        let (mut open, mut seen) = (vec![first], HashSet::from([first]));
        let mut reached = HashSet::new();
        while let Some((i, j)) = open.pop() {
            reached.insert((i, j));
            for (di, dj) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
                let next = (i + di, j + dj);
                if seen.insert(next) && has_room(next) {
                    open.push(next);
                }
            }
        }
        Self { reached }
    }

    /// The four nodes around a point.
    fn around(point: &Point) -> impl Iterator<Item = (i32, i32)> + use<> {
        let [i, j] = [point.x, point.y].map(|at| (at / Self::FINE).floor() as i32);
        [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].into_iter()
    }

    fn reaches(&self, point: &Point) -> bool {
        Self::around(point).any(|node| self.reached.contains(&node))
    }
}

/// Full rooms with gaps that some vehicles do not fit through.
fn narrow_room() -> impl Strategy<Value = RoomSpec> {
    (4.0..8.0, 4.0..8.0, 0.1..0.35, 0.02..0.7, 0.02..0.25).prop_map(
        |(width, height, density, min_gap, start_goal_clearance)| RoomSpec {
            width: Interval::Fixed(width),
            height: Interval::Fixed(height),
            obstacles: Quantity::Density(Interval::Range([0.0, density])),
            kinds: Kinds { disc: 1.0, r#box: 2.0, polygon: 1.0 },
            obstacle_radius: Interval::Range([0.2, 0.9]),
            min_gap,
            start_goal_distance: 1.5,
            start_goal_clearance,
            crowd: None,
        },
    )
}

fn footprint() -> impl Strategy<Value = Shape> {
    prop_oneof![
        (0.1..0.4).prop_map(|radius| Shape::Disc { radius }),
        (0.2..0.8, 0.1..0.4).prop_map(|(length, width)| Shape::Box { length, width }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn paths_join_starts_and_all_goals(spec in narrow_room(), shape in footprint(), seed in 0..1000_u64) {
        let vehicle = Footprint::new(&shape).unwrap();
        // Rooms too full for the vehicle are refused, which is as good.
        let scenario = WorldSpec::Room(spec).build(&vehicle).and_then(|source| source.scenario(seed, 0));
        prop_assume!(scenario.is_ok());
        let scenario = scenario.unwrap();
        let flood = Flood::new(&scenario.world, scenario.start.translation.vector.into(), vehicle.circumradius());
        prop_assert!(flood.reaches(&scenario.goal));
        let (mut from, rng) = (scenario.goal, &mut stream(seed, "goals", 0));
        for _ in 0..5 {
            from = scenario.new_goal(&from, &vehicle, rng);
            prop_assert!(flood.reaches(&from));
        }
    }
}

/// A 10 x 10 m room divided at x = 5, but for a gap around y = 5.
fn divided(gap: f64) -> World {
    let half = (10.0 - gap) / 2.0;
    let barrier = |y| Obstacle { shape: Shape::Box { length: 0.2, width: half }, x: 5.0, y, yaw: 0.0 };
    let barriers = vec![barrier(half / 2.0), barrier(10.0 - half / 2.0)];
    World::new(Room::new(10.0, 10.0), barriers).unwrap()
}

#[test]
fn further_goals_stay_on_the_vehicles_side() {
    let vehicle = disc(0.25);
    let rule = GoalRule { distance: 3.0, clearance: 0.2 };
    for (gap, may_cross) in [(0.0, false), (0.45, false), (1.0, true)] {
        let (start, goal) = (Point::new(2.0, 2.0), Point::new(2.0, 8.0));
        let scenario = Scenario::new(divided(gap), Pose::translation(start.x, start.y), goal, rule).unwrap();
        let new_goal = |k| scenario.new_goal(&start, &vehicle, &mut stream(k, "goals", 0));
        assert_eq!((0..100).any(|k| new_goal(k).x > 5.0), may_cross, "gap {gap}");
    }
}

#[test]
fn further_goals_are_never_where_the_vehicle_is() {
    let vehicle = disc(0.25);
    let world = World::new(Room::new(10.0, 10.0), vec![]).unwrap();
    let (start, goal) = (Pose::translation(1.0, 5.0), Point::new(9.0, 5.0));
    // Draws are possible in the middle 0.5 m, where the vehicle is, or nowhere at all.
    for clearance in [4.5, 6.0] {
        let rule = GoalRule { distance: 8.0, clearance };
        let scenario = Scenario::new(world.clone(), start, goal, rule).unwrap();
        for (x, expected) in [(4.9, 9.0), (5.1, 1.0)] {
            let new = scenario.new_goal(&Point::new(x, 5.0), &vehicle, &mut stream(0, "goals", 0));
            assert_eq!((new.x, new.y), (expected, 5.0));
        }
    }
    // From the middle of a small room nothing is as far as the rule asks for, but half as far is.
    let rule = GoalRule { distance: 8.0, clearance: 0.2 };
    let scenario = Scenario::new(world, start, goal, rule).unwrap();
    for k in 0..100 {
        let middle = Point::new(5.0, 5.0);
        let new = scenario.new_goal(&middle, &vehicle, &mut stream(k, "goals", 0));
        assert!(nalgebra::distance(&new, &middle) >= 4.0);
    }
}

#[test]
fn layouts_do_not_depend_on_the_goal_rule_nor_the_vehicle() {
    let kinds = Kinds { disc: 1.0, r#box: 1.0, polygon: 1.0 };
    let base = RoomSpec { kinds, height: Interval::Range([12.0, 15.0]), ..RoomSpec::default() };
    let far = RoomSpec { start_goal_distance: 9.0, start_goal_clearance: 0.3, ..base.clone() };
    let build = |spec: &RoomSpec, radius| WorldSpec::Room(spec.clone()).build(&disc(radius)).unwrap();
    let [base, far, wide] = [build(&base, 0.25), build(&far, 0.25), build(&base, 0.3)];
    let mut n_moved = 0;
    for k in 0..50 {
        let [a, b, c] = [&base, &far, &wide].map(|source| source.scenario(3, k).unwrap());
        assert_eq!(a.world.room(), b.world.room());
        assert_eq!(a.world.obstacles(), b.world.obstacles());
        assert_eq!(a.world.obstacles(), c.world.obstacles());
        n_moved += usize::from((a.start, a.goal) != (b.start, b.goal));
    }
    assert!(n_moved > 10, "only {n_moved} of 50 have other ends");
}

#[test]
fn starts_and_goals_do_not_depend_on_how_the_layout_was_drawn() {
    // Drawing a width from a range of no extent takes a number from the layout's random stream.
    let empty = |width| RoomSpec { width, obstacles: Quantity::Count(0), ..RoomSpec::default() };
    let build = |width| WorldSpec::Room(empty(width)).build(&disc(0.25)).unwrap();
    let [fixed, drawn] = [build(Interval::Fixed(10.0)), build(Interval::Range([10.0, 10.0]))];
    for k in 0..10 {
        let [a, b] = [&fixed, &drawn].map(|source| source.scenario(3, k).unwrap());
        assert_eq!((a.start, a.goal), (b.start, b.goal));
    }
}

#[test]
fn difficult_rooms_are_not_passed_over() {
    // In the shorter rooms most pairs of places are too near each other. Drawing the size anew after such a
    // failure made short rooms rare.
    let spec = RoomSpec {
        width: Interval::Fixed(3.0),
        height: Interval::Range([3.0, 7.0]),
        obstacles: Quantity::Count(0),
        start_goal_distance: 2.3,
        ..RoomSpec::default()
    };
    let source = WorldSpec::Room(spec).build(&disc(0.25)).unwrap();
    let heights: Vec<f64> = (0..400).map(|k| source.scenario(0, k).unwrap().world.room().height).collect();
    let n_short = heights.iter().filter(|height| **height < 3.4).count();
    assert!((28..52).contains(&n_short), "{n_short} of 400 should be about 40");
}

#[test]
fn scenarios_are_checked_when_made_and_when_read() {
    #[derive(serde::Serialize)]
    struct Data {
        world: World,
        start: Pose,
        goal: Point,
        goal_rule: GoalRule,
    }
    let post = Obstacle { shape: Shape::Disc { radius: 0.5 }, x: 5.0, y: 5.0, yaw: 0.0 };
    let world = World::new(Room::new(10.0, 10.0), vec![post]).unwrap();
    let check = |start: Pose, goal: (f64, f64), distance: f64, clearance: f64| {
        let (goal, goal_rule) = (Point::new(goal.0, goal.1), GoalRule { distance, clearance });
        let made = Scenario::new(world.clone(), start, goal, goal_rule);
        let text = toml::to_string(&Data { world: world.clone(), start, goal, goal_rule }).unwrap();
        let read = toml::from_str::<Scenario>(&text);
        let message = made.as_ref().map_err(ToString::to_string).err();
        assert!(message.as_ref().is_none_or(|m| read.as_ref().unwrap_err().to_string().contains(m)));
        if let Ok(read) = read {
            assert_eq!(toml::to_string(&read).unwrap(), text);
            assert!(message.is_none());
        }
        message.unwrap_or_default()
    };
    let at = Pose::translation;
    assert_eq!(check(at(1.0, 1.0), (8.0, 8.0), 4.0, 0.2), "");
    for (start, goal, distance, clearance, expected) in [
        (at(f64::NAN, 1.0), (8.0, 8.0), 4.0, 0.2, "start = (NaN, 1): must be inside the room"),
        (at(1.0, 11.0), (8.0, 8.0), 4.0, 0.2, "start = (1, 11): must be inside the room"),
        (Pose::new([1.0, 1.0].into(), f64::NAN), (8.0, 8.0), 4.0, 0.2, "start.rotation = "),
        (at(1.0, 1.0), (8.0, f64::INFINITY), 4.0, 0.2, "goal = (8, inf): must be inside the room"),
        (at(1.0, 1.0), (5.2, 5.2), 4.0, 0.2, "goal = (5.2, 5.2): must be inside the room and outside of all"),
        (at(1.0, 1.0), (8.0, 8.0), 15.0, 0.2, "goal_rule.distance = 15: must be less than the room's diagonal"),
        (at(1.0, 1.0), (8.0, 8.0), f64::NAN, 0.2, "goal_rule.distance = NaN"),
        (at(1.0, 1.0), (8.0, 8.0), 4.0, 0.0, "goal_rule.clearance = 0: must be from 0.01 to 1000"),
    ] {
        let message = check(start, goal, distance, clearance);
        assert!(message.starts_with(expected), "{message:?} but {expected:?}");
    }
}

#[test]
fn what_would_take_for_ever_is_refused() {
    let fixed = Interval::Fixed;
    let base = RoomSpec::default;
    let density = |d| Quantity::Density(fixed(d));
    for (spec, expected) in [
        (RoomSpec { width: fixed(1e6), ..base() }, "width = 1000000: must be from 0.1 to 1000"),
        (RoomSpec { height: Interval::Range([1e-3, 10.0]), ..base() }, "height = 0.001: must be from 0.1 to 1000"),
        (RoomSpec { obstacle_radius: fixed(1e-9), ..base() }, "obstacle_radius = 0.000000001: must be from 0.001"),
        (RoomSpec { obstacles: Quantity::Count(10_001), ..base() }, "obstacles.count = 10001: must be from 0 to 10000"),
        (
            RoomSpec { width: fixed(100.0), height: Interval::Range([10.0, 200.0]), obstacles: density(1.0), ..base() },
            "obstacles.density = 1: must be at most 0.5 in a room of up to 20000 square metres: 10000 obstacles",
        ),
        (
            RoomSpec { width: fixed(1000.0), height: fixed(1000.0), ..base() },
            "start_goal_clearance = 0.2: must be 0.667 or more in a 1000.0 x 1000.0 m room",
        ),
        (
            RoomSpec { width: fixed(100.0), height: fixed(100.0), start_goal_clearance: 0.01, ..base() },
            "start_goal_clearance = 0.01: must be 0.067 or more",
        ),
        (
            RoomSpec { width: Interval::Range([2.0, 30.0]), height: fixed(2.0), ..base() },
            "start_goal_distance = 4: must be less than the room's diagonal, 2.83 m",
        ),
    ] {
        let message = WorldSpec::Room(spec).build(&disc(0.25)).unwrap_err().to_string();
        assert!(message.starts_with(expected), "{message:?} but {expected:?}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "a test of speed: two seconds in a release build")]
fn rooms_of_ten_thousand_obstacles_are_placed_or_refused_in_time() {
    let room = |extent, kinds| RoomSpec {
        width: Interval::Fixed(extent),
        height: Interval::Fixed(extent),
        obstacles: Quantity::Count(10_000),
        kinds,
        ..RoomSpec::default()
    };
    let all = Kinds { disc: 1.0, r#box: 1.0, polygon: 1.0 };
    let begin = Instant::now();
    for (extent, kinds, fits) in [(250.0, all, true), (150.0, Kinds::default(), false), (1.0, all, false)] {
        let built = WorldSpec::Room(RoomSpec { start_goal_distance: 1.0, ..room(extent, kinds) }).build(&disc(0.25));
        assert_eq!(built.is_ok(), fits, "{extent}: {:?}", built.err());
    }
    assert!(begin.elapsed() < Duration::from_secs(40), "{:?}", begin.elapsed());
}

#[test]
fn a_spec_that_often_fails_is_found_when_it_is_built() {
    // A quarter of the rooms is too short for its goals, but not the first.
    let spec = RoomSpec {
        width: Interval::Fixed(3.0),
        height: Interval::Range([3.0, 7.0]),
        obstacles: Quantity::Count(0),
        start_goal_distance: 3.9,
        ..RoomSpec::default()
    };
    let error = WorldSpec::Room(spec).build(&disc(0.25)).unwrap_err().to_string();
    assert!(error.starts_with("found no start and goal"), "{error}");
}

#[test]
fn a_mixture_draws_by_weight() {
    let part = |weight, world| WeightedWorld { weight, world };
    let worlds = vec![part(3.0, WorldSpec::Room10x15 {}), part(1.0, WorldSpec::Room25x25 {})];
    let source = WorldSpec::Mixture { worlds }.build(&disc(0.25)).unwrap();
    let small = (0..400).filter(|&k| source.scenario(1, k).unwrap().world.room().width < 20.0).count();
    assert!((260..340).contains(&small), "{small} of 400 should be about 300");
}

#[test]
fn what_does_not_fit_is_said() {
    let build = |spec: RoomSpec| WorldSpec::Room(spec).build(&disc(0.25)).unwrap_err().to_string();
    let full = RoomSpec { obstacles: Quantity::Count(500), ..RoomSpec::default() };
    let message = build(full);
    assert!(message.starts_with("cannot place obstacle "), "{message}");
    assert!(message.contains("of 500"), "{message}");
    let divided = RoomSpec {
        width: Interval::Fixed(8.0),
        height: Interval::Fixed(0.8),
        obstacles: Quantity::Count(0),
        ..RoomSpec::default()
    };
    let message = build(divided);
    assert!(message.starts_with("found no start and goal at least 4 m apart"), "{message}");
    let far = RoomSpec { start_goal_distance: 20.0, ..RoomSpec::default() };
    assert_eq!(build(far), "start_goal_distance = 20: must be less than the room's diagonal, 18.03 m");
    let nothing = WorldSpec::Mixture { worlds: vec![] }.build(&disc(0.25)).unwrap_err();
    assert_eq!(nothing.to_string(), "worlds = []: must be one world or more");
    let inner = WeightedWorld {
        weight: 1.0,
        world: WorldSpec::Room(RoomSpec { obstacle_radius: Interval::Fixed(-0.3), ..RoomSpec::default() }),
    };
    let nested = WorldSpec::Mixture { worlds: vec![inner] }.build(&disc(0.25)).unwrap_err();
    assert_eq!(nested.to_string(), "worlds.0.world.obstacle_radius = -0.3: must be a finite number above 0");
}
