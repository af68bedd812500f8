//! What one decision and one gradient step cost, on one thread.
//!
//! `dqn_step/*` and `ddqn_step/*` are whole learn steps: one env step observed, a minibatch drawn from a replay of at
//! least 20 000 transitions, two or three forward passes, Huber loss, backward pass, Adam, and the soft and averaged
//! updates. The rival `plain` is the same gradient step in candle-nn's own layers and AdamW, on a minibatch that is
//! already there, without the average. Set `RAYON_NUM_THREADS=1` to be fair to it: otherwise candle looks up the number
//! of processors before every product, and spreads what one thread does faster. `floor/matmul/512` is a product of two
//! 512 x 512 matrices by candle: 2 x 512^3 floating-point operations at about the most a core can do.

#[path = "../tests/plain/mod.rs"]
mod plain;

use std::hint::black_box;

use candle_core::{Device, Tensor};
use criterion::{Criterion, criterion_group, criterion_main};
use headway_rl::{Agent, Dqn, DqnSpec, Mode, StepBatch, TargetRule};
use plain::{Batch, Plain};

/// Deterministic numbers in `[-1, 1]` without any pattern that matters here.
fn numbers(n: usize, phase: f32) -> Vec<f32> {
    (0..n).map(|i| (12.9898 * i as f32 + phase).sin()).collect()
}

/// The sizes of a problem: observation, hidden layers, actions, minibatch.
#[derive(Clone, Copy)]
struct Sizes {
    obs_dim: usize,
    hidden: usize,
    n_actions: usize,
    batch_size: usize,
}

/// Those of the default task and spec.
const DEFAULT: Sizes = Sizes { obs_dim: 42, hidden: 64, n_actions: 12, batch_size: 64 };

fn observe(agent: &mut Dqn, obs_dim: usize, t: usize) {
    let (obs, next_obs) = (numbers(obs_dim, t as f32), numbers(obs_dim, t as f32 + 1.0));
    let batch = StepBatch {
        obs: &obs,
        actions: &[t as u32 % 12],
        rewards: &[obs[0]],
        next_obs: &next_obs,
        terminated: &[t % 100 == 99],
        truncated: &[false],
    };
    agent.observe(batch).expect("a valid batch");
}

/// An agent with one environment that owes a gradient step after each env step.
fn learner(target: TargetRule, Sizes { obs_dim, hidden, n_actions, batch_size }: Sizes) -> Dqn {
    const N_FILLED: u64 = 20_000;
    let spec = DqnSpec {
        target,
        hidden: vec![hidden; 2],
        batch_size,
        update_every: 1,
        warm_up: N_FILLED,
        ..DqnSpec::default()
    };
    let mut agent = spec.build(obs_dim, n_actions, 1, 100_000_000, 0).expect("a valid spec");
    (0..N_FILLED as usize).for_each(|t| observe(&mut agent, obs_dim, t));
    agent
}

fn act(c: &mut Criterion) {
    let mut agent = DqnSpec::default().build(DEFAULT.obs_dim, DEFAULT.n_actions, 32, 1, 0).expect("a valid spec");
    for n in [1, 32] {
        let (obs, mut actions) = (numbers(n * DEFAULT.obs_dim, 0.0), vec![0; n]);
        c.bench_function(&format!("act/{n}"), |b| {
            b.iter(|| agent.act(black_box(&obs), Mode::Greedy, &mut actions).expect("a valid shape"));
        });
    }
}

fn headway(c: &mut Criterion, id: &str, target: TargetRule, sizes: Sizes) {
    let mut agent = learner(target, sizes);
    // Back and forth, so that every step begins where the one before led to.
    let mut obs = [numbers(sizes.obs_dim, 0.0), numbers(sizes.obs_dim, 1.0)];
    c.bench_function(id, |b| {
        b.iter(|| {
            obs.swap(0, 1);
            let batch = StepBatch {
                obs: &obs[0],
                actions: &[3],
                rewards: &[0.5],
                next_obs: &obs[1],
                terminated: &[false],
                truncated: &[false],
            };
            agent.observe(black_box(batch)).expect("a valid batch");
            agent.update().expect("finite").expect("due")
        });
    });
}

fn plain(c: &mut Criterion, id: &str, target: TargetRule, sizes: Sizes) {
    let Sizes { obs_dim, hidden, n_actions, batch_size: n } = sizes;
    let spec = DqnSpec { hidden: vec![hidden; 2], ..DqnSpec::default() };
    let layers = spec.build(obs_dim, n_actions, 1, 1, 0).and_then(|agent| agent.layers()).expect("a valid spec");
    let mut rival = Plain::new(target, &layers, 1e-3, 0.01).expect("layers fit");
    let actions: Vec<u32> = (0..n as u32).map(|k| k % n_actions as u32).collect();
    let (obs, next_obs) = (numbers(n * obs_dim, 0.0), numbers(n * obs_dim, 1.0));
    let batch = Batch::new(&obs, &actions, &numbers(n, 2.0), &next_obs, &vec![0.9; n]).expect("a valid batch");
    c.bench_function(id, |b| b.iter(|| rival.step(black_box(&batch)).expect("finite")));
}

fn learn(c: &mut Criterion) {
    let large = Sizes { obs_dim: 40, hidden: 128, n_actions: 15, batch_size: 128 };
    for (id, target, sizes) in [
        ("dqn_step/default", TargetRule::Dqn, DEFAULT),
        ("ddqn_step/default", TargetRule::DoubleDqn, DEFAULT),
        ("ddqn_step/128", TargetRule::DoubleDqn, large),
    ] {
        headway(c, &format!("{id}/headway"), target, sizes);
        plain(c, &format!("{id}/plain"), target, sizes);
    }
    for batch_size in [32, 128, 512, 1024] {
        let id = format!("ddqn_step/batch/{batch_size}");
        headway(c, &id, TargetRule::DoubleDqn, Sizes { batch_size, ..DEFAULT });
    }
}

fn floor(c: &mut Criterion) {
    let matrix = |phase| Tensor::from_vec(numbers(512 * 512, phase), (512, 512), &Device::Cpu).expect("it fits");
    let (a, b) = (matrix(0.0), matrix(1.0));
    c.bench_function("floor/matmul/512", |bench| bench.iter(|| a.matmul(black_box(&b)).expect("shapes agree")));
}

criterion_group!(benches, act, learn, floor);
criterion_main!(benches);
