//! Time to choose one action, with the default network, without candle.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use headway_policy::{Driver, Header, Layer, Policy};

fn act(c: &mut Criterion) {
    let header = Header::default();
    let sizes = [header.obs_dim().expect("valid"), 64, 64, 12];
    let layers = sizes.windows(2).map(|pair| Layer {
        weight: (0..pair[0] * pair[1]).map(|k| ((k % 17) as f32 - 8.0) * 0.02).collect(),
        bias: vec![0.1; pair[1]],
    });
    let (vehicle, lidar) = (header.vehicle.clone(), header.lidar.clone());
    let policy = Policy::new(header, layers.collect()).expect("sizes fit");
    let mut driver = Driver::new(Arc::new(policy), &vehicle, &lidar).expect("the same robot");
    let obs = vec![0.3; sizes[0]];
    c.bench_function("policy_act", |b| b.iter(|| driver.act(black_box(&obs))));
}

criterion_group!(benches, act);
criterion_main!(benches);
