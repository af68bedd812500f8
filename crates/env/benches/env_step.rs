//! Time of one environment's step (vehicle, collision, scan, angle, reward, observation, resets) under random actions.
//!
//! `env_step/36` and `env_step/360`: beams, in a batch of 64. `env_scaling/envs/*`: copies in a batch, on one thread and on two.
//! `env_scaling/obstacles/*`: obstacles in a room as dense as the default's small one. `reset`: what a new episode costs.

use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use headway_env::{Env, NavEnv, NavSpec, Navigator, Step};
use headway_sensors::LidarSpec;
use headway_sim::{Interval, Quantity, RoomSpec, WorldSpec, stream};
use rand::RngExt;

fn with_beams(n_beams: usize) -> NavSpec {
    NavSpec { lidar: LidarSpec { n_beams, ..LidarSpec::default() }, ..NavSpec::default() }
}

/// Measures steps of `n_envs` copies, in time per copy.
fn bench(group: &mut BenchmarkGroup<'_, WallTime>, name: String, spec: &NavSpec, n_envs: usize, n_threads: usize) {
    let n_threads = NonZeroUsize::new(n_threads).expect("one or more");
    let mdp = spec.build().expect("valid");
    let mut env = NavEnv::new(mdp, n_envs).on_threads(n_threads).expect("threads start");
    let mut step = Step::new(n_envs, env.obs_dim());
    env.reset(0, &mut step.obs).expect("there is room");
    let mut rng = stream(0, "actions", 0);
    let n_actions = env.n_actions() as u32;
    let mut actions = vec![0; n_envs];
    group.throughput(Throughput::Elements(1));
    group.bench_function(name, |b| {
        b.iter_custom(|n_steps| {
            let n_batches = n_steps.div_ceil(n_envs as u64);
            let mut elapsed = Duration::ZERO;
            for _ in 0..n_batches {
                actions.iter_mut().for_each(|action| *action = rng.random_range(0..n_actions));
                let start = Instant::now();
                env.step(black_box(&actions), &mut step).expect("actions exist");
                elapsed += start.elapsed();
            }
            elapsed.mul_f64(n_steps as f64 / (n_batches * n_envs as u64) as f64)
        });
    });
}

fn env_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("env_step");
    for n_beams in [36, 360] {
        bench(&mut group, n_beams.to_string(), &with_beams(n_beams), 64, 1);
    }
    group.finish();
}

fn scaling(c: &mut Criterion) {
    let mut group = c.benchmark_group("env_scaling");
    for n_beams in [36, 72, 180, 360, 720, 1080] {
        bench(&mut group, format!("beams/{n_beams}"), &with_beams(n_beams), 64, 1);
    }
    for n_obstacles in [10, 30, 100, 300, 1000] {
        let side = Interval::Fixed((n_obstacles as f64 / 0.08).sqrt());
        let obstacles = Quantity::Count(n_obstacles);
        let world = WorldSpec::Room(RoomSpec { width: side, height: side, obstacles, ..RoomSpec::default() });
        bench(&mut group, format!("obstacles/{n_obstacles}"), &NavSpec { world, ..NavSpec::default() }, 64, 1);
    }
    for n_envs in [1, 4, 16, 64, 256, 1024] {
        for n_threads in [1, 2] {
            bench(&mut group, format!("envs/{n_envs}/threads/{n_threads}"), &with_beams(36), n_envs, n_threads);
        }
    }
    group.finish();
}

fn reset(c: &mut Criterion) {
    let mut navigator = Navigator::new(NavSpec::default().build().expect("valid"), 0, 0).expect("there is room");
    let mut index = 0;
    c.bench_function("reset/10x15", |b| {
        b.iter(|| {
            index += 1;
            navigator.restart(0, index).expect("there is room");
        });
    });
}

criterion_group!(benches, env_step, scaling, reset);
criterion_main!(benches);
