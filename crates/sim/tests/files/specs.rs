//! Scenarios in worlds from files.

use std::path::{Path, PathBuf};

use headway_sim::files::{WorldFile, write_sdf};
use headway_sim::{FilesSpec, Footprint, Obstacle, Point, Room, Shape, World, WorldSource, WorldSpec};

fn vehicle() -> Footprint {
    Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap()
}

fn block([x, y]: [f64; 2], [length, width]: [f64; 2]) -> Obstacle {
    Obstacle { shape: Shape::Box { length, width }, x, y, yaw: 0.0 }
}

/// A 10 x 10 m hall in a file.
fn hall(folder: &Path, name: &str, obstacles: Vec<Obstacle>) -> PathBuf {
    let path = folder.join(name);
    let world = World::new(Room::new(10.0, 10.0), obstacles).unwrap();
    write_sdf(&path, &WorldFile { name: "hall".into(), world, start: None, goal: None, unsupported: vec![] }).unwrap();
    path
}

/// Four blocks around (2, 2).
fn cell() -> Vec<Obstacle> {
    let (long, thin) = (2.2, 0.2);
    vec![
        block([2.0, 1.0], [long, thin]),
        block([2.0, 3.0], [long, thin]),
        block([1.0, 2.0], [thin, long]),
        block([3.0, 2.0], [thin, long]),
    ]
}

fn source(spec: &FilesSpec) -> Result<WorldSource, String> {
    WorldSpec::Files(spec.clone()).build(&vehicle()).map_err(|e| e.to_string())
}

/// The other end was once one of a pair of which the given end was not.
#[test]
fn a_given_end_is_joined_to_the_drawn_one_and_far_from_it() {
    let folder = tempfile::tempdir().unwrap();
    let divided = vec![block([5.0, 5.0], [0.2, 10.0])];
    let spec = FilesSpec { paths: vec![hall(folder.path(), "a.world", divided)], ..FilesSpec::default() };
    let from = source(&FilesSpec { start: Some([1.0, 3.0, 0.5]), ..spec.clone() }).unwrap();
    let to = source(&FilesSpec { goal: Some([9.0, 3.0]), ..spec }).unwrap();
    for index in 0..50 {
        let there = from.scenario(0, index).unwrap();
        assert_eq!((there.start.translation.x, there.start.translation.y), (1.0, 3.0));
        let here = to.scenario(0, index).unwrap();
        assert_eq!(here.goal, Point::new(9.0, 3.0));
        for (scenario, is_left) in [(there, true), (here, false)] {
            let start: Point = scenario.start.translation.vector.into();
            assert!(nalgebra::distance(&start, &scenario.goal) >= 4.0);
            assert_eq!((start.x < 5.0, scenario.goal.x < 5.0), (is_left, is_left));
        }
    }
}

#[test]
fn a_sealed_end_is_refused_with_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let spec = FilesSpec { paths: vec![hall(folder.path(), "cell.world", cell())], ..FilesSpec::default() };
    assert!(source(&spec).is_ok());
    let ends = [
        FilesSpec { start: Some([2.0, 2.0, 0.0]), ..spec.clone() },
        FilesSpec { goal: Some([2.0, 2.0]), ..spec.clone() },
    ];
    for spec in ends {
        let error = source(&spec).unwrap_err();
        assert!(error.contains("cell.world: found no start and goal at least 4 m apart"), "{error}");
    }
}

/// Some files were never tried: with 16 trials in 40 files, a bad one was met in the midst of a run.
#[test]
fn every_file_is_tried() {
    let folder = tempfile::tempdir().unwrap();
    for k in 0..40 {
        hall(folder.path(), &format!("w_{k}.world"), vec![]);
    }
    let spec = FilesSpec { paths: vec![folder.path().into()], ..FilesSpec::default() };
    assert!(source(&spec).is_ok());
    for bad in [3, 17, 38] {
        let name = format!("w_{bad}.world");
        hall(folder.path(), &name, vec![block([5.0, 5.0], [9.8, 9.8])]);
        let error = source(&spec).unwrap_err();
        assert!(error.contains(&format!("{name}: found no start and goal")), "{error}");
        hall(folder.path(), &name, vec![]);
    }
}

#[test]
fn what_is_given_is_checked_in_each_file() {
    let folder = tempfile::tempdir().unwrap();
    let spec = FilesSpec { paths: vec![hall(folder.path(), "cell.world", cell())], ..FilesSpec::default() };
    let given = |start, goal| FilesSpec { start, goal, ..spec.clone() };
    let ruled = |start_goal_distance, start_goal_clearance| FilesSpec {
        start_goal_distance,
        start_goal_clearance,
        ..spec.clone()
    };
    let free = "must be outside of all obstacles, in ";
    let untouched = "must be a place where the vehicle touches nothing, in ";
    let cases = [
        (given(None, Some([f64::NAN, 5.0])), "goal = (NaN, 5): ", free),
        (given(None, Some([2.0, 1.0])), "goal = (2, 1): ", free),
        (given(None, Some([5.0, 10.5])), "goal = (5, 10.5): ", free),
        (given(Some([f64::NAN, 5.0, 0.0]), None), "start = (NaN, 5): ", untouched),
        (given(Some([5.0, 5.0, f64::NAN]), None), "start = (5, 5): ", untouched),
        (given(Some([2.0, 1.3, 0.0]), None), "start = (2, 1.3): ", untouched),
        (ruled(20.0, 0.2), "start_goal_distance = 20: ", "must be less than the room's diagonal, 14.14 m, in "),
        (ruled(4.0, 0.0), "start_goal_clearance = 0: ", "must be from 0.01 to 1000, in "),
    ];
    for (spec, value, allowed) in cases {
        let error = source(&spec).unwrap_err();
        assert!(error.starts_with(value), "{error}");
        assert!(error.contains(allowed) && error.ends_with("cell.world"), "{error}");
    }
}
