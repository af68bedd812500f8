//! Time of one control period of a vehicle among obstacles, and of one scenario.

use criterion::{Criterion, criterion_group, criterion_main};
use headway_sim::{Command, VehicleSpec, VehicleState, WorldSpec};
use std::hint::black_box;

fn step(c: &mut Criterion) {
    let vehicle = VehicleSpec::default().build().expect("the default is valid");
    let source = WorldSpec::default().build(vehicle.footprint()).expect("the default is valid");
    let scenario = source.scenario(0, 0).expect("the default has room");
    c.bench_function("vehicle_step", |b| {
        let mut state = VehicleState::at_rest(scenario.start);
        b.iter(|| {
            let command = Command { speed: 1.0, yaw_rate: 0.5 };
            let motion = vehicle.step(&scenario.world, &mut state, black_box(command));
            if motion.collided {
                state = VehicleState::at_rest(scenario.start);
            }
            motion.distance
        });
    });
    c.bench_function("scenario/10x15", |b| {
        let mut index = 0;
        b.iter(|| {
            index += 1;
            source.scenario(1, index).expect("the default has room")
        });
    });
}

criterion_group!(benches, step);
criterion_main!(benches);
