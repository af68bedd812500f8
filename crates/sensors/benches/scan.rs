//! Time of one scan in a furnished room.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use headway_sensors::LidarSpec;
use headway_sim::{VehicleSpec, WorldSpec, stream};

fn scan(c: &mut Criterion) {
    let vehicle = VehicleSpec::default().build().expect("the default is valid");
    let source = WorldSpec::default().build(vehicle.footprint()).expect("the default is valid");
    let scenario = source.sample(&mut stream(0, "layout", 0)).expect("the default has room");
    let mut group = c.benchmark_group("scan");
    for n_beams in [36, 360, 1080] {
        let lidar = LidarSpec { n_beams, ..LidarSpec::default() }.build().expect("valid");
        let mut ranges = vec![0.0; n_beams];
        let mut rng = stream(0, "noise", 0);
        group.throughput(criterion::Throughput::Elements(n_beams as u64));
        group.bench_function(BenchmarkId::new(n_beams.to_string(), "headway"), |b| {
            b.iter(|| lidar.scan(&scenario.world, &scenario.start, &mut rng, &mut ranges));
        });
    }
    group.finish();
}

criterion_group!(benches, scan);
criterion_main!(benches);
