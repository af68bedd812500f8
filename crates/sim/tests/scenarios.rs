//! Scenarios keep what their specs promise, and refuse what cannot be.

use headway_sim::{Footprint, Interval, Kinds, Quantity, RoomSpec, Shape, WeightedWorld, World, WorldSpec, stream};
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
        let scenario = source.sample(&mut stream(seed, "layout", 0)).unwrap();
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
        let again = source.sample(&mut stream(seed, "layout", 0)).unwrap();
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
        let rng = &mut stream(seed, "layout", 0);
        let scenario = source.sample(rng).unwrap();
        let goal = scenario.new_goal(&scenario.goal, &vehicle, rng).unwrap();
        prop_assert!(nalgebra::distance(&goal, &scenario.goal) >= 4.0);
        prop_assert!(scenario.world.distance(&goal) >= 0.45);
    }
}

#[test]
fn a_mixture_draws_by_weight() {
    let part = |weight, world| WeightedWorld { weight, world };
    let worlds = vec![part(3.0, WorldSpec::Room10x15 {}), part(1.0, WorldSpec::Room25x25 {})];
    let source = WorldSpec::Mixture { worlds }.build(&disc(0.25)).unwrap();
    let small =
        (0..400).filter(|&k| source.sample(&mut stream(1, "layout", k)).unwrap().world.room().width < 20.0).count();
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
