use super::*;
use headway_sim::{Obstacle, Pose, Room, Shape, Twist, VehicleSpec, World};

fn room() -> World {
    let disc = |x, y, radius| Obstacle { shape: Shape::Disc { radius }, x, y, yaw: 0.0 };
    let shape = Shape::Box { length: 1.0, width: 0.3 };
    let boxed = Obstacle { shape, x: 3.0, y: 4.3, yaw: 0.6 };
    World::new(Room::new(6.0, 5.93), vec![disc(3.9, 2.0, 0.4), disc(1.0, 3.0, 0.2), boxed]).unwrap()
}

fn angles(n: usize) -> Vec<f64> {
    (0..n).map(|k| (k as f64 / n as f64 - 0.5) * std::f64::consts::TAU).collect()
}

fn scan(world: &World, pose: &Pose, angles: &[f64]) -> Vec<f32> {
    let cast = |angle: &f64| {
        let direction = pose.rotation * Vector2::new(angle.cos(), angle.sin());
        world.cast_ray(&pose.translation.vector.into(), &direction, 5.0) as f32
    };
    angles.iter().map(cast).collect()
}

fn sensed<'a>(vehicle: &'a VehicleSpec, scan: &'a [f32], beam_angles: &'a [f64], pose: Pose) -> Sensed<'a> {
    let goal = Point::new(5.0, 5.0);
    Sensed {
        vehicle,
        scan,
        beam_angles,
        max_range: 5.0,
        pose,
        twist: Twist::zeros(),
        goal,
        route: None,
        last_command: headway_sim::Command::default(),
        movers: &[],
    }
}

fn poses() -> [Pose; 3] {
    [Pose::new([2.02, 1.51].into(), 0.3), Pose::new([2.41, 1.83].into(), 1.0), Pose::new([2.61, 2.93].into(), 2.0)]
}

/// Whether a line passes through a cell, found by cutting it with the cell's two slabs; `hair` widens the cell.
fn crosses(a: &Point, b: &Point, center: &Point, half: f64, hair: f64) -> bool {
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for k in 0..2 {
        let (d, to) = (b[k] - a[k], center[k] - a[k]);
        let ends = [(to - half - hair) / d, (to + half + hair) / d];
        low = low.max(ends[0].min(ends[1]));
        high = high.min(ends[0].max(ends[1]));
    }
    low < high
}

/// Cell by cell and beam by beam, for each scan in turn.
#[test]
fn cells_are_what_the_beams_say_one_by_one() {
    let (world, vehicle, angles) = (room(), VehicleSpec::default(), angles(97));
    let mut map = ScanMapSpec::default().build().unwrap();
    let mut states = std::collections::HashMap::new();
    for pose in poses() {
        let ranges = scan(&world, &pose, &angles);
        map.update(&sensed(&vehicle, &ranges, &angles, pose));
        let origin = Point::from(pose.translation.vector);
        let cell = |point: &Point| [(point.x / 0.05).floor() as i64, (point.y / 0.05).floor() as i64];
        let ends = angles.iter().zip(&ranges).map(|(angle, range)| {
            let range = f64::from(*range);
            (range, pose * Point::new(range * angle.cos(), range * angle.sin()))
        });
        let ends: Vec<_> = ends.collect();
        let marked: std::collections::HashSet<_> =
            ends.iter().filter(|(range, _)| *range < 2.5).map(|(_, end)| cell(end)).collect();
        for x in -10..130 {
            for y in -10..130 {
                let center = Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * 0.05;
                let passes = |hair: f64| {
                    ends.iter().any(|(range, end)| {
                        let cut = origin + (end - origin) * (range.min(3.0) / range);
                        let is_own_end = *range < 3.0 && cell(end) == [i64::from(x), i64::from(y)];
                        !is_own_end && crosses(&origin, &cut, &center, 0.025, hair)
                    })
                };
                let state = states.entry((x, y)).or_insert(CellState::Unknown);
                if marked.contains(&[i64::from(x), i64::from(y)]) {
                    *state = CellState::Marked;
                } else if passes(-1e-7) {
                    *state = CellState::Free;
                } else if passes(1e-7) {
                    *state = map.at(&center); // a corner is touched: either will do
                }
                assert_eq!(map.at(&center), *state, "{center}");
            }
        }
    }
}

#[test]
fn marks_lie_on_surfaces_and_the_vehicle_stands_free() {
    let (world, vehicle, angles) = (room(), VehicleSpec::default(), angles(720));
    let mut map = ScanMapSpec::default().build().unwrap();
    for pose in poses() {
        let ranges = scan(&world, &pose, &angles);
        map.update(&sensed(&vehicle, &ranges, &angles, pose));
        assert_eq!(map.at(&pose.translation.vector.into()), CellState::Free);
    }
    assert!(map.marked().count() > 100);
    for mark in map.marked() {
        assert!(world.distance(&mark).abs() < 0.036, "{mark}");
    }
}

#[test]
fn marks_go_when_beams_pass_and_stay_when_none_does() {
    let (vehicle, angles) = (VehicleSpec::default(), [0.0, 1.0]);
    let mut map = ScanMapSpec::default().build().unwrap();
    let pose = Pose::translation(0.02, 0.02);
    map.update(&sensed(&vehicle, &[1.0, 2.0], &angles, pose));
    assert_eq!(map.marked().count(), 2);
    // The first beam meets nothing now; the second is gone.
    map.update(&sensed(&vehicle, &[5.0, f32::NAN], &angles, pose));
    assert_eq!(map.marked().count(), 1);
    assert_eq!(map.at(&Point::new(2.9, 0.02)), CellState::Free);
    assert_eq!(map.at(&Point::new(3.1, 0.02)), CellState::Unknown);
    map.clear_beyond(&pose.translation.vector.into(), 1.5);
    assert_eq!(map.marked().count(), 0);
}

#[test]
fn reset_forgets_and_nonsense_is_passed_over() {
    let (vehicle, angles) = (VehicleSpec::default(), [0.0, f64::NAN, f64::INFINITY]);
    let mut map = ScanMapSpec::default().build().unwrap();
    map.update(&sensed(&vehicle, &[1.0, 1.0, 1.0], &angles, Pose::translation(0.02, 0.02)));
    assert_eq!(map.marked().count(), 1);
    map.update(&sensed(&vehicle, &[-1.0, 1.0, f32::INFINITY], &angles, Pose::new([f64::NAN, 0.0].into(), 0.0)));
    assert_eq!(map.marked().count(), 1);
    map.reset();
    assert_eq!((map.size(), map.marked().count()), ((0, 0), 0));
    assert_eq!(map.at(&Point::origin()), CellState::Unknown);
}

#[test]
fn specs_are_checked() {
    let error = ScanMapSpec { cell: 0.0, ..ScanMapSpec::default() }.build().unwrap_err();
    assert_eq!(error.to_string(), "cell = 0: must be from 0.005 to 10");
    assert!(ScanMapSpec { max_size: 0.1, ..ScanMapSpec::default() }.build().is_err());
}
