//! Time of a training by the default spec per env step, acting and learning included, beyond its first 10 000 steps.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use headway_experiments::spec::RunSpec;
use headway_experiments::train::Training;

fn train(c: &mut Criterion) {
    let spec = RunSpec::default();
    let mut training = Training::new(&spec, 0).expect("the default is valid");
    while training.n_env_steps() < 10_000 {
        training.step().expect("it learns");
    }
    let mut group = c.benchmark_group("training_step");
    group.throughput(Throughput::Elements(1));
    group.bench_function("default", |b| {
        b.iter_custom(|n_steps| {
            let n_batches = n_steps.div_ceil(spec.train.n_envs as u64);
            let start = std::time::Instant::now();
            for _ in 0..n_batches {
                training.step().expect("it learns");
            }
            start.elapsed().mul_f64(n_steps as f64 / (n_batches * spec.train.n_envs as u64) as f64)
        });
    });
    group.finish();
}

criterion_group!(benches, train);
criterion_main!(benches);
