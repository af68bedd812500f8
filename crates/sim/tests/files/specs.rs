//! Scenarios in worlds from files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use headway_sim::files::{FileSpec, SdfSpec, Unsupported, WorldFile, write_sdf};
use headway_sim::{
    CrowdSpec, FilePart, FilesSpec, Footprint, Interval, Obstacle, Point, Room, Shape, WeightedWorld, World,
    WorldSource, WorldSpec,
};

use crate::common::{document, model};

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

/// The names of the files of a part, by a disc in each whose radius tells its number.
fn part(folder: &Path, part: FilePart, test_share: f64, split_seed: u64) -> Result<BTreeSet<u64>, String> {
    let spec = FilesSpec { paths: vec![folder.into()], part, test_share, split_seed, ..FilesSpec::default() };
    let source = source(&spec)?;
    let number = |index| match source.scenario(0, index).unwrap().world.obstacles()[0].shape {
        Shape::Disc { radius } => (radius * 100.0).round() as u64,
        _ => unreachable!("there are only discs"),
    };
    Ok((0..400).map(number).collect())
}

/// Halls with a disc each, of 1 cm, 2 cm, ...
fn discs(folder: &Path, n: u64) {
    for k in 1..=n {
        let disc = Obstacle { shape: Shape::Disc { radius: k as f64 / 100.0 }, x: 5.0, y: 5.0, yaw: 0.0 };
        hall(folder, &format!("w_{k}.world"), vec![disc]);
    }
}

#[test]
fn the_parts_are_disjoint_and_together_all() {
    let folder = tempfile::tempdir().unwrap();
    discs(folder.path(), 14);
    let of = |which, share, seed| part(folder.path(), which, share, seed).unwrap();
    let all: BTreeSet<u64> = (1..=14).collect();
    for (share, n_test) in [(0.2, 3), (0.5, 7), (0.75, 11)] {
        for seed in 0..4 {
            let [train, test] = [FilePart::Train, FilePart::Test].map(|which| of(which, share, seed));
            assert_eq!((train.len(), test.len()), (14 - n_test, n_test));
            assert!(train.is_disjoint(&test));
            assert_eq!(&train | &test, all);
            assert_eq!(test, of(FilePart::Test, share, seed));
        }
        assert_eq!(of(FilePart::All, share, 0), all);
    }
    let splits: BTreeSet<_> = (0..8).map(|seed| of(FilePart::Test, 0.5, seed)).collect();
    assert!(splits.len() > 6, "other seeds, other splits");
}

#[test]
fn an_empty_part_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    discs(folder.path(), 2);
    let allowed = |part| format!("must be such that some of the 2 files are left for part = {part}");
    let refusal = |which, share| part(folder.path(), which, share, 0).unwrap_err();
    assert_eq!(refusal(FilePart::Test, 0.2), format!("test_share = 0.2: {}", allowed("test")));
    assert_eq!(refusal(FilePart::Train, 1.0), format!("test_share = 1: {}", allowed("train")));
    assert_eq!(refusal(FilePart::Train, f64::NAN), "test_share = NaN: must be from 0 to 1");
    let nothing = FilesSpec::default();
    assert!(source(&nothing).unwrap_err().starts_with("paths = []: must be world files"));
}

/// One file was once two, one of which could be for training and the other for tests.
#[test]
fn twins_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    discs(folder.path(), 3);
    let detour = folder.path().join("../").join(folder.path().file_name().unwrap()).join("w_2.world");
    let spec = FilesSpec { paths: vec![folder.path().into(), detour], ..FilesSpec::default() };
    let error = source(&spec).unwrap_err();
    assert!(error.starts_with("paths = ") && error.contains("w_2.world: must be named once: it is"), "{error}");
    assert!(spec.files().is_err());
    let missing = FilesSpec { paths: vec![folder.path().join("no.world")], ..FilesSpec::default() };
    assert!(source(&missing).unwrap_err().contains("no.world: cannot be read"));
}

#[test]
fn a_mixture_draws_from_files_and_from_a_room() {
    let folder = tempfile::tempdir().unwrap();
    discs(folder.path(), 3);
    let files = WorldSpec::Files(FilesSpec { paths: vec![folder.path().into()], ..FilesSpec::default() });
    let part = |weight, world| WeightedWorld { weight, world };
    let spec = WorldSpec::Mixture { worlds: vec![part(3.0, files), part(1.0, WorldSpec::Room10x15 {})] };
    let source = spec.build(&vehicle()).unwrap();
    let is_file = |index: &u64| source.scenario(0, *index).unwrap().world.obstacles().len() == 1;
    let n_files = (0..400).filter(is_file).count();
    // 300 expected, with a standard deviation of 8.7.
    assert!((265..335).contains(&n_files), "{n_files}");
}

#[test]
fn files_with_a_crowd_are_the_files_and_a_crowd() {
    let folder = tempfile::tempdir().unwrap();
    discs(folder.path(), 3);
    let still = FilesSpec { paths: vec![folder.path().into()], ..FilesSpec::default() };
    let lively = FilesSpec { crowd: Some(CrowdSpec::default()), ..still.clone() };
    let [a, b] = [&still, &lively].map(|spec| source(spec).unwrap());
    for index in 0..20 {
        let [still, lively] = [&a, &b].map(|source| source.scenario(2, index).unwrap());
        assert_eq!(still.world.obstacles(), lively.world.static_obstacles());
        assert_eq!((still.start, still.goal), (lively.start, lively.goal));
        let crowd = lively.crowd.unwrap();
        assert_eq!(Some(&crowd), b.scenario(2, index).unwrap().crowd.as_ref());
        let start: Point = still.start.translation.vector.into();
        for mover in crowd.movers() {
            assert!(still.world.distance(&mover.position) >= mover.radius + 0.3);
            assert!(nalgebra::distance(&mover.position, &start) >= mover.radius + 0.25 + 0.3);
        }
    }
    let full = CrowdSpec { n_movers: Interval::Fixed(900.0), ..CrowdSpec::default() };
    let error = source(&FilesSpec { crowd: Some(full), ..still }).unwrap_err();
    assert!(error.contains("w_1.world: cannot place mover "), "{error}");
}

#[test]
fn what_is_left_out_is_listed_with_its_file() {
    let folder = tempfile::tempdir().unwrap();
    hall(folder.path(), "a.world", vec![]);
    let house = document(&model("house", "0 0 0 0 0 0", "<mesh><uri>house.dae</uri></mesh>"));
    std::fs::write(folder.path().join("b.world"), house).unwrap();
    let sdf = SdfSpec { unsupported: Unsupported::Ignore, ..SdfSpec::default() };
    let read = FileSpec { sdf, ..FileSpec::default() };
    let spec = FilesSpec { paths: vec![folder.path().into()], ..FilesSpec::default() };
    assert!(source(&spec).unwrap_err().contains("cannot represent model 'house'"));
    let left_out = source(&FilesSpec { read, ..spec }).unwrap().left_out();
    let expected = "b.world: model 'house', link 'link', collision 'collision': mesh 'house.dae'";
    assert!(left_out.len() == 1 && left_out[0].ends_with(expected), "{left_out:?}");
    assert!(WorldSpec::default().build(&vehicle()).unwrap().left_out().is_empty());
}
