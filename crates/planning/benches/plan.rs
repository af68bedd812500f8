//! Time to map a room, and to plan a way through it.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use headway_planning::{GridMap, plan};
use headway_sim::{Point, VehicleSpec, WorldSpec};

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

criterion_group!(benches, routes);
criterion_main!(benches);
