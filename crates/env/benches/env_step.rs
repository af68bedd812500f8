//! Time of one environment's step (vehicle, collision, scan, angle, reward, observation, resets), in a
//! batch of 64.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use headway_env::{Env, NavEnv, NavSpec, Step};
use headway_sensors::LidarSpec;
use headway_sim::stream;
use rand::RngExt;

const N_ENVS: usize = 64;

fn env_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("env_step");
    group.throughput(Throughput::Elements(1));
    for n_beams in [36, 360] {
        let spec = NavSpec { lidar: LidarSpec { n_beams, ..LidarSpec::default() }, ..NavSpec::default() };
        let mut env = NavEnv::new(spec.build().expect("valid"), N_ENVS);
        let mut step = Step::new(N_ENVS, env.obs_dim());
        env.reset(0, &mut step.obs).expect("the default has room");
        let mut rng = stream(0, "actions", 0);
        let n_actions = env.n_actions() as u32;
        group.bench_function(n_beams.to_string(), |b| {
            b.iter_custom(|n_steps| {
                let n_batches = n_steps.div_ceil(N_ENVS as u64);
                let start = std::time::Instant::now();
                for _ in 0..n_batches {
                    let actions: [u32; N_ENVS] = std::array::from_fn(|_| rng.random_range(0..n_actions));
                    env.step(black_box(&actions), &mut step).expect("actions exist");
                }
                start.elapsed().mul_f64(n_steps as f64 / (n_batches * N_ENVS as u64) as f64)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, env_step);
criterion_main!(benches);
