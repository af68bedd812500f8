use super::*;
use headway_sim::{Twist, VehicleSpec};
use proptest::prelude::*;

fn jackal() -> VehicleSpec {
    let footprint = Shape::Box { length: 0.42, width: 0.33 };
    VehicleSpec { footprint, control_period: 0.05, ..VehicleSpec::default() }
}

fn sensed<'a>(vehicle: &'a VehicleSpec, scan: &'a [f32], beam_angles: &'a [f64], x: f64) -> Sensed<'a> {
    let (pose, goal) = (Pose::new([x, 0.02].into(), 0.4), Point::new(5.0, 0.0));
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

proptest! {
    /// Updated bit by bit, and from scratch with a look at every mark.
    #[test]
    fn costs_are_those_of_the_nearest_mark(
        scans in prop::collection::vec(prop::collection::vec(0.1..5.5_f32, 40), 1..4),
        inflation_radius in 0.0..0.8,
    ) {
        let vehicle = jackal();
        let angles: Vec<_> = (0..40).map(|k| f64::from(k) * 0.157 - 3.0).collect();
        let map = ScanMapSpec { max_size: 6.0, ..ScanMapSpec::default() };
        let mut costmap = CostmapSpec { inflation_radius, map, ..CostmapSpec::default() }.build().unwrap();
        for (k, scan) in scans.iter().enumerate() {
            prop_assert!(costmap.update(&sensed(&vehicle, scan, &angles, k as f64 * 0.3)));
        }
        let marks: Vec<_> = costmap.map().marked().collect();
        let window = *costmap.window();
        for index in 0..window.n_x * window.n_y {
            let center = window.center((index % window.n_x, index / window.n_x));
            let nearest = marks.iter().map(|mark| (mark - center).norm()).fold(f64::INFINITY, f64::min);
            let nearest = (nearest / 0.05).powi(2).round().sqrt() * 0.05;
            let cost = |nearest: f64| costmap.spec().cost(nearest, 0.265);
            let found = costmap.cost_at(&center);
            prop_assert!(found.abs_diff(cost(nearest)) <= 1 || cost(nearest - 1e-9) == found, "{center} {nearest}");
        }
    }
}

#[test]
fn what_lies_within_the_footprint_is_free() {
    let (vehicle, angles) = (jackal(), [0.0, 0.1]);
    for (footprint_clearing, n_marks) in [(true, 1), (false, 2)] {
        let mut costmap = CostmapSpec { footprint_clearing, ..CostmapSpec::default() }.build().unwrap();
        costmap.update(&sensed(&vehicle, &[0.3, 0.45], &angles, 0.0));
        assert_eq!(costmap.map().marked().count(), n_marks);
        // Driving over what was marked clears it.
        costmap.update(&sensed(&vehicle, &[], &angles, 0.3));
        assert_eq!(costmap.map().marked().count(), if footprint_clearing { 0 } else { 2 });
    }
}

#[test]
fn updates_come_at_their_period_and_scans_late() {
    let vehicle = jackal();
    let mut costmap = CostmapSpec { update_period: 0.2, ..CostmapSpec::default() }.build().unwrap();
    let updates: Vec<_> = (0..9).map(|_| costmap.update(&sensed(&vehicle, &[1.0], &[0.0], 0.0))).collect();
    assert_eq!(updates, [true, false, false, false, true, false, false, false, true]);

    let mut costmap = CostmapSpec { latency: 0.1, ..CostmapSpec::default() }.build().unwrap();
    let seen = [1.0, 1.5, 2.0].map(|range| {
        let updated = costmap.update(&sensed(&vehicle, &[range], &[0.0], 0.0));
        let mark = costmap.map().marked().next();
        mark.map(|mark| (updated, (mark.coords.norm() * 10.0).round()))
    });
    assert_eq!(seen, [None, None, Some((true, 10.0))]);
    costmap.update(&sensed(&vehicle, &[4.0], &[0.0], 0.0));
    assert!(costmap.map().marked().any(|mark| (mark.coords.norm() - 1.5).abs() < 0.06));
}

#[test]
fn resetting_forgets() {
    let vehicle = jackal();
    let mut costmap = CostmapSpec::default().build().unwrap();
    costmap.update(&sensed(&vehicle, &[1.0], &[0.0], 0.0));
    let mark = costmap.map().marked().next().unwrap();
    assert_eq!(costmap.cost_at(&mark), LETHAL);
    costmap.clear_beyond(&Point::origin(), 0.5);
    assert_eq!(costmap.cost_at(&mark), 0);
    costmap.update(&sensed(&vehicle, &[1.0], &[0.0], 0.0));
    costmap.reset();
    assert_eq!(costmap.cost_at(&mark), 0);
    let footprint = Some(Shape::Disc { radius: -1.0 });
    let error = CostmapSpec { footprint, ..CostmapSpec::default() }.build().unwrap_err();
    assert_eq!(error.field, "footprint.radius");
    assert!(CostmapSpec { padding: -0.1, ..CostmapSpec::default() }.build().is_err());
    // The costs around a mark were computed for days.
    let error = CostmapSpec { padding: 1e6, ..CostmapSpec::default() }.build().unwrap_err();
    assert_eq!(error.to_string(), "padding = 1000000: must be from 0 to 10");
}
