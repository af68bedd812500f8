//! The scan kernel against exact ray casts in f64, beam by beam.

use headway_sensors::{Lidar, LidarSpec};
use headway_sim::{Interval, Kinds, Point, Pose, Quantity, RoomSpec, Scenario, VehicleSpec, WorldSpec, stream};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

/// What one exact ray at an angle of the vehicle's frame measures.
fn exact(lidar: &Lidar, scenario: &Scenario, pose: &Pose, angle: f64) -> f64 {
    let (sin, cos) = (pose.rotation.angle() + angle).sin_cos();
    let origin = Point::from(pose.translation.vector);
    scenario.world.cast_ray(&origin, &Vector2::new(cos, sin), lidar.spec().max_range)
}

/// The largest error over many scans, metres, and how many beams were looked at. Where a ray that is turned by a
/// hundred-thousandth of a radian to either side hits something else, either answer is right.
fn largest_error(lidar: &Lidar, room: &RoomSpec, n_scans: u64) -> (f64, usize) {
    let vehicle = VehicleSpec::default().build().unwrap();
    let source = WorldSpec::Room(room.clone()).build(vehicle.footprint()).unwrap();
    let mut ranges = vec![0.0; lidar.beam_angles().len()];
    let mut worst = (0.0_f64, 0);
    for index in 0..n_scans {
        let rng = &mut stream(5, "layout", index);
        let scenario = source.scenario(5, index).unwrap();
        lidar.scan(&scenario.world, &scenario.start, rng, &mut ranges);
        for (range, angle) in ranges.iter().zip(lidar.beam_angles()) {
            let error = |turn: f64| (f64::from(*range) - exact(lidar, &scenario, &scenario.start, angle + turn)).abs();
            worst.0 = worst.0.max(error(0.0).min(error(1e-5)).min(error(-1e-5)));
            worst.1 += 1;
        }
    }
    worst
}

#[test]
fn the_kernel_is_within_a_millimetre_of_exact_rays() {
    let all = Kinds { disc: 1.0, r#box: 1.0, polygon: 1.0 };
    let furnished = RoomSpec { kinds: all, obstacles: Quantity::Count(20), min_gap: 0.3, ..RoomSpec::default() };
    let crowded = RoomSpec { obstacles: Quantity::Density(Interval::Fixed(0.15)), min_gap: 0.1, ..furnished.clone() };
    let large = RoomSpec { kinds: all, ..RoomSpec::room_25x25() };
    for room in [furnished, crowded, large] {
        for (n_beams, field_of_view) in
            [(36, TAU), (37, PI), (1, PI), (360, TAU), (1080, 1.5 * PI), (721, TAU), (200, 6.0)]
        {
            let spec = LidarSpec { n_beams, field_of_view, max_range: 30.0, ..LidarSpec::default() };
            let (error, n) = largest_error(&spec.build().unwrap(), &room, 40);
            assert!(n >= 40 && error < 1e-3, "{n_beams} beams over {field_of_view}: {error} m");
        }
    }
}

#[test]
fn a_range_limit_hides_only_what_lies_beyond() {
    let lidar = |max_range| LidarSpec { n_beams: 360, max_range, ..LidarSpec::default() }.build().unwrap();
    let vehicle = VehicleSpec::default().build().unwrap();
    let source = WorldSpec::Room(RoomSpec { kinds: Kinds { r#box: 1.0, ..Kinds::default() }, ..RoomSpec::default() });
    let source = source.build(vehicle.footprint()).unwrap();
    let (mut near, mut far) = ([0.0; 360], [0.0; 360]);
    for index in 0..50 {
        let scenario = source.scenario(6, index).unwrap();
        lidar(2.0).scan(&scenario.world, &scenario.start, &mut stream(0, "noise", 0), &mut near);
        lidar(30.0).scan(&scenario.world, &scenario.start, &mut stream(0, "noise", 0), &mut far);
        for (a, b) in near.iter().zip(&far) {
            assert!((a - b.min(2.0)).abs() < 1e-6);
        }
    }
}
