//! What is written is read back.

use headway_sim::files::{FileSpec, MapSpec, SdfSpec, WorldFile, parse_map, parse_sdf, to_map, to_sdf};
use headway_sim::{Footprint, Obstacle, Point, Pose, Room, Scenario, Shape, World, WorldSpec};
use proptest::prelude::*;

fn shapes() -> impl Strategy<Value = Shape> {
    let polygon = (3..9_u32, 0.1..0.9_f64, 0.0..1.0_f64).prop_map(|(n, radius, phase)| {
        let corner = |k| (f64::from(k) / f64::from(n) * std::f64::consts::TAU + phase).sin_cos();
        Shape::Polygon { vertices: (0..n).map(corner).map(|(y, x)| [radius * x, 0.7 * radius * y]).collect() }
    });
    prop_oneof![
        (0.01..1.0_f64).prop_map(|radius| Shape::Disc { radius }),
        (0.01..1.0_f64, 0.01..1.0_f64).prop_map(|(length, width)| Shape::Box { length, width }),
        polygon,
    ]
}

prop_compose! {
    fn world_files()(
        corner in (-1e3..1e3_f64, -1e3..1e3_f64), extent in (4.0..9.0_f64, 4.0..9.0_f64),
        obstacles in prop::collection::vec((shapes(), 0.0..1.0_f64, 0.0..1.0_f64, -4.0..4.0_f64), 0..9),
        yaw in -4.0..4.0_f64, has_ends in any::<bool>(), name in "\\PC{0,12}",
    ) -> WorldFile {
        let room = Room { x: corner.0, y: corner.1, width: extent.0, height: extent.1 };
        let at = |u: f64, v: f64| (room.x + 1.5 + u * (room.width - 3.0), room.y + 1.5 + v * (room.height - 3.0));
        let obstacle = |(shape, u, v, yaw)| { let (x, y) = at(u, v); Obstacle { shape, x, y, yaw } };
        let world = World::new(room, obstacles.into_iter().map(obstacle).collect()).unwrap();
        let start = Pose::new([room.x + 0.1, room.y + 0.1].into(), yaw);
        let goal = Point::new(room.x + extent.0 / 3.0, room.y + 0.2);
        WorldFile { name, world, start: has_ends.then_some(start), goal: has_ends.then_some(goal), unsupported: vec![] }
    }
}

proptest! {
    #[test]
    fn sdf_comes_back_bit_for_bit(file in world_files(), slice_height in 0.0..=2.0_f64) {
        let spec = SdfSpec { slice_height, ..SdfSpec::default() };
        let again = parse_sdf(to_sdf(&file).as_bytes(), &spec).unwrap();
        prop_assert_eq!(again.world.obstacles(), file.world.obstacles());
        prop_assert_eq!(again.world.room(), file.world.room());
        prop_assert_eq!((again.start, again.goal), (file.start, file.goal));
        prop_assert_eq!(&again.name, &file.name);
        prop_assert_eq!(to_sdf(&again), to_sdf(&file));
    }

    #[test]
    fn a_map_of_a_map_is_the_same(file in world_files(), resolution in 0.05..0.5_f64) {
        let map = to_map(&file, resolution, "a \"b\".pgm").unwrap();
        let again = parse_map(map.yaml.as_bytes(), &MapSpec::default(), |name| {
            assert_eq!(name, "a \"b\".pgm");
            Ok(map.pgm.clone())
        }).unwrap();
        prop_assert_eq!((again.start, again.goal), (file.start, file.goal));
        let twice = to_map(&again, resolution, "a \"b\".pgm").unwrap();
        prop_assert!(twice.pgm == map.pgm);
    }

    #[test]
    fn what_is_free_on_a_map_is_free_in_the_world(file in world_files(), u in 0.0..1.0_f64, v in 0.0..1.0_f64) {
        let map = to_map(&file, 0.1, "a.pgm").unwrap();
        let again = parse_map(map.yaml.as_bytes(), &MapSpec::default(), |_| Ok(map.pgm.clone())).unwrap();
        let room = file.world.room();
        let point = Point::new(room.x + u * room.width, room.y + v * room.height);
        if again.world.distance(&point) > 1e-6 {
            prop_assert!(file.world.distance(&point) > 0.0);
        }
    }
}

#[test]
fn scenarios_go_through_files() {
    let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
    let scenario = WorldSpec::Room10x15 {}.build(&vehicle).unwrap().scenario(1, 2).unwrap();
    let file = WorldFile::of_scenario("room", &scenario);
    let folder = tempfile::tempdir().unwrap();
    let [world, map] = ["room.world", "room.yaml"].map(|name| folder.path().join(name));
    headway_sim::files::write_sdf(&world, &file).unwrap();
    headway_sim::files::write_map(&map, &file, 0.05).unwrap();
    for path in [world, map] {
        let again = headway_sim::files::read(&path, &FileSpec::default()).unwrap();
        assert_eq!((again.start, again.goal, again.name.as_str()), (file.start, file.goal, "room"));
        let rule = scenario.goal_rule;
        assert!(Scenario::new(again.world, again.start.unwrap(), again.goal.unwrap(), rule).is_ok());
    }
}

/// What moves was once written as if it stood still.
#[test]
fn movers_are_not_written() {
    let disc = |x, radius| Obstacle { shape: Shape::Disc { radius }, x, y: 5.0, yaw: 0.0 };
    let still = World::new(Room::new(10.0, 10.0), vec![disc(2.0, 0.5)]).unwrap();
    let mut world = still.clone();
    world.add_movers(vec![disc(7.0, 0.3), disc(8.5, 0.3)]).unwrap();
    let rule = headway_sim::GoalRule { distance: 4.0, clearance: 0.2 };
    let scenario = Scenario::new(world.clone(), Pose::translation(1.0, 1.0), Point::new(9.0, 9.0), rule).unwrap();
    let file = WorldFile::of_scenario("crowd", &scenario);
    assert_eq!(file.unsupported, ["mover 0 at (7, 5)", "mover 1 at (8.5, 5)"]);
    assert_eq!((file.world.obstacles(), file.world.movers()), (still.obstacles(), &[][..]));
    for moving in [file.clone(), WorldFile { world, ..file.clone() }] {
        let empty = WorldFile { world: still.clone(), ..file.clone() };
        assert_eq!(to_sdf(&moving), to_sdf(&empty));
        assert_eq!(to_map(&moving, 0.1, "a.pgm").unwrap(), to_map(&empty, 0.1, "a.pgm").unwrap());
    }
}
