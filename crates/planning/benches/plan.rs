//! Time to map a room, and to plan a way through it.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use headway_planning::{Controller, GridMap, PurePursuit, RegulatedPursuitSpec, Sensed, ShieldSpec, VfhSpec, plan};
use headway_sim::{Point, Twist, VehicleSpec, WorldSpec};

fn routes(c: &mut Criterion) {
    let vehicle = VehicleSpec::default().build().expect("valid");
    for (name, spec) in [("10x15", WorldSpec::Room10x15 {}), ("25x25", WorldSpec::Room25x25 {})] {
        let source = spec.build(vehicle.footprint()).expect("valid");
        let scenarios: Vec<_> = (0..16).map(|index| source.scenario(0, index).expect("there is room")).collect();
        let map = |index: usize| GridMap::from_world(&scenarios[index].world, 0.1, 0.25);
        let maps: Vec<_> = (0..16).map(map).collect();
        let mut index = 0;
        c.bench_function(&format!("grid_map/{name}"), |b| {
            b.iter(|| {
                index = (index + 1) % 16;
                map(black_box(index))
            });
        });
        c.bench_function(&format!("plan/{name}"), |b| {
            b.iter(|| {
                index = (index + 1) % 16;
                let start: Point = scenarios[index].start.translation.vector.into();
                plan(&maps[index], &start, &scenarios[index].goal)
            });
        });
    }
}

/// One command of each driver, at 1 m/s in a full room with 720 beams all round.
fn drivers(c: &mut Criterion) {
    let vehicle = VehicleSpec::default().build().expect("valid");
    let source = WorldSpec::Room10x15 {}.build(vehicle.footprint()).expect("valid");
    let beam_angles: Vec<f64> = (0..720).map(|k| f64::from(k) / 720.0 * std::f64::consts::TAU).collect();
    let looks: Vec<_> = (0..16)
        .map(|index| {
            let scenario = source.scenario(0, index).expect("there is room");
            let origin = Point::from(scenario.start.translation.vector);
            let beam = |angle: &f64| {
                let direction = scenario.start.rotation * Point::new(angle.cos(), angle.sin()).coords;
                scenario.world.cast_ray(&origin, &direction, 10.0) as f32
            };
            (scenario.start, scenario.goal, beam_angles.iter().map(beam).collect::<Vec<_>>())
        })
        .collect();
    let pursuit = RegulatedPursuitSpec::default().build().expect("valid");
    let vfh = VfhSpec::default().build().expect("valid");
    let drivers: [(&str, Box<dyn Controller>); 4] = [
        ("pure_pursuit", Box::new(PurePursuit::default())),
        ("regulated_pursuit", Box::new(pursuit)),
        ("vfh", Box::new(vfh)),
        ("shield", Box::new(ShieldSpec::default().build(PurePursuit::default()).expect("valid"))),
    ];
    for (name, mut driver) in drivers {
        let mut index = 0;
        c.bench_function(&format!("command/{name}/720"), |b| {
            b.iter(|| {
                index = (index + 1) % 16;
                let (pose, goal, scan) = &looks[index];
                driver.command(black_box(&Sensed {
                    vehicle: vehicle.spec(),
                    scan,
                    beam_angles: &beam_angles,
                    max_range: 10.0,
                    pose: *pose,
                    twist: Twist::new(1.0, 0.0, 0.0),
                    goal: *goal,
                    route: None,
                }))
            });
        });
    }
}

criterion_group!(benches, routes, drivers);
criterion_main!(benches);
